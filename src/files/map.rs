//! Read-only memory maps. The crate's only `unsafe` lives here.

use std::fs::File;
use std::path::{Path, PathBuf};

use crate::{Error, Result};

/// A file mapped for reading.
///
/// The bytes follow the file while the map lives, so callers decode them into their own memory at once and keep nothing
/// that points here. Truncating a file *while* it is decoded is the one thing mapping cannot survive.
#[derive(Debug)]
pub struct Mapped {
    path: PathBuf,
    map: Option<memmap2::Mmap>,
}

impl Mapped {
    /// Maps `path`, which must be a regular file. An empty file maps to an empty slice.
    pub fn open(path: &Path) -> Result<Self> {
        let metadata = std::fs::metadata(path).map_err(|e| Error::io(path, "open", e))?;
        if !metadata.is_file() {
            return Err(Error::Unsupported {
                path: path.to_owned(),
                what: if metadata.is_dir() { "a folder" } else { "a pipe or device" }.into(),
                fix: "name a regular file".into(),
            });
        }
        let file = File::open(path).map_err(|e| Error::io(path, "open", e))?;
        let len = file.metadata().map_err(|e| Error::io(path, "open", e))?.len();
        let map = if len == 0 { None } else { Some(map_readonly(&file, path)?) };
        Ok(Self { path: path.to_owned(), map })
    }

    /// The file's bytes.
    pub fn bytes(&self) -> &[u8] {
        self.map.as_deref().unwrap_or(&[])
    }

    /// The path that was opened.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

#[allow(unsafe_code)]
fn map_readonly(file: &File, path: &Path) -> Result<memmap2::Mmap> {
    // SAFETY: the map is private to `Mapped`, read-only, and decoded at once; another process that truncates the file in
    // that moment can end this one with SIGBUS, but cannot make it read outside the map.
    unsafe { memmap2::Mmap::map(file) }.map_err(|e| Error::io(path, "map", e))
}
