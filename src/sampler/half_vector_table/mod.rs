//! Tables over the domain of half vectors: every draw reflects above the horizon, and well-spread points stay well spread.
//!
//! For a few angles of `wo` there is a density over the chart of [`crate::geometry::half_vector_chart`]: rows over θh that end
//! where MERL's bins end, each with a probability, a slope, and a density over the azimuth that is linear between nodes.
//! Between two angles the *probabilities* are interpolated, not the choice of a table, so (u1, u2) → `wi` is one continuous map
//! in each row, which can be inverted, and Owen-scrambled points keep their stratification. All tables are integers of 16 bits
//! or less, so the sums of an interpolated table are exact.
//!
//! Unlike the cascade CDF (thesis 5.6; Lawrence et al. 2005), the domain ends exactly at the horizon, so no draw is lost, and
//! angles between tables are served by one interpolated table instead of a random choice of two.
//!
//! `docs/half-vector-table.md` has the method as steps 1 to 24. Comments name the step at its line: [`tables`] has step 4,
//! [`lookup`] 5, 7, 11 and 12, the chart 1 to 3, 6 and 15 to 20, [`sample`] puts them together, [`batch`] for many lanes.

mod azimuth_shift;
mod azimuths;
mod batch;
mod build;
mod codec;
mod lookup;
mod sample;
mod settings;
mod tables;
mod tabulate;

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::store::{TensorWriter, Tensors};
use super::{DirectionSample, DirectionSampler, Method, Needs, Settings};
use crate::batch::Wo;
use crate::brdf::Brdf;
use crate::geometry::half_vector_chart::HalfVectorChart;
use crate::geometry::{Symmetry, unit_upper};
use crate::material::{Loaded, MaterialFacts};
use crate::{Error, Result};
use sample::TableView;
use tables::{IndexedTables, TablePair};

pub use azimuths::ByAzimuth;
pub(crate) use lookup::{NODE_UNIT, ROW_UNIT};
pub use settings::HalfVectorSettings;
pub(crate) use tables::Stored;

/// The last table stands short of the horizon.
const LAST_KNOT: f64 = 89.0 / 180.0 * PI;

/// Cosines of the angles that have a table: 0° to 89°, denser towards the horizon, and the more so the fewer there are.
pub(super) fn knot_cosines(tables: usize) -> Vec<f32> {
    let steps = tables.saturating_sub(1).max(1) as f64;
    let power = if tables < 8 { 2.0 } else { 1.5 };
    (0..tables)
        .map(|k| (LAST_KNOT * (1.0 - (1.0 - k as f64 / steps).powf(power))).cos() as f32)
        .collect()
}

/// A density over the chart of half vectors at each of a few angles of `wo`.
#[derive(Clone, Debug)]
pub struct HalfVectorTable {
    settings: HalfVectorSettings,
    tables: IndexedTables,
}

impl HalfVectorTable {
    /// Tabulates the isotropic `brdf` on the threads of the current pool; the result does not depend on their number.
    ///
    /// Where the BRDF is black at an angle, the table there follows the cosine.
    ///
    /// # Errors
    /// [`Error::Argument`] for settings outside their domains, or a BRDF that is not isotropic.
    pub fn build(brdf: &dyn Brdf, settings: HalfVectorSettings) -> Result<Self> {
        settings.check()?;
        if !brdf.is_isotropic() {
            return Err(Error::argument(
                "the half-vector table is for isotropic BRDFs",
                "choose another sampler",
            ));
        }
        if settings.azimuths.is_some() {
            return Err(settings::azimuths_of_isotropic());
        }
        Ok(Self::from_parts(
            settings,
            build::build_tables(brdf, &settings),
        ))
    }

    /// Puts a sampler together from tables that have been validated.
    pub(super) fn from_parts(settings: HalfVectorSettings, stored: Stored) -> Self {
        Self {
            settings,
            tables: IndexedTables::new(stored, settings.fold),
        }
    }

    /// The settings it was built with.
    pub fn settings(&self) -> &HalfVectorSettings {
        &self.settings
    }

    /// The tables of the two polar angles about that of a chart's `wo`, with their weights.
    #[inline]
    pub(super) fn interpolate(&self, chart: &HalfVectorChart) -> TablePair<'_> {
        self.tables.interpolate(chart.cos_o())
    }

    pub(crate) fn stored(&self) -> &Stored {
        self.tables.stored()
    }

    /// The point of the unit square that [`DirectionSampler::sample`] maps to `wi`, up to rounding; `None` unless both
    /// directions are above the horizon.
    pub fn invert(&self, wo: Vec3, wi: Vec3) -> Option<Vec2> {
        let wo = unit_upper(wo)?;
        let wi = unit_upper(wi)?;
        Some(TableView::new(&self.tables, HalfVectorChart::new(wo)).invert(wi))
    }
}

impl DirectionSampler for HalfVectorTable {
    /// Never fails for a `wo` above the horizon.
    #[inline]
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        let wo = unit_upper(wo)?;
        Some(TableView::new(&self.tables, HalfVectorChart::new(wo)).sample(u))
    }

    #[inline]
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let (Some(wo), Some(wi)) = (unit_upper(wo), unit_upper(wi)) else {
            return 0.0;
        };
        TableView::new(&self.tables, HalfVectorChart::new(wo)).pdf(wi)
    }

    fn bytes(&self) -> usize {
        self.tables.bytes()
    }

    #[track_caller]
    fn sample_batch(&self, wo: Wo<'_>, u: &[Vec2], out: &mut [Option<DirectionSample>]) {
        wo.assert_lanes(u.len(), out.len());
        batch::sample_batch(&self.tables, wo, u, out);
    }

    #[track_caller]
    fn pdf_batch(&self, wo: Wo<'_>, wi: &[Vec3], out: &mut [f32]) {
        wo.assert_lanes(wi.len(), out.len());
        batch::pdf_batch(&self.tables, wo, wi, out);
    }
}

/// The half-vector table of an isotropic material, or those of an anisotropic one.
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
        if facts.is_isotropic() && settings.azimuths.is_some() {
            return Err(settings::azimuths_of_isotropic());
        }
        Ok(())
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
            Self::Isotropic(table) => codec::write(&[table.stored()], out),
            Self::Anisotropic(tables) => codec::write(&tables.stored(), out),
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
