//! Read-only memory maps. The crate's only `unsafe` lives here.

use std::path::Path;

use super::RegularFile;
use crate::{Error, Result};

/// A file mapped for reading, for callers who know that nobody shortens it meanwhile: see [`crate::files`].
#[derive(Debug)]
pub struct Mapped {
    map: Option<memmap2::Mmap>,
}

impl Mapped {
    /// Maps `path`, which must be a regular file. An empty file maps to an empty slice.
    ///
    /// # Errors
    /// As [`RegularFile::open`].
    pub fn open(path: &Path) -> Result<Self> {
        let file = RegularFile::open(path)?;
        let map = if file.is_empty() {
            None
        } else {
            Some(map_readonly(&file)?)
        };
        Ok(Self { map })
    }

    /// The file's bytes.
    pub fn bytes(&self) -> &[u8] {
        self.map.as_deref().unwrap_or(&[])
    }
}

#[allow(unsafe_code)]
fn map_readonly(file: &RegularFile) -> Result<memmap2::Mmap> {
    // SAFETY: the map is private to `Mapped`, read-only, and decoded at once; another process that truncates the file in
    // that moment can end this one with SIGBUS, but cannot make it read outside the map.
    unsafe { memmap2::Mmap::map(file.file()) }.map_err(|e| Error::io(file.path(), "map", e))
}
