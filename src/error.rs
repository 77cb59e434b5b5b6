//! The one error type: a kind, a place and what to do about it.

use std::io;
use std::path::{Path, PathBuf};

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
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused an operation on a file.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was attempted, as a verb: "open", "write".
        action: &'static str,
        /// The system's answer.
        source: io::Error,
    },
    /// A file's content contradicts its format.
    #[error("{}: at byte {offset}: expected {expected}, found {found}; {fix}", path.display())]
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
    #[error("{}: {what} is not supported; {fix}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// The kind that was met.
        what: String,
        /// What the user can do.
        fix: String,
    },
    /// An argument is outside its documented domain.
    #[error("{what}; {fix}")]
    Argument {
        /// What is wrong.
        what: String,
        /// What the user can do.
        fix: String,
    },
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
