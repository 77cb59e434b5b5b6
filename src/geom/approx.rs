//! Elementary functions to a few units of f32, in a third of the library's time.
//!
//! Samplers that look up and invert tables need angles no better than the f32 directions they come from and go to. The
//! polynomials are Abramowitz and Stegun's (1964): 4.4.46, 4.4.49 and 4.3.97.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Arc cosine on [0, 1] to 2·10⁻⁸ rad; 0 above 1.
#[inline]
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
    let x = x.min(1.0);
    (1.0 - x).sqrt() * polynomial(&C, x)
}

/// Angle of (x, y) in [−π, π] to 4·10⁻⁸ rad, and to 4·10⁻⁸ of itself near 0; 0 for (0, 0).
#[inline]
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
    let t = ax.min(ay) / high;
    let t2 = t * t;
    let angle = t * (polynomial(&[C[0], C[1], C[2], C[3], C[4], C[5], C[6], C[7]], t2) + C[8] * t2.powi(8));
    // Octants come at random, so they are told apart without branches.
    let steep = f64::from(u8::from(ay > ax));
    let angle = steep * FRAC_PI_2 + (1.0 - 2.0 * steep) * angle;
    let back = f64::from(u8::from(x < 0.0));
    let angle = back * PI + (1.0 - 2.0 * back) * angle;
    angle.copysign(y)
}

/// Sine and cosine of `turns` full turns, 0 to 1, to 10⁻⁸; the sine to 10⁻⁸ of itself near 0.
#[inline]
pub fn sin_cos_turns(turns: f64) -> (f64, f64) {
    // Truncation is an instruction everywhere; rounding is a call on the oldest x86-64.
    let nearest = (4.0 * turns + 0.5) as u32;
    // At most an eighth of a turn from a multiple of a quarter, where the cosine follows from the sine without loss.
    let x = (turns - 0.25 * f64::from(nearest)) * TAU;
    let x2 = x * x;
    let low = 1.0 - 0.166_666_666_4 * x2 + x2 * x2 * (0.008_333_331_5 - 0.000_198_409_0 * x2);
    let s = x * (low + x2 * x2 * x2 * x2 * (0.000_002_752_6 - 0.000_000_023_9 * x2));
    let c = ((1.0 - s) * (1.0 + s)).sqrt();
    // The quarter comes at random, so it is applied without branches.
    let odd = 0u64.wrapping_sub(u64::from(nearest & 1));
    let (s, c) = (s.to_bits(), c.to_bits());
    let negative = |quarter: u32| u64::from(quarter & 2) << 62;
    let sin = (s & !odd | c & odd) ^ negative(nearest);
    let cos = (c & !odd | s & odd) ^ negative(nearest + 1);
    (f64::from_bits(sin), f64::from_bits(cos))
}

/// Estrin's scheme: shorter chains of operations than Horner's.
#[inline]
fn polynomial(c: &[f64; 8], x: f64) -> f64 {
    let x2 = x * x;
    let low = (c[0] + c[1] * x) + (c[2] + c[3] * x) * x2;
    let high = (c[4] + c[5] * x) + (c[6] + c[7] * x) * x2;
    low + high * (x2 * x2)
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
}
