//! Choosing a sampler by the error one can bear.

use serde::Serialize;

use super::candidates::supported;
use super::point::{ErrorPoint, PointPlan, Reference, curve, errors_at, references};
use super::target::{Reach, reach, seconds};
use super::{Competitor, Curve};
use crate::measure::cost::time;
use merlkit::Result;
use merlkit::brdf::Brdf;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::light::Environment;
use merlkit::material::{Loaded, MaterialFacts};
use merlkit::sampler::SamplerSpec;

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Wish {
    /// Relative RMSE of one estimate of the lit point, above 0.
    pub error: f64,
    /// Most bytes of tables.
    pub max_bytes: Option<usize>,
    /// Most seconds to build, on the threads of this run.
    pub max_build: Option<f64>,
    /// Samples that share the precomputation.
    pub shared_by: u64,
}

/// A sampler that was tried.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tried {
    /// What was measured.
    pub curve: Curve,
    /// What it needs; `None` if it doesn't get there with [`MOST_SAMPLES`] samples.
    pub reach: Option<Reach>,
    /// Seconds of one estimate on one thread, with its share of the precomputation.
    pub seconds: Option<f64>,
    /// Whether it keeps the limits of bytes and build time.
    pub allowed: bool,
}

/// More samples than these are no choice.
pub const MOST_SAMPLES: f64 = 1e8;

/// A choice measured again, on other seeds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Proof {
    /// Samples of one estimate that were found to be enough.
    pub samples: usize,
    /// The first of the fresh seeds.
    pub first_seed: u64,
    /// How many.
    pub seeds: u64,
    /// The error with its interval; at most what was asked for.
    pub error: ErrorPoint,
}

/// Samplers in the order of time to the error, and which of them it is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tuning {
    /// What was asked for.
    pub wish: Wish,
    /// What the errors are relative to.
    pub references: Vec<Reference>,
    /// Everything tried, the quickest first, then those that don't get there.
    pub tried: Vec<Tried>,
    /// Position of the quickest that is allowed and gets there.
    pub chosen: Option<usize>,
    /// The proof of the choice; `None` without one, or if it needs more samples than are measured.
    pub proof: Option<Proof>,
}

impl Tuning {
    /// The quickest of those that are allowed, get there and hold fewer bytes than the choice.
    pub fn cheaper(&self) -> Option<&Tried> {
        let bytes = self.tried.get(self.chosen?)?.curve.table_bytes;
        self.usable().find(|t| t.curve.table_bytes < bytes)
    }

    /// The quickest of those that get there with fewer samples than the choice, whether the limits allow it or not.
    pub fn better(&self) -> Option<&Tried> {
        let samples = self.tried.get(self.chosen?)?.reach?.samples;
        self.tried
            .iter()
            .find(|t| t.reach.is_some_and(|r| r.samples < 0.95 * samples))
    }

    /// The allowed one with the least error at the largest number of samples measured: as near as one gets.
    pub fn nearest(&self) -> Option<(&Tried, ErrorPoint)> {
        let last = |t: &Tried| t.curve.sobol.last().copied();
        let ends = self
            .tried
            .iter()
            .filter(|t| t.allowed)
            .filter_map(|t| Some((t, last(t)?)));
        ends.min_by(|a, b| a.1.rmse.total_cmp(&b.1.rmse))
    }

    fn usable(&self) -> impl Iterator<Item = &Tried> {
        self.tried.iter().filter(|t| t.allowed && t.reach.is_some())
    }
}

/// Samplers that are tried: the half-vector table in every size, the thesis's two, and lobes.
const TUNABLE: [&str; 15] = [
    "half-vector:2KB",
    "half-vector:4KB",
    "half-vector:8KB",
    "half-vector:16KB",
    "half-vector:32KB",
    "half-vector:64KB",
    "half-vector:256KB",
    "half-vector:1MB",
    "cascade-cdf:tolerance=0.01",
    "cascade-cdf",
    "adaptive-disc",
    "adaptive-disc:rejection-free",
    "lobe:cosine",
    "lobe:ward",
    "lobe:ggx",
];

