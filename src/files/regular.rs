//! Regular files, read through the operating system's `read`.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::{Error, Result};

/// A regular file open for reading, and its length when it was opened.
///
/// Whatever happens to the file meanwhile, a read ends with bytes or with an error: one that has become shorter is
/// [`Error::Invalid`] at its new end.
///
/// [`SamplerFile::open`](crate::sampler::store::SamplerFile::open) reads through it; that type has an example.
#[derive(Debug)]
pub struct RegularFile {
    path: PathBuf,
    file: File,
    len: u64,
}

impl RegularFile {
    /// Opens `path`. A pipe or device is refused before it is opened, since opening a pipe waits for its writer.
    ///
    /// # Errors
    /// [`Error::Io`] if it can't be opened; [`Error::Unsupported`] if it is no regular file.
    pub fn open(path: &Path) -> Result<Self> {
        let failed = |e| Error::io(path, "open", e);
        refuse_irregular(&std::fs::metadata(path).map_err(failed)?, path)?;
        let file = File::open(path).map_err(failed)?;
        let metadata = file.metadata().map_err(failed)?;
        refuse_irregular(&metadata, path)?;
        Ok(Self {
            path: path.to_owned(),
            file,
            len: metadata.len(),
        })
    }

    /// Length in bytes when the file was opened.
    pub fn len(&self) -> u64 {
        self.len
    }

    /// Whether the file was empty when it was opened.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The path that was opened.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The open file itself.
    pub(super) fn file(&self) -> &File {
        &self.file
    }

    /// Fills `out` with the bytes from `offset` on.
    ///
    /// # Errors
    /// [`Error::Invalid`] at the end of a file that ends before; [`Error::Io`] if it can't be read.
    pub fn read_at(&mut self, offset: u64, out: &mut [u8]) -> Result<()> {
        let read = self
            .file
            .seek(SeekFrom::Start(offset))
            .and_then(|_| self.file.read_exact(out));
        read.map_err(|e| self.explain(e, offset + out.len() as u64))
    }

    /// SHA-256 of the bytes, in hexadecimal: as many as there were when it was opened, so that a file that grows has an end.
    ///
    /// # Errors
    /// As [`Self::read_at`].
    pub fn sha256(mut self) -> Result<String> {
        let mut hash = Sha256::new();
        let mut buffer = vec![0; 1 << 16];
        let mut offset = 0;
        while offset < self.len {
            let piece = (self.len - offset).min(buffer.len() as u64) as usize;
            self.read_at(offset, &mut buffer[..piece])?;
            hash.update(&buffer[..piece]);
            offset += piece as u64;
        }
        Ok(hash.finalize().iter().map(|b| format!("{b:02x}")).collect())
    }

    /// All bytes, at most `limit`.
    ///
    /// # Errors
    /// [`Error::Unsupported`] if there are more than `limit`; otherwise as [`Self::read_at`].
    pub fn read_all(mut self, limit: u64) -> Result<Vec<u8>> {
        let len = usize::try_from(self.len)
            .ok()
            .filter(|_| self.len <= limit)
            .ok_or_else(|| {
                let what = format!("a file of {} bytes", self.len);
                Error::Unsupported {
                    path: self.path.clone(),
                    what,
                    fix: format!("name one of at most {limit} bytes"),
                }
            })?;
        let mut out = Vec::new();
        if out.try_reserve_exact(len).is_err() {
            let error = std::io::ErrorKind::OutOfMemory.into();
            return Err(Error::io(&self.path, "read", error));
        }
        out.resize(len, 0);
        self.read_at(0, &mut out)?;
        Ok(out)
    }

    /// A file that ends early says where; anything else is the system's answer.
    fn explain(&self, error: std::io::Error, wanted: u64) -> Error {
        if error.kind() != std::io::ErrorKind::UnexpectedEof {
            return Error::io(&self.path, "read", error);
        }
        let end = self.file.metadata().map_or(0, |m| m.len());
        Error::invalid(
            &self.path,
            end.min(wanted),
            format!(
                "{wanted} bytes: the file had {} when it was opened",
                self.len
            ),
            format!("its end after {end}"),
            "read it again when nothing writes to it, or fetch it again",
        )
    }
}

impl Read for RegularFile {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        self.file.read(out)
    }
}

impl Seek for RegularFile {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.file.seek(to)
    }
}

fn refuse_irregular(metadata: &std::fs::Metadata, path: &Path) -> Result<()> {
    if metadata.is_file() {
        return Ok(());
    }
    Err(Error::Unsupported {
        path: path.to_owned(),
        what: if metadata.is_dir() {
            "a folder"
        } else {
            "a pipe or device"
        }
        .into(),
        fix: "name a regular file".into(),
    })
}
