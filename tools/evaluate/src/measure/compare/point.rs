//! The point experiment: errors of an environment-lit point against samples and against measured seconds.

use std::hint::black_box;

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::counted::counted_cost;
use super::light::LightTables;
use super::target::next_count;
use super::{Competitor, CountedCost};
use crate::measure::convergence::{Incident, LitPoint, Runs, Technique, slope_of};
use crate::measure::cost::{CallCost, TimedBatch, costs};
use merlkit::brdf::{Brdf, Importance};
use merlkit::direction_sampler::DirectionSampler;
use merlkit::geometry::spherical;
use merlkit::light::Environment;
use merlkit::material::Loaded;
use merlkit::points::PointSet;

/// Numbers of samples of the thesis (6.4), up to 50².
pub const THESIS_SAMPLES: [usize; 8] = [1, 25, 100, 225, 400, 900, 1600, 2500];

/// How much of the experiment is run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointPlan {
    /// Polar angles of `wo`, degrees.
    pub theta_o_deg: Vec<f64>,
    /// Numbers of samples of one estimate, increasing.
    pub samples: Vec<usize>,
    /// Independent estimates at each.
    pub seeds: u64,
    /// The first of their seeds.
    pub first_seed: u64,
    /// Samples of each batch that is timed.
    pub timed: usize,
    /// Whether errors under independent random numbers are measured, beside those under Sobol points.
    pub random: bool,
}

impl PointPlan {
    /// Three angles, up to 2500 samples, 40 estimates.
    pub fn quick(first_seed: u64) -> Self {
        Self {
            theta_o_deg: vec![14.5, 45.0, 75.5],
            samples: sample_counts(2500),
            seeds: 40,
            first_seed,
            timed: 3000,
            random: true,
        }
    }

    /// As [`Self::quick`], under Sobol points alone, at numbers of samples that a choice may name: powers of two and one and a
    /// half times these.
    pub fn tuning(first_seed: u64) -> Self {
        let mut samples = vec![1];
        while samples.last().is_some_and(|&n| n < MOST_TUNED) {
            samples.extend(samples.last().map(|&n| next_count(n)));
        }
        Self {
            samples,
            random: false,
            ..Self::quick(first_seed)
        }
    }

    /// Six angles, up to 4096 samples, 200 estimates.
    pub fn full(first_seed: u64) -> Self {
        Self {
            theta_o_deg: vec![0.76, 14.5, 29.75, 45.0, 60.25, 75.5],
            samples: sample_counts(4096),
            seeds: 200,
            first_seed,
            timed: 6000,
            random: true,
        }
    }
}

/// The largest number of samples that [`PointPlan::tuning`] measures.
const MOST_TUNED: usize = 4096;

/// The thesis's numbers of samples and the powers of two from 2 on, up to `most`.
fn sample_counts(most: usize) -> Vec<usize> {
    let powers = (1..).map(|e| 1usize << e).take_while(|&n| n <= most);
    let mut all: Vec<usize> = THESIS_SAMPLES
        .into_iter()
        .filter(|&n| n <= most)
        .chain(powers)
        .collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// The point under `sky`, facing up, seen at polar angle `theta_o_deg`.
fn lit<'a>(brdf: &'a dyn Brdf, sky: &'a Environment, theta_o_deg: f64) -> LitPoint<'a> {
    LitPoint {
        brdf,
        importance: Importance::Mean,
        light: Incident::Environment(sky),
        wo: direction(theta_o_deg),
    }
}

/// `wo` of a polar angle; its azimuth is no multiple of anything.
fn direction(theta_o_deg: f64) -> Vec3 {
    spherical(theta_o_deg.to_radians(), 0.8).as_vec3()
}

/// A reference of the experiment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Polar angle of `wo`, degrees.
    pub theta_o_deg: f64,
    /// Reflected radiance, mean of RGB.
    pub radiance: f64,
    /// Its relative error: the difference from a quadrature of fewer points.
    pub error: f64,
}

/// Nodes in each of MERL's bins of θh; the small sun of an environment needs more than an albedo.
const NODES: [usize; 2] = [2584, 6765];

