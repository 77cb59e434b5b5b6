//! Which of many competitors a chart shows: no more than can be told apart.

use std::collections::BTreeSet;

use crate::measure::compare::Competitor;
use crate::measure::convergence::Technique;
use merlkit::sampler::SamplerSpec;

/// Competitors of one kind; the number chooses the style, the same in every chart.
pub(super) fn family(competitor: &Competitor) -> usize {
    match (competitor.technique, competitor.spec) {
        (Technique::Light, _) => 8,
        (Technique::Mis(_), _) => 9,
        (Technique::Ris(_), SamplerSpec::Cosine) => 10,
        (Technique::Ris(_), _) => 11,
        (Technique::Brdf, spec) => match spec {
            SamplerSpec::HalfVector(_) | SamplerSpec::ByAzimuth(_) => 0,
            SamplerSpec::CascadeCdf(_) => 1,
            SamplerSpec::AdaptiveDisc(s) if s.depth == 0 => 5,
            SamplerSpec::AdaptiveDisc(_) => 2,
            SamplerSpec::Lobe(_) => 3,
            SamplerSpec::Factored(_) | SamplerSpec::File => 4,
            SamplerSpec::Cosine => 6,
        },
    }
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
