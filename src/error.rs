//! The one error type: a kind, a place and what to do about it.

use std::path::{Path, PathBuf};
use std::{fmt, io};

/// Result of every fallible call in this crate.
///
/// See [`Error`] for an example.
pub type Result<T> = std::result::Result<T, Error>;

/// What went wrong, where, and the fix.
///
/// # Examples
/// ```
/// use merlkit::{Error, Material};
///
/// // Every message says what is wrong and what to do about it.
/// match Material::resolve("nikel") {
///     Err(Error::Argument { what, fix }) => {
///         assert!(what.contains("nikel"));
///         assert!(fix.contains("nickel"));
///     }
///     other => panic!("{other:?}"),
/// }
/// ```
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused an operation on a file.
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was attempted, as a verb: "open", "write".
        action: &'static str,
        /// The system's answer.
        source: io::Error,
    },
    /// A file's content contradicts its format.
    Invalid {
        /// The file.
        path: PathBuf,
        /// Where in the file, in bytes from its start.
        offset: u64,
        /// What the format demands there.
        expected: String,
        /// What the file has there.
        found: String,
        /// What the user can do.
        fix: String,
    },
    /// The file is well formed but of a kind this crate does not read.
    Unsupported {
        /// The file.
        path: PathBuf,
        /// The kind that was met.
        what: String,
        /// What the user can do.
        fix: String,
    },
    /// An argument is outside its documented domain.
    Argument {
        /// What is wrong.
        what: String,
        /// What the user can do.
        fix: String,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io {
                path,
                action,
                source,
            } => write!(f, "{}: cannot {action}: {source}", path.display()),
            Self::Invalid {
                path,
                offset,
                expected,
                found,
                fix,
            } => write!(
                f,
                "{}: at byte {offset}: expected {expected}, found {found}; {fix}",
                path.display()
            ),
            Self::Unsupported { path, what, fix } => {
                write!(f, "{}: {what} is not supported; {fix}", path.display())
            }
            Self::Argument { what, fix } => write!(f, "{what}; {fix}"),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Io { source, .. } => Some(source),
            Self::Invalid { .. } | Self::Unsupported { .. } | Self::Argument { .. } => None,
        }
    }
}

/// Words as a list of choices, for messages: "a, b or c".
pub(crate) fn list_words(words: &[&str]) -> String {
    match words {
        [] => String::new(),
        [word] => (*word).to_owned(),
        [first @ .., tail] => format!("{} or {tail}", first.join(", ")),
    }
}

impl Error {
    /// An [`Error::Io`] at `path`.
    pub fn io(path: &Path, action: &'static str, source: io::Error) -> Self {
        Self::Io {
            path: path.to_owned(),
            action,
            source,
        }
    }

    /// An [`Error::Argument`].
    pub fn argument(what: impl Into<String>, fix: impl Into<String>) -> Self {
        Self::Argument {
            what: what.into(),
            fix: fix.into(),
        }
    }

    /// An [`Error::Invalid`] at byte `offset` of `path`.
    pub fn invalid(
        path: &Path,
        offset: u64,
        expected: impl Into<String>,
        found: impl Into<String>,
        fix: impl Into<String>,
    ) -> Self {
        Self::Invalid {
            path: path.to_owned(),
            offset,
            expected: expected.into(),
            found: found.into(),
            fix: fix.into(),
        }
    }
}
