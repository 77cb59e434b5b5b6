//! Uniform on the disc: the plain baseline.

use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;
use std::sync::Arc;

use super::{Field, Method, Needs, Settings};
use crate::Result;
use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::geometry::{cosine_hemisphere, unit_upper};
use crate::material::Loaded;

/// Sampling the cosine has no settings.
///
/// The example of [`DirectionSampler`](crate::direction_sampler::DirectionSampler) draws a direction and weights it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct CosineSettings {}

impl Settings for CosineSettings {
    type Method = Cosine;

    fn fields() -> Vec<Field<Self>> {
        Vec::new()
    }
}

/// Density cosθ/π for every material (thesis 5.1.1).
///
/// The example of [`DirectionSampler`](crate::direction_sampler::DirectionSampler) draws a direction and weights it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cosine;

impl Method for Cosine {
    const NAME: &'static str = "cosine";
    const SUMMARY: &'static str = "in proportion to cosθ, the same for every material";
    const NEEDS: Needs = Needs::AnyMaterial;
    const IS_STORED: bool = false;
    type Settings = CosineSettings;

    fn build(_: &Loaded, _: &CosineSettings) -> Result<Self> {
        Ok(Self)
    }

    fn settings(&self) -> CosineSettings {
        CosineSettings {}
    }

    fn sampler(self: Arc<Self>) -> Arc<dyn DirectionSampler> {
        self
    }
}

impl DirectionSampler for Cosine {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        let wi = cosine_hemisphere(u.as_dvec2()).as_vec3();
        let pdf = self.pdf(wo, wi);
        (pdf > 0.0).then_some(DirectionSample { wi, pdf })
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        unit_upper(wo)
            .and(unit_upper(wi))
            .map_or(0.0, |wi| wi.z * FRAC_1_PI)
    }

    fn bytes(&self) -> usize {
        0
    }
}
