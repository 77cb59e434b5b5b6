//! A material with its half-vector table for other programs: a C header, which is C++ and GLSL as well, and numpy's `.npz`.
//!
//! What is written is values and the tables of [`crate::sampler::HalfVectorTable`]; files for renderers that have a format of
//! their own are [`crate::material::rgl`]'s business, and how well a table draws is the caller's.

mod header;
mod npz;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use crate::files::{Overwrite, write_new};
use crate::material::merl::Header;
use crate::material::{Loaded, Material, MerlBrdf, MerlTable, Origin};
use crate::sampler::{HalfVectorSettings, HalfVectorTable};
use crate::{Error, Result};

/// A loaded material, its lookup rule and the half-vector table built for both.
#[derive(Debug)]
pub struct Export {
    name: String,
    embedded: bool,
    sha256: String,
    brdf: Arc<MerlBrdf>,
    table: HalfVectorTable,
}

impl Export {
    /// Builds the table of `material`, loaded as `loaded`, on the threads of the current pool.
    ///
    /// # Errors
    /// As [`Material::sha256`] and [`HalfVectorTable::build`]; [`Error::Argument`] for a material that is not a MERL table.
    pub fn new(material: &Material, loaded: &Loaded, settings: HalfVectorSettings) -> Result<Self> {
        let brdf = loaded.require_table("this export")?.clone();
        Ok(Self {
            name: material.name().to_owned(),
            embedded: matches!(material.origin(), Origin::Embedded(_)),
            sha256: material.sha256()?,
            table: HalfVectorTable::build(brdf.as_ref(), settings)?,
            brdf,
        })
    }

    /// The material under its lookup rule.
    pub fn brdf(&self) -> &MerlBrdf {
        &self.brdf
    }

    /// The table that is exported.
    pub fn table(&self) -> &HalfVectorTable {
        &self.table
    }

    /// The text of the header: ASCII, the same for the same material, settings and lookup rule.
    pub fn header(&self) -> String {
        header::text(self)
    }

    /// Writes [`Self::header`]; returns the file's length in bytes.
    ///
    /// # Errors
    /// As [`write_new`].
    pub fn write_header(&self, path: &Path, overwrite: Overwrite) -> Result<u64> {
        write_bytes(self.header().as_bytes(), path, overwrite)
    }

    /// Writes the values that the header's `eval` reads: [`Self::values`] as little-endian f32; returns the file's length.
    ///
    /// # Errors
    /// As [`write_new`].
    pub fn write_values(&self, path: &Path, overwrite: Overwrite) -> Result<u64> {
        write_bytes(&little_endian(self.values()), path, overwrite)
    }

    /// Writes values, tables and settings as arrays that `numpy.load` reads; returns the file's length in bytes.
    ///
    /// # Errors
    /// As [`write_new`].
    pub fn write_npz(&self, path: &Path, overwrite: Overwrite) -> Result<u64> {
        write_new(path, overwrite, |out| {
            npz::write(self, out).map_err(|e| Error::io(path, "write", e))
        })?;
        path.metadata()
            .map(|m| m.len())
            .map_err(|e| Error::io(path, "read", e))
    }

    /// f_r in sr⁻¹ by `[theta_h, theta_d, phi_d, rgb]`; −1 in all channels of a cell without a usable value.
    pub fn values(&self) -> impl Iterator<Item = f32> + '_ {
        let rgb = |c: &glam::Vec4| {
            if c.w == 0.0 {
                [-1.0; 3]
            } else {
                c.truncate().to_array()
            }
        };
        self.merl().cells().iter().flat_map(rgb)
    }

    fn merl(&self) -> &MerlTable {
        self.brdf.table()
    }

    fn dimensions(&self) -> Header {
        self.merl().header()
    }
}

/// What the functions of a material's header begin with: its name with `_` for what no identifier of C and GLSL holds. Names
/// that would be reserved there begin with `m_`.
pub fn identifier(name: &str) -> String {
    let words: Vec<&str> = name
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter(|w| !w.is_empty())
        .collect();
    let joined = words.join("_");
    let lower = joined.to_ascii_lowercase();
    let reserved = |prefix: &str| lower == prefix || lower.starts_with(&format!("{prefix}_"));
    let begins = joined.starts_with(|c: char| c.is_ascii_alphabetic());
    match joined.as_str() {
        "" => "m".into(),
        _ if begins && !reserved("gl") && !reserved("merlkit") => joined,
        _ => format!("m_{joined}"),
    }
}

/// Two materials of one [`identifier`] could not be included together.
///
/// # Errors
/// [`Error::Argument`] naming both.
pub fn refuse_same_identifier(materials: &[Material]) -> Result<()> {
    let mut seen = BTreeMap::new();
    match materials.iter().find_map(|m| {
        seen.insert(identifier(m.name()), m.name())
            .map(|first| (first, m.name()))
    }) {
        None => Ok(()),
        Some((first, second)) => Err(Error::argument(
            format!("{first} and {second} would have functions of the same names"),
            "rename one of the files, or export them apart",
        )),
    }
}

fn little_endian(values: impl Iterator<Item = f32>) -> Vec<u8> {
    values.flat_map(f32::to_le_bytes).collect()
}

fn write_bytes(bytes: &[u8], path: &Path, overwrite: Overwrite) -> Result<u64> {
    write_new(path, overwrite, |out| {
        out.write_all(bytes)
            .map_err(|e| Error::io(path, "write", e))
    })?;
    Ok(bytes.len() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_are_legal_and_unreserved() {
        for (name, expected) in [
            ("nickel", "nickel"),
            ("blue-metallic-paint", "blue_metallic_paint"),
            ("_two--of  them_", "two_of_them"),
            ("2-layer gold", "m_2_layer_gold"),
            ("gl", "m_gl"),
            ("gl-paint", "m_gl_paint"),
            ("glass", "glass"),
            ("merlkit", "m_merlkit"),
            ("MERLKIT", "m_MERLKIT"),
            ("Gl-paint", "m_Gl_paint"),
            ("tôle", "t_le"),
            ("…", "m"),
        ] {
            assert_eq!(identifier(name), expected);
        }
    }
}