/// References by quadrature, which no sampler takes part in.
pub fn references(brdf: &dyn Brdf, sky: &Environment, plan: &PointPlan) -> Vec<Reference> {
    let reference = |&theta_o_deg: &f64| {
        let point = lit(brdf, sky, theta_o_deg);
        let [coarse, fine] = NODES.map(|n| point.reference(n));
        let error = if fine > 0.0 {
            (coarse / fine - 1.0).abs()
        } else {
            0.0
        };
        Reference {
            theta_o_deg,
            radiance: fine,
            error,
        }
    };
    plan.theta_o_deg.iter().map(reference).collect()
}

/// Error of estimates from a number of samples, over all angles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorPoint {
    /// Samples of one estimate.
    pub samples: usize,
    /// Root of the mean, over angles and seeds, of the squared relative error.
    pub rmse: f64,
    /// Where the true one lies with 95 %, as far as the scatter of these seeds tells.
    pub low: f64,
    /// The interval's upper end.
    pub high: f64,
}

/// What a competitor does for a material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// Sampler and how it is used.
    pub competitor: Competitor,
    /// Its name for people.
    pub label: String,
    /// Bytes of the tables that it draws by: the sampler's, the environment's, or both.
    pub table_bytes: usize,
    /// Wall-clock seconds that building these took, on all threads.
    pub build_seconds: f64,
    /// What a sample and building cost by the fixed model, which comparisons go by.
    pub counted: CountedCost,
    /// CPU time of one sample of the estimate on one thread: numbers, draw, density, BRDF and light. All 0 until
    /// [`measure_costs`] has been called.
    pub ns_per_sample: CallCost,
    /// Errors under independent random numbers; none if the plan leaves them out.
    pub random: Vec<ErrorPoint>,
    /// Errors under Owen-scrambled Sobol points.
    pub sobol: Vec<ErrorPoint>,
    /// Least-squares slope of log error over log samples from 16 samples on, under random numbers.
    pub random_slope: f64,
    /// The same under Sobol points.
    pub sobol_slope: f64,
}

/// Measures `sampler`, which took `build_seconds`, as `competitor` uses it; its time is left to [`measure_costs`].
pub fn curve(
    competitor: Competitor,
    sampler: &dyn DirectionSampler,
    build_seconds: f64,
    material: &Loaded,
    sky: &Environment,
    (plan, references): (&PointPlan, &[Reference]),
) -> Curve {
    let points = lit_points(&**material.brdf(), sky, references);
    let technique = competitor.technique;
    let errors = |set| errors(&points, sampler, technique, plan, set);
    let sobol = errors(PointSet::Sobol);
    let random = if plan.random {
        errors(PointSet::Random)
    } else {
        Vec::new()
    };
    // Light sampling asks the environment alone, the BRDF's techniques the sampler alone.
    let light = match technique {
        Technique::Light | Technique::Mis(_) => LightTables::measure(sky),
        Technique::Brdf | Technique::Ris(_) => LightTables::default(),
    };
    let (sampler_bytes, sampler_seconds) = match technique {
        Technique::Light => (0, 0.0),
        _ => (sampler.bytes(), build_seconds),
    };
    Curve {
        label: competitor.label(),
        table_bytes: sampler_bytes + light.bytes,
        build_seconds: sampler_seconds + light.build_seconds,
        counted: counted_cost(&competitor, material, sampler_bytes, light.bytes),
        ns_per_sample: CallCost::default(),
        random_slope: fitted(&random),
        sobol_slope: fitted(&sobol),
        random,
        sobol,
        competitor,
    }
}

fn lit_points<'a>(
    brdf: &'a dyn Brdf,
    sky: &'a Environment,
    references: &[Reference],
) -> Vec<(LitPoint<'a>, f64)> {
    references
        .iter()
        .map(|r| (lit(brdf, sky, r.theta_o_deg), r.radiance))
        .collect()
}

/// Estimates of all angles, to be timed.
struct EstimateBatch<'a> {
    points: &'a [(LitPoint<'a>, f64)],
    sampler: &'a dyn DirectionSampler,
    technique: Technique,
    /// Samples at each angle.
    each: usize,
}

