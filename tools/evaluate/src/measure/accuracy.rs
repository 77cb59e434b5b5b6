//! Spread and bias of a sampler's weights w = f_r·cosθ/pdf.
//!
//! The spread comes from quadrature: on materials whose peak is 10⁴ times the mean, 10⁵ draws do not see it. The bias
//! compares seeded draws with quadrature, and takes its standard error from the spread by quadrature too.

use glam::{DVec4, Vec3};

use super::probe::Violations;
use merlkit::Wo;
use merlkit::brdf::{Brdf, Importance};
use merlkit::color::Rgb;
use merlkit::direction_sampler::{DirectionSample, DirectionSampler};
use merlkit::geometry::{Quadrature, Symmetry};
use merlkit::points::PointSet;

/// Polar angles of `wo`, degrees, at which spread and bias are reported; none is a knot of a table of one and a half
/// degrees' step.
pub const LIMIT_ANGLES_DEG: [f64; 7] = [0.76, 14.5, 29.75, 45.0, 60.25, 75.5, 84.7];

/// Azimuths of `wo`, degrees, at which spread and bias are reported; those of isotropic materials at the first alone, 0.4
/// radians. Each is in another quarter turn.
const LIMIT_AZIMUTHS_DEG: [f64; 4] = [22.918311805232932, 111.7, -126.1, -48.7];

/// Polar angle and azimuth of the `wo` at which spread and bias are reported, degrees: [`LIMIT_ANGLES_DEG`], each at four
/// azimuths unless the material is isotropic.
pub fn limit_directions(symmetry: Symmetry) -> Vec<[f64; 2]> {
    let azimuths = if symmetry == Symmetry::Isotropic {
        1
    } else {
        LIMIT_AZIMUTHS_DEG.len()
    };
    let at = |theta: f64| {
        LIMIT_AZIMUTHS_DEG[..azimuths]
            .iter()
            .map(move |&phi| [theta, phi])
    };
    LIMIT_ANGLES_DEG.into_iter().flat_map(at).collect()
}

/// How the weight of one draw spreads, by quadrature. A failed draw is a weight of 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct WeightSpread {
    /// Standard deviation over mean, the variance being `∫ (w − E[w])² pdf + lost·E[w]²`, with `E[w]` = ∫ f cosθ where pdf > 0
    /// and lost the probability of a failed draw, 1 − ∫ pdf if that is above 0. 0 for a black material. The quadrature resolves about 2·10⁻³.
    pub relstd: f64,
    /// `E[w]`: the directional albedo as far as the sampler reaches it.
    pub mean: f64,
    /// Largest weight at a node, over the mean: what one draw can add. 0 for a black material.
    pub peak: f64,
    /// Share of ∫ f cosθ where pdf = 0, in [0, 1]: what the sampler can never see.
    pub holes: f64,
    /// ∫ pdf over the directions above the horizon: one minus the probability of a failed draw.
    pub pdf_integral: f64,
}

/// Spread of the weight whose value is `importance` of RGB, at the nodes of `quadrature`.
///
/// A pdf that is NaN, negative or infinite counts as 0. For an invalid `wo` everything is 0.
pub fn weight_spread(
    sampler: &dyn DirectionSampler,
    brdf: &dyn Brdf,
    quadrature: &Quadrature,
    importance: Importance,
) -> WeightSpread {
    Moments::integrate(sampler, brdf, quadrature, importance).spread(SCALAR)
}

/// Seeded independent draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Draws {
    /// How many.
    pub count: usize,
    /// Which.
    pub seed: u64,
}

/// Deviation of the albedo estimated by draws from the albedo by quadrature.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Bias {
    /// Estimate over albedo, minus 1; 0 where the albedo is 0.
    pub relative: f64,
    /// Standard error of `relative`, from the spread by quadrature: √(Var w / count) over the albedo.
    pub standard_error: f64,
}

/// A bias below this is rounding of f32, whatever its standard error is.
const ROUNDING: f64 = 1e-6;

impl Bias {
    /// How many standard errors it is from 0; 0 for what f32's rounding explains, as of a constant weight, whose standard
    /// error is 0.
    pub fn in_standard_errors(&self) -> f64 {
        if self.relative.abs() <= ROUNDING {
            return 0.0;
        }
        self.relative.abs() / self.standard_error
    }
}

