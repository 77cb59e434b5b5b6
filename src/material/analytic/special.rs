//! Special functions that the standard library lacks.

use std::f64::consts::PI;

/// The complementary error function for x ≥ 0, to a relative error of some 10⁻¹³.
pub(super) fn erfc(x: f64) -> f64 {
    if x < 2.0 {
        1.0 - erf_series(x)
    } else {
        erfc_fraction(x)
    }
}

/// erf x = 2/√π · e^(−x²) Σ 2ⁿ x^(2n+1) / (1·3·5 … (2n+1)): all terms are positive.
fn erf_series(x: f64) -> f64 {
    let mut term = x;
    let mut sum = x;
    let mut n = 0.0;
    while term > 1e-17 * sum {
        n += 1.0;
        term *= 2.0 * x * x / (2.0 * n + 1.0);
        sum += term;
    }
    2.0 / PI.sqrt() * (-x * x).exp() * sum
}

/// erfc x = e^(−x²)/√π · 1/(x + (1/2)/(x + (2/2)/(x + (3/2)/(x + …)))), from the inside out.
fn erfc_fraction(x: f64) -> f64 {
    let mut denominator = x;
    for k in (1..=100).rev() {
        denominator = x + 0.5 * f64::from(k) / denominator;
    }
    (-x * x).exp() / PI.sqrt() / denominator
}

/// ln m! for m ≥ 0: a sum for small m, Stirling's series beyond.
pub(super) fn ln_factorial(m: u32) -> f64 {
    if m < 32 {
        (2..=m).map(|k| f64::from(k).ln()).sum()
    } else {
        let m = f64::from(m);
        let series = 1.0 / (12.0 * m) - 1.0 / (360.0 * m.powi(3)) + 1.0 / (1260.0 * m.powi(5));
        m * m.ln() - m + 0.5 * (2.0 * PI * m).ln() + series
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_tables() {
        for (x, value) in [
            (0.0, 1.0),
            (0.5, 0.479_500_122_186_953_5),
            (1.0, 0.157_299_207_050_285_13),
            (2.0, 0.004_677_734_981_047_266),
            (3.0, 2.209_049_699_858_544e-5),
            (6.0, 2.151_973_671_249_891_3e-17),
        ] {
            let error = erfc(x) / value - 1.0;
            assert!(error.abs() < 2e-12, "{x}: {error}");
        }
        assert_eq!(erfc(1e3), 0.0);
        assert_eq!(erfc(f64::INFINITY), 0.0);
    }

    #[test]
    fn factorials_agree_where_the_formulas_meet() {
        let sum: f64 = (2..=40u32).map(|k| f64::from(k).ln()).sum();
        assert!((ln_factorial(40) - sum).abs() < 1e-11);
        assert_eq!(ln_factorial(0), 0.0);
    }
}
