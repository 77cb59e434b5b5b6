//! Uniform on the disc: the plain baseline.

use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

use super::{DirectionSample, DirectionSampler};
use crate::geometry::{cosine_hemisphere, unit_upper};

/// Density cosθ/π, whatever the material (thesis 5.1.1).
#[derive(Clone, Copy, Debug, Default)]
pub struct Cosine;

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
