//! How a command ends.

use std::io;
use std::path::Path;
use std::process::ExitCode;

/// What every command returns: its exit status, or why it stopped.
pub type Outcome = Result<ExitCode, Failure>;

/// Why a command stopped.
#[derive(Debug)]
pub enum Failure {
    /// The reader of standard output closed it, as `head` does. Not an error.
    ReaderGone,
    /// Anything else.
    Error(merlkit::Error),
}

impl From<merlkit::Error> for Failure {
    fn from(error: merlkit::Error) -> Self {
        Self::Error(error)
    }
}

impl Failure {
    /// A failed write to standard output.
    pub fn stdout(error: io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            Self::ReaderGone
        } else {
            Self::Error(merlkit::Error::io(
                Path::new("standard output"),
                "write",
                error,
            ))
        }
    }
}
