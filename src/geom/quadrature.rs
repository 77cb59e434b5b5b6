//! Integrals over the hemisphere of `wi`, taken over half vectors where measured reflectance is smooth between known edges.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec3, Vec3};

use super::reflect_about;

/// Nodes over (√θh, φh): `theta_points` Gauss points in each of MERL's 90 bins of θh, and `phi_points` midpoints over the
/// azimuths of half vectors that reflect above the horizon, of which there are exactly 2 φmax(θh).
///
/// With tan²(φmax/2) = −cos(2θh − θo)/cos(2θh + θo) for 2θh + θo > 90°, no node is wasted below the horizon and none of the
/// hemisphere is left out; dσ(wi) = 4 (wo·h) dσ(h).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HalfVectorQuadrature {
    /// Azimuths a ring of half vectors.
    pub phi_points: usize,
    /// How many equal parts each bin is cut into, of two Gauss points each.
    pub parts: usize,
}

impl Default for HalfVectorQuadrature {
    /// 180 rings of 256 azimuths: albedos of measured metals to about 10⁻⁴.
    fn default() -> Self {
        Self { phi_points: 256, parts: 1 }
    }
}

/// Two-point Gauss–Legendre on [0, 1].
const GAUSS: [f64; 2] = [0.211_324_865_405_187_13, 0.788_675_134_594_812_9];
/// Bins of θh, √-spaced over a right angle.
const BINS: usize = 90;

impl HalfVectorQuadrature {
    /// ∫ f(wi) dσ(wi) over the hemisphere, for an upper unit `wo`; summed in f64.
    pub fn integrate(&self, wo: Vec3, mut f: impl FnMut(Vec3) -> f64) -> f64 {
        let mut sum = 0.0;
        self.for_each(wo, |wi, weight| sum += f(wi) * weight);
        sum
    }

    /// Calls `visit(wi, dσ)` at every node; the weights sum to 2π.
    pub fn for_each(&self, wo: Vec3, mut visit: impl FnMut(Vec3, f64)) {
        let wo = wo.as_dvec3();
        let theta_o = wo.x.hypot(wo.y).atan2(wo.z);
        let (cos, sin) = match wo.truncate().try_normalize() {
            Some(axis) => (axis.x, axis.y),
            None => (1.0, 0.0),
        };
        let last = ((FRAC_PI_2 + theta_o) * 0.5).min(FRAC_PI_2);
        let full = (FRAC_PI_2 - theta_o) * 0.5;
        let mut ring = |low: f64, high: f64| {
            for g in GAUSS {
                let theta_h = low + (high - low) * g;
                self.ring(wo, theta_o, (cos, sin), theta_h, (high - low) * 0.5, &mut visit);
            }
        };
        for k in 0..BINS * self.parts {
            let edge = |k: usize| (k as f64 / (BINS * self.parts) as f64).powi(2) * FRAC_PI_2;
            let (low, high) = (edge(k), edge(k + 1).min(last));
            if low >= high {
                break;
            }
            // φmax has a kink where half vectors begin to reflect below the horizon; no part spans it.
            if low < full && full < high {
                ring(low, full);
                ring(full, high);
            } else {
                ring(low, high);
            }
        }
    }

    /// A ring of half vectors of polar angle `theta_h`, which stands for a width of `d_theta`.
    fn ring(
        &self,
        wo: DVec3,
        theta_o: f64,
        (cos, sin): (f64, f64),
        theta_h: f64,
        d_theta: f64,
        visit: &mut impl FnMut(Vec3, f64),
    ) {
        let phi_max = phi_max(theta_o, theta_h);
        let (sin_h, cos_h) = theta_h.sin_cos();
        let d_phi = 2.0 * phi_max / self.phi_points as f64;
        for j in 0..self.phi_points {
            let (s, c) = (-phi_max + (j as f64 + 0.5) * d_phi).sin_cos();
            let h = DVec3::new(sin_h * (c * cos - s * sin), sin_h * (c * sin + s * cos), cos_h);
            let wi = reflect_about(wo, h);
            if wi.z > 0.0 {
                visit(wi.as_vec3(), 4.0 * wo.dot(h) * sin_h * d_theta * d_phi);
            }
        }
    }
}

/// Largest azimuth, from that of `wo`, of half vectors at `theta_h` whose reflection of `wo` is above the horizon; π where
/// all are. Domain: θh below (90° + θo)/2.
pub fn phi_max(theta_o: f64, theta_h: f64) -> f64 {
    let (below, above) = ((2.0 * theta_h - theta_o).cos(), (2.0 * theta_h + theta_o).cos());
    if above >= 0.0 {
        return PI;
    }
    2.0 * (below / -above).max(0.0).sqrt().atan()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::spherical;

    #[test]
    fn integrates_constants_and_cosines_at_every_angle() {
        for degrees in [0.0, 0.76, 14.5, 29.75, 45.0, 60.25, 75.5, 84.7, 89.0, 89.9] {
            let wo = spherical(f64::to_radians(degrees), 0.7).as_vec3();
            let q = HalfVectorQuadrature::default();
            let cosine = q.integrate(wo, |wi| f64::from(wi.z) / PI);
            let solid_angle = q.integrate(wo, |_| 1.0) / (2.0 * PI);
            assert!((cosine - 1.0).abs() < 2e-4, "{degrees}: {cosine}");
            assert!((solid_angle - 1.0).abs() < 2e-3, "{degrees}: {solid_angle}");
        }
    }
}
