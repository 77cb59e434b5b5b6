//! What a user means by a material, and what is in memory once it is loaded.
//!
//! A [`Material`] is an argument that has been understood: a name and an [`Origin`]. [`Material::facts`] says what can be asked
//! of it, and [`Material::load`] gives [`Loaded`], which every command, sampler and renderer works on.
//!
//! A format is one folder here with a `MaterialFormat`, and one line in `FORMATS`. A formula is one file in [`analytic`], and
//! one line in its list.

use std::path::Path;

use sha2::{Digest, Sha256};

pub mod analytic;
mod facts;
mod format;
mod loaded;
pub mod measurements;
pub mod merl;
pub mod rgl;
mod stored_fit;

pub use facts::MaterialFacts;
pub use format::Origin;
pub use loaded::Loaded;
pub use merl::{LookupRule, MerlBrdf, MerlTable};
pub use rgl::RglBrdf;

use crate::files::RegularFile;
use crate::{Error, Result};
use format::{MaterialFormat, TableReading};
use merl::{CellFormat, embedded};

/// All formats: the first that recognises an origin reads it. What none recognises is read as a MERL binary, which begins
/// with no magic number and whose reader says what is wrong.
const FORMATS: [&dyn MaterialFormat; 4] = [
    &rgl::RglFormat,
    &stored_fit::StoredFits,
    &merl::EmbeddedNetworks,
    &analytic::Formulas,
];

/// A named material whose values are not loaded yet.
///
/// # Examples
/// ```
/// use merlkit::geometry::spherical;
/// use merlkit::{LookupRule, Material};
///
/// let material = Material::resolve("lambert:reflectance=0.5")?;
/// assert!(material.facts()?.is_isotropic());
///
/// let loaded = material.load(LookupRule::Floor)?;
/// let wo = spherical(0.5, 0.0).as_vec3();
/// let wi = spherical(0.6, 3.0).as_vec3();
/// let value = loaded.brdf().eval(wo, wi);
/// assert!((value.x - 0.5 / std::f32::consts::PI).abs() < 1e-6);
/// # Ok::<(), merlkit::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Material {
    name: String,
    origin: Origin,
    channels_apart: bool,
    cell_format: CellFormat,
}

impl Material {
    /// Resolves an argument: an embedded name, a formula as "lambert:reflectance=0.5", or a path to a MERL binary or a
    /// `.bsdf` file.
    ///
    /// A bare word is an embedded name or a formula first; `./nickel` or `nickel.binary` is a path.
    ///
    /// # Errors
    /// [`Error::Argument`] for a word that is none of them, with the nearest embedded names, and for a formula's parameter that
    /// is unknown or outside its domain; [`Error::Io`] for a path that does not exist.
    pub fn resolve(argument: &str) -> Result<Self> {
        if embedded::names().iter().any(|n| n == argument) {
            return Ok(Self {
                name: argument.into(),
                origin: Origin::Embedded(argument.into()),
                channels_apart: false,
                cell_format: CellFormat::F32,
            });
        }
        let path = Path::new(argument);
        match analytic::canonical_text(argument) {
            Ok(Some(text)) => Ok(Self {
                name: text.replace([':', ',', '/'], "-"),
                origin: Origin::Formula(text),
                channels_apart: false,
                cell_format: CellFormat::F32,
            }),
            // A file may be called like a formula that is none.
            Err(error) if !path.exists() => Err(error),
            Ok(None) | Err(_) => Self::resolve_path(argument, path),
        }
    }

    fn resolve_path(argument: &str, path: &Path) -> Result<Self> {
        if path.exists() {
            let name = path
                .file_stem()
                .map_or_else(|| argument.into(), |s| s.to_string_lossy().into_owned());
            return Ok(Self {
                name,
                origin: Origin::File(path.to_owned()),
                channels_apart: false,
                cell_format: CellFormat::F32,
            });
        }
        if path.extension().is_some() || path.components().count() > 1 {
            return Err(missing_file(path));
        }
        Err(Error::argument(
            format!("no file and no built-in material is called \"{argument}\""),
            suggestion(argument),
        ))
    }

    /// Short name, without folder or extension; of a formula, its text with `-` for what no file is called by.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where the values come from.
    pub fn origin(&self) -> &Origin {
        &self.origin
    }

    /// The text of the formula that the material is, by its argument or in a stored fit; `None` for other materials.
    ///
    /// # Errors
    /// Those of a stored fit that does not read.
    pub fn formula(&self) -> Result<Option<String>> {
        stored_fit::formula_text(&self.origin)
    }