/// Bias of the mean weight of `draws`, each with the pdf that the sampler returned.
pub fn bias(
    sampler: &dyn DirectionSampler,
    brdf: &dyn Brdf,
    quadrature: &Quadrature,
    importance: Importance,
    draws: Draws,
) -> Bias {
    let moments = Moments::integrate(sampler, brdf, quadrature, importance);
    let wo = quadrature.wo();
    let points = (0..draws.count as u64).map(|i| PointSet::Random.point(draws.seed, i, 0));
    let samples = points.map(|u| sampler.sample(wo, u));
    let estimate = mean_weight(brdf, wo, importance, samples)[SCALAR];
    moments.bias(SCALAR, estimate, draws.count)
}

/// Lane of [`DVec4`] that holds the importance; the other three hold RGB.
pub(super) const SCALAR: usize = 3;

/// Integrals of the weight, for red, green, blue and their importance.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moments {
    /// ∫ f cosθ.
    pub albedo: DVec4,
    /// ∫ f cosθ where pdf > 0.
    first: DVec4,
    /// ∫ (f cosθ)²/pdf where pdf > 0.
    second: DVec4,
    /// Largest f cosθ/pdf at a node.
    largest: DVec4,
    pdf: f64,
    /// Nodes with f cosθ > 0 where pdf is not positive and finite.
    pub holes: Violations,
}

impl Moments {
    pub fn integrate(
        sampler: &dyn DirectionSampler,
        brdf: &dyn Brdf,
        quadrature: &Quadrature,
        importance: Importance,
    ) -> Self {
        let mut batch = DirectionQueue::new(brdf, quadrature.wo(), importance);
        let mut sums = Self::default();
        let mut solid_angles = Vec::with_capacity(BATCH);
        quadrature.for_each(|wi, d_sigma| {
            solid_angles.push(d_sigma);
            if batch.push(wi) {
                sums.add_batch(sampler, &mut batch, &mut solid_angles);
            }
        });
        sums.add_batch(sampler, &mut batch, &mut solid_angles);
        sums
    }

    /// Adds the nodes of a batch, one after another.
    fn add_batch(
        &mut self,
        sampler: &dyn DirectionSampler,
        batch: &mut DirectionQueue<'_>,
        solid_angles: &mut Vec<f64>,
    ) {
        let wo = batch.wo;
        let solid_angles = solid_angles.drain(..);
        for ((wi, f_cos), d_sigma) in batch.drain().zip(solid_angles) {
            let pdf = sampler.pdf(wo, wi);
            if pdf > 0.0 && pdf.is_finite() {
                self.add(f_cos, f64::from(pdf), d_sigma);
            } else if f_cos.max_element() > 0.0 {
                self.holes.add(wi, pdf);
            }
            self.albedo += f_cos * d_sigma;
        }
    }

    fn add(&mut self, f_cos: DVec4, pdf: f64, d_sigma: f64) {
        let weight = f_cos / pdf;
        self.first += f_cos * d_sigma;
        self.second += f_cos * weight * d_sigma;
        self.largest = self.largest.max(weight);
        self.pdf += pdf * d_sigma;
    }

    pub fn spread(&self, lane: usize) -> WeightSpread {
        let mean = self.first[lane];
        let albedo = self.albedo[lane];
        let holes = if albedo > 0.0 {
            (1.0 - mean / albedo).max(0.0)
        } else {
            0.0
        };
        let (relstd, peak) = if mean > 0.0 {
            (self.variance(lane).sqrt() / mean, self.largest[lane] / mean)
        } else {
            (0.0, 0.0)
        };
        WeightSpread {
            relstd,
            mean,
            peak,
            holes,
            pdf_integral: self.pdf,
        }
    }

    /// Variance of one weight: ∫ (w − E)² pdf + lost·E² with E = ∫ w pdf and lost = max(1 − ∫ pdf, 0).
    ///
    /// The first term is ∫ w² pdf − 2 E² + E² ∫ pdf, so the sum is ∫ w² pdf − E² + E²·max(∫ pdf − 1, 0). It is never negative,
    /// also where a density integrates to more than 1: Cauchy and Schwarz give ∫ w² pdf ≥ E²/∫ pdf ≥ E² (2 − ∫ pdf). What
    /// rounding leaves of a constant weight below 0 is 0.
    pub fn variance(&self, lane: usize) -> f64 {
        let square = self.first[lane] * self.first[lane];
        let beyond_one = (self.pdf - 1.0).max(0.0);
        (self.second[lane] - square + square * beyond_one).max(0.0)
    }

    /// The farthest that one weight can be from the mean, by the nodes.
    pub fn reach(&self, lane: usize) -> f64 {
        (self.largest[lane] - self.first[lane]).max(self.first[lane])
    }

