//! Tables over the domain of half vectors: every draw reflects above the horizon, and well-spread points stay well spread.
//!
//! For a few angles of `wo` there is a density over the chart of [`crate::geometry::half_vector_chart`]: rows over θh that end
//! where MERL's bins end, each with a probability, a slope, and a density over the azimuth that is linear between nodes.
//! Between two angles the *probabilities* are interpolated, not the choice of a table, so (u1, u2) → `wi` is one continuous map
//! in each row, which can be inverted, and Owen-scrambled points keep their stratification. All tables are integers of 16 bits
//! or less, so the sums of an interpolated table are exact.
//!
//! Unlike the cascade CDF (thesis 5.6; Lawrence et al. 2005), the domain ends exactly at the horizon, so no draw fails, and
//! angles between tables are served by one interpolated table instead of a random choice of two.
//!
//! `docs/half-vector-table.md` has the method as steps 1 to 24. Comments name the step at its line: [`draw::pair`] has
//! step 4, [`tables::packed`] 5, 7 and 12, [`tables::lookup`] 11, and the chart 1 to 3, 6 and 15 to 20. [`draw::sample`] puts them
//! together, and [`draw::batch`] does so for many lanes.

mod azimuths;
mod build;
mod codec;
mod draw;
mod fields;
mod settings;
mod table;
mod tables;

use std::sync::Arc;

use super::azimuth_knots::check_azimuths;
use super::store::{TensorWriter, Tensors};
use super::{Method, Needs};
use crate::Result;
use crate::direction_sampler::DirectionSampler;
use crate::geometry::Symmetry;
use crate::material::{Loaded, MaterialFacts};

pub use azimuths::ByAzimuth;
pub use settings::HalfVectorSettings;
pub use table::HalfVectorTable;
pub(crate) use tables::Stored;
pub(crate) use tables::lookup::{NODE_UNIT, ROW_UNIT};

/// The half-vector table of an isotropic material, or those of an anisotropic one.
///
/// See [`SamplerSpec`](crate::SamplerSpec) for an example that builds a sampler.
#[derive(Clone, Debug)]
pub enum HalfVector {
    /// One azimuth of `wo` is enough.
    Isotropic(Arc<HalfVectorTable>),
    /// A table for each of a few azimuths of `wo`.
    Anisotropic(Arc<ByAzimuth>),
}

impl Method for HalfVector {
    const NAME: &'static str = "half-vector";
    const SUMMARY: &'static str =
        "densities over a square of half vectors that ends at the horizon, interpolated";
    const NEEDS: Needs = Needs::AnyMaterial;
    type Settings = HalfVectorSettings;

    fn check_facts(settings: &HalfVectorSettings, facts: &MaterialFacts) -> Result<()> {
        check_azimuths(settings.azimuths, facts.symmetry)
    }

    fn build(material: &Loaded, settings: &HalfVectorSettings) -> Result<Self> {
        let brdf = &**material.brdf();
        if material.symmetry() == Symmetry::Isotropic {
            let table = HalfVectorTable::build(brdf, *settings)?;
            return Ok(Self::Isotropic(Arc::new(table)));
        }
        let tables = ByAzimuth::build(brdf, *settings)?;
        Ok(Self::Anisotropic(Arc::new(tables)))
    }

    fn settings(&self) -> HalfVectorSettings {
        match self {
            Self::Isotropic(table) => *table.settings(),
            Self::Anisotropic(tables) => *tables.settings(),
        }
    }

    fn agree(asked: &HalfVectorSettings, used: &HalfVectorSettings) -> bool {
        asked == used || asked.for_anisotropic() == *used
    }

    fn sampler(self: Arc<Self>) -> Arc<dyn DirectionSampler> {
        match &*self {
            Self::Isotropic(table) => table.clone(),
            Self::Anisotropic(tables) => tables.clone(),
        }
    }

    fn write(&self, out: &mut TensorWriter) -> Result<()> {
        match self {
            Self::Isotropic(table) => codec::write(&[table.to_stored()], out),
            Self::Anisotropic(tables) => codec::write(&tables.to_stored(), out),
        }
        Ok(())
    }

    fn read(tensors: &Tensors, settings: HalfVectorSettings, material: &Loaded) -> Result<Self> {
        match (material.symmetry(), settings.azimuths) {
            (Symmetry::Isotropic, None) => {
                let table = codec::read(tensors, settings)?;
                Ok(Self::Isotropic(Arc::new(table)))
            }
            (Symmetry::Isotropic, Some(azimuths)) => {
                let found = format!("tables of {azimuths} azimuths");
                Err(tensors.invalid("one table for an isotropic material", found))
            }
            (symmetry, _) => {
                let tables = codec::read_by_azimuth(tensors, settings, symmetry)?;
                Ok(Self::Anisotropic(Arc::new(tables)))
            }
        }
    }
}
