//! The axis of θh that cells are laid on.

use std::f64::consts::FRAC_PI_2;

use crate::geometry::merl_axes::{
    THETA_H_BINS, theta_h_at_fraction, theta_h_edge, theta_h_fraction,
};

/// How cells are spaced over θh.
///
/// The example of [`SamplerSpec`](crate::sampler::SamplerSpec) reads settings from text and lists them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ThetaSpacing {
    /// Equal steps of √θh, as MERL's own bins: fine where highlights are.
    #[default]
    Merl,
    /// Equal steps of θh (the thesis).
    Uniform,
}

/// MERL's first bin of θh ends here on the axis of √θh.
const FIRST_BIN: f64 = 1.0 / THETA_H_BINS as f64;

/// A map from a in [0, 1] to θh in [0, π/2].
///
/// Up to `first` it is uniform in area: a density over a that is finite at the pole would otherwise be infinite per solid
/// angle there, and the pole is the mirror direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::sampler) struct ThetaAxis {
    spacing: ThetaSpacing,
    first: f64,
    /// 1 − cos θh at `first`.
    cap: f64,
}

impl ThetaAxis {
    pub fn new(spacing: ThetaSpacing, cells: usize) -> Self {
        let first = match spacing {
            ThetaSpacing::Merl => FIRST_BIN,
            ThetaSpacing::Uniform => 1.0 / cells as f64,
        };
        let beyond = Self {
            spacing,
            first: 0.0,
            cap: 0.0,
        };
        // 1 − cos θ = 2 sin²(θ/2), without cancellation at small θ.
        let half = beyond.theta(first) * 0.5;
        Self {
            spacing,
            first,
            cap: 2.0 * half.sin().powi(2),
        }
    }

    /// θh at `a`.
    #[inline]
    pub fn theta(&self, a: f64) -> f64 {
        if a < self.first {
            // 1 − cos θ = cap·a/first, with 1 − cos θ = 2 sin²(θ/2).
            return 2.0 * (a / self.first * self.cap * 0.5).sqrt().asin();
        }
        match self.spacing {
            ThetaSpacing::Merl => theta_h_at_fraction(a),
            ThetaSpacing::Uniform => a * FRAC_PI_2,
        }
    }

    /// The `a` at which [`Self::theta`] is `theta`.
    #[inline]
    pub fn coordinate(&self, theta: f64) -> f64 {
        let a = match self.spacing {
            ThetaSpacing::Merl => theta_h_fraction(theta),
            ThetaSpacing::Uniform => theta / FRAC_PI_2,
        };
        if a < self.first {
            2.0 * (theta * 0.5).sin().powi(2) / self.cap * self.first
        } else {
            a.min(1.0)
        }
    }

    /// The `a` of the edges between MERL's bins of θh, ascending, without both ends. None for equal steps of the angle, which
    /// are the thesis's and know nothing of bins.
    pub fn merl_edges(&self) -> Vec<f64> {
        if self.spacing == ThetaSpacing::Uniform {
            return Vec::new();
        }
        (1..THETA_H_BINS)
            .map(|bin| self.coordinate(theta_h_edge(bin)))
            .collect()
    }

    /// sin θh · dθh/da: solid angle a radian of azimuth and unit of a, at `a` where the sine of θh is `sin`.
    #[inline]
    pub fn solid_angle(&self, a: f64, sin: f64) -> f64 {
        if a < self.first {
            // d(1 − cos θ)/da
            return self.cap / self.first;
        }
        match self.spacing {
            // dθ/da of θ = a²·π/2
            ThetaSpacing::Merl => sin * 2.0 * a * FRAC_PI_2,
            ThetaSpacing::Uniform => sin * FRAC_PI_2,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_invert_and_areas_add_up() {
        for spacing in [ThetaSpacing::Merl, ThetaSpacing::Uniform] {
            let axis = ThetaAxis::new(spacing, 37);
            let mut area = 0.0;
            let n = 200_000;
            for i in 0..n {
                let a = (f64::from(i) + 0.5) / f64::from(n);
                assert!((axis.coordinate(axis.theta(a)) - a).abs() < 1e-12);
                area += axis.solid_angle(a, axis.theta(a).sin()) / f64::from(n);
            }
            assert!((area - 1.0).abs() < 1e-5, "{spacing:?}: {area}");
            assert_eq!(axis.theta(0.0), 0.0);
            assert!((axis.theta(1.0) - FRAC_PI_2).abs() < 1e-15);
        }
    }
}
