//! Samplers as files: safetensors, with a record of what they were built from.
//!
//! A file holds the tensors of one sampler and one metadata entry, `merlkit`: JSON of [`Record`]. Reading checks structure,
//! version, checksum and every invariant that sampling relies on; the sampler then draws the same bits as the one that was
//! saved. Which tensors a method has, and what they must be, is in the method's own `codec.rs`.

mod curves;
mod tensors;

use std::collections::HashMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{Sampler, SamplerSpec};
use crate::files::{Overwrite, RegularFile, write_new};
use crate::material::Loaded;
use crate::material::merl::{CellFormat, LookupRule};
use crate::material::{Material, Origin};
use crate::{Error, Result};

pub(super) use curves::{read_curves, write_curves};
pub use tensors::{Element, TensorWriter, Tensors};

/// Layout version written and read.
const VERSION: u32 = 3;
const KEY: &str = "merlkit";
/// Bytes of the longest file that is read.
const LONGEST: u64 = 1 << 32;

/// What a sampler file says of itself.
///
/// The example of [`SamplerFile`] stores a sampler and reads it back.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Layout version.
    pub version: u32,
    /// The sampler and settings asked for, as text.
    pub spec: SamplerSpec,
    /// The settings of `spec`, one by one, with what was fitted to the material.
    settings: serde_json::Value,
    /// Name of the material.
    pub material: String,
    /// Path of the material's file as it was named when building, or its formula; `None` for an embedded material.
    pub path: Option<String>,
    /// SHA-256 of the material's defining bytes.
    pub source_sha256: String,
    /// Lookup rule the sampler was built under; `None` for a material that has no table.
    pub lookup: Option<LookupRule>,
    /// Whether channels of the material's table could be invalid alone ([`Material::with_channels_apart`]).
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub channels_apart: bool,
    /// How the cells of the material's table were kept ([`Material::with_cell_format`]).
    #[serde(default, skip_serializing_if = "is_default")]
    pub cell_format: CellFormat,
    /// SHA-256 over all tensors.
    payload_sha256: String,
}

impl Record {
    /// The material, of which a table will be read as the sampler's was.
    fn read_alike(&self, material: Material) -> Material {
        material
            .with_channels_apart(self.channels_apart)
            .with_cell_format(self.cell_format)
    }

    /// The material that the file names, not loaded yet.
    ///
    /// # Errors
    /// As [`Material::resolve`].
    pub fn material(&self) -> Result<Material> {
        let material = Material::resolve(self.path.as_deref().unwrap_or(&self.material))?;
        Ok(self.read_alike(material))
    }
}

fn is_default(format: &CellFormat) -> bool {
    *format == CellFormat::default()
}

/// A sampler file that has been read but waits for its material.
///
/// # Examples
/// ```
/// use std::path::Path;
///
/// use merlkit::sampler::store::{SamplerFile, encode};
/// use merlkit::{LookupRule, Material, SamplerSpec};
///
/// let material = Material::resolve("lambert:reflectance=0.5")?;
/// let spec: SamplerSpec = "half-vector:2KB".parse()?;
/// let built = spec.build(&material.load(LookupRule::Floor)?)?;
///
/// // `save` writes these bytes to a file, and `SamplerFile::open` reads one.
/// let bytes = encode(&built, &material)?;
/// let file = SamplerFile::from_bytes(bytes, Path::new("grey.merlkit"))?;
/// assert_eq!(file.record().spec, spec);
/// let (read, _material) = file.load(None)?;
/// assert_eq!(read.as_dyn().bytes(), built.as_dyn().bytes());
/// # Ok::<(), merlkit::Error>(())
/// ```
#[derive(Debug)]
pub struct SamplerFile {
    record: Record,
    tensors: Tensors,
}

/// Saves `sampler`, built for `material`; returns the file's length in bytes.
///
/// The example of [`SamplerFile`] stores a sampler and reads it back.
///
/// # Errors
/// As [`encode`] and [`write_new`].
pub fn save(
    sampler: &Sampler,
    material: &Material,
    path: &Path,
    overwrite: Overwrite,
) -> Result<u64> {
    let bytes = encode(sampler, material)?;
    write_new(path, overwrite, |file| {
        file.write_all(&bytes)
            .map_err(|e| Error::io(path, "write", e))
    })?;
    Ok(bytes.len() as u64)
}

/// The bytes of a sampler file; the same for the same sampler.
///
/// The example of [`SamplerFile`] stores a sampler and reads it back.
///
/// # Errors
/// [`Error::Argument`] for a sampler that has nothing to store; [`Error::Io`] if the material's file is gone.
pub fn encode(sampler: &Sampler, material: &Material) -> Result<Vec<u8>> {
    let mut out = TensorWriter::default();
    sampler.write(&mut out)?;
    let record = Record {
        version: VERSION,
        spec: sampler.spec().clone(),
        settings: sampler.fitted().to_json()?,
        material: material.name().into(),
        path: match material.origin() {
            Origin::File(path) => Some(path.to_string_lossy().into_owned()),
            Origin::Embedded(_) => None,
            Origin::Formula(text) => Some(text.clone()),
        },
        source_sha256: material.sha256()?,
        lookup: sampler.rule(),
        channels_apart: material.keeps_channels_apart(),
        cell_format: match sampler.rule() {
            Some(_) => material.cell_format(),
            None => CellFormat::default(),
        },
        payload_sha256: out.sha256(),
    };
    let json = serde_json::to_string(&record)
        .map_err(|e| Error::argument(e.to_string(), "report this"))?;
    out.serialize(HashMap::from([(KEY.to_owned(), json)]))
}