    /// The same material; `apart` says whether in a cell of its table of which some channels are negative, NaN or infinite only
    /// these are invalid, rather than the whole cell as by default. Other materials have no such cells.
    pub fn with_channels_apart(self, apart: bool) -> Self {
        Self {
            channels_apart: apart,
            ..self
        }
    }

    /// Whether its table will keep channels apart, as [`Self::with_channels_apart`] says.
    pub fn keeps_channels_apart(&self) -> bool {
        self.channels_apart
    }

    /// The same material, whose table will be kept in memory in `format`, rather than as it was read by default. Other materials
    /// have no use for it.
    pub fn with_cell_format(self, format: CellFormat) -> Self {
        Self {
            cell_format: format,
            ..self
        }
    }

    /// How its table will be kept in memory, as [`Self::with_cell_format`] says.
    pub fn cell_format(&self) -> CellFormat {
        self.cell_format
    }

    /// What it is, without loading its values; a `.bsdf` file is read to know.
    ///
    /// # Errors
    /// As [`rgl::BsdfFile::open`], for what begins as such a file.
    pub fn facts(&self) -> Result<MaterialFacts> {
        self.format().facts(&self.origin)
    }

    /// Loads it: a MERL table with `rule`, for which other materials have no use. A `.bsdf` file is evaluated as it is.
    ///
    /// # Errors
    /// As [`merl::load`] and [`MerlTable::with_cell_format`], or as [`rgl::BsdfFile::open`].
    pub fn load(&self, rule: LookupRule) -> Result<Loaded> {
        let reading = TableReading {
            rule,
            channels_apart: self.channels_apart,
            cell_format: self.cell_format,
        };
        let loaded = self.format().load(&self.origin, reading)?;
        Ok(loaded.named(&self.name))
    }

    fn format(&self) -> &'static dyn MaterialFormat {
        for format in FORMATS {
            if format.recognises(&self.origin) {
                return format;
            }
        }
        &merl::MerlBinary
    }

    /// SHA-256, in hexadecimal, of the bytes that define the material: the file, the embedded network's weights, or the
    /// formula's text.
    ///
    /// # Errors
    /// [`Error::Io`] if the file can't be read.
    pub fn sha256(&self) -> Result<String> {
        let digest = match &self.origin {
            Origin::File(path) => return RegularFile::open(path)?.sha256(),
            Origin::Embedded(name) => Sha256::digest(embedded::weights(name).unwrap_or_default()),
            Origin::Formula(text) => Sha256::digest(text),
        };
        Ok(digest.iter().map(|b| format!("{b:02x}")).collect())
    }
}

/// Why a path can't be opened; of a file that is called as an embedded material, how to name that.
fn missing_file(path: &Path) -> Error {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    if let Some(name) = embedded::names().iter().find(|name| **name == stem) {
        return Error::argument(
            format!("{}: no such file", path.display()),
            format!("the built-in material is called {name}, without folder and extension"),
        );
    }
    match path.metadata() {
        Err(reason) => Error::io(path, "open", reason),
        Ok(_) => Error::io(path, "open", std::io::ErrorKind::NotFound.into()),
    }
}

/// "did you mean …?", with the three nearest names of embedded materials and models.
fn suggestion(word: &str) -> String {
    let word = word.to_lowercase().replace(['_', ' '], "-");
    let mut ranked = Vec::new();
    let names = embedded::names().iter().map(String::as_str);
    for name in names.chain(analytic::model_names()) {
        ranked.push((strsim::jaro_winkler(&word, name), name));
    }
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(b.1)));
    let nearest: Vec<_> = ranked.iter().take(3).map(|r| r.1).collect();
    format!(
        "did you mean {}? `merlkit list` and `merlkit models` show all names",
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

    #[test]
    fn formulas_are_materials() {
        let material = Material::resolve("lambert:reflectance=0.8/0.5/0.25").unwrap();
        assert_eq!(material.name(), "lambert-reflectance=0.8-0.5-0.25");
        let facts = material.facts().unwrap();
        assert!(facts.is_isotropic() && !facts.has_table && !facts.has_own_sampler);
        let same = Material::resolve("lambert: reflectance = 0.50").unwrap();
        let default = Material::resolve("lambert").unwrap();
        assert_eq!(same, default);
        assert_eq!(same.sha256().unwrap(), default.sha256().unwrap());
        assert_ne!(material.sha256().unwrap(), default.sha256().unwrap());
    }
}
