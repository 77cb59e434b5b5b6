//! Choosing a sampler by the error one can bear.

use serde::Serialize;

use super::candidates::supported;
use super::point::{ErrorPoint, PointPlan, Reference, curve, measure_costs, references};
use super::proof::{Proof, Prover};
use super::target::{Reach, count_to_reach, counted_seconds, reach_with};
use super::tie::{Contender, Winner, best};
use super::{Competitor, Curve, cost_notes};
use crate::measure::cost::time;
use merlkit::Result;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::light::Environment;
use merlkit::material::{Loaded, MaterialFacts};
use merlkit::sampler::{Sampler, SamplerSpec};

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Wish {
    /// Relative RMSE of one estimate of the lit point, above 0.
    pub error: f64,
    /// Most bytes of tables.
    pub max_bytes: Option<usize>,
    /// Most seconds to build, by the clock on the threads of this run.
    pub max_build: Option<f64>,
    /// Samples that share the precomputation.
    pub shared_by: u64,
}

/// A sampler that was tried.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tried {
    /// What was measured.
    pub curve: Curve,
    /// What it needs, proved if `proof` is there; `None` if it doesn't get there with [`MOST_SAMPLES`] samples.
    pub reach: Option<Reach>,
    /// Counted seconds of one estimate on one thread, with its part of the precomputation.
    pub counted_seconds: Option<f64>,
    /// Whether it keeps the limits of bytes and build time.
    pub allowed: bool,
    /// The proof on fresh seeds, if one was made.
    pub proof: Option<Proof>,
    /// Whether a proof was tried and would take more samples than are measured, so that this is no choice.
    pub unproved: bool,
}

/// More samples than these are no choice.
pub const MOST_SAMPLES: f64 = 1e8;

/// Samplers in the order of counted time to the error, and which of them it is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tuning {
    /// What was asked for.
    pub wish: Wish,
    /// What the errors are relative to.
    pub references: Vec<Reference>,
    /// Everything tried, the quickest first, then those that don't get there.
    pub tried: Vec<Tried>,
    /// Position of the best that is allowed and gets there, by [`best`].
    pub chosen: Option<usize>,
    /// Positions of those that tie with the choice in counted time.
    pub ties: Vec<usize>,
    /// Position of the best of those that are allowed, proved and hold fewer bytes than the choice.
    pub cheaper: Option<usize>,
    /// Position of the best of those that are proved with fewer samples than the choice, whether the limits allow it or not.
    pub better: Option<usize>,
    /// The proof of the choice; `None` without one, or if it needs more samples than are measured.
    pub proof: Option<Proof>,
    /// What to know before trusting a measured time.
    pub notes: Vec<String>,
}

impl Tuning {
    /// The allowed one with the least error at the largest number of samples measured: as near as one gets.
    pub fn nearest(&self) -> Option<(&Tried, ErrorPoint)> {
        let mut ends = Vec::new();
        for tried in self.tried.iter().filter(|t| t.allowed) {
            ends.extend(tried.curve.sobol.last().map(|end| (tried, *end)));
        }
        let nearest = ends.into_iter();
        nearest.min_by(|a, b| a.1.rmse.total_cmp(&b.1.rmse))
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

/// Tries `specs` for a material under a sky, proves the best three and whatever then is the choice or named beside it, and
/// chooses among what is proved. `progress` is called after each that is tried.
///
/// The choice goes by counted costs and by errors of fixed seeds, so that it is the same in every run; measured times stand
/// beside. A limit of build time alone is held against the clock.
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
    let measured = (plan, &references[..]);
    let mut samplers: Vec<Sampler> = Vec::new();
    let mut curves = Vec::new();
    for spec in specs {
        let (sampler, seconds) = time(|| spec.build(material));
        let sampler = sampler?;
        let competitor = Competitor::brdf(spec.clone());
        let found = curve(competitor, &*sampler, seconds.wall, material, sky, measured);
        curves.push(found);
        samplers.push(sampler);
        progress();
    }
    let drawing: Vec<&dyn DirectionSampler> = samplers.iter().map(Sampler::as_dyn).collect();
    measure_costs(&mut curves, &drawing, brdf, sky, measured);
    let mut field = Field {
        tried: curves.into_iter().map(|c| judged(c, wish)).collect(),
        samplers: &drawing,
        wish,
        prover: Prover {
            material,
            sky,
            references: &references,
            plan,
            error: wish.error,
        },
    };
    let choice = field.choose();
    let tried = field.tried;
    Ok(ordered(choice, tried, wish, references))
}

fn judged(curve: Curve, wish: Wish) -> Tried {
    let reach = count_to_reach(&curve.sobol, wish.error)
        .map(|(samples, beyond)| reach_with(&curve, wish.error, samples as f64, beyond))
        .filter(|r| r.samples <= MOST_SAMPLES);
    let seconds = reach.map(|r| counted_seconds(&curve, r.samples, wish.shared_by));
    let allowed = wish.max_bytes.is_none_or(|most| curve.table_bytes <= most)
        && wish
            .max_build
            .is_none_or(|most| curve.build_seconds <= most);
    Tried {
        curve,
        reach,
        counted_seconds: seconds,
        allowed,
        proof: None,
        unproved: false,
    }
}

/// Positions of the choice and of what is named beside it.
#[derive(Default)]
struct Choice {
    winner: Option<Winner>,
    cheaper: Option<usize>,
    better: Option<usize>,
}

/// How many are proved whatever the first proof comes to.
const PROVED: usize = 3;
/// What takes more than this times as long as the best is neither proved beside it nor named as an alternative: nobody would
/// take it, and its proof would take as much longer.
const FAR: f64 = 30.0;

/// Contenders whose figures change as they are proved.
struct Field<'a> {
    tried: Vec<Tried>,
    samplers: &'a [&'a dyn DirectionSampler],
    wish: Wish,
    prover: Prover<'a>,
}

