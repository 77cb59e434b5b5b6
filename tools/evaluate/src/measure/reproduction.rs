//! How well a `.bsdf` file stands for a material, or a table for a file.

use glam::Vec3;
use rayon::prelude::*;

use super::accuracy::{LIMIT_ANGLES_DEG, weight_spread};
use merlkit::brdf::{Brdf, Importance};
use merlkit::color::Rgb;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::geometry::{Quadrature, cosine_hemisphere, spherical};
use merlkit::material::MerlBrdf;
use merlkit::material::merl::reciprocal_mean;
use merlkit::material::rgl::{BsdfFile, BsdfSize, RglBrdf, tabulate};
use merlkit::points::PointSet;
use merlkit::{Error, Result, color};

/// Pairs of directions that the relative errors are taken over.
const PAIRS: u64 = 100_000;
/// Points a bin of θh for the spread and the albedo: they resolve about 10⁻³ and 10⁻⁴.
const POINTS_PER_BIN: [usize; 2] = [233, 89];

/// The albedo error beyond which a table or file is taken for broken. Files of the RGL database become MERL tables within
/// 15 %, nearly all of which is the reciprocity that a table forces on them; a picture that is off by a quarter shows anybody
/// that something is wrong.
pub const LARGEST_ALBEDO_ERROR: f64 = 0.25;

/// Differences of one BRDF from another.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct ValueErrors {
    /// Median of the relative difference of f_r, over 100,000 pairs of directions that both follow the cosine; pairs where the
    /// expected value is 0 are left out. The difference of a pair is Σ|Δ| over Σ of the channels.
    pub median: f64,
    /// Its 95th percentile.
    pub percentile_95: f64,
    /// Largest relative difference of a directional albedo (mean of the channels), at every degree from 0.5 to 85.5.
    pub albedo: f64,
}

/// Differences of a MERL table from the reflectance it was made of, and where they come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct ResamplingErrors {
    /// Of the table from its source.
    pub whole: ValueErrors,
    /// Of the source's [`reciprocal_mean`], which is all that a table can hold, from the source.
    pub reciprocity: ValueErrors,
    /// Of the table from that mean.
    pub bins: ValueErrors,
}

/// How the weights of draws by a file's own density spread, by quadrature at [`LIMIT_ANGLES_DEG`].
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct DrawQuality {
    /// Standard deviation over mean of the scalar asked for of f_r·cosθ/pdf, f_r the material's and pdf the file's or table's: the least.
    pub least_relstd: f64,
    /// And the largest.
    pub largest_relstd: f64,
    /// Largest probability that a draw is below the horizon.
    pub failed: f64,
}

/// Differences of `found` from `expected`.
pub fn value_errors(found: &dyn Brdf, expected: &dyn Brdf) -> ValueErrors {
    let errors = (0..PAIRS)
        .into_par_iter()
        .filter_map(|i| relative_error(found, expected, i));
    let mut errors: Vec<f64> = errors.collect();
    errors.sort_by(f64::total_cmp);
    let quantile = |q: f64| {
        errors
            .get((q * errors.len() as f64) as usize)
            .copied()
            .unwrap_or_default()
    };
    let degrees = (0..86u32).into_par_iter().map(|k| 0.5 + f64::from(k));
    let albedo: Vec<f64> = degrees
        .map(|deg| albedo_error(found, expected, deg))
        .collect();
    ValueErrors {
        median: quantile(0.5),
        percentile_95: quantile(0.95),
        albedo: albedo.into_iter().fold(0.0, f64::max),
    }
}

/// Differences of a table from the reflectance that [`merlkit::material::merl::tabulate_brdf`] made it of.
pub fn resampling_errors(table: &MerlBrdf, source: &dyn Brdf) -> ResamplingErrors {
    let reciprocal = ReciprocalMean(source);
    ResamplingErrors {
        whole: value_errors(table, source),
        reciprocity: value_errors(&reciprocal, source),
        bins: value_errors(table, &reciprocal),
    }
}

/// The [`reciprocal_mean`] of a reflectance.
struct ReciprocalMean<'a>(&'a dyn Brdf);

impl Brdf for ReciprocalMean<'_> {
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        reciprocal_mean(self.0, wo, wi)
    }

    fn is_isotropic(&self) -> bool {
        self.0.is_isotropic()
    }
}