/// Samplers that are tried for a material: every size of the half-vector table, the thesis's two, the lobes and a file's own
/// density, as far as the material supports them. With `stored`, only those that a sampler file can hold.
///
/// # Errors
/// As [`SamplerSpec::parse_all`].
pub fn tunable(facts: &MaterialFacts, stored: bool) -> Result<Vec<SamplerSpec>> {
    let mut all = SamplerSpec::parse_all(&TUNABLE)?;
    if !stored {
        all.extend(SamplerSpec::parse_all(&["cosine", "file"])?);
    }
    all.retain(|spec| supported(spec, &[*facts]));
    Ok(all)
}

/// Tries `specs` for a material under a sky. `progress` is called after each.
///
/// # Errors
/// Those of building samplers.
pub fn tune(
    material: &Loaded,
    sky: &Environment,
    wish: Wish,
    specs: &[SamplerSpec],
    plan: &PointPlan,
    progress: &dyn Fn(),
) -> Result<Tuning> {
    let brdf = &**material.brdf();
    let references = references(brdf, sky, plan);
    let mut tried = Vec::new();
    for spec in specs {
        let (sampler, seconds) = time(|| spec.build(material));
        let measured = (plan, &references[..]);
        let curve = curve(
            Competitor::brdf(spec.clone()),
            &*sampler?,
            seconds.wall,
            brdf,
            sky,
            measured,
        );
        tried.push(judged(curve, wish));
        progress();
    }
    let order = |t: &Tried| t.seconds.unwrap_or(f64::INFINITY);
    tried.sort_by(|a, b| order(a).total_cmp(&order(b)));
    let chosen = tried.iter().position(|t| t.allowed && t.reach.is_some());
    let mut tuning = Tuning {
        wish,
        references,
        tried,
        chosen,
        proof: None,
    };
    if let Some(choice) = chosen.map(|i| &tuning.tried[i]) {
        let sampler = choice.curve.competitor.spec.build(material)?;
        tuning.proof = prove(&tuning, choice, &*sampler, (brdf, sky), plan);
    }
    Ok(tuning)
}

fn judged(curve: Curve, wish: Wish) -> Tried {
    let reach = reach(&curve, wish.error).filter(|r| r.samples <= MOST_SAMPLES);
    let seconds = reach.map(|r| seconds(&curve, r.samples, wish.shared_by));
    let allowed = wish.max_bytes.is_none_or(|most| curve.table_bytes <= most)
        && wish
            .max_build
            .is_none_or(|most| curve.build_seconds <= most);
    Tried {
        curve,
        reach,
        seconds,
        allowed,
    }
}

/// Added to the plan's seeds for the proof.
const FRESH: u64 = 1 << 32;
/// Estimates of more samples are not tried.
const MOST_PROVED: f64 = (1u64 << 20) as f64;
/// Times that the number of samples may be raised.
const ROUNDS: u64 = 6;

/// Measures the choice on fresh seeds; where its error is above what was asked for, with more samples on fresher ones.
fn prove(
    tuning: &Tuning,
    choice: &Tried,
    sampler: &dyn DirectionSampler,
    (brdf, sky): (&dyn Brdf, &Environment),
    plan: &PointPlan,
) -> Option<Proof> {
    let mut samples = choice.reach?.samples;
    for round in 1..=ROUNDS {
        if samples > MOST_PROVED {
            return None;
        }
        let fresh = PointPlan {
            samples: vec![samples.ceil() as usize],
            first_seed: plan.first_seed.wrapping_add(round * FRESH),
            ..plan.clone()
        };
        let error = errors_at(sampler, brdf, sky, &tuning.references, &fresh)
            .into_iter()
            .next()?;
        if error.rmse <= tuning.wish.error {
            let PointPlan {
                first_seed, seeds, ..
            } = fresh;
            return Some(Proof {
                samples: error.samples,
                first_seed,
                seeds,
                error,
            });
        }
        samples *= (error.rmse / tuning.wish.error).powf(1.5) * 1.02;
    }
    None
}
