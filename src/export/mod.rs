//! A material with its half-vector table for other programs: a C header, which is C++ and GLSL as well, files that one header
//! loads at run time, and numpy's `.npz`.
//!
//! What is written is values and the tables of [`crate::sampler::HalfVectorTable`]; files for renderers that have a format of
//! their own are [`crate::material::rgl`]'s business, and how well a table draws is the caller's.

mod contents;
mod header;
mod identifier;
#[cfg(feature = "npz")]
mod npz;
mod packed;
mod runtime;
mod shaders;
mod table_code;
mod templates;
mod wgsl;

use std::path::{Path, PathBuf};

use crate::files::{Overwrite, write_new};
use crate::{Error, Result};
use contents::little_endian;

pub use contents::Export;
pub use identifier::{identifier, refuse_same_identifier};

impl Export {
    /// The text of the header: ASCII, the same for the same material, settings and lookup rule.
    pub fn header(&self) -> String {
        header::text(self)
    }

    /// Writes [`Self::header`]; returns the file's length in bytes.
    ///
    /// # Errors
    /// As [`write_new`]; [`crate::Error::Argument`] for a table of which cells are valid in some channels only, under a linear rule.
    pub fn write_header(&self, path: &Path, overwrite: Overwrite) -> Result<u64> {
        self.require_whole_cells()?;
        write_bytes(self.header().as_bytes(), path, overwrite)
    }

    /// Writes the values that the header's `eval` reads: [`Self::values`] as little-endian f32; returns the file's length.
    ///
    /// # Errors
    /// As [`Self::write_header`].
    pub fn write_values(&self, path: &Path, overwrite: Overwrite) -> Result<u64> {
        self.require_whole_cells()?;
        write_bytes(&little_endian(self.values()), path, overwrite)
    }

    /// The names and texts of the code that reads files of [`Self::write_runtime`]: `merlkit.h` for C and C++, and shaders. They
    /// are ASCII and the same for all materials.
    pub fn runtime_code() -> [(&'static str, String); 4] {
        [
            ("merlkit.h", runtime::c_header()),
            ("merlkit.glsl", shaders::glsl()),
            ("merlkit.hlsl", shaders::hlsl()),
            ("merlkit.wgsl", shaders::wgsl()),
        ]
    }

    /// [`Self::runtime_code`] that `folder` does not hold yet, with its paths. It is the same for all materials, so that more of them can be
    /// exported to one folder.
    pub fn missing_runtime_code(folder: &Path) -> Vec<(PathBuf, String)> {
        let mut missing = Vec::new();
        for (name, text) in Self::runtime_code() {
            let path = folder.join(name);
            if std::fs::read(&path).ok().as_deref() != Some(text.as_bytes()) {
                missing.push((path, text));
            }
        }
        missing
    }

    /// The table and [`Self::values`] as the bytes of a file for [`Self::runtime_code`].
    ///
    /// # Errors
    /// [`crate::Error::Argument`] for a table of which cells are valid in some channels only, under a linear rule.
    pub fn runtime_bytes(&self) -> Result<Vec<u8>> {
        self.require_whole_cells()?;
        Ok(runtime::file(self))
    }

    /// Writes [`Self::runtime_bytes`]; returns the file's length in bytes.
    ///
    /// # Errors
    /// As [`Self::write_header`].
    pub fn write_runtime(&self, path: &Path, overwrite: Overwrite) -> Result<u64> {
        write_bytes(&self.runtime_bytes()?, path, overwrite)
    }

    /// Writes values, tables and settings as arrays that `numpy.load` reads; returns the file's length in bytes.
    ///
    /// # Errors
    /// As [`write_new`].
    #[cfg(feature = "npz")]
    pub fn write_npz(&self, path: &Path, overwrite: Overwrite) -> Result<u64> {
        write_new(path, overwrite, |out| {
            npz::write(self, out).map_err(|e| Error::io(path, "write", e))
        })?;
        path.metadata()
            .map(|m| m.len())
            .map_err(|e| Error::io(path, "read", e))
    }
}

fn write_bytes(bytes: &[u8], path: &Path, overwrite: Overwrite) -> Result<u64> {
    write_new(path, overwrite, |out| {
        out.write_all(bytes)
            .map_err(|e| Error::io(path, "write", e))
    })?;
    Ok(bytes.len() as u64)
}