/// Whether `path` begins like a sampler file: a length, then JSON. A MERL binary begins with its dimensions.
///
/// The example of [`SamplerFile`] stores a sampler and reads it back.
pub fn looks_like_sampler_file(path: &Path) -> bool {
    let mut ninth = [0];
    RegularFile::open(path)
        .and_then(|mut f| f.read_at(8, &mut ninth))
        .is_ok()
        && ninth == [b'{']
}

impl SamplerFile {
    /// Reads a sampler file.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Unsupported`] for what is no regular file or longer than any sampler; otherwise as
    /// [`Self::from_bytes`].
    pub fn open(path: &Path) -> Result<Self> {
        Self::from_bytes(RegularFile::open(path)?.read_all(LONGEST)?, path)
    }

    /// A sampler file from its bytes; `path` is for messages.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming what does not fit, and where.
    pub fn from_bytes(bytes: Vec<u8>, path: &Path) -> Result<Self> {
        let (tensors, metadata) = Tensors::read(bytes, path)?;
        let record: Record = metadata
            .get(KEY)
            .ok_or_else(|| tensors.invalid("a metadata entry \"merlkit\"", "none"))
            .and_then(|json| parse_record(json, &tensors))?;
        let found = tensors.sha256();
        if found != record.payload_sha256 {
            return Err(tensors.invalid(
                format!("tensors of SHA-256 {}", record.payload_sha256),
                format!("{found}: the file was damaged or edited"),
            ));
        }
        Ok(Self { record, tensors })
    }

    /// What the file says of itself.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// The sampler, for the material that is recorded, loaded with the lookup rule that is recorded.
    ///
    /// # Errors
    /// [`Error::Argument`] if the lookup rule, the reading of cells with invalid channels or the format of cells differs, or the material is not of a kind that the sampler can be used for;
    /// [`Error::Invalid`] if a tensor breaks an invariant.
    pub fn into_sampler(self, material: &Loaded) -> Result<Sampler> {
        if material.rule() != self.record.lookup {
            return Err(another_rule(self.record.lookup));
        }
        if let Some(measured) = material.table()
            && measured.table().mixed_cells() > 0
            && measured.table().keeps_channels_apart() != self.record.channels_apart
        {
            return Err(Error::argument(
                "the sampler was built with a different treatment of cells in which some channels are invalid",
                "load the material as the file records it, or build the sampler again",
            ));
        }
        if let Some(measured) = material.table()
            && measured.table().cell_format() != self.record.cell_format
        {
            let format = self.record.cell_format.name();
            return Err(Error::argument(
                format!("the sampler was built for a table of {format} cells"),
                format!("pass --table {format}, or build it again"),
            ));
        }
        self.record.spec.check_supports(&material.facts())?;
        self.record
            .spec
            .read(&self.tensors, &self.record.settings, material)
    }

    /// The recorded material; a relative path starts from the current folder, which may have changed since.
    fn recorded_material(&self) -> Result<Material> {
        self.record.material().map_err(|e| {
            Error::argument(
                format!(
                    "{} needs the material it was built from: {e}",
                    self.tensors.path().display()
                ),
                "name that material with --material, or run in the folder where the file was built",
            )
        })
    }

    /// Whether the sampler was built from the bytes of this material.
    ///
    /// # Errors
    /// [`Error::Argument`] for a material of other bytes; those of reading it.
    pub fn check_material(&self, material: &Material) -> Result<()> {
        let found = material.sha256()?;
        if found == self.record.source_sha256 {
            return Ok(());
        }
        Err(Error::argument(
            format!(
                "material {} has SHA-256 {found}, but the sampler was built from {}",
                material.name(),
                self.record.source_sha256
            ),
            "build the sampler again, or name the material it was built from",
        ))
    }

    /// Loads the recorded material, or `instead`, and puts the sampler together with it.
    ///
    /// # Errors
    /// As [`Self::into_sampler`], and [`Error::Argument`] if the material is not where the record says, or its bytes are not
    /// those the sampler was built from.
    pub fn load(self, instead: Option<Material>) -> Result<(Sampler, Loaded)> {
        let material = instead.map_or_else(|| self.recorded_material(), Ok)?;
        self.check_material(&material)?;
        let material = self
            .record
            .read_alike(material)
            .load(self.record.lookup.unwrap_or_default())?;
        Ok((self.into_sampler(&material)?, material))
    }
}

/// The error for a material that is loaded by another lookup rule than the sampler was built for.
fn another_rule(recorded: Option<LookupRule>) -> Error {
    match recorded {
        Some(rule) => Error::argument(
            format!("the sampler was built for the {} lookup", rule.name()),
            format!("pass --lookup {}, or build it again", rule.name()),
        ),
        None => Error::argument(
            "the sampler was built for a material without a table",
            "name that material, or build it again",
        ),
    }
}

fn parse_record(json: &str, tensors: &Tensors) -> Result<Record> {
    #[derive(Deserialize)]
    struct Version {
        version: u32,
    }
    let wrong =
        |e: serde_json::Error| tensors.invalid("metadata of a merlkit sampler", e.to_string());
    let Version { version } = serde_json::from_str(json).map_err(wrong)?;
    if version != VERSION {
        return Err(tensors.invalid(
            format!("layout version {VERSION}"),
            format!("version {version}"),
        ));
    }
    serde_json::from_str(json).map_err(wrong)
}
