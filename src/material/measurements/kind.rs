//! Which kind of measurements a file holds.

use std::path::Path;

use super::polarised::is_polarised;
use crate::files::{RegularFile, SIGNATURE_BYTES, looks_like_utia};

/// How a file that is no material of its own holds measurements.
///
/// The example of [`Measurements`](crate::material::measurements::Measurements) makes a table from a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeasurementKind {
    /// A text with a pair of directions and its values a row: [`super::Measurements::read`].
    List,
    /// A table as an array of numpy: [`super::read_array`].
    Array,
    /// Mueller matrices on a grid, a `.pbsdf` file (Baek et al. 2020): [`super::Measurements::read`] takes their unpolarised part.
    Polarised,
    /// A file of the UTIA database (Filip & Vávra 2014): [`super::Measurements::read`] takes its mean over rotations about the normal.
    Utia,
}

impl MeasurementKind {
    /// The kind of a file by its first bytes, for UTIA's by its size; `None` for what is of no kind, and for what can't be read.
    pub fn detect(path: &Path) -> Option<Self> {
        let mut file = RegularFile::open(path).ok()?;
        let mut start = [0; 256];
        let start = &mut start[..file.len().min(256) as usize];
        file.read_at(0, start).ok()?;
        if start.starts_with(b"\x93NUMPY") || start.starts_with(b"PK\x03\x04") {
            return Some(Self::Array);
        }
        if is_polarised(&mut file) {
            return Some(Self::Polarised);
        }
        if looks_like_utia(&start[..start.len().min(SIGNATURE_BYTES)], file.len()) {
            return Some(Self::Utia);
        }
        // The last character may be cut.
        let text = match std::str::from_utf8(start) {
            Ok(text) => text,
            Err(error) if error.error_len().is_none() => {
                std::str::from_utf8(&start[..error.valid_up_to()]).unwrap_or_default()
            }
            Err(_) => return None,
        };
        let is_printable = text.chars().all(|c| !c.is_control() || c.is_whitespace());
        let is_text = !text.is_empty() && is_printable && !text.starts_with('<');
        is_text.then_some(Self::List)
    }
}
