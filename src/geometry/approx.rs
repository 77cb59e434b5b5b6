//! Elementary functions to a few units of f32, in a third of the library's time.
//!
//! Samplers that look up and invert tables need angles no better than the f32 directions they come from and go to. The
//! polynomials are Abramowitz and Stegun's (1964): 4.4.46, 4.4.49 and 4.3.97.
//!
//! Their `fine_` siblings are for f64 directions that are looked up in pictures: ten digits and more, without branches, so
//! that loops over arrays become vector code. Their polynomials are minimax (Remez) with the leading term exact.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// Arc cosine on [0, 1] to 2·10⁻⁸ rad; 0 above 1.
///
/// # Examples
/// ```
/// use merlkit::geometry::approx;
///
/// assert!((approx::acos(0.3) - 0.3_f64.acos()).abs() < 1e-7);
/// assert!((approx::atan2(1.0, -2.0) - 1.0_f64.atan2(-2.0)).abs() < 1e-7);
/// let (sin, cos) = approx::sin_cos_turns(0.125);
/// assert!((sin - cos).abs() < 1e-7);
/// ```
#[inline(always)]
pub fn acos(x: f64) -> f64 {
    const C: [f64; 8] = [
        1.570_796_305_0,
        -0.214_598_801_6,
        0.088_978_987_4,
        -0.050_174_304_6,
        0.030_891_881_0,
        -0.017_088_125_6,
        0.006_670_090_1,
        -0.001_262_491_1,
    ];
    // acos x = √(1 − x)·P(x): the root takes up the infinite slope at x = 1, and P is smooth.
    let x = x.min(1.0);
    (1.0 - x).sqrt() * polynomial(&C, x)
}

/// Angle of (x, y) in [−π, π] to 4·10⁻⁸ rad, and to 4·10⁻⁸ of itself near 0; 0 for (0, 0).
///
/// See [`acos`] for an example.
#[inline(always)]
pub fn atan2(y: f64, x: f64) -> f64 {
    const C: [f64; 9] = [
        1.0,
        -0.333_331_452_8,
        0.199_935_508_5,
        -0.142_088_994_4,
        0.106_562_639_3,
        -0.075_289_640_0,
        0.042_909_613_8,
        -0.016_165_736_7,
        0.002_866_225_7,
    ];
    let (ax, ay) = (x.abs(), y.abs());
    let high = ax.max(ay);
    if high == 0.0 {
        return 0.0;
    }
    // Step 1: t = min/max in [0, 1], where atan t = t·P(t²). P has one coefficient more than `polynomial` takes.
    let t = ax.min(ay) / high;
    let t2 = t * t;
    let angle =
        t * (polynomial(&[C[0], C[1], C[2], C[3], C[4], C[5], C[6], C[7]], t2) + C[8] * t2.powi(8));
    // Step 2: the octant. The angle is π/2 − atan t where |y| > |x|, then π − angle where x < 0, with the sign of y.
    // Octants come at random, so they are told apart without branches.
    let steep = f64::from(u8::from(ay > ax));
    let angle = steep * FRAC_PI_2 + (1.0 - 2.0 * steep) * angle;
    let back = f64::from(u8::from(x < 0.0));
    let angle = back * PI + (1.0 - 2.0 * back) * angle;
    angle.copysign(y)
}

/// Sine and cosine of `turns` full turns, 0 to 1, to 10⁻⁸; the sine to 10⁻⁸ of itself near 0.
///
/// See [`acos`] for an example.
#[inline(always)]
pub fn sin_cos_turns(turns: f64) -> (f64, f64) {
    // Step 1: the nearest multiple k of a quarter turn, and x = 2π(turns − k/4) in [−π/4, π/4].
    // Truncation is an instruction everywhere; rounding is a call on the oldest x86-64.
    let nearest = (4.0 * turns + 0.5) as u32;
    // At most an eighth of a turn from a multiple of a quarter, where the cosine follows from the sine without loss.
    let x = (turns - 0.25 * f64::from(nearest)) * TAU;
    // Step 2: sin x = x·P(x²), and cos x = √((1 − sin x)(1 + sin x)), which is positive there.
    let x2 = x * x;
    let low = 1.0 - 0.166_666_666_4 * x2 + x2 * x2 * (0.008_333_331_5 - 0.000_198_409_0 * x2);
    let s = x * (low + x2 * x2 * x2 * x2 * (0.000_002_752_6 - 0.000_000_023_9 * x2));
    let c = ((1.0 - s) * (1.0 + s)).sqrt();
    // Step 3: an odd k swaps the two. Bit 1 of k is the sign of the sine, and bit 1 of k + 1 that of the cosine.
    // The quarter comes at random, so it is applied without branches.
    let odd = 0u64.wrapping_sub(u64::from(nearest & 1));
    let (s, c) = (s.to_bits(), c.to_bits());
    let sin = (s & !odd | c & odd) ^ sign_of_quarter(nearest);
    let cos = (c & !odd | s & odd) ^ sign_of_quarter(nearest + 1);
    (f64::from_bits(sin), f64::from_bits(cos))
}

