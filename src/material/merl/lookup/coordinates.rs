//! From squared tangents to coordinates in bins, in arithmetic that a compiler turns into vector code.

use super::half_diff_tan2::HalfDiffTan2;

/// A pair's place in a table, in units of bins from the lower edge of bin 0 on each axis.
#[derive(Clone, Copy, Debug)]
pub(in crate::material::merl) struct Coordinates {
    /// 0 to 90, as √θh.
    pub theta_h: f64,
    /// 0 to 90, in degrees.
    pub theta_d: f64,
    /// −90 to 360, in degrees; the table's bins of φd are its period.
    pub phi_d: f64,
}

impl Coordinates {
    /// Coordinates of a valid pair, within 2·10⁻⁷ bins of arctangents. Where θh is 0, φd means nothing: it is the azimuth of `wi`.
    #[inline(always)]
    pub fn compute(tan2: HalfDiffTan2, phi_d_bins: usize) -> Self {
        // Degrees on either side of φd = 0 or, in a table of 360, of φd = π.
        let falling = tan2.phi_d < 0.0;
        let opposite = (phi_d_bins == 360) & ((tan2.half_turn < 0.0) != falling);
        let degrees = 90.0 * quarter_turns(tan2.phi_d.abs());
        let signed = if falling { -degrees } else { degrees };
        Self {
            // c = 90·√(θh/(π/2))
            theta_h: 90.0 * quarter_turns(tan2.theta_h).sqrt(),
            theta_d: 90.0 * quarter_turns(tan2.theta_d),
            phi_d: if opposite { signed + 180.0 } else { signed },
        }
    }
}

/// The angle in [0, 1] quarter turns whose squared tangent is `tan2` ≥ 0, to 8·10⁻¹⁰; 0 for NaN, 1 for infinity.
#[inline(always)]
fn quarter_turns(tan2: f64) -> f64 {
    // arctan(t)/t in quarter turns as a polynomial in t² on [0, 1]: minimax in t·P(t²), with P(0) = 2/π exact.
    const C: [f64; 10] = [
        std::f64::consts::FRAC_2_PI,
        -0.212_206_142_172_572_53,
        0.127_308_802_638_172_24,
        -0.090_753_091_543_192,
        0.069_456_966_161_563_38,
        -0.052_774_181_815_641_245,
        0.035_731_665_973_233_57,
        -0.018_746_123_180_936_74,
        0.006_382_458_354_069_254,
        -0.001_020_127_493_160_140_3,
    ];
    // Step 1: the squared tangent of the angle or, beyond half a quarter, of its complement: tan(π/2 − α) = 1/tan α.
    let steep = tan2 > 1.0;
    let t2 = if steep { 1.0 / tan2 } else { tan2 };
    let t2 = if t2 > 0.0 { t2 } else { 0.0 };
    // Step 2: P by Estrin's scheme, whose chains are shorter than Horner's.
    let t4 = t2 * t2;
    let low = (C[0] + C[1] * t2) + (C[2] + C[3] * t2) * t4;
    let high = (C[4] + C[5] * t2) + (C[6] + C[7] * t2) * t4;
    let t8 = t4 * t4;
    let angle = t2.sqrt() * (low + high * t8 + (C[8] + C[9] * t2) * (t8 * t8));
    // Step 3: back from the complement.
    if steep { 1.0 - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::merl_axes::{degree_coordinate, theta_h_coordinate};

    fn coordinates(tan2: f64) -> Coordinates {
        let all = HalfDiffTan2 {
            theta_h: tan2,
            theta_d: tan2,
            phi_d: tan2,
            half_turn: 1.0,
        };
        Coordinates::compute(all, 180)
    }

    #[test]
    fn coordinates_are_those_of_arctangents() {
        let mut worst = [0.0f64; 3];
        for i in 0..=400_000 {
            // Squared tangents from 2⁻⁶⁰ to 2²⁰.
            let t = (f64::from(i) / 5000.0 - 60.0).exp2();
            let found = coordinates(t);
            let degrees = degree_coordinate(t);
            worst[0] = worst[0].max((found.theta_h - theta_h_coordinate(t)).abs());
            worst[1] = worst[1].max((found.theta_d - degrees).abs());
            worst[2] = worst[2].max((found.phi_d - degrees).abs());
        }
        assert!(worst.iter().all(|&e| e < 2e-7), "{worst:?}");
    }

    #[test]
    fn ends_are_exact_and_the_complement_joins() {
        for (tan2, expected) in [(0.0, 0.0), (f64::NAN, 0.0), (f64::INFINITY, 90.0)] {
            let found = coordinates(tan2);
            assert_eq!([found.theta_h, found.theta_d], [expected; 2], "{tan2}");
        }
        let step = coordinates(1f64.next_up()).theta_d - coordinates(1.0).theta_d;
        assert!(step.abs() < 2e-7, "{step}");
    }

    /// −φd and, in a table of 360 bins, the other half turn.
    #[test]
    fn azimuths_have_their_half_turn() {
        for (phi_d, half_turn, expected) in [
            (1.0, 1.0, 45.0),
            (-1.0, 1.0, 135.0),
            (1.0, -1.0, 225.0),
            (-1.0, -1.0, -45.0),
        ] {
            let tan2 = HalfDiffTan2 {
                theta_h: 1.0,
                theta_d: 1.0,
                phi_d,
                half_turn,
            };
            let found = Coordinates::compute(tan2, 360).phi_d;
            assert!(
                (found - expected).abs() < 1e-6,
                "{phi_d} {half_turn}: {found}"
            );
        }
    }
}
