//! The sampler that a `.bsdf` file itself holds: half vectors drawn by its luminance and its warp.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, Vec2, Vec3};

use super::RglBrdf;
use super::warp::SliceBlend;
use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::geometry::{reflect_about, spherical, to_spherical, unit_upper};

impl RglBrdf {
    /// The direction that a point of the unit square is mapped to, in double precision; `None` below the horizon, and for a
    /// `wo` that is not above it. [`DirectionSampler::sample`] adds the density.
    pub fn map_square(&self, wo: Vec3, u: DVec2) -> Option<Vec3> {
        let view = self.fold(unit_upper(wo)?);
        let (theta, phi) = to_spherical(view.wo);
        let blend = SliceBlend::between(phi, theta, &self.phi_i, &self.theta_i);
        // s follows the luminance; u_m is what the file's warp makes of s.
        let s = self.luminance.sample(u.to_array(), &blend);
        let u_m = self.warp.sample(s, &blend);
        // The half vector: θm = u_m.x²·π/2, φm = (2 u_m.y − 1)·π.
        let m = spherical(
            u_m[0] * u_m[0] * FRAC_PI_2,
            (2.0 * u_m[1] - 1.0) * PI + self.azimuth_origin(phi),
        );
        // wi = 2 (wo·m) m − wo, and back to where wo was before it was folded.
        unit_upper((reflect_about(view.wo, m) * view.signs).as_vec3())
    }
}

impl DirectionSampler for RglBrdf {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        let wi = self.map_square(wo, u.as_dvec2())?;
        // Evaluated at `wi` itself, which rounding may have moved.
        let pdf = self.pdf(wo, wi);
        (pdf > 0.0 && pdf.is_finite()).then_some(DirectionSample { wi, pdf })
    }

    /// Draws below the horizon make it integrate to less than 1.
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let Some(point) = self.file_point(wo, wi) else {
            return 0.0;
        };
        // Both steps of the draw, backwards: s = warp⁻¹(u_m), with the warp's density there.
        let (s, stretch) = self.warp.invert(point.u_m, &point.blend);
        let jacobian = solid_angle_per_area(point.u_m[0], point.theta_m.sin(), point.cos_d);
        // luminance(s)·warp(u_m)/J.
        (self.luminance.density(s, &point.blend) * stretch / jacobian) as f32
    }

    fn bytes(&self) -> usize {
        self.warp.bytes() + self.luminance.bytes()
    }
}

/// J = max(2π²·x·sinθm, 10⁻⁶)·4(wo·m): solid angle of `wi` for a unit of area on the square of half vectors.
fn solid_angle_per_area(x: f64, sin_theta_m: f64, cos_d: f64) -> f64 {
    (TAU * PI * x * sin_theta_m).max(1e-6) * 4.0 * cos_d
}
