//! The sampler that a `.bsdf` file itself holds: half vectors drawn by its luminance and its warp.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, Vec2, Vec3};

use super::RglBrdf;
use super::brdf::GivenView;
use super::coordinates::{polar_angles, square_point};
use crate::batch::Wo;
use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::geometry::{reflect_about, spherical, unit_upper};

impl RglBrdf {
    /// The direction that a point of the unit square is mapped to, in double precision; `None` below the horizon, and for a
    /// `wo` that is not above it. [`DirectionSampler::sample`] adds the density.
    pub fn map_square(&self, wo: Vec3, u: DVec2) -> Option<Vec3> {
        self.map_square_about(&self.view(wo)?, u)
    }

    fn map_square_about(&self, view: &GivenView, u: DVec2) -> Option<Vec3> {
        // s follows the luminance; u_m is what the file's warp makes of s.
        let s = self.luminance.sample(u.to_array(), &view.tables.blend);
        let u_m = self.warp.sample(s, &view.tables.blend);
        // The half vector: θm = u_m.x²·π/2, φm = (2 u_m.y − 1)·π.
        let m = spherical(
            u_m[0] * u_m[0] * FRAC_PI_2,
            (2.0 * u_m[1] - 1.0) * PI + view.origin,
        );
        // wi = 2 (wo·m) m − wo, and back to where wo was before it was folded.
        let folded = &view.folded;
        unit_upper((reflect_about(folded.wo, m) * folded.signs).as_vec3())
    }

    fn sample_about(&self, view: &GivenView, u: Vec2) -> Option<DirectionSample> {
        let wi = self.map_square_about(view, u.as_dvec2())?;
        // Evaluated at `wi` itself, which rounding may have moved.
        let pdf = self.pdf_about(view, wi);
        (pdf > 0.0 && pdf.is_finite()).then_some(DirectionSample { wi, pdf })
    }

    fn pdf_about(&self, view: &GivenView, wi: Vec3) -> f32 {
        let Some(wi) = unit_upper(wi) else {
            return 0.0;
        };
        let half = view.folded.half_vector(wi);
        let [theta_m, phi_m] = polar_angles(half.to_array());
        let u_m = square_point([theta_m, phi_m - view.origin]);
        // Both steps of the draw, backwards: s = warp⁻¹(u_m), with the warp's density there.
        let (s, stretch) = self.warp.invert(u_m, &view.tables.blend);
        // sinθm and wo·m of m = (wo + wi)/|wo + wi|.
        let m = half.normalize();
        let sin_theta_m = m.truncate().length();
        let cos_d = view.folded.wo.dot(m);
        let jacobian = solid_angle_per_area(u_m[0], sin_theta_m, cos_d);
        // luminance(s)·warp(u_m)/J.
        (self.luminance.density(s, &view.tables.blend) * stretch / jacobian) as f32
    }
}

impl DirectionSampler for RglBrdf {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        self.sample_about(&self.view(wo)?, u)
    }

    /// Draws below the horizon make it integrate to less than 1.
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.view(wo).map_or(0.0, |view| self.pdf_about(&view, wi))
    }

    #[track_caller]
    fn sample_batch(&self, wo: Wo<'_>, u: &[Vec2], out: &mut [Option<DirectionSample>]) {
        wo.assert_lanes(u.len(), out.len());
        match wo {
            Wo::One(wo) => match self.view(wo) {
                Some(view) => {
                    for (out, &u) in out.iter_mut().zip(u) {
                        *out = self.sample_about(&view, u);
                    }
                }
                None => out.fill(None),
            },
            Wo::Each(wo) => {
                for ((out, &wo), &u) in out.iter_mut().zip(wo).zip(u) {
                    *out = self.sample(wo, u);
                }
            }
        }
    }

    #[track_caller]
    fn pdf_batch(&self, wo: Wo<'_>, wi: &[Vec3], out: &mut [f32]) {
        wo.assert_lanes(wi.len(), out.len());
        match wo {
            Wo::One(wo) => match self.view(wo) {
                Some(view) => {
                    for (out, &wi) in out.iter_mut().zip(wi) {
                        *out = self.pdf_about(&view, wi);
                    }
                }
                None => out.fill(0.0),
            },
            Wo::Each(wo) => {
                for ((out, &wo), &wi) in out.iter_mut().zip(wo).zip(wi) {
                    *out = self.pdf(wo, wi);
                }
            }
        }
    }

    fn bytes(&self) -> usize {
        self.warp.bytes() + self.luminance.bytes()
    }
}

/// J = max(2π²·x·sinθm, 10⁻⁶)·4(wo·m): solid angle of `wi` for a unit of area on the square of half vectors.
fn solid_angle_per_area(x: f64, sin_theta_m: f64, cos_d: f64) -> f64 {
    (TAU * PI * x * sin_theta_m).max(1e-6) * 4.0 * cos_d
}