/// Angle of (x, y) in [−π, π] to 4·10⁻¹² of itself where it is within π/8 of 0, and to 4·10⁻¹² rad elsewhere.
///
/// Zeros count by their signs, as the library's do. Multiples of π/4 are exact to rounding. For lengths about
/// `f64::MIN_POSITIVE` it only stays in bounds; infinite ones give NaN.
#[inline(always)]
pub(crate) fn fine_atan2(y: f64, x: f64) -> f64 {
    const C: [f64; 8] = [
        1.0,
        -0.333_333_333_314_815_7,
        0.199_999_989_340_907_56,
        -0.142_856_136_363_537_25,
        0.111_075_227_528_023_92,
        -0.090_292_904_688_179_43,
        0.071_368_995_627_514_77,
        -0.040_462_555_942_950_79,
    ];
    const TAN_PI_8: f64 = 0.414_213_562_373_095;
    // Octants come at random, so they are distinguished by signs: compilers turn comparisons into branches.
    let (ax, ay) = (x.abs(), y.abs());
    // Step 1: low ≤ high of |x| and |y|, and on which side of the diagonals and axes the point is.
    let (low, high) = if ay > ax { (ax, ay) } else { (ay, ax) };
    let steep = ones_if_negative(ax - ay);
    let back = ones_if_negative(x);
    let far = ones_if_negative(TAN_PI_8 * high - low);
    // Step 2: for tan α = low/high, t = tan(α − π/4) = (low − high)/(high + low) where α > π/8, else tan α.
    // |t| ≤ tan(π/8) keeps the polynomial short. The summand MIN_POSITIVE makes t = 0 of (0, 0).
    let t = (low - masked(high, far)) / (high + masked(low, far) + f64::MIN_POSITIVE);
    let angle = t * polynomial(&C, t * t) + masked(FRAC_PI_4, far);
    // Step 3: back through the diagonal, α to π/2 − α, the vertical axis, α to π − α, and the horizontal axis.
    let angle = masked(FRAC_PI_2, steep) + negated(angle, steep);
    let angle = masked(PI, back) + negated(angle, back);
    angle.copysign(y)
}

/// Sine and cosine of `turns` full turns, in [−1, 1], to 10⁻¹²; their squares sum to 1 within 10⁻¹².
#[inline(always)]
pub(crate) fn fine_sin_cos_turns(turns: f64) -> (f64, f64) {
    // To this, numbers are added as integers: rounding without a call, and vector code on the oldest x86-64.
    const ROUND: f64 = 1.5 * (1u64 << 52) as f64;
    // Step 1: the quarter k nearest to 4·turns, in the low bits of the sum, and x = 2π(turns − k/4) in [−π/4, π/4].
    let rounded = 4.0 * turns + ROUND;
    let quarter = rounded.to_bits();
    let x = (turns - 0.25 * (rounded - ROUND)) * TAU;
    let x2 = x * x;
    let x4 = x2 * x2;
    // Step 2: s = (sin x/x − 1)/x² and c = (cos x − 1)/x². The leading terms are added last and keep all digits.
    let s = (-0.166_666_666_666_638_45 + 0.008_333_333_331_058_115 * x2)
        + (-0.000_198_412_668_997_644_8 + 0.000_002_755_598_643_096_349_3 * x2) * x4
        + -0.000_000_024_805_268_900_610_935 * (x4 * x4);
    let c = (-0.499_999_999_999_629_9 + 0.041_666_666_636_929_87 * x2)
        + (-0.001_388_888_505_353_456_3 + 0.000_024_799_852_339_582_005 * x2) * x4
        + -0.000_000_272_363_391_574_624_6 * (x4 * x4);
    let (s, c) = ((x + x * x2 * s).to_bits(), (1.0 + x2 * c).to_bits());
    // Step 3: an odd k swaps the two. Bit 1 of k is the sign of the sine, and bit 1 of k + 1 that of the cosine.
    let odd = 0u64.wrapping_sub(quarter & 1);
    let sin = (s & !odd | c & odd) ^ ((quarter & 2) << 62);
    let cos = (c & !odd | s & odd) ^ ((quarter.wrapping_add(1) & 2) << 62);
    (f64::from_bits(sin), f64::from_bits(cos))
}

