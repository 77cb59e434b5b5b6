//! A `.bsdf` file as a sampler: the density that the file itself holds.

use glam::{Vec2, Vec3};

use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::material::rgl::RglBrdf;

impl DirectionSampler for RglBrdf {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        let wi = self.draw(wo, u.as_dvec2().to_array())?;
        // Taken from `wi` itself, which rounding may have moved.
        let pdf = self.density(wo, wi);
        (pdf > 0.0 && pdf.is_finite()).then_some(DirectionSample { wi, pdf })
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.density(wo, wi)
    }

    fn bytes(&self) -> usize {
        self.draw_bytes()
    }
}
