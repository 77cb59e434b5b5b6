//! What a user means by a material: a path or an embedded name.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use sha2::{Digest, Sha256};

pub mod analytic;
mod facts;
mod loaded;
pub mod merl;
pub mod rgl;

pub use facts::MaterialFacts;
pub use loaded::Loaded;

use crate::files::RegularFile;
use crate::geometry::Symmetry;
use crate::{Error, Result};
use merl::{BinPoint, LookupRule, MerlBrdf, MerlTable, embedded, import_bsdf, load};
use rgl::{BsdfFile, RglBrdf, looks_like_bsdf};

/// Where a material's values come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// A MERL binary, or a `.bsdf` file.
    File(PathBuf),
    /// One of the embedded networks.
    Embedded(String),
}

/// A named material whose values are not loaded yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Material {
    name: String,
    source: Source,
}

impl Material {
    /// Resolves an argument: an embedded name, or a path to a MERL binary or a `.bsdf` file.
    ///
    /// A bare word is an embedded name first; `./nickel` or `nickel.binary` is a path.
    ///
    /// # Errors
    /// [`Error::Argument`] for a word that is neither, with the nearest embedded names; [`Error::Io`] for a path that does
    /// not exist.
    pub fn resolve(argument: &str) -> Result<Self> {
        if embedded::names().iter().any(|n| n == argument) {
            return Ok(Self {
                name: argument.into(),
                source: Source::Embedded(argument.into()),
            });
        }
        let path = Path::new(argument);
        if path.exists() {
            let name = path
                .file_stem()
                .map_or_else(|| argument.into(), |s| s.to_string_lossy().into_owned());
            return Ok(Self {
                name,
                source: Source::File(path.to_owned()),
            });
        }
        if path.extension().is_some() || path.components().count() > 1 {
            return Err(Error::io(path, "open", std::io::ErrorKind::NotFound.into()));
        }
        Err(Error::argument(
            format!("no file and no embedded material is called \"{argument}\""),
            suggestion(argument),
        ))
    }

    /// Short name, without folder or extension.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where the values come from.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// What it is, without loading its values; a `.bsdf` file is read to know.
    ///
    /// # Errors
    /// As [`BsdfFile::open`], for what begins as such a file.
    pub fn facts(&self) -> Result<MaterialFacts> {
        let rgl = match &self.source {
            Source::File(path) if looks_like_bsdf(path) => {
                Some(RglBrdf::new(BsdfFile::open(path)?)).filter(|rgl| !rgl.is_isotropic())
            }
            Source::File(_) | Source::Embedded(_) => None,
        };
        Ok(MaterialFacts {
            symmetry: rgl.as_ref().map_or(Symmetry::Isotropic, RglBrdf::symmetry),
            has_table: rgl.is_none(),
            has_own_sampler: rgl.is_some(),
        })
    }

    /// Whether it is an anisotropic `.bsdf` file, which is read to know.
    ///
    /// # Errors
    /// As [`BsdfFile::open`], for what begins as such a file.
    pub fn is_anisotropic(&self) -> Result<bool> {
        match &self.source {
            Source::File(path) if looks_like_bsdf(path) => {
                Ok(!BsdfFile::open(path)?.is_isotropic())
            }
            Source::File(_) | Source::Embedded(_) => Ok(false),
        }
    }

    /// Loads it: a table with `rule`, for which other materials have no use. An isotropic `.bsdf` file is resampled into a
    /// table.
    ///
    /// # Errors
    /// As [`load`], or as [`BsdfFile::open`].
    pub fn load(&self, rule: LookupRule) -> Result<Loaded> {
        if let Source::File(path) = &self.source
            && looks_like_bsdf(path)
        {
            let rgl = RglBrdf::new(BsdfFile::open(path)?);
            if !rgl.is_isotropic() {
                return Ok(Loaded::from_rgl(Arc::new(rgl)));
            }
        }
        let table = Arc::new(self.load_table()?);
        Ok(Loaded::from_table(Arc::new(MerlBrdf::new(table, rule))))
    }

    /// Loads or decodes the table. A `.bsdf` file, known by its first bytes, is resampled at the centres of bins.
    ///
    /// # Errors
    /// As [`load`], or as [`import_bsdf`]: [`Error::Unsupported`] for an anisotropic file.
    pub fn load_table(&self) -> Result<MerlTable> {
        match &self.source {
            Source::File(path) if looks_like_bsdf(path) => {
                Ok(import_bsdf(path, BinPoint::Centre)?.0)
            }
            Source::File(path) => load(path),
            Source::Embedded(name) => embedded::decode(name)
                .ok_or_else(|| Error::argument(format!("no material {name}"), suggestion(name))),
        }
    }

    /// SHA-256, in hexadecimal, of the bytes that define the material: the file, or the embedded network's weights.
    ///
    /// # Errors
    /// [`Error::Io`] if the file can't be read.
    pub fn sha256(&self) -> Result<String> {
        let digest = match &self.source {
            Source::File(path) => digest_of(RegularFile::open(path)?)?,
            Source::Embedded(name) => Sha256::digest(embedded::weights(name).unwrap_or_default()),
        };
        Ok(digest.iter().map(|b| format!("{b:02x}")).collect())
    }
}

/// Of the file's length when it was opened, so that one that grows meanwhile has an end.
fn digest_of(mut file: RegularFile) -> Result<sha2::digest::Output<Sha256>> {
    let (mut hash, mut buffer) = (Sha256::new(), vec![0; 1 << 16]);
    let mut at = 0;
    while at < file.len() {
        let piece = (file.len() - at).min(buffer.len() as u64) as usize;
        file.read_at(at, &mut buffer[..piece])?;
        hash.update(&buffer[..piece]);
        at += piece as u64;
    }
    Ok(hash.finalize())
}

/// "did you mean …?", with the three nearest embedded names.
fn suggestion(word: &str) -> String {
    let word = word.to_lowercase().replace(['_', ' '], "-");
    let mut ranked: Vec<_> = embedded::names()
        .iter()
        .map(|n| (strsim::jaro_winkler(&word, n), n.as_str()))
        .collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(b.1)));
    let nearest: Vec<_> = ranked.iter().take(3).map(|r| r.1).collect();
    format!(
        "did you mean {}? `merlkit list` shows all names",
        nearest.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn misspelt_names_are_answered_with_the_nearest() {
        let message = Material::resolve("nikel").unwrap_err().to_string();
        assert!(message.contains("nickel"), "{message}");
        let message = Material::resolve("Red_Plastik").unwrap_err().to_string();
        assert!(message.contains("red-plastic"), "{message}");
    }

    #[test]
    fn a_missing_path_is_named_as_a_path() {
        let message = Material::resolve("no/such.binary").unwrap_err().to_string();
        assert!(
            message.starts_with("no/such.binary: cannot open"),
            "{message}"
        );
    }
}
