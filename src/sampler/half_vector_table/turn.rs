//! A table about one azimuth of `wo` used about another.
//!
//! What is sharp in an anisotropic material, the streaks of its half vectors, stays on the surface when `wo` turns. So azimuths
//! in the table, which count from `wo`, are turned back by as much as `wo` has turned: exactly where every azimuth reflects
//! above the horizon, and elsewhere by the Möbius map of [−1, 1] that keeps both ends and moves the middle as far. Either maps
//! the row of half vectors about one `wo` onto that about the other, so no draw is lost and no direction left out.

use std::f64::consts::{PI, TAU};

/// How far `wo` is turned from the azimuth of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// tan(Δ/4), in [−1, 1].
    quarter: f32,
}

/// The farthest that the middle of a row which the horizon ends is moved, as a share of the way to its end.
const FARTHEST: f32 = 0.5;

impl Turn {
    /// `wo` at azimuth `angle` from the table's, radians.
    pub fn by(angle: f64) -> Self {
        let within = angle - TAU * (angle / TAU).round();
        Self {
            quarter: (0.25 * within.clamp(-PI, PI) as f32).tan(),
        }
    }

    /// Where the azimuth's share `b` about `wo` stands in the table, and how much the table is stretched there: db in the table
    /// per db. `widest` is the unit of `b`, 1 for a whole turn.
    #[inline]
    pub fn to_table(self, b: f32, widest: f32) -> (f32, f32) {
        moved(b, widest, self.quarter)
    }

    /// The inverse.
    #[inline]
    pub fn to_surface(self, b: f32, widest: f32) -> f32 {
        moved(b, widest, -self.quarter).0
    }
}

/// `b` moved by the angle of which `quarter` is tan(Δ/4), and the slope of the map.
#[inline]
fn moved(b: f32, widest: f32, quarter: f32) -> (f32, f32) {
    if widest >= 1.0 {
        // tan of a sum; beyond half a turn, a whole one less.
        let sum = (b + quarter) / (1.0 - b * quarter);
        let to = if sum.abs() > 1.0 { -1.0 / sum } else { sum };
        return (to, (1.0 + to * to) / (1.0 + b * b));
    }
    let middle = (quarter / widest).clamp(-FARTHEST, FARTHEST);
    let scale = 1.0 / (1.0 + b * middle);
    (
        ((b + middle) * scale).clamp(-1.0, 1.0),
        (1.0 - middle * middle) * scale * scale,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANGLES: [f64; 7] = [0.0, 0.3, -0.02, 1.5, -2.0, PI, 6.0];

    #[test]
    fn whole_rows_are_turned_by_the_angle() {
        for angle in ANGLES {
            for k in -20..20 {
                let phi = f64::from(k) * PI / 20.0 + 0.01;
                let (b, slope) = Turn::by(angle).to_table((0.25 * phi).tan() as f32, 1.0);
                let off = (4.0 * f64::from(b).atan() - phi - angle) / TAU;
                assert!((off - off.round()).abs() < 1e-6, "{angle} {phi}: {b}");
                let expected = (1.0 + f64::from(b * b)) / (1.0 + (0.25 * phi).tan().powi(2));
                assert!((f64::from(slope) - expected).abs() < 1e-5);
            }
        }
    }

    /// At seams of the turn too: nothing but a whole turn lies between.
    #[test]
    fn maps_are_inverted_and_their_slopes_integrate_to_their_length() {
        for angle in ANGLES {
            for widest in [1.0, 0.999, 0.4, 0.01, 1e-6] {
                let (mut sum, n) = (0.0, 20_000);
                for k in 0..n {
                    let b = (k as f32 + 0.5) / n as f32 * 2.0 - 1.0;
                    let (to, slope) = Turn::by(angle).to_table(b, widest);
                    assert!(
                        (-1.0..=1.0).contains(&to) && slope > 0.2 && slope < 5.0,
                        "{angle} {b}: {to}"
                    );
                    let back = Turn::by(angle).to_surface(to, widest);
                    assert!((back - b).abs() < 2e-6, "{angle} {widest} {b}: {to} {back}");
                    sum += f64::from(slope) / f64::from(n);
                }
                assert!((sum - 1.0).abs() < 1e-3, "{angle} {widest}: {sum}");
            }
        }
        for b in [-1.0, 1.0] {
            assert!(Turn::by(PI).to_table(b, 1.0).0.is_finite());
        }
    }
}