    fn bias(&self, lane: usize, estimate: f64, count: usize) -> Bias {
        let albedo = self.albedo[lane];
        if albedo <= 0.0 || count == 0 {
            return Bias::default();
        }
        let standard_error = (self.variance(lane) / count as f64).sqrt() / albedo;
        Bias {
            relative: estimate / albedo - 1.0,
            standard_error,
        }
    }
}

/// Mean weight of a run of draws: red, green, blue and their importance. Failed draws count as 0, and so do
/// those with a pdf that is not positive and finite; no draws give 0.
pub(super) fn mean_weight(
    brdf: &dyn Brdf,
    wo: Vec3,
    importance: Importance,
    draws: impl Iterator<Item = Option<DirectionSample>>,
) -> DVec4 {
    let mut batch = DirectionQueue::new(brdf, wo, importance);
    let mut densities = Vec::with_capacity(BATCH);
    let (mut sum, mut count) = (DVec4::ZERO, 0usize);
    for draw in draws {
        if let Some(sample) = draw.filter(|d| d.pdf > 0.0 && d.pdf.is_finite()) {
            densities.push(sample.pdf);
            if batch.push(sample.wi) {
                sum = add_weights(sum, &mut batch, &mut densities);
            }
        }
        count += 1;
    }
    add_weights(sum, &mut batch, &mut densities) / count.max(1) as f64
}

/// `sum` and the weights of a batch of draws, one after another.
fn add_weights(mut sum: DVec4, batch: &mut DirectionQueue<'_>, densities: &mut Vec<f32>) -> DVec4 {
    for ((_, f_cos), pdf) in batch.drain().zip(densities.drain(..)) {
        sum += f_cos / f64::from(pdf);
    }
    sum
}

/// Directions that are evaluated together.
const BATCH: usize = 256;

/// Directions that wait to be evaluated, for one `wo`.
struct DirectionQueue<'a> {
    brdf: &'a dyn Brdf,
    wo: Vec3,
    importance: Importance,
    wi: Vec<Vec3>,
    values: Vec<Rgb>,
}

impl<'a> DirectionQueue<'a> {
    fn new(brdf: &'a dyn Brdf, wo: Vec3, importance: Importance) -> Self {
        Self {
            brdf,
            wo,
            importance,
            wi: Vec::with_capacity(BATCH),
            values: vec![Rgb::ZERO; BATCH],
        }
    }

    /// Adds a direction; whether the batch is full then.
    fn push(&mut self, wi: Vec3) -> bool {
        self.wi.push(wi);
        self.wi.len() == BATCH
    }

