//! Sources of light: how to sample them from a point, and what a ray sees of them.
//!
//! World space, `y` up. Lights have no body: they block nothing, and whether something blocks them is the renderer's
//! business.

mod area;
mod delta;
mod environment;
mod lamps;
mod studio;

pub use area::Area;
pub use delta::{Directional, Point};
pub use environment::{Environment, SkySampling};
pub use lamps::lamps;
pub use studio::studio;

use glam::{DVec2, DVec3};

use crate::color::Rgb;

/// A direction towards a light, chosen from a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Towards the light, world space, unit length.
    pub wi: DVec3,
    /// How far the light is; infinite for distant ones.
    pub distance: f64,
    /// Radiance that arrives along `wi`; for a delta light, its irradiance on a surface that faces it.
    pub radiance: Rgb,
    /// Density per solid angle, sr⁻¹, finite and > 0; 1 for a delta light.
    pub pdf: f64,
}

/// What a ray sees of a light that has an extent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Radiance along the ray.
    pub radiance: Rgb,
    /// Density per solid angle of [`Light::sample`] choosing this direction from the ray's origin; may be 0.
    pub pdf: f64,
}

/// A source of light.
pub trait Light: Send + Sync {
    /// Chooses a direction towards the light from a point of the unit square; `None` where none of its light arrives.
    fn sample(&self, from: DVec3, u: DVec2) -> Option<LightSample>;

    /// What a ray from `from` along the unit vector `direction` sees of the light within `reach`; `None` if it misses, and
    /// always for delta lights.
    fn seen(&self, from: DVec3, direction: DVec3, reach: f64) -> Option<Seen>;

    /// [`Self::sample`] for many points: `out[k]` becomes `sample(from[k], u[k])`, to the bit. As many as the shortest slice
    /// holds are sampled; what is left of a longer `out` stays as it was.
    fn sample_many(&self, from: &[DVec3], u: &[DVec2], out: &mut [Option<LightSample>]) {
        for ((out, &from), &u) in out.iter_mut().zip(from).zip(u) {
            *out = self.sample(from, u);
        }
    }

    /// [`Self::seen`] for many rays: `out[k]` becomes `seen(from[k], directions[k], reach[k])`, to the bit. As many as the
    /// shortest slice holds are looked along; what is left of a longer `out` stays as it was.
    fn seen_many(
        &self,
        from: &[DVec3],
        directions: &[DVec3],
        reach: &[f64],
        out: &mut [Option<Seen>],
    ) {
        for (((out, &from), &direction), &reach) in
            out.iter_mut().zip(from).zip(directions).zip(reach)
        {
            *out = self.seen(from, direction, reach);
        }
    }

    /// Whether it has no extent: it has one direction from each point, and no ray sees it.
    fn is_delta(&self) -> bool {
        false
    }
}
