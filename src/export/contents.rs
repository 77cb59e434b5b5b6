//! What is exported: a material's values and its table.

use std::sync::Arc;

use crate::Result;
use crate::material::merl::Header;
use crate::material::{Loaded, Material, MerlBrdf, MerlTable, Origin};
use crate::sampler::{HalfVectorSettings, HalfVectorTable};

/// A loaded material, its lookup rule and the half-vector table built for both.
#[derive(Debug)]
pub struct Export {
    pub(super) name: String,
    pub(super) embedded: bool,
    pub(super) sha256: String,
    pub(super) brdf: Arc<MerlBrdf>,
    pub(super) table: HalfVectorTable,
}

impl Export {
    /// Builds the table of `material`, loaded as `loaded`, on the threads of the current pool.
    ///
    /// # Errors
    /// As [`Material::sha256`] and [`HalfVectorTable::build`]; [`crate::Error::Argument`] for a material that is not a MERL table.
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

    pub(super) fn dimensions(&self) -> Header {
        self.merl().header()
    }
}

/// Values as they stand in a file.
pub(super) fn little_endian(values: impl Iterator<Item = f32>) -> Vec<u8> {
    values.flat_map(f32::to_le_bytes).collect()
}
