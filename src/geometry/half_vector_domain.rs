//! The half vectors that reflect a direction above the horizon, in angles: [`super::half_vector_chart`] has the equations.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec3, Vec3};

use super::{approx, is_upper, reflect_about, to_spherical};

/// The domain about one direction, with coordinates that are angles, in f64: for quadrature and statistical tests.
///
/// The coordinates are θh in [0, θmax] and the azimuth φ of h against that of `wo` as a fraction in [−1, 1] of φmax(θh).
///
/// The example of [`Quadrature`](crate::geometry::Quadrature) integrates over the hemisphere.
#[derive(Clone, Copy, Debug)]
pub struct HalfVectorDomain {
    wo: DVec3,
    theta_o: f64,
    /// Cosine and sine of the azimuth of `wo`; (1, 0) along the normal.
    azimuth: (f64, f64),
}

impl HalfVectorDomain {
    /// The domain about `wo`; `None` unless that is finite and above the horizon.
    pub fn new(wo: Vec3) -> Option<Self> {
        if !is_upper(wo) {
            return None;
        }
        let wo = wo.as_dvec3().normalize();
        let (theta_o, phi_o) = to_spherical(wo);
        let (sin, cos) = phi_o.sin_cos();
        Some(Self {
            wo,
            theta_o,
            azimuth: (cos, sin),
        })
    }

    /// The largest θh that reflects above the horizon: (π/2 + θo)/2.
    pub fn theta_max(&self) -> f64 {
        0.5 * (FRAC_PI_2 + self.theta_o)
    }

    /// The θh up to which every azimuth reflects above the horizon: (π/2 − θo)/2.
    pub fn theta_full(&self) -> f64 {
        0.5 * (FRAC_PI_2 - self.theta_o)
    }

    /// The largest azimuth of h against `wo` that reflects above the horizon, in [0, π].
    pub fn phi_max(&self, theta_h: f64) -> f64 {
        if theta_h <= self.theta_full() {
            return PI;
        }
        // tan²(φmax/2) = −cos(2θh − θo)/cos(2θh + θo), by f64 cosines to 10⁻⁸.
        let sum = 2.0 * theta_h + self.theta_o;
        let difference = 2.0 * theta_h - self.theta_o;
        let far = approx::sin_cos_turns(sum.abs() * (1.0 / TAU)).1;
        let near = approx::sin_cos_turns(difference.abs() * (1.0 / TAU)).1;
        // Next to θfull rounding may leave no azimuth to cut, and next to θmax it may carry `near` below 0.
        if far >= 0.0 {
            PI
        } else {
            2.0 * approx::atan2(near.max(0.0).sqrt(), (-far).sqrt())
        }
    }

    /// The reflected direction at (θh, azimuth fraction), and dσ(wi) per dθh and d(azimuth fraction):
    /// 4 (wo·h) sin θh φmax, sr.
    #[inline]
    pub fn direction(&self, theta_h: f64, azimuth_fraction: f64) -> (Vec3, f64) {
        let phi_max = self.phi_max(theta_h);
        let (sin_h, cos_h) = approx::sin_cos_turns(theta_h * (1.0 / TAU));
        // h has the azimuth fraction·φmax against wo. `sin_cos_turns` takes [0, 1], so negative turns go once round.
        let turn = azimuth_fraction * phi_max * (1.0 / TAU);
        let (sin, cos) = approx::sin_cos_turns(if turn < 0.0 { turn + 1.0 } else { turn });
        let h = self.turn(DVec3::new(sin_h * cos, sin_h * sin, cos_h), 1.0);
        let wi = reflect_about(self.wo, h);
        (wi.as_vec3(), 4.0 * self.wo.dot(h) * sin_h * phi_max)
    }

    /// θh and azimuth fraction of a direction: the inverse of [`Self::direction`], clamped to the rectangle where rounding leaves it.
    pub fn coordinates(&self, wi: Vec3) -> (f64, f64) {
        let h = self.turn(self.wo + wi.as_dvec3(), -1.0);
        let (theta_h, phi) = to_spherical(h);
        let phi_max = self.phi_max(theta_h);
        // At θmax a single azimuth is left, and its fraction is arbitrary.
        let fraction = if phi_max > 0.0 { phi / phi_max } else { 0.0 };
        (
            theta_h.clamp(0.0, self.theta_max()),
            fraction.clamp(-1.0, 1.0),
        )
    }

    /// `w` turned about the normal by the azimuth of `wo` (`sign` = 1), or back (−1).
    fn turn(&self, w: DVec3, sign: f64) -> DVec3 {
        let (cos, sin) = (self.azimuth.0, sign * self.azimuth.1);
        DVec3::new(cos * w.x - sin * w.y, sin * w.x + cos * w.y, w.z)
    }
}
