//! Samplers whose densities are wrong on purpose: the checks must reject them.

use glam::{Vec2, Vec3};
use merlkit::direction_sampler::{DirectionSample, DirectionSampler};
use merlkit::geometry::{spherical, to_spherical};

/// Draws of one sampler with the densities of another; those are asked for at a `wo` whose polar angle is `shift` larger.
pub struct Tampered<'a> {
    /// What draws.
    pub draws: &'a dyn DirectionSampler,
    /// What tells densities.
    pub claims: &'a dyn DirectionSampler,
    /// Radians.
    pub shift: f64,
}

impl Tampered<'_> {
    fn claim(&self, wo: Vec3, wi: Vec3) -> f32 {
        let (theta, phi) = to_spherical(wo.as_dvec3());
        let wo = if self.shift == 0.0 {
            wo
        } else {
            spherical(theta + self.shift, phi).as_vec3()
        };
        self.claims.pdf(wo, wi)
    }
}

impl DirectionSampler for Tampered<'_> {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        let DirectionSample { wi, .. } = self.draws.sample(wo, u)?;
        Some(DirectionSample {
            wi,
            pdf: self.claim(wo, wi),
        })
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.claim(wo, wi)
    }

    fn bytes(&self) -> usize {
        self.draws.bytes()
    }
}