impl TimedBatch for EstimateBatch<'_> {
    fn run(&self, round: u64) -> usize {
        for (point, _) in self.points {
            let runs = Runs {
                points: PointSet::Sobol,
                seeds: 1,
                first_seed: round,
            };
            black_box(point.estimate(self.technique, self.sampler, self.each, runs));
        }
        self.each * self.points.len()
    }
}

/// Times a sample of each of `curves`, whose samplers are `samplers` in the same order, all in turn ([`costs`]).
pub fn measure_costs(
    curves: &mut [Curve],
    samplers: &[&dyn DirectionSampler],
    brdf: &dyn Brdf,
    sky: &Environment,
    (plan, references): (&PointPlan, &[Reference]),
) {
    let points = lit_points(brdf, sky, references);
    let mut batches = Vec::new();
    for (curve, &sampler) in curves.iter().zip(samplers) {
        batches.push(EstimateBatch {
            points: &points,
            sampler,
            technique: curve.competitor.technique,
            each: plan.timed.div_ceil(points.len().max(1)),
        });
    }
    let contenders: Vec<&dyn TimedBatch> = batches.iter().map(|b| b as &dyn TimedBatch).collect();
    for (curve, cost) in curves.iter_mut().zip(costs(&contenders)) {
        curve.ns_per_sample = cost;
    }
}

fn fitted(errors: &[ErrorPoint]) -> f64 {
    slope_of(
        errors
            .iter()
            .filter(|e| e.samples >= 16)
            .map(|e| (e.samples, e.rmse)),
    )
}

/// Errors over the points' angles and the plan's seeds.
fn errors(
    points: &[(LitPoint<'_>, f64)],
    sampler: &dyn DirectionSampler,
    technique: Technique,
    plan: &PointPlan,
    set: PointSet,
) -> Vec<ErrorPoint> {
    let runs = Runs {
        points: set,
        seeds: plan.seeds,
        first_seed: plan.first_seed,
    };
    let lit = points.iter().filter(|(_, reference)| *reference > 0.0);
    let squares: Vec<Vec<f64>> = lit
        .flat_map(|(point, reference)| {
            point.squared_errors(technique, sampler, *reference, &plan.samples, runs)
        })
        .collect();
    let at = |(i, &samples): (usize, &usize)| interval(samples, squares.iter().map(|s| s[i]));
    plan.samples.iter().enumerate().map(at).collect()
}

/// Root of the mean of squared errors, with its interval.
fn interval(samples: usize, squares: impl Iterator<Item = f64> + Clone) -> ErrorPoint {
    let count = squares.clone().count().max(1) as f64;
    let mean = squares.clone().sum::<f64>() / count;
    let variance = squares.map(|s| (s - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    let reach = 1.96 * (variance / count).sqrt();
    let [rmse, low, high] = [mean, mean - reach, mean + reach].map(|x| x.max(0.0).sqrt());
    ErrorPoint {
        samples,
        rmse,
        low,
        high,
    }
}

/// Errors of directions from the sampler alone, under Sobol points.
pub(super) fn errors_at(
    sampler: &dyn DirectionSampler,
    brdf: &dyn Brdf,
    sky: &Environment,
    references: &[Reference],
    plan: &PointPlan,
) -> Vec<ErrorPoint> {
    let points = lit_points(brdf, sky, references);
    errors(&points, sampler, Technique::Brdf, plan, PointSet::Sobol)
}

/// Relative RMSE from `samples` Sobol samples with 45° between `wo` and the normal, directions from the sampler alone.
pub(super) fn error_at(
    sampler: &dyn DirectionSampler,
    brdf: &dyn Brdf,
    sky: &Environment,
    samples: usize,
    plan: &PointPlan,
) -> f64 {
    let point = lit(brdf, sky, 45.0);
    let reference = point.reference(NODES[0]);
    let runs = Runs {
        points: PointSet::Sobol,
        seeds: plan.seeds,
        first_seed: plan.first_seed,
    };
    point
        .errors(sampler, reference, &[samples], runs)
        .first()
        .map_or(0.0, |e| e.rmse)
}
