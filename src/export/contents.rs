//! What is exported: a material's values and its table.

use std::sync::Arc;

use crate::material::merl::Header;
use crate::material::{Loaded, LookupRule, Material, MerlBrdf, MerlTable, Origin};
use crate::sampler::{HalfVectorSettings, HalfVectorTable};
use crate::{Error, Result};

/// A loaded material, its lookup rule and the half-vector table built for both.
///
/// # Examples
/// ```
/// use merlkit::export::{Export, identifier};
/// use merlkit::sampler::HalfVectorSettings;
/// use merlkit::{LookupRule, Material};
///
/// let material = Material::resolve("red-plastic")?;
/// let loaded = material.load(LookupRule::Floor)?;
/// let export = Export::new(&material, &loaded, HalfVectorSettings::default())?;
/// assert!(export.header().contains(&identifier("red-plastic")));
/// # Ok::<(), merlkit::Error>(())
/// ```
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

    /// f_r in sr⁻¹ by `[theta_h, theta_d, phi_d, rgb]`; −1 in a channel without a usable value.
    pub fn values(&self) -> impl Iterator<Item = f32> + '_ {
        let table = self.merl();
        (0..table.cells().len()).flat_map(move |cell| {
            let rgb = table.cell(cell);
            let valid = table.valid_channels(cell);
            [0, 1, 2].map(|channel| if valid[channel] { rgb[channel] } else { -1.0 })
        })
    }

    /// Between bins, headers and run-time code leave out whole cells, by their red.
    pub(super) fn require_whole_cells(&self) -> Result<()> {
        if !self.merl().has_partial_cells() || self.brdf.rule() == LookupRule::Floor {
            return Ok(());
        }
        Err(Error::argument(
            format!(
                "a table for programs with the {} lookup cannot keep the channels of a cell apart",
                self.brdf.rule().name()
            ),
            "leave --invalid channel out, or export for the floor lookup or as npz",
        ))
    }

    fn merl(&self) -> &MerlTable {
        self.brdf.table()
    }

    pub(super) fn dimensions(&self) -> Header {
        self.merl().header()
    }
}

/// Values in the byte order of a file.
pub(super) fn little_endian(values: impl Iterator<Item = f32>) -> Vec<u8> {
    values.flat_map(f32::to_le_bytes).collect()
}
