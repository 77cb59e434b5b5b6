//! Tables at a few polar angles of `wo`, and what is used for the angles between them.

use std::f64::consts::FRAC_PI_2;

use glam::Vec3;

use crate::geometry::approx;
use crate::{Error, Result};

/// What a sampler does with a `wo` between two of its tables.
///
/// The example of [`SamplerSpec`](crate::sampler::SamplerSpec) reads settings from text and lists them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TableChoice {
    /// Uses the table of the nearest angle (thesis 6.3.1).
    Nearest,
    /// Draws from one of the two neighbours at random, in proportion to nearness; the density is that of the mixture.
    #[default]
    Mixture,
}

/// The angle of the last table, short of the horizon, where measured values are few and wild.
const LAST: f64 = 89.5 / 180.0 * std::f64::consts::PI;

/// Polar angles of `wo` that have a table: equally spaced from 0 to 90°, the last moved to 89.5°.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ThetaKnots {
    count: usize,
    choice: TableChoice,
}

/// One or two tables and the weight of the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct KnotPair {
    pub first: usize,
    pub second: usize,
    pub share: f64,
}

impl ThetaKnots {
    /// `count` knots, 1 to 4096.
    pub fn new(count: usize, choice: TableChoice) -> Result<Self> {
        if !(1..=4096).contains(&count) {
            return Err(Error::argument(
                format!("{count} tables over the angle of wo"),
                "choose between 1 and 4096 tables",
            ));
        }
        Ok(Self { count, choice })
    }

    pub fn count(self) -> usize {
        self.count
    }

    /// Angle of knot `k`, radians. A single table is that of normal incidence.
    pub fn theta(self, k: usize) -> f64 {
        debug_assert!(k < self.count);
        if self.count == 1 {
            return 0.0;
        }
        (k as f64 * FRAC_PI_2 / (self.count - 1) as f64).min(LAST)
    }

    /// The knot whose angle is nearest to `theta`, radians; the first for one that is not finite.
    pub fn nearest(self, theta: f64) -> usize {
        let mut nearest = 0;
        let mut least = f64::INFINITY;
        for k in 0..self.count {
            // For an angle that is not finite, no distance is below infinity: the first knot remains.
            let distance = (self.theta(k) - theta).abs();
            if distance < least {
                (nearest, least) = (k, distance);
            }
        }
        nearest
    }

    /// Tables that are used for the upper direction `wo`.
    #[inline]
    pub fn neighbours(self, wo: Vec3) -> KnotPair {
        if self.count == 1 {
            return KnotPair {
                first: 0,
                second: 0,
                share: 0.0,
            };
        }
        // Angles beyond the last knot use its table alone.
        let theta = approx::acos(f64::from(wo.z)).min(LAST);
        let step = FRAC_PI_2 / (self.count - 1) as f64;
        let first = ((theta / step) as usize).min(self.count - 2);
        let low = first as f64 * step;
        // If the step is small, several knots have the last angle, and the interval between them has no width.
        let width = self.theta(first + 1) - low;
        let share = if width > 0.0 {
            ((theta - low) / width).clamp(0.0, 1.0)
        } else {
            0.0
        };
        debug_assert!((0.0..=1.0).contains(&share));
        match self.choice {
            TableChoice::Mixture => KnotPair {
                first,
                second: first + 1,
                share,
            },
            TableChoice::Nearest => {
                let nearest = first + usize::from(share > 0.5);
                KnotPair {
                    first: nearest,
                    second: nearest,
                    share: 0.0,
                }
            }
        }
    }
}

/// Splits [0, 1) at `at`: whether `u` fell below, and its position within its part, again uniform in [0, 1).
#[inline]
pub(super) fn split_unit(u: f64, at: f64) -> (bool, f64) {
    debug_assert!((0.0..=1.0).contains(&at));
    // Both parts come at random: choose the operands, not the path.
    let below = u < at;
    let (low, width) = if below { (0.0, at) } else { (at, 1.0 - at) };
    (below, ((u - low) / width).min(1.0f64.next_down()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::spherical;

    #[test]
    fn knots_span_the_hemisphere_and_stop_short_of_the_horizon() {
        let knots = ThetaKnots::new(60, TableChoice::Mixture).unwrap();
        assert_eq!(knots.theta(0), 0.0);
        assert!((knots.theta(1).to_degrees() - 90.0 / 59.0).abs() < 1e-12);
        assert!((knots.theta(59).to_degrees() - 89.5).abs() < 1e-12);
        for degrees in [0.0, 0.1, 45.0, 88.4, 88.5, 89.4, 89.6, 89.9999] {
            let n = knots.neighbours(spherical(f64::to_radians(degrees), 1.0).as_vec3());
            let theta = knots.theta(n.first) * (1.0 - n.share) + knots.theta(n.second) * n.share;
            // z rounded to f32 leaves angles near 0 uncertain by 10⁻⁴ rad.
            assert!(
                (theta.to_degrees() - degrees.min(89.5)).abs() < 2e-2,
                "{degrees}: {n:?}"
            );
        }
    }

    #[test]
    fn every_count_serves_every_angle() {
        for count in 1..=4096 {
            let knots = ThetaKnots::new(count, TableChoice::Mixture).unwrap();
            for degrees in [0.0, 45.0, 89.25, 89.5, 89.75, 89.999] {
                let n = knots.neighbours(spherical(f64::to_radians(degrees), 1.0).as_vec3());
                assert!(
                    (0.0..=1.0).contains(&n.share),
                    "{count} tables, {degrees}°: {n:?}"
                );
                assert!(n.second < count);
            }
        }
    }

    #[test]
    fn nearest_takes_one_table() {
        let knots = ThetaKnots::new(10, TableChoice::Nearest).unwrap();
        let n = knots.neighbours(spherical(f64::to_radians(16.0), 0.0).as_vec3());
        assert_eq!(
            n,
            KnotPair {
                first: 2,
                second: 2,
                share: 0.0
            }
        );
    }

    #[test]
    fn counts_out_of_range_are_refused() {
        assert!(ThetaKnots::new(0, TableChoice::Mixture).is_err());
        assert!(ThetaKnots::new(5000, TableChoice::Mixture).is_err());
    }
}
