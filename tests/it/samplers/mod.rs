//! The samplers themselves: each passes every check of `merlkit check` on a dozen materials, and each check that matters for
//! them fails when a real sampler's density is tampered with.
//!
//! Left out: the adaptive disc with leaves by integral. Its densities are as good as the integrals of its leaves, which are
//! estimates from points, so it is approximate and is not held to these checks; the published settings below show it.

mod batches;
mod draws;
mod passes;
mod published;
mod rejected;

use crate::support::tampered::Tampered;
use crate::support::{loaded, measured, measured_under};
use glam::{Vec2, Vec3};
use merlkit::brdf::{Brdf, Importance};
use merlkit::direction_sampler::{DirectionSample, DirectionSampler};
use merlkit::geometry::{POINTS_PER_BIN, Quadrature, spherical};
use merlkit::material::Material;
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::points::PointSet;
use merlkit::sampler::store::encode;
use merlkit::sampler::{
    AdaptiveDiscSettings, Carry, CascadeCdfSettings, CosineSettings, LeafChoice, Sampler,
    SamplerSpec, TableChoice,
};
use merlkit_evaluate::measure::accuracy::{LIMIT_ANGLES_DEG, WeightSpread, weight_spread};
use merlkit_evaluate::measure::check::{
    Check, CheckReport, CheckSettings, check_directions, check_sampler,
};
use merlkit_evaluate::measure::chi_square::{ChiSquareTest, ChiSquareVerdict};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Upper bound of how often [`assert_passes`] is called in this file: together they err once in a hundred seeds.
const CALLS: usize = 100;

fn direction(degrees: f64) -> Vec3 {
    spherical(degrees.to_radians(), 0.8).as_vec3()
}

fn disc(choice: TableChoice) -> SamplerSpec {
    SamplerSpec::new(AdaptiveDiscSettings {
        choice,
        ..Default::default()
    })
}

fn rejection_free(choice: TableChoice) -> SamplerSpec {
    let leaves = LeafChoice::Warp;
    SamplerSpec::new(AdaptiveDiscSettings {
        choice,
        leaves,
        ..Default::default()
    })
}

/// Directions stay where a tree has them, as in the thesis.
fn kept(choice: TableChoice) -> SamplerSpec {
    let settings = AdaptiveDiscSettings {
        choice,
        carry: Carry::Direction,
        tables: 60,
        ..Default::default()
    };
    SamplerSpec::new(settings)
}

fn cascade(choice: TableChoice) -> SamplerSpec {
    SamplerSpec::new(CascadeCdfSettings {
        choice,
        ..Default::default()
    })
}

fn whole(choice: TableChoice) -> SamplerSpec {
    SamplerSpec::new(CascadeCdfSettings {
        choice,
        ..CascadeCdfSettings::uniform()
    })
}

fn coarse(choice: TableChoice) -> SamplerSpec {
    SamplerSpec::new(CascadeCdfSettings {
        choice,
        tolerance: Some(1e-2),
        ..Default::default()
    })
}

/// A sampler with its default settings but for what serves a `wo` between two tables.
type Spec = fn(TableChoice) -> SamplerSpec;

fn settings(seed: u64) -> CheckSettings {
    CheckSettings {
        draws: 30_000,
        calls: CALLS,
        seed,
        ..CheckSettings::default()
    }
}

fn assert_passes(spec: SamplerSpec, brdf: &Arc<MerlBrdf>, settings: &CheckSettings) {
    let sampler = spec.build(&loaded(brdf)).unwrap();
    let report = check_sampler(&*sampler, &**brdf, &check_directions(), settings);
    assert_eq!(report.outcomes.len(), 13 * 7);
    assert!(
        report.pass(),
        "{spec:?}: {:#?}",
        report.failures().collect::<Vec<_>>()
    );
}

fn failed(report: &CheckReport, check: Check) -> usize {
    report.failures().filter(|o| o.check == check).count()
}

fn mean_and_variance(values: &[f64]) -> (f64, f64) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (
        mean,
        values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64,
    )
}
