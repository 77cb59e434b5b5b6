//! How well a `.bsdf` file stands for the material it was made from.

use glam::{DVec2, Vec3};
use rayon::prelude::*;

use super::accuracy::{LIMIT_ANGLES_DEG, weight_spread};
use crate::brdf::{Brdf, Importance};
use crate::bsdf::Rgl;
use crate::color;
use crate::geom::{Quadrature, cosine_hemisphere, spherical};
use crate::points::PointSet;

/// Pairs of directions that the relative errors are taken over.
const PAIRS: u64 = 100_000;
/// Points a bin of θh for the albedo and the spread: they resolve about 10⁻³.
const POINTS_PER_BIN: usize = 233;

/// Errors of a file's values against a material, and the spread of its draws.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Reproduction {
    /// Median of the relative error of f_r, over pairs of directions that both follow the cosine; pairs where the material is
    /// black are left out. The error of a pair is Σ|Δ| over Σ of the channels.
    pub median: f64,
    /// Its 95th percentile.
    pub percentile_95: f64,
    /// Largest difference of a directional albedo (mean of the channels), as a share of it, at [`LIMIT_ANGLES_DEG`].
    pub albedo: f64,
    /// Standard deviation over mean of f_r·cosθ/pdf, f_r the material's and pdf the file's: least and largest at
    /// [`LIMIT_ANGLES_DEG`].
    pub relstd: [f64; 2],
    /// Largest probability that a draw is below the horizon, at these angles.
    pub failed: f64,
}

/// Compares a file with the material it was made from.
pub fn reproduction(file: &Rgl, brdf: &dyn Brdf) -> Reproduction {
    let mut errors: Vec<f64> =
        (0..PAIRS).into_par_iter().filter_map(|i| relative_error(file, brdf, i)).collect();
    errors.sort_by(f64::total_cmp);
    let quantile = |q: f64| errors.get((q * errors.len() as f64) as usize).copied().unwrap_or_default();
    let at_angles: Vec<[f64; 3]> =
        LIMIT_ANGLES_DEG.into_par_iter().map(|deg| at_angle(file, brdf, deg)).collect();
    let largest = |k: usize| at_angles.iter().map(|a| a[k]).fold(0.0, f64::max);
    let least = at_angles.iter().map(|a| a[1]).fold(f64::INFINITY, f64::min);
    Reproduction {
        median: quantile(0.5),
        percentile_95: quantile(0.95),
        albedo: largest(0),
        relstd: [least, largest(1)],
        failed: largest(2),
    }
}

/// Of pair `i`; `None` where the material is black.
fn relative_error(file: &Rgl, brdf: &dyn Brdf, i: u64) -> Option<f64> {
    let direction = |set| {
        let u = PointSet::Random.point(0, i, set).as_dvec2();
        cosine_hemisphere(DVec2::new(u.x, u.y)).as_vec3()
    };
    let (wo, wi) = (direction(0), direction(1));
    let expected = brdf.eval(wo, wi);
    let sum = f64::from(expected.element_sum());
    (sum > 0.0).then(|| f64::from((file.eval(wo, wi) - expected).abs().element_sum()) / sum)
}

/// Relative difference of the albedo, spread of weights and probability of a failed draw.
fn at_angle(file: &Rgl, brdf: &dyn Brdf, degrees: f64) -> [f64; 3] {
    let wo = spherical(degrees.to_radians(), 0.0).as_vec3();
    let quadrature = Quadrature::new(wo, POINTS_PER_BIN);
    let spread = weight_spread(file, brdf, &quadrature, Importance::Luminance);
    let albedo =
        |brdf: &dyn Brdf| quadrature.integrate(|wi: Vec3| f64::from(color::mean(brdf.eval_cos(wo, wi))));
    let (file, material) = (albedo(file), albedo(brdf));
    let difference = if material > 0.0 { (file / material - 1.0).abs() } else { 0.0 };
    [difference, spread.relstd, 1.0 - spread.pdf_integral]
}
