//! Directional albedo by quadrature over the half vector.
//!
//! Measured BRDFs peak at θh = 0 up to 3·10⁴ times above their mean, where quadrature or random numbers over `wi` see
//! nothing. Here h is integrated over, in the variable t = √(θh / (π/2)) in which MERL's θh bins are evenly spaced: Gauss
//! points inside each of the 90 bins, evenly spaced azimuths, and dω(wi) = 4 (wo·h) dω(h).
//!
//! Convergence: halving both numbers of points moves the albedo of the 100 embedded materials at 0, 30, 60 and 80° by at most
//! 2·10⁻⁴ with the floor rule, whose steps in θd and φd the points don't follow.

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::brdf::Brdf;
use crate::color::Rgb;
use crate::geom::{reflect_about, spherical};
use crate::merl::THETA_H_BINS;

/// Points of the quadrature: Gauss–Legendre positions and weights on [0, 1] for each θh bin, and azimuths of h.
struct Grid {
    gauss: &'static [(f64, f64)],
    azimuths: usize,
}

const FINE: Grid = Grid {
    gauss: &[
        (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
        (0.330_009_478_207_571_9, 0.326_072_577_431_273_07),
        (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
        (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
    ],
    azimuths: 512,
};

const COARSE: Grid =
    Grid { gauss: &[(0.211_324_865_405_187_1, 0.5), (0.788_675_134_594_812_9, 0.5)], azimuths: 256 };

/// A directional albedo and how far it can be trusted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlbedoEstimate {
    /// The albedo, a fraction per channel.
    pub value: Rgb,
    /// Largest difference of a channel from the same quadrature with half the points in both directions.
    pub error: f32,
}

/// Directional albedo ∫ f_r(wo, wi) cosθᵢ dωᵢ, a fraction per channel, for `wo` at polar angle `theta_o` (radians) in the
/// x–z plane. 0 for a `theta_o` that is NaN or not above the horizon.
pub fn directional_albedo(brdf: &dyn Brdf, theta_o: f64) -> Rgb {
    integrate(brdf, theta_o, &FINE).as_vec3()
}

/// [`directional_albedo`] and an estimate of its error.
pub fn directional_albedo_with_error(brdf: &dyn Brdf, theta_o: f64) -> AlbedoEstimate {
    let fine = integrate(brdf, theta_o, &FINE);
    let coarse = integrate(brdf, theta_o, &COARSE);
    AlbedoEstimate { value: fine.as_vec3(), error: (fine - coarse).abs().max_element() as f32 }
}

/// Directional albedo at 0°, 1° … 89°, with a quarter of the points of [`directional_albedo`], in parallel.
pub fn albedo_by_degree(brdf: &dyn Brdf) -> Vec<Rgb> {
    (0..90u32)
        .into_par_iter()
        .map(|degree| integrate(brdf, f64::from(degree).to_radians(), &COARSE).as_vec3())
        .collect()
}

fn integrate(brdf: &dyn Brdf, theta_o: f64, grid: &Grid) -> DVec3 {
    let wo = spherical(theta_o, 0.0);
    let mut sum = DVec3::ZERO;
    for bin in 0..THETA_H_BINS {
        for &(position, weight) in grid.gauss {
            let t = (bin as f64 + position) / THETA_H_BINS as f64;
            let theta_h = t * t * FRAC_PI_2;
            // dθh = π t dt
            let measure = weight / THETA_H_BINS as f64 * PI * t * theta_h.sin();
            sum += measure * ring(brdf, wo, theta_h, grid.azimuths);
        }
    }
    sum
}

/// Integral over the azimuth of h of f_r cosθᵢ · 4 (wo·h).
fn ring(brdf: &dyn Brdf, wo: DVec3, theta_h: f64, azimuths: usize) -> DVec3 {
    let step = TAU / azimuths as f64;
    let given = wo.as_vec3();
    let mut sum = DVec3::ZERO;
    for k in 0..azimuths {
        let h = spherical(theta_h, (k as f64 + 0.5) * step);
        let wi = reflect_about(wo, h);
        let cos_d = wo.dot(h);
        if cos_d > 0.0 && wi.z > 0.0 {
            let f: Vec3 = brdf.eval(given, wi.as_vec3());
            sum += f.as_dvec3() * (wi.z * 4.0 * cos_d);
        }
    }
    sum * step
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brdf::{LookupRule, Measured};
    use crate::geom::cosine_hemisphere;
    use crate::points::PointSet;

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
            assert!(a.value.abs_diff_eq(Rgb::new(0.2, 0.5, 1.0), 1e-4), "{degrees}: {a:?}");
            assert!(a.error < 1e-3, "{degrees}: {a:?}");
        }
    }

    #[test]
    fn agrees_with_cosine_sampling_where_that_converges() {
        let table = std::sync::Arc::new(crate::merl::decode_embedded("teflon").unwrap());
        let brdf = Measured::new(table, LookupRule::Floor);
        for degrees in [10.0f64, 50.0] {
            let wo = spherical(degrees.to_radians(), 0.0).as_vec3();
            let count = 200_000u64;
            let (mut sum, mut squares) = (0.0, 0.0);
            for i in 0..count {
                let wi = cosine_hemisphere(PointSet::Random.point(1, i, 0)).as_vec3();
                let weight = f64::from(brdf.eval(wo, wi).x) * PI;
                sum += weight;
                squares += weight * weight;
            }
            let mean = sum / count as f64;
            let error = ((squares / count as f64 - mean * mean) / count as f64).sqrt();
            assert!(error < 0.01 * mean, "{degrees}: {error} of {mean}");
            let albedo = f64::from(directional_albedo(&brdf, degrees.to_radians()).x);
            assert!((albedo - mean).abs() < 4.0 * error, "{degrees}: {albedo}, {mean} ± {error}");
        }
    }

    #[test]
    fn no_albedo_outside_the_domain() {
        struct Upper;
        impl Brdf for Upper {
            fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
                if crate::geom::is_upper(wo) && crate::geom::is_upper(wi) { Rgb::ONE } else { Rgb::ZERO }
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
