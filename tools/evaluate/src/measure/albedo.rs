//! Directional albedo by quadrature over the half vector ([`Quadrature`]).

use glam::DVec3;
use rayon::prelude::*;

use merlkit::brdf::Brdf;
use merlkit::color::Rgb;
use merlkit::geometry::{POINTS_PER_BIN, Quadrature, spherical};

/// A directional albedo and how far it can be trusted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlbedoEstimate {
    /// The albedo, a fraction per channel.
    pub value: Rgb,
    /// Twice the largest difference of a channel from quadratures with fewer points. One such difference may be small by
    /// chance where a narrow peak lies between the points.
    pub error: f32,
}

/// Quadratures with fewer points, to tell the error of the fine one: no two place their points alike.
const COARSER: [usize; 2] = [POINTS_PER_BIN / 4, POINTS_PER_BIN * 5 / 8];

/// Directional albedo ∫ f_r(wo, wi) cosθᵢ dσ(wi), a fraction per channel, for `wo` at polar angle `theta_o` (radians) in the
/// x–z plane. 0 for a `theta_o` that is not finite or not above the horizon.
pub fn directional_albedo(brdf: &dyn Brdf, theta_o: f64) -> Rgb {
    integrate(brdf, theta_o, POINTS_PER_BIN).as_vec3()
}

/// [`directional_albedo`] and an estimate of its error.
pub fn directional_albedo_with_error(brdf: &dyn Brdf, theta_o: f64) -> AlbedoEstimate {
    estimate(brdf, theta_o, POINTS_PER_BIN, &COARSER)
}

/// Directional albedo at 0°, 1° … 89°, with a quarter of the points of [`directional_albedo`], in parallel.
pub fn albedo_by_degree(brdf: &dyn Brdf) -> Vec<AlbedoEstimate> {
    let [coarse, _] = COARSER;
    (0..90u32)
        .into_par_iter()
        .map(|degree| {
            let theta_o = f64::from(degree).to_radians();
            estimate(brdf, theta_o, coarse, &[coarse * 5 / 8])
        })
        .collect()
}

/// The albedo with `points` a bin, and its error by quadratures of `coarser` points.
fn estimate(brdf: &dyn Brdf, theta_o: f64, points: usize, coarser: &[usize]) -> AlbedoEstimate {
    let fine = integrate(brdf, theta_o, points);
    let mut largest = 0.0f64;
    for &points in coarser {
        let difference = fine - integrate(brdf, theta_o, points);
        largest = largest.max(difference.abs().max_element());
    }
    AlbedoEstimate {
        value: fine.as_vec3(),
        error: 2.0 * largest as f32,
    }
}

fn integrate(brdf: &dyn Brdf, theta_o: f64, points: usize) -> DVec3 {
    let quadrature = Quadrature::new(spherical(theta_o, 0.0).as_vec3(), points);
    let mut sum = DVec3::ZERO;
    quadrature
        .for_each(|wi, d_sigma| sum += brdf.eval_cos(quadrature.wo(), wi).as_dvec3() * d_sigma);
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use merlkit::geometry::cosine_hemisphere;
    use merlkit::material::merl::{LookupRule, MerlBrdf};
    use merlkit::points::PointSet;
    use std::f64::consts::PI;

    struct Lambert;

    impl Brdf for Lambert {
        fn eval(&self, _: Vec3, _: Vec3) -> Rgb {
            Rgb::new(0.2, 0.5, 1.0) * std::f32::consts::FRAC_1_PI
        }

        fn is_isotropic(&self) -> bool {
            true
        }
    }

    #[test]
    fn a_lambertian_has_its_albedo_at_every_angle() {
        for degrees in [0.0f64, 17.0, 45.0, 75.0, 88.0] {
            let a = directional_albedo_with_error(&Lambert, degrees.to_radians());
            assert!(
                a.value.abs_diff_eq(Rgb::new(0.2, 0.5, 1.0), 1e-4),
                "{degrees}: {a:?}"
            );
            assert!(a.error < 1e-3, "{degrees}: {a:?}");
        }
    }

    #[test]
    fn agrees_with_cosine_sampling_where_that_converges() {
        let table =
            std::sync::Arc::new(merlkit::material::merl::decode_embedded("teflon").unwrap());
        let brdf = MerlBrdf::new(table, LookupRule::Floor);
        for degrees in [10.0f64, 50.0] {
            let wo = spherical(degrees.to_radians(), 0.0).as_vec3();
            let count = 200_000u64;
            let (mut sum, mut squares) = (0.0, 0.0);
            for i in 0..count {
                let wi = cosine_hemisphere(PointSet::Random.point(1, i, 0).as_dvec2()).as_vec3();
                let weight = f64::from(brdf.eval(wo, wi).x) * PI;
                sum += weight;
                squares += weight * weight;
            }
            let mean = sum / count as f64;
            let error = ((squares / count as f64 - mean * mean) / count as f64).sqrt();
            assert!(error < 0.01 * mean, "{degrees}: {error} of {mean}");
            let albedo = f64::from(directional_albedo(&brdf, degrees.to_radians()).x);
            assert!(
                (albedo - mean).abs() < 4.0 * error,
                "{degrees}: {albedo}, {mean} ± {error}"
            );
        }
    }

    #[test]
    fn no_albedo_outside_the_domain() {
        struct Upper;
        impl Brdf for Upper {
            fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
                if merlkit::geometry::is_upper(wo) && merlkit::geometry::is_upper(wi) {
                    Rgb::ONE
                } else {
                    Rgb::ZERO
                }
            }

            fn is_isotropic(&self) -> bool {
                true
            }
        }
        for theta in [f64::NAN, f64::INFINITY, 2.0] {
            assert_eq!(directional_albedo(&Upper, theta), Rgb::ZERO);
        }
    }
}
