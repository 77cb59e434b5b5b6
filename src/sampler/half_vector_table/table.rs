//! The half-vector table of an isotropic material.

use fearless_simd::{Level, dispatch};
use glam::{Vec2, Vec3};

use super::build::build_tables;
use super::draw::batch;
use super::draw::pair::TablePair;
use super::draw::sample::TableView;
use super::settings::HalfVectorSettings;
use super::tables::{IndexedTables, Stored};
use crate::batch::Wo;
use crate::brdf::Brdf;
use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::geometry::half_vector_chart::HalfVectorChart;
use crate::geometry::unit_upper;
use crate::sampler::Settings;
use crate::sampler::azimuth_knots::azimuths_of_isotropic;
use crate::{Error, Result};

/// A density over the chart of half vectors at each of a few angles of `wo`.
///
/// See [`SamplerSpec`](crate::SamplerSpec) for an example that builds a sampler.
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
            return Err(azimuths_of_isotropic());
        }
        Ok(Self::from_parts(settings, build_tables(brdf, &settings)))
    }

    /// Puts a sampler together from tables that have been validated.
    pub(super) fn from_parts(settings: HalfVectorSettings, stored: Stored) -> Self {
        Self {
            settings,
            tables: IndexedTables::new(&stored, settings.fold),
        }
    }

    /// The tables as draws read them.
    #[cfg(test)]
    pub(super) fn indexed(&self) -> &IndexedTables {
        &self.tables
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

    /// What a file holds of the tables.
    pub(crate) fn to_stored(&self) -> Stored {
        self.tables.to_stored()
    }

    /// The point of the unit square that [`DirectionSampler::sample`] maps to `wi`, up to rounding; `None` unless both
    /// directions are above the horizon.
    pub fn invert(&self, wo: Vec3, wi: Vec3) -> Option<Vec2> {
        let wo = unit_upper(wo)?;
        let wi = unit_upper(wi)?;
        Some(TableView::new(&self.tables, HalfVectorChart::new(wo)).invert(wi))
    }
}

#[inline(always)]
fn sample_single(tables: &IndexedTables, wo: Vec3, u: Vec2) -> DirectionSample {
    TableView::new(tables, HalfVectorChart::new(wo)).sample(u)
}

#[inline(always)]
fn single_pdf(tables: &IndexedTables, wo: Vec3, wi: Vec3) -> f32 {
    TableView::new(tables, HalfVectorChart::new(wo)).pdf(wi)
}

impl DirectionSampler for HalfVectorTable {
    /// Never fails for a `wo` above the horizon.
    #[inline]
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        let wo = unit_upper(wo)?;
        Some(dispatch!(Level::new(), _ => sample_single(&self.tables, wo, u)))
    }

    #[inline]
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let (Some(wo), Some(wi)) = (unit_upper(wo), unit_upper(wi)) else {
            return 0.0;
        };
        dispatch!(Level::new(), _ => single_pdf(&self.tables, wo, wi))
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
