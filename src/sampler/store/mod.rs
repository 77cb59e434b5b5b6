//! Samplers as files: safetensors, with a record of what they were built from.
//!
//! A file holds the tensors of one sampler and one metadata entry, `merlkit`: JSON of [`Record`]. Reading checks structure,
//! version, checksum and every invariant that sampling relies on; the sampler then draws the same bits as the one that was
//! saved.

mod parts;
mod tensors;

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{Sampler, SamplerSpec};
use crate::files::{Overwrite, RegularFile, write_new};
use crate::material::Loaded;
use crate::material::merl::{LookupRule, MerlBrdf};
use crate::material::{Material, Origin};
use crate::{Error, Result};
use tensors::{Tensors, TensorsOut};

/// Layout version written and read.
const VERSION: u32 = 2;
const KEY: &str = "merlkit";
/// Bytes of the longest file that is read.
const LONGEST: u64 = 1 << 32;

/// What a sampler file says of itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Layout version.
    pub version: u32,
    /// Sampler and settings.
    pub spec: SamplerSpec,
    /// Name of the material.
    pub material: String,
    /// Path of the material's file as it was named when building, or its formula; `None` for an embedded material.
    pub path: Option<String>,
    /// SHA-256 of the material's defining bytes.
    pub source_sha256: String,
    /// Lookup rule the sampler was built under; without a meaning to a material that is no table.
    pub lookup: LookupRule,
    /// SHA-256 over all tensors.
    payload_sha256: String,
}

impl Record {
    /// The material that the file names, not loaded yet.
    ///
    /// # Errors
    /// As [`Material::resolve`].
    pub fn material(&self) -> Result<Material> {
        Material::resolve(self.path.as_deref().unwrap_or(&self.material))
    }
}

/// A sampler file that has been read but waits for its material.
#[derive(Debug)]
pub struct SamplerFile {
    record: Record,
    tensors: Tensors,
}

/// Saves `sampler`, built for `material` under `lookup`; returns the file's length in bytes.
///
/// # Errors
/// As [`encode`] and [`write_new`].
pub fn save(
    sampler: &Sampler,
    material: &Material,
    lookup: LookupRule,
    path: &Path,
    overwrite: Overwrite,
) -> Result<u64> {
    let bytes = encode(sampler, material, lookup)?;
    write_new(path, overwrite, |file| {
        file.write_all(&bytes)
            .map_err(|e| Error::io(path, "write", e))
    })?;
    Ok(bytes.len() as u64)
}

/// The bytes of a sampler file; the same for the same sampler.
///
/// # Errors
/// [`Error::Argument`] for the cosine sampler, which has nothing to store, and for the density of a `.bsdf` file, which is
/// stored there; [`Error::Io`] if the material's file is gone.
pub fn encode(sampler: &Sampler, material: &Material, lookup: LookupRule) -> Result<Vec<u8>> {
    // Only tables have a lookup rule: for other materials the bytes are the same whichever was asked for.
    let lookup = if material.facts()?.has_table {
        lookup
    } else {
        LookupRule::default()
    };
    let mut out = TensorsOut::default();
    match sampler {
        Sampler::Cosine(_) => {
            return Err(Error::argument(
                "the cosine sampler has no tables to store",
                "choose another sampler",
            ));
        }
        Sampler::File(_) => return Err(in_the_file()),
        Sampler::ByAzimuth(s) => parts::write_half_vectors(&s.stored(), &mut out),
        Sampler::AdaptiveDisc(s) => parts::write_trees(s.trees(), &mut out),
        Sampler::CascadeCdf(s) => parts::write_tables(s.tables(), &mut out),
        Sampler::HalfVector(s) => parts::write_half_vectors(&[s.stored()], &mut out),
        Sampler::Lobe(s) => parts::write_lobe(s.parameters(), &mut out),
        Sampler::Factored(s) => parts::write_factors(s.terms(), &mut out),
    }
    let record = Record {
        version: VERSION,
        spec: sampler.spec(),
        material: material.name().into(),
        path: match material.origin() {
            Origin::File(path) => Some(path.to_string_lossy().into_owned()),
            Origin::Embedded(_) => None,
            Origin::Formula(text) => Some(text.clone()),
        },
        source_sha256: material.sha256()?,
        lookup,
        payload_sha256: out.sha256(),
    };
    let json = serde_json::to_string(&record)
        .map_err(|e| Error::argument(e.to_string(), "report this"))?;
    out.serialize(HashMap::from([(KEY.to_owned(), json)]))
}

