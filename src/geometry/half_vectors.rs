//! The half vectors about a given `wo` that reflect it above the horizon, as a rectangle.
//!
//! Coordinates: `theta_h` in [0, (π/2 + θo)/2], and `b` in [−1, 1], the azimuth of h against that of `wo` as a share of
//! the largest one, φmax(θh), that still reflects above the horizon. No point of the rectangle is lost.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec3, Vec3};

use super::{approx, is_upper, reflect_about, to_spherical};

/// The rectangle of half vectors about one direction.
#[derive(Clone, Copy, Debug)]
pub struct HalfVectors {
    wo: DVec3,
    theta_o: f64,
    /// Cosine and sine of the azimuth of `wo`; (1, 0) along the normal.
    azimuth: (f64, f64),
}

impl HalfVectors {
    /// `None` unless `wo` is finite and above the horizon.
    pub fn about(wo: Vec3) -> Option<Self> {
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
    ///
    /// cos φmax = −cot θo·cot 2θh, in the form tan²(φmax/2) = −cos(2θh−θo)/cos(2θh+θo), which keeps its digits at both ends.
    pub fn phi_max(&self, theta_h: f64) -> f64 {
        if theta_h <= self.theta_full() {
            return PI;
        }
        let cos = |angle: f64| approx::sin_cos_turns(angle.abs() * (1.0 / TAU)).1;
        let far = cos(2.0 * theta_h + self.theta_o);
        let near = cos(2.0 * theta_h - self.theta_o);
        if far >= 0.0 {
            PI
        } else {
            2.0 * approx::atan2(near.max(0.0).sqrt(), (-far).sqrt())
        }
    }

    /// The reflected direction at (θh, b) and dσ(wi) per dθh db = 4 (wo·h) sin θh φmax (Torrance–Sparrow's Jacobian).
    #[inline]
    pub fn direction(&self, theta_h: f64, b: f64) -> (Vec3, f64) {
        let phi_max = self.phi_max(theta_h);
        let (sin_h, cos_h) = approx::sin_cos_turns(theta_h * (1.0 / TAU));
        let turn = b * phi_max * (1.0 / TAU);
        let (sin, cos) = approx::sin_cos_turns(if turn < 0.0 { turn + 1.0 } else { turn });
        let h = self.turn(DVec3::new(sin_h * cos, sin_h * sin, cos_h), 1.0);
        let wi = reflect_about(self.wo, h);
        (wi.as_vec3(), 4.0 * self.wo.dot(h) * sin_h * phi_max)
    }

    /// (θh, b) of a direction: inverse of [`Self::direction`], clamped to the rectangle where rounding leaves it.
    pub fn coordinates(&self, wi: Vec3) -> (f64, f64) {
        let h = self.turn(self.wo + wi.as_dvec3(), -1.0);
        let (theta_h, phi) = to_spherical(h);
        let phi_max = self.phi_max(theta_h);
        let b = if phi_max > 0.0 { phi / phi_max } else { 0.0 };
        (theta_h.clamp(0.0, self.theta_max()), b.clamp(-1.0, 1.0))
    }

    /// `w` turned about the normal by the azimuth of `wo` (`sign` = 1), or back (−1).
    fn turn(&self, w: DVec3, sign: f64) -> DVec3 {
        let (cos, sin) = (self.azimuth.0, sign * self.azimuth.1);
        DVec3::new(cos * w.x - sin * w.y, sin * w.x + cos * w.y, w.z)
    }
}

/// A Fibonacci lattice in the unit square.
///
/// Its points project to equidistant midpoints on both axes, so that a density that jumps along either axis is integrated
/// to 1/size, where a grid of as many points reaches only 1/√size (Niederreiter 1992, §5).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FibonacciLattice {
    size: u64,
    generator: u64,
}

impl FibonacciLattice {
    /// The smallest Fibonacci lattice of at least `points` points (at least two, at most about 10⁹).
    pub fn at_least(points: usize) -> Self {
        let mut lattice = Self {
            size: 2,
            generator: 1,
        };
        while lattice.size < (points as u64).min(1 << 30) {
            lattice = Self {
                size: lattice.size + lattice.generator,
                generator: lattice.size,
            };
        }
        lattice
    }

    /// Number of points.
    pub fn size(self) -> usize {
        self.size as usize
    }

    /// The points, both coordinates strictly inside (0, 1).
    pub fn points(self) -> impl Iterator<Item = (f64, f64)> {
        let scale = 1.0 / self.size as f64;
        let at = move |i: u64| (i as f64 + 0.5) * scale;
        (0..self.size).map(move |i| (at(i), at(i * self.generator % self.size)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::spherical;

    #[test]
    fn coordinates_invert_directions_and_all_are_above_the_horizon() {
        for theta_o in [0.0, 0.3, 30.0, 60.25, 85.0, 89.9_f64] {
            let wo = spherical(theta_o.to_radians(), 2.0).as_vec3();
            let domain = HalfVectors::about(wo).unwrap();
            for (s, t) in FibonacciLattice::at_least(500).points() {
                let (theta_h, b) = (s * domain.theta_max(), 2.0 * t - 1.0);
                let (wi, jacobian) = domain.direction(theta_h, b);
                assert!(
                    is_upper(wi) && jacobian > 0.0,
                    "θo {theta_o}, θh {theta_h}, b {b}: {wi}"
                );
                let (theta_back, b_back) = domain.coordinates(wi);
                assert!(
                    (theta_back - theta_h).abs() < 2e-6,
                    "{theta_o}: {theta_h} {theta_back}"
                );
                let slack = 1e-5 / (theta_h.sin() * domain.phi_max(theta_h)).max(1e-6);
                assert!((b_back - b).abs() < slack, "{theta_o}: {b} {b_back}");
            }
        }
    }

    #[test]
    fn the_horizon_is_at_the_ends_of_the_azimuth() {
        let domain = HalfVectors::about(spherical(1.2, 0.0).as_vec3()).unwrap();
        for theta_h in [
            domain.theta_full() + 0.01,
            0.6,
            1.0,
            domain.theta_max() - 0.01,
        ] {
            let (wi, _) = domain.direction(theta_h, 1.0);
            assert!(wi.z.abs() < 1e-6, "{theta_h}: {wi}");
        }
        assert_eq!(domain.phi_max(domain.theta_full() - 1e-9), PI);
        assert!(domain.phi_max(domain.theta_max()) < 1e-7);
    }

    #[test]
    fn directions_below_the_horizon_have_no_half_vectors() {
        assert!(HalfVectors::about(-Vec3::Z).is_none());
        assert!(HalfVectors::about(Vec3::NAN).is_none());
    }

    #[test]
    fn lattices_project_to_midpoints() {
        let lattice = FibonacciLattice::at_least(89);
        assert_eq!(lattice.size(), 89);
        let mut second: Vec<f64> = lattice.points().map(|p| p.1).collect();
        second.sort_by(f64::total_cmp);
        for (i, y) in second.iter().enumerate() {
            assert!((y - (i as f64 + 0.5) / 89.0).abs() < 1e-12);
        }
    }
}