    /// Takes the directions out, each with f cosθ of red, green, blue and their importance.
    fn drain(&mut self) -> impl Iterator<Item = (Vec3, DVec4)> {
        let values = &mut self.values[..self.wi.len()];
        self.brdf.eval_cos_batch(Wo::One(self.wo), &self.wi, values);
        let importance = self.importance;
        let directions = self.wi.drain(..);
        directions.zip(values).map(move |(wi, f_cos)| {
            let scalar = importance.reduce(*f_cos);
            (wi, f_cos.extend(scalar).as_dvec4())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use merlkit::color::Rgb;
    use merlkit::geometry::POINTS_PER_BIN;
    use merlkit::geometry::spherical;
    use merlkit::sampler::Cosine;
    use std::f32::consts::FRAC_1_PI;

    /// Albedo times cosⁿθ of `wi`, scaled to that albedo: with cosine sampling E[w²]/E[w]² = (n+2)²/(4(n+1)).
    struct Power {
        albedo: Rgb,
        n: i32,
    }

    impl Brdf for Power {
        fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
            let upper = wo.z > 0.0 && wi.z > 0.0;
            let scale = (self.n + 2) as f32 * 0.5 * FRAC_1_PI;
            if upper {
                self.albedo * scale * wi.z.powi(self.n)
            } else {
                Rgb::ZERO
            }
        }

        fn is_isotropic(&self) -> bool {
            true
        }
    }

    fn quadrature(theta: f64) -> Quadrature {
        Quadrature::new(spherical(theta.to_radians(), 1.0).as_vec3(), POINTS_PER_BIN)
    }

    #[test]
    fn spread_of_a_power_of_the_cosine_has_its_closed_form() {
        let brdf = Power {
            albedo: Rgb::new(0.2, 0.5, 0.8),
            n: 6,
        };
        for theta in LIMIT_ANGLES_DEG {
            let spread = weight_spread(&Cosine, &brdf, &quadrature(theta), Importance::Mean);
            let expected = (64.0 / 28.0 - 1.0_f64).sqrt();
            assert!(
                (spread.relstd - expected).abs() < 1e-4,
                "{theta}°: {spread:?}"
            );
            assert!((spread.mean - 0.5).abs() < 1e-5, "{theta}°: {spread:?}");
            assert!((spread.peak - 4.0).abs() < 1e-2, "{theta}°: {spread:?}");
            assert!(
                (spread.pdf_integral - 1.0).abs() < 1e-5 && spread.holes == 0.0,
                "{theta}°: {spread:?}"
            );
        }
    }

    #[test]
    fn a_constant_weight_does_not_spread() {
        let brdf = Power {
            albedo: Rgb::splat(1.0),
            n: 0,
        };
        let spread = weight_spread(&Cosine, &brdf, &quadrature(30.0), Importance::Mean);
        assert!(spread.relstd < 2e-3, "{spread:?}");
        let bias = bias(
            &Cosine,
            &brdf,
            &quadrature(30.0),
            Importance::Mean,
            Draws {
                count: 1000,
                seed: 1,
            },
        );
        assert!(bias.relative.abs() < 1e-5, "{bias:?}");
    }

    /// Density c·cosθ/π, which integrates to c, while directions follow the cosine.
    struct Scaled(f32);

    impl DirectionSampler for Scaled {
        fn sample(&self, wo: Vec3, u: glam::Vec2) -> Option<DirectionSample> {
            let drawn = Cosine.sample(wo, u)?;
            Some(DirectionSample {
                pdf: self.0 * drawn.pdf,
                ..drawn
            })
        }

        fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
            self.0 * Cosine.pdf(wo, wi)
        }

        fn bytes(&self) -> usize {
            0
        }
    }

    /// With density c·cosθ/π the weight of a power of the cosine is v/c, where v has mean E and second moment S under the
    /// cosine. So for c ≥ 1 the variance is ∫ (v/c − E)² c cosθ/π = S/c − 2E² + cE², whose relative square is
    /// (S/E²)/c − 2 + c; E² (S/E²/c − 1) as was printed is less, and below 0 for a nearly constant weight.
    #[test]
    fn a_density_beyond_one_hides_no_spread() {
        for (n, c) in [(6, 1.25_f32), (1, 1.2), (0, 1.01)] {
            let brdf = Power {
                albedo: Rgb::splat(0.5),
                n,
            };
            let spread = weight_spread(&Scaled(c), &brdf, &quadrature(30.0), Importance::Mean);
            let (n, c) = (f64::from(n), f64::from(c));
            let moment = (n + 2.0).powi(2) / (4.0 * (n + 1.0));
            let expected = (moment / c - 2.0 + c).sqrt();
            assert!(
                (spread.relstd - expected).abs() < 1e-3,
                "{n} {c}: {spread:?} {expected}"
            );
        }
    }

    #[test]
    fn a_bias_that_is_rounding_is_no_standard_error() {
        let bias = |relative, standard_error| Bias {
            relative,
            standard_error,
        };
        assert_eq!(bias(3e-7, 0.0).in_standard_errors(), 0.0);
        assert_eq!(bias(-4e-4, 1e-4).in_standard_errors(), 4.0);
    }

    #[test]
    fn black_has_no_spread_and_no_bias() {
        let brdf = Power {
            albedo: Rgb::ZERO,
            n: 1,
        };
        let spread = weight_spread(&Cosine, &brdf, &quadrature(60.25), Importance::Mean);
        assert_eq!(
            (spread.relstd, spread.mean, spread.peak, spread.holes),
            (0.0, 0.0, 0.0, 0.0)
        );
        let draws = Draws {
            count: 100,
            seed: 3,
        };
        assert_eq!(
            bias(&Cosine, &brdf, &quadrature(60.25), Importance::Mean, draws),
            Bias::default()
        );
    }

    #[test]
    fn bias_is_within_its_standard_error() {
        let brdf = Power {
            albedo: Rgb::new(0.2, 0.5, 0.8),
            n: 20,
        };
        for (seed, theta) in LIMIT_ANGLES_DEG.into_iter().enumerate() {
            let draws = Draws {
                count: 100_000,
                seed: seed as u64,
            };
            let bias = bias(
                &Cosine,
                &brdf,
                &quadrature(theta),
                Importance::Luminance,
                draws,
            );
            assert!(
                bias.standard_error > 1e-3 && bias.standard_error < 1e-2,
                "{bias:?}"
            );
            assert!(
                bias.relative.abs() < 4.0 * bias.standard_error,
                "{theta}°: {bias:?}"
            );
        }
    }
}