/// Estrin's scheme: shorter chains of operations than Horner's.
#[inline(always)]
fn polynomial(c: &[f64; 8], x: f64) -> f64 {
    let x2 = x * x;
    let low = (c[0] + c[1] * x) + (c[2] + c[3] * x) * x2;
    let high = (c[4] + c[5] * x) + (c[6] + c[7] * x) * x2;
    low + high * (x2 * x2)
}

/// The sign bit of the sine in a quarter of the turn: set in the third and the fourth.
#[inline(always)]
fn sign_of_quarter(quarter: u32) -> u64 {
    u64::from(quarter & 2) << 62
}

/// All bits for numbers whose sign bit is set, else none, without a branch.
#[inline(always)]
fn ones_if_negative(v: f64) -> u64 {
    // The arithmetic shift copies the sign bit to all bits.
    (v.to_bits() as i64 >> 63) as u64
}

/// `v` where `mask` has all bits, 0 where it has none.
#[inline(always)]
fn masked(v: f64, mask: u64) -> f64 {
    f64::from_bits(v.to_bits() & mask)
}

/// −`v` where `mask` has all bits, `v` where it has none.
#[inline(always)]
fn negated(v: f64, mask: u64) -> f64 {
    f64::from_bits(v.to_bits() ^ (mask & (1 << 63)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_as_stated() {
        for i in 0..=100_000 {
            let x = f64::from(i) / 100_000.0;
            assert!((acos(x) - x.acos()).abs() < 2.5e-8, "{x}");
            let (s, c) = sin_cos_turns(x);
            let (sin, cos) = (x * TAU).sin_cos();
            assert!((s - sin).abs() < 5e-9, "{x}: {s} {sin}");
            assert!((c - cos).abs() < 5e-9, "{x}: {c} {cos}");
            let angle = (2.0 * x - 1.0) * PI;
            for radius in [1e-30, 1.0, 1e20] {
                let (y, x) = (radius * angle.sin(), radius * angle.cos());
                assert!((atan2(y, x) - y.atan2(x)).abs() < 4e-8, "{x} {y}");
            }
        }
        for k in 0..60 {
            let x = 0.5f64.powi(k);
            assert!((atan2(x, 1.0) / x.atan() - 1.0).abs() < 4e-8);
            assert!((sin_cos_turns(x / TAU).0 / x.sin() - 1.0).abs() < 5e-9);
        }
        assert_eq!(atan2(0.0, 0.0), 0.0);
        assert_eq!(acos(1.000_001), 0.0);
    }

    #[test]
    fn fine_errors_are_as_stated() {
        for i in -300_000..=300_000 {
            let turns = f64::from(i) / 300_000.0;
            let (s, c) = fine_sin_cos_turns(turns);
            let (sin, cos) = (turns * TAU).sin_cos();
            assert!(
                (s - sin).abs() < 1e-12 && (c - cos).abs() < 1e-12,
                "{turns}: {s} {sin} {c} {cos}"
            );
            assert!((s * s + c * c - 1.0).abs() < 1e-12);
            for radius in [1e-30, 1.0, 1e20] {
                let (y, x) = (radius * sin, radius * cos);
                assert!((fine_atan2(y, x) - y.atan2(x)).abs() < 4e-12, "{x} {y}");
            }
        }
        for k in 0..60 {
            let x = 0.4 * 0.5f64.powi(k);
            assert!((fine_atan2(x, 1.0) / x.atan() - 1.0).abs() < 4e-12);
            assert!((fine_sin_cos_turns(x / TAU).0 / x.sin() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn fine_functions_are_exact_on_axes_and_finite_everywhere() {
        let signed = [0.0, -0.0, 1.0, -1.0];
        for (y, x) in signed
            .into_iter()
            .flat_map(|y| signed.map(|x| (y, x)))
            .filter(|&(y, x)| y != x && y != -x)
        {
            assert_eq!(fine_atan2(y, x), f64::atan2(y, x), "{y} {x}");
        }
        for (y, x) in signed.into_iter().flat_map(|y| signed.map(|x| (y, x))) {
            let tiny = fine_atan2(y * 5e-324, x * 5e-324);
            assert!((-PI..=PI).contains(&tiny));
        }
        assert_eq!(fine_atan2(0.0, 0.0), 0.0);
        assert_eq!(fine_sin_cos_turns(0.0), (0.0, 1.0));
        assert_eq!(fine_sin_cos_turns(0.25), (1.0, 0.0));
        assert_eq!(fine_sin_cos_turns(-0.5).1, -1.0);
    }
}
