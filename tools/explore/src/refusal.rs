//! Why a request has no answer.

use std::fmt;

/// An HTTP status of 400 or more, and one line that says what is wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// The HTTP status.
    pub status: u16,
    /// One line for people.
    pub message: String,
}

impl Refusal {
    /// A refusal with a message, whose line ends become blanks.
    pub fn new(status: u16, message: impl Into<String>) -> Self {
        let message: String = message.into();
        Self {
            status,
            message: message.replace(['\n', '\r'], " "),
        }
    }

    /// A request that nobody can answer as it is.
    pub(crate) fn bad(message: impl Into<String>) -> Self {
        Self::new(400, message)
    }

    /// A key or a material that is not there.
    pub(crate) fn missing(message: impl Into<String>) -> Self {
        Self::new(404, message)
    }
}

impl From<merlkit::Error> for Refusal {
    fn from(error: merlkit::Error) -> Self {
        Self::bad(error.to_string())
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({})", self.message, self.status)
    }
}
