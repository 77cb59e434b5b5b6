//! Reflectance of a smooth interface for unpolarised light.

/// Fresnel's reflectance of a conductor of index η + iκ, where light arrives at cosine `c`: the mean of
///
/// ```text
/// r∥² = ((η² + κ²)c² − 2ηc + 1) / ((η² + κ²)c² + 2ηc + 1)
/// r⊥² = (η² + κ² − 2ηc + c²) / (η² + κ² + 2ηc + c²)
/// ```
///
/// which is near the exact value where η² + κ² is large, as of metals, and is the formula of the older models.
/// κ enters squared, so its sign has no effect. `eta` is > 0.
pub(super) fn conductor(eta: f64, kappa: f64, c: f64) -> f64 {
    let square = eta * eta + kappa * kappa;
    let twice = 2.0 * eta * c;
    let parallel = (square * c * c - twice + 1.0) / (square * c * c + twice + 1.0);
    let across = (square - twice + c * c) / (square + twice + c * c);
    0.5 * (parallel + across)
}

/// Fresnel's reflectance of a conductor of index η + iκ without approximation, where light arrives at cosine `c`. With s² = 1 − c²,
/// t = η² − κ² − s² and a² + b² = √(t² + 4η²κ²), a² = ½(a² + b² + t):
///
/// ```text
/// r⊥² = (a² + b² + c² − 2ac) / (a² + b² + c² + 2ac)
/// r∥² = r⊥²·(c²(a² + b²) + s⁴ − 2acs²) / (c²(a² + b²) + s⁴ + 2acs²)
/// ```
///
/// For κ = 0 and η ≥ 1 it is [`dielectric`]. `eta` is > 0.
pub(super) fn exact_conductor(eta: f64, kappa: f64, c: f64) -> f64 {
    let c2 = c * c;
    let s2 = (1.0 - c2).max(0.0);
    let t = eta * eta - kappa * kappa - s2;
    let both = t.hypot(2.0 * eta * kappa);
    let a = (0.5 * (both + t)).max(0.0).sqrt();
    let across = reflected(both + c2, 2.0 * a * c);
    let parallel = across * reflected(c2 * both + s2 * s2, 2.0 * a * c * s2);
    0.5 * (across + parallel)
}

/// (sum − part)/(sum + part), 0 where both are 0: η = 1 at the horizon reflects nothing.
fn reflected(sum: f64, part: f64) -> f64 {
    if sum + part > 0.0 {
        (sum - part) / (sum + part)
    } else {
        0.0
    }
}

/// Fresnel's reflectance of a dielectric of relative index `eta` ≥ 1, where light arrives from outside at cosine `c`:
/// F = ½ ((g−c)/(g+c))² (1 + ((c(g+c) − 1)/(c(g−c) + 1))²), g² = η² + c² − 1.
pub(super) fn dielectric(eta: f64, c: f64) -> f64 {
    let g = (eta * eta + c * c - 1.0).max(0.0).sqrt();
    // η = 1 reflects nothing; c = 0 would make 0/0 of it.
    if g <= c {
        return 0.0;
    }
    let first = (g - c) / (g + c);
    let second = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    0.5 * first * first * (1.0 + second * second)
}

/// The reflectance of diffuse light that arrives from outside: ∫ F(c) 2c dc over [0, 1], by midpoints.
pub(super) fn diffuse_dielectric(eta: f64) -> f64 {
    const STEPS: u32 = 2000;
    let mut sum = 0.0;
    for k in 0..STEPS {
        let c = (f64::from(k) + 0.5) / f64::from(STEPS);
        sum += dielectric(eta, c) * 2.0 * c;
    }
    sum / f64::from(STEPS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_incidence_and_grazing_have_their_known_values() {
        // ((η − 1)² + κ²)/((η + 1)² + κ²) of copper at 0.617 + 2.63i, and ((η − 1)/(η + 1))² of glass.
        let copper = (0.383f64.powi(2) + 2.63f64.powi(2)) / (1.617f64.powi(2) + 2.63f64.powi(2));
        assert!((conductor(0.617, 2.63, 1.0) - copper).abs() < 1e-12);
        assert!((conductor(0.617, -2.63, 1.0) - copper).abs() < 1e-12);
        assert!((dielectric(1.5, 1.0) - 0.04).abs() < 1e-12);
        for grazing in [conductor(0.617, 2.63, 0.0), dielectric(1.5, 0.0)] {
            assert!((grazing - 1.0).abs() < 1e-12);
        }
        assert_eq!(dielectric(1.0, 0.0), 0.0);
        assert_eq!(dielectric(1.0, 0.5), 0.0);
    }

    #[test]
    fn the_exact_reflectance_meets_the_others_where_they_hold() {
        for c in [1.0, 0.8, 0.5, 0.2, 0.01] {
            for eta in [1.0, 1.2, 1.5, 3.0] {
                let difference = exact_conductor(eta, 0.0, c) - dielectric(eta, c);
                assert!(difference.abs() < 1e-12, "{eta} {c}: {difference}");
            }
            // Large indices, for which the approximation was made.
            let difference = exact_conductor(20.0, 30.0, c) - conductor(20.0, 30.0, c);
            assert!(difference.abs() < 1e-3, "{c}: {difference}");
        }
        assert!((exact_conductor(0.617, 2.63, 1.0) - conductor(0.617, 2.63, 1.0)).abs() < 1e-12);
        assert!((exact_conductor(0.617, 2.63, 0.0) - 1.0).abs() < 1e-12);
        assert_eq!(exact_conductor(0.5, 0.0, 0.5), 1.0);
        assert_eq!(exact_conductor(1.0, 0.0, 0.0), 0.0);
    }

    #[test]
    fn diffuse_light_is_reflected_as_tables_say() {
        // 9.18 % for η = 1.5 (Egan and Hilgeman 1973).
        assert!((diffuse_dielectric(1.5) - 0.0918).abs() < 1e-4);
    }
}