impl Field<'_> {
    /// The choice and its neighbours, all of them proved.
    ///
    /// A proof can only raise a number of samples, which may let others past, so proofs go on until the choice by all figures
    /// is one that is proved.
    fn choose(&mut self) -> Choice {
        let first = self.winner(&|t| t.allowed);
        let least = first.and_then(|w| self.tried[w.index].counted_seconds);
        for _ in 0..PROVED {
            let Some(next) = self.winner(&|t| t.allowed && t.proof.is_none() && is_near(t, least))
            else {
                break;
            };
            self.prove(next.index);
        }
        loop {
            let Some(winner) = self.settle(&|t| t.allowed) else {
                return self.unproved();
            };
            let choice = &self.tried[winner.index];
            let bytes = choice.curve.table_bytes;
            let samples = choice.reach.map_or(0.0, |r| r.samples);
            let seconds = choice.counted_seconds;
            let fewer_bytes =
                self.settle(&|t| t.allowed && t.curve.table_bytes < bytes && is_near(t, seconds));
            let fewer_samples = self
                .settle(&|t| t.reach.is_some_and(|r| r.samples < samples) && is_near(t, seconds));
            // The proofs of the neighbours may have changed who ties.
            let again = self.winner(&|t| t.allowed);
            if again.as_ref().is_some_and(|w| w.index == winner.index) {
                return Choice {
                    winner: again,
                    cheaper: fewer_bytes.map(|w| w.index),
                    better: fewer_samples.map(|w| w.index),
                };
            }
        }
    }

    /// The best of some, proved; `None` if none of them can be.
    fn settle(&mut self, among: &dyn Fn(&Tried) -> bool) -> Option<Winner> {
        loop {
            let winner = self.winner(among)?;
            if self.tried[winner.index].proof.is_some() {
                return Some(winner);
            }
            self.prove(winner.index);
        }
    }

    /// The best of some by the figures so far.
    fn winner(&self, among: &dyn Fn(&Tried) -> bool) -> Option<Winner> {
        let mut contenders = Vec::new();
        for tried in &self.tried {
            let takes_part = !tried.unproved && among(tried);
            contenders.push(contender(tried).filter(|_| takes_part));
        }
        best(&contenders)
    }

    /// Proves one that is not proved yet, and puts the proved figures in the place of the found ones.
    fn prove(&mut self, index: usize) {
        let tried = &mut self.tried[index];
        let Some(reach) = tried.reach else {
            return;
        };
        let start = reach.samples as usize;
        let proof = self.prover.prove(&tried.curve, self.samplers[index], start);
        tried.proof = proof;
        tried.unproved = proof.is_none();
        if let Some(proof) = proof {
            let samples = proof.samples as f64;
            tried.reach = Some(reach_with(&tried.curve, self.wish.error, samples, false));
            let seconds = counted_seconds(&tried.curve, samples, self.wish.shared_by);
            tried.counted_seconds = Some(seconds);
        }
    }

    /// Where no proof was had: what would be the choice if all figures held.
    fn unproved(&self) -> Choice {
        let mut contenders = Vec::new();
        for tried in &self.tried {
            contenders.push(contender(tried).filter(|_| tried.allowed));
        }
        Choice {
            winner: best(&contenders),
            ..Choice::default()
        }
    }
}

/// Whether something takes at most [`FAR`] times `seconds`.
fn is_near(tried: &Tried, seconds: Option<f64>) -> bool {
    let most = FAR * seconds.unwrap_or(f64::INFINITY);
    tried.counted_seconds.is_some_and(|s| s <= most)
}

fn contender(tried: &Tried) -> Option<Contender> {
    Some(Contender {
        seconds: tried.counted_seconds?,
        samples: tried.reach?.samples,
        bytes: tried.curve.table_bytes,
    })
}

/// The tuning with everything tried in the order of counted time; of equals the one tried first.
fn ordered(choice: Choice, tried: Vec<Tried>, wish: Wish, references: Vec<Reference>) -> Tuning {
    let mut order: Vec<usize> = (0..tried.len()).collect();
    let seconds = |i: usize| tried[i].counted_seconds.unwrap_or(f64::INFINITY);
    order.sort_by(|&a, &b| seconds(a).total_cmp(&seconds(b)));
    let place = |index: usize| order.iter().position(|&i| i == index);
    let chosen = choice.winner.as_ref().and_then(|w| place(w.index));
    let ties = choice.winner.map_or_else(Vec::new, |w| w.ties);
    Tuning {
        wish,
        references,
        chosen,
        ties: ties.into_iter().filter_map(place).collect(),
        cheaper: choice.cheaper.and_then(place),
        better: choice.better.and_then(place),
        proof: chosen.and_then(|c| tried[order[c]].proof),
        notes: cost_notes(&tried.iter().map(|t| &t.curve).collect::<Vec<_>>()),
        tried: order.iter().map(|&i| tried[i].clone()).collect(),
    }
}