/// Whether `path` begins like a sampler file: a length, then JSON. A MERL binary begins with its dimensions.
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

    /// The sampler, for a BRDF whose table is the recorded material's and whose lookup rule is the recorded one.
    ///
    /// # Errors
    /// [`Error::Argument`] if the lookup rule differs, [`Error::Invalid`] if a tensor breaks an invariant.
    pub fn into_sampler(self, brdf: &Arc<MerlBrdf>) -> Result<Sampler> {
        if brdf.rule() != self.record.lookup {
            return Err(Error::argument(
                format!(
                    "the sampler was built for the {} lookup",
                    self.record.lookup.name()
                ),
                format!(
                    "pass --lookup {}, or build it again",
                    self.record.lookup.name()
                ),
            ));
        }
        match self.record.spec {
            SamplerSpec::AdaptiveDisc(settings) => {
                let disc = parts::read_disc(&self.tensors, brdf.clone(), settings)?;
                Ok(Sampler::AdaptiveDisc(disc))
            }
            _ => self.read_isotropic(),
        }
    }

    /// A sampler of an isotropic material that does not need it to draw.
    fn read_isotropic(&self) -> Result<Sampler> {
        let tensors = &self.tensors;
        Ok(match self.record.spec {
            SamplerSpec::Cosine => return Err(tensors.invalid("a sampler with tables", "cosine")),
            SamplerSpec::File => return Err(in_the_file()),
            SamplerSpec::ByAzimuth(_) => {
                let found = "one of an anisotropic material";
                return Err(tensors.invalid("a sampler of an isotropic material", found));
            }
            SamplerSpec::AdaptiveDisc(_) => {
                let found = "adaptive-disc, which draws from a MERL table";
                return Err(tensors.invalid("a sampler that needs no table", found));
            }
            SamplerSpec::CascadeCdf(settings) => {
                Sampler::CascadeCdf(parts::read_cascade(tensors, settings)?)
            }
            SamplerSpec::HalfVector(settings) => {
                Sampler::HalfVector(parts::read_half_vector(tensors, settings)?)
            }
            SamplerSpec::Lobe(settings) => Sampler::Lobe(parts::read_lobe(tensors, settings)?),
            SamplerSpec::Factored(settings) => {
                Sampler::Factored(parts::read_factored(tensors, settings)?)
            }
        })
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

    /// Loads the recorded material, or `instead`, and puts the sampler together with it.
    ///
    /// # Errors
    /// As [`Self::into_sampler`], and [`Error::Argument`] if the material is not where the record says, or its bytes are not
    /// those the sampler was built from.
    pub fn load(self, instead: Option<Material>) -> Result<(Sampler, Loaded)> {
        let material = instead.map_or_else(|| self.recorded_material(), Ok)?;
        let found = material.sha256()?;
        if found != self.record.source_sha256 {
            return Err(Error::argument(
                format!(
                    "material {} has SHA-256 {found}, but the sampler was built from {}",
                    material.name(),
                    self.record.source_sha256
                ),
                "build the sampler again, or name the material it was built from",
            ));
        }
        let material = material.load(self.record.lookup)?;
        let sampler =
            match (material.table(), self.record.spec) {
                (Some(measured), _) => self.into_sampler(measured)?,
                (None, _) if material.facts().is_isotropic() => self.read_isotropic()?,
                (None, SamplerSpec::ByAzimuth(settings)) => Sampler::ByAzimuth(
                    parts::read_by_azimuth(&self.tensors, settings, material.symmetry())?,
                ),
                (None, _) => {
                    let found = self.record.spec.name();
                    return Err(self
                        .tensors
                        .invalid("a sampler of an anisotropic material", found));
                }
            };
        Ok((sampler, material))
    }
}

fn in_the_file() -> Error {
    Error::argument(
        "the sampler file is stored in the .bsdf file already",
        "name that file in its place",
    )
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