/// How well a file's own density, or a table's, draws from the material it was made from, by the scalar that its density
/// follows: the luminance of a `.bsdf` file, the mean of RGB of a table unless it was built on another.
pub fn draw_quality(
    sampler: &dyn DirectionSampler,
    brdf: &dyn Brdf,
    importance: Importance,
) -> DrawQuality {
    let spread = |degrees: f64| {
        weight_spread(
            sampler,
            brdf,
            &quadrature(degrees, POINTS_PER_BIN[0]),
            importance,
        )
    };
    let spreads: Vec<_> = LIMIT_ANGLES_DEG.into_par_iter().map(spread).collect();
    let relstd = spreads.iter().map(|s| s.relstd);
    DrawQuality {
        least_relstd: relstd.clone().fold(f64::INFINITY, f64::min),
        largest_relstd: relstd.fold(0.0, f64::max),
        failed: spreads
            .iter()
            .map(|s| 1.0 - s.pdf_integral)
            .fold(0.0, f64::max),
    }
}

/// The smallest preset whose file has a median error within `limit`, a share above 0, and that file, not described yet.
///
/// # Errors
/// [`Error::Argument`] if none has.
pub fn size_within(brdf: &dyn Brdf, limit: f64) -> Result<(BsdfSize, BsdfFile)> {
    let mut least = f64::INFINITY;
    for size in BsdfSize::ALL {
        let file = tabulate(|wo, wi| brdf.eval(wo, wi), size, String::new());
        let error = value_errors(&RglBrdf::new(file.clone()), brdf).median;
        if error <= limit {
            return Ok((size, file));
        }
        least = least.min(error);
    }
    let reached = format!(
        "no size has a median error within {:.3} %: the least is {:.3} %",
        100.0 * limit,
        100.0 * least
    );
    Err(Error::argument(
        reached,
        "allow more, or export with --lookup linear, which a file reproduces best",
    ))
}

/// Largest difference of a colour in `found` from that in `expected`, over the largest channel there, for files of the same
/// shape.
pub fn colour_error(found: &BsdfFile, expected: &BsdfFile) -> f64 {
    let (found, expected) = (found.colour.to_rgb(), expected.colour.to_rgb());
    let square: usize = expected.shape[3..].iter().product();
    let slices = found
        .values
        .chunks(3 * square)
        .zip(expected.values.chunks(3 * square));
    let mut largest = 0.0f32;
    for (found, expected) in slices {
        for k in 0..square.min(found.len() / 3).min(expected.len() / 3) {
            let channels = [k, k + square, k + 2 * square];
            let scale = channels
                .map(|c| expected[c])
                .into_iter()
                .fold(0.0, f32::max);
            if scale > 0.0 {
                let differences = channels.map(|c| (found[c] - expected[c]).abs() / scale);
                largest = differences.into_iter().fold(largest, f32::max);
            }
        }
    }
    f64::from(largest)
}

/// Of pair `i`; `None` where nothing is expected.
fn relative_error(found: &dyn Brdf, expected: &dyn Brdf, i: u64) -> Option<f64> {
    let direction = |set| cosine_hemisphere(PointSet::Random.point(0, i, set).as_dvec2()).as_vec3();
    let (wo, wi) = (direction(0), direction(1));
    let expected = expected.eval(wo, wi);
    let sum = f64::from(expected.element_sum());
    (sum > 0.0).then(|| f64::from((found.eval(wo, wi) - expected).abs().element_sum()) / sum)
}

fn albedo_error(found: &dyn Brdf, expected: &dyn Brdf, degrees: f64) -> f64 {
    let quadrature = quadrature(degrees, POINTS_PER_BIN[1]);
    let albedo = |brdf: &dyn Brdf| {
        quadrature.integrate(|wi: Vec3| f64::from(color::mean(brdf.eval_cos(quadrature.wo(), wi))))
    };
    let (found, expected) = (albedo(found), albedo(expected));
    if expected > 0.0 {
        (found / expected - 1.0).abs()
    } else {
        0.0
    }
}

fn quadrature(degrees: f64, points_per_bin: usize) -> Quadrature {
    Quadrature::new(
        spherical(degrees.to_radians(), 0.0).as_vec3(),
        points_per_bin,
    )
}
