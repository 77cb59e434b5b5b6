//! Which of many competitors a chart shows: no more than can be told apart.

use std::collections::BTreeSet;

use crate::measure::compare::Competitor;
use crate::measure::convergence::Technique;
use merlkit::sampler::{AdaptiveDiscSettings, SamplerSpec};

/// Competitors of one kind; the number chooses the style, the same in every chart.
pub(super) fn family(competitor: &Competitor) -> usize {
    let spec = &competitor.spec;
    match (competitor.technique, spec.name()) {
        (Technique::Light, _) => 8,
        (Technique::Mis(_), _) => 9,
        (Technique::Ris(_), "cosine") => 10,
        (Technique::Ris(_), _) => 11,
        (Technique::Brdf, "half-vector") => 0,
        (Technique::Brdf, "cascade-cdf") => 1,
        (Technique::Brdf, "adaptive-disc") if is_rejection(spec) => 5,
        (Technique::Brdf, "adaptive-disc") => 2,
        (Technique::Brdf, "lobe") => 3,
        (Technique::Brdf, "cosine") => 6,
        (Technique::Brdf, _) => 4,
    }
}

/// A competitor's name where there is little room: "MIS (power) + half-vector:64KB".
pub(super) fn short_label(label: &str) -> String {
    label.replacen(" of light and ", " + ", 1)
}

/// Whether draws are rejected on the whole disc.
fn is_rejection(spec: &SamplerSpec) -> bool {
    spec.settings::<AdaptiveDiscSettings>()
        .is_some_and(|s| s.depth == 0)
}

/// The first of each family of those that draw from the BRDF alone, and then the first of all of these with the first of
/// each family that knows the light; `all` begins with the best.
pub(super) fn chosen<'a, T>(
    all: &[&'a T],
    competitor: impl Fn(&T) -> &Competitor,
) -> [Vec<&'a T>; 2] {
    let mut seen = BTreeSet::new();
    let firsts: Vec<&T> = all
        .iter()
        .copied()
        .filter(|t| seen.insert(family(competitor(t))))
        .collect();
    let (brdf, mut light): (Vec<&T>, Vec<&T>) = firsts
        .into_iter()
        .partition(|t| competitor(t).technique == Technique::Brdf);
    if !light.is_empty() {
        light.extend(brdf.first());
    }
    [brdf, light]
}
