//! A table about one azimuth of `wo` used about another.
//!
//! What is sharp in an anisotropic material, the streaks of its half vectors, stays on the surface when `wo` turns. So azimuths
//! in the table, which count from `wo`, are turned back by as much as `wo` has turned: exactly where every azimuth reflects
//! above the horizon, and elsewhere by the Möbius map of [−1, 1] that keeps both ends and moves the middle as far. Either maps
//! the row of half vectors about one `wo` onto that about the other, so no draw fails and no direction left out.

use std::f64::consts::{PI, TAU};

/// How far `wo` is turned from the azimuth of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AzimuthShift {
    /// tan(Δ/4), in [−1, 1].
    quarter_tan: f32,
}

/// The farthest that the middle of a row which the horizon ends is moved, as a fraction of the way to its end.
const FARTHEST: f32 = 0.5;

impl AzimuthShift {
    /// `wo` at azimuth `angle` from the table's, radians.
    pub fn new(angle: f64) -> Self {
        let within = angle - TAU * (angle / TAU).round();
        Self {
            quarter_tan: (0.25 * within.clamp(-PI, PI) as f32).tan(),
        }
    }

    /// The table's azimuth fraction of the azimuth fraction `fraction` about `wo`, and the slope of that map. `max_quarter_tan`
    /// is the unit of both, 1 for a whole turn.
    #[inline]
    pub fn to_table(self, fraction: f32, max_quarter_tan: f32) -> (f32, f32) {
        shift(fraction, max_quarter_tan, self.quarter_tan)
    }

    /// The inverse.
    #[inline]
    pub fn to_surface(self, fraction: f32, max_quarter_tan: f32) -> f32 {
        shift(fraction, max_quarter_tan, -self.quarter_tan).0
    }
}

/// An azimuth fraction moved by the angle Δ of which `quarter_tan` is tan(Δ/4), and the slope of the map.
#[inline]
fn shift(fraction: f32, max_quarter_tan: f32, quarter_tan: f32) -> (f32, f32) {
    if max_quarter_tan >= 1.0 {
        // Every azimuth is in the row: tan of a sum; beyond half a turn, a whole one less.
        let sum = (fraction + quarter_tan) / (1.0 - fraction * quarter_tan);
        let moved = if sum.abs() > 1.0 { -1.0 / sum } else { sum };
        return (moved, (1.0 + moved * moved) / (1.0 + fraction * fraction));
    }
    // The horizon ends the row: (β + m)/(1 + βm), with the middle moved by m, keeps both ends.
    let middle = (quarter_tan / max_quarter_tan).clamp(-FARTHEST, FARTHEST);
    let scale = 1.0 / (1.0 + fraction * middle);
    (
        ((fraction + middle) * scale).clamp(-1.0, 1.0),
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
                let (b, slope) = AzimuthShift::new(angle).to_table((0.25 * phi).tan() as f32, 1.0);
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
            for max_quarter_tan in [1.0, 0.999, 0.4, 0.01, 1e-6] {
                let (mut sum, n) = (0.0, 20_000);
                for k in 0..n {
                    let b = (k as f32 + 0.5) / n as f32 * 2.0 - 1.0;
                    let (to, slope) = AzimuthShift::new(angle).to_table(b, max_quarter_tan);
                    assert!(
                        (-1.0..=1.0).contains(&to) && slope > 0.2 && slope < 5.0,
                        "{angle} {b}: {to}"
                    );
                    let back = AzimuthShift::new(angle).to_surface(to, max_quarter_tan);
                    assert!(
                        (back - b).abs() < 2e-6,
                        "{angle} {max_quarter_tan} {b}: {to} {back}"
                    );
                    sum += f64::from(slope) / f64::from(n);
                }
                assert!((sum - 1.0).abs() < 1e-3, "{angle} {max_quarter_tan}: {sum}");
            }
        }
        for b in [-1.0, 1.0] {
            assert!(AzimuthShift::new(PI).to_table(b, 1.0).0.is_finite());
        }
    }
}
