//! Measurements as people have them, lists of angles with values or arrays of numpy, and how they become MERL tables.

mod array;
mod columns;
mod fill;
mod scattered;
mod text;

use std::path::Path;

use crate::files::RegularFile;

pub use array::read_array;
pub use columns::AngleUnit;
pub use fill::fill_gaps;
pub use scattered::Measurements;

/// How a file that is no material of its own holds measurements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeasurementKind {
    /// A text with a pair of directions and its values a row: [`Measurements::read`].
    List,
    /// A table as an array of numpy: [`read_array`].
    Array,
}

impl MeasurementKind {
    /// The kind of a file by its first bytes; `None` for what is neither text nor an array, and for what can't be read.
    pub fn detect(path: &Path) -> Option<Self> {
        let mut file = RegularFile::open(path).ok()?;
        let mut start = [0; 256];
        let start = &mut start[..file.len().min(256) as usize];
        file.read_at(0, start).ok()?;
        if start.starts_with(b"\x93NUMPY") || start.starts_with(b"PK\x03\x04") {
            return Some(Self::Array);
        }
        // The last character may be cut.
        let text = match std::str::from_utf8(start) {
            Ok(text) => text,
            Err(error) if error.error_len().is_none() => {
                std::str::from_utf8(&start[..error.valid_up_to()]).unwrap_or_default()
            }
            Err(_) => return None,
        };
        let printable = |c: char| !c.is_control() || c.is_whitespace();
        let is_text = !text.is_empty() && text.chars().all(printable) && !text.starts_with('<');
        is_text.then_some(Self::List)
    }
}
