//! What a format of materials does, and where it reads them from.

use std::path::{Path, PathBuf};

use super::facts::MaterialFacts;
use super::loaded::Loaded;
use super::merl::{CellFormat, LookupRule};
use crate::Result;

/// How a table is read; other formats have no use for it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TableReading {
    /// What it says between its samples.
    pub rule: LookupRule,
    /// Whether a channel can be invalid alone.
    pub channels_apart: bool,
    /// How its cells are kept in memory.
    pub cell_format: CellFormat,
}

/// How one kind of material is recognised and loaded.
pub(super) trait MaterialFormat: Sync {
    /// Whether materials of this origin are of this format; a file is known by its first bytes.
    fn recognises(&self, origin: &Origin) -> bool;

    /// What the material is, with no more work than that takes.
    ///
    /// # Errors
    /// Those of reading the material.
    fn facts(&self, origin: &Origin) -> Result<MaterialFacts>;

    /// Loads the material.
    ///
    /// # Errors
    /// Those of reading the material.
    fn load(&self, origin: &Origin, reading: TableReading) -> Result<Loaded>;
}

/// Where a material's values come from.
///
/// The example of [`Material`](crate::material::Material) goes from an argument to a loaded material.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A MERL binary, or a `.bsdf` file.
    File(PathBuf),
    /// One of the embedded networks, by its name.
    Embedded(String),
    /// A formula with all its parameters, as "lambert:reflectance=0.5".
    Formula(String),
}

impl Origin {
    /// What it holds, as a path: of a file its path, otherwise the name or the formula's text as it is.
    pub(super) fn path(&self) -> &Path {
        match self {
            Self::File(path) => path,
            Self::Embedded(text) | Self::Formula(text) => Path::new(text),
        }
    }
}
