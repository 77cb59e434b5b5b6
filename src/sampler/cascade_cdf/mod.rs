//! Cascaded CDFs of the half vector (Lawrence, Rusinkiewicz, Ramamoorthi 2005; thesis 5.6): a marginal over θh and
//! conditionals over φh for each of a few angles of `wo`, inverted by binary search, stored whole or compressed.
//!
//! Half vectors that reflect `wo` below the horizon make a draw fail; only cells that the horizon crosses hold any.

mod axis;
mod batch;
mod build;
mod cascade;
mod codec;
mod density;
mod fields;
mod plot_data;
mod settings;
mod tables;

pub use axis::ThetaSpacing;
pub use cascade::CascadeCdf;
pub use plot_data::CdfCurve;
pub use settings::CascadeCdfSettings;

pub(super) use axis::ThetaAxis;
pub(super) use build::{contribution, masses};

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::azimuth_knots::{check_azimuths, check_stored_azimuths};
use super::store::{TensorWriter, Tensors};
use super::{Method, Needs};
use crate::Result;
use crate::batch::Wo;
use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::geometry::{cosine_hemisphere, is_upper, reflect_about, unit_upper};
use crate::material::{Loaded, MaterialFacts};
use cascade::Chosen;

impl Method for CascadeCdf {
    const NAME: &'static str = "cascade-cdf";
    const SUMMARY: &'static str =
        "a marginal and conditional CDFs over the half vector, compressed or whole";
    const NEEDS: Needs = Needs::AnyMaterial;
    type Settings = CascadeCdfSettings;

    fn check_facts(settings: &CascadeCdfSettings, facts: &MaterialFacts) -> Result<()> {
        check_azimuths(settings.azimuths, facts.symmetry)
    }

    fn build(material: &Loaded, settings: &CascadeCdfSettings) -> Result<Self> {
        Self::build(&**material.brdf(), *settings)
    }

    fn settings(&self) -> CascadeCdfSettings {
        *self.settings()
    }

    fn sampler(self: Arc<Self>) -> Arc<dyn DirectionSampler> {
        self
    }

    fn write(&self, out: &mut TensorWriter) -> Result<()> {
        codec::write(&self.tables, out);
        Ok(())
    }

    fn agree(asked: &CascadeCdfSettings, used: &CascadeCdfSettings) -> bool {
        let azimuths = asked.azimuths.or(used.azimuths);
        CascadeCdfSettings { azimuths, ..*asked } == *used
    }

    fn read(tensors: &Tensors, settings: CascadeCdfSettings, material: &Loaded) -> Result<Self> {
        let symmetry = material.symmetry();
        check_stored_azimuths(settings.azimuths, symmetry, tensors)?;
        Self::from_parts(settings, symmetry, codec::read(tensors, &settings)?)
    }
}

impl DirectionSampler for CascadeCdf {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        let near = self.knots.neighbours(unit_upper(wo)?);
        let wi = match self.choose(&near, u) {
            Chosen::Cosine(u) => cosine_hemisphere(u).as_vec3(),
            Chosen::Table { table, azimuth, u } => {
                let h = self.half_vector(near.axes[azimuth], self.draw(table, u));
                reflect_about(near.wo.as_dvec3(), h).as_vec3()
            }
        };
        if !is_upper(wi) {
            return None;
        }
        self.finish(&near, wi, self.density(&near, wi.as_dvec3()))
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let (Some(wo), Some(wi)) = (unit_upper(wo), unit_upper(wi)) else {
            return 0.0;
        };
        let near = self.knots.neighbours(wo);
        self.density(&near, (wi * near.signs).as_dvec3())
    }

    fn bytes(&self) -> usize {
        self.tables.marginal.bytes()
            + self.tables.conditional.bytes()
            + size_of_val(self.tables.first.as_slice())
    }

    #[track_caller]
    fn sample_batch(&self, wo: Wo<'_>, u: &[Vec2], out: &mut [Option<DirectionSample>]) {
        wo.assert_lanes(u.len(), out.len());
        batch::sample(self, wo, u, out);
    }

    #[track_caller]
    fn pdf_batch(&self, wo: Wo<'_>, wi: &[Vec3], out: &mut [f32]) {
        wo.assert_lanes(wi.len(), out.len());
        batch::pdf(self, wo, wi, out);
    }
}
