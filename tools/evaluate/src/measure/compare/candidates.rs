//! Who competes.

use serde::{Deserialize, Serialize};

use crate::measure::convergence::Technique;
use merlkit::distribution::Heuristic;
use merlkit::material::MaterialFacts;
use merlkit::render::Strategy;
use merlkit::sampler::{
    AdaptiveDiscSettings, CascadeCdfSettings, FactoredSettings, HalfVectorSettings, LeafChoice,
    LobeKind, LobeSettings, Sampler, SamplerSpec,
};

/// Materials that methods are compared on unless others are asked for: metals, paints, plastics and a diffuse one.
pub const MATERIALS: [&str; 8] = [
    "alum-bronze",
    "black-obsidian",
    "blue-metallic-paint",
    "chrome",
    "nickel",
    "red-plastic",
    "teflon",
    "violet-acrylic",
];

/// A sampler and how it is used.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Competitor {
    /// What draws from the BRDF, as asked for: parameters that are fitted stand in the label.
    pub spec: SamplerSpec,
    /// How its draws are combined with the light's.
    pub technique: Technique,
}

impl Competitor {
    /// Directions from the sampler alone.
    pub fn brdf(spec: SamplerSpec) -> Self {
        Self {
            spec,
            technique: Technique::Brdf,
        }
    }

    /// Its name for people, with what the built `sampler` was fitted to.
    pub fn label_of(&self, sampler: &Sampler) -> String {
        match self.technique {
            Technique::Light => "light sampling".into(),
            Technique::Brdf => sampler.spec().label(),
            technique => format!("{} of light and {}", technique.name(), self.spec.name()),
        }
    }
}

/// The half-vector table of a preset's name.
fn half_vector(name: &str) -> SamplerSpec {
    let preset = HalfVectorSettings::PRESETS.iter().find(|p| p.0 == name);
    SamplerSpec::HalfVector(preset.map_or_else(HalfVectorSettings::default, |p| p.1))
}

/// All that are compared for materials of these facts, as far as every one of the materials supports them; `quick` leaves out
/// those that nobody would choose between.
pub fn competitors(quick: bool, facts: &[MaterialFacts]) -> Vec<Competitor> {
    let warp = AdaptiveDiscSettings {
        leaves: LeafChoice::Warp,
        ..Default::default()
    };
    let mut specs = vec![
        half_vector("2KB"),
        half_vector("64KB"),
        SamplerSpec::CascadeCdf(CascadeCdfSettings::default()),
        SamplerSpec::AdaptiveDisc(AdaptiveDiscSettings::default()),
        SamplerSpec::AdaptiveDisc(warp),
        SamplerSpec::Cosine,
    ];
    let lobes = if quick {
        vec![LobeKind::CosineLobe, LobeKind::Ggx]
    } else {
        LobeKind::ALL.to_vec()
    };
    specs.extend(
        lobes
            .into_iter()
            .map(|kind| SamplerSpec::Lobe(LobeSettings::fitted(kind))),
    );
    if !quick {
        specs.push(half_vector("1MB"));
        specs.push(SamplerSpec::AdaptiveDisc(AdaptiveDiscSettings::rejection()));
    }
    specs.push(SamplerSpec::Factored(FactoredSettings::default()));
    specs.push(SamplerSpec::File);
    specs.retain(|spec| supported(spec, facts));
    let mut all: Vec<Competitor> = specs.into_iter().map(Competitor::brdf).collect();
    all.extend(with_light(half_vector("64KB"), quick));
    all
}

/// All whose pictures are compared: as [`competitors`], and resampling, which saves rays in a picture; `quick` leaves out the
/// factored BRDF, which takes seconds to fit.
pub fn picture_competitors(quick: bool, facts: &[MaterialFacts]) -> Vec<Competitor> {
    let resampled = [half_vector("64KB"), SamplerSpec::Cosine];
    let ris = |spec| Competitor {
        spec,
        technique: Technique::Ris(Strategy::CANDIDATES),
    };
    let slow = |c: &Competitor| quick && matches!(c.spec, SamplerSpec::Factored(_));
    competitors(quick, facts)
        .into_iter()
        .filter(|c| !slow(c))
        .chain(resampled.map(ris))
        .collect()
}

/// Whether every material supports a sampler: those that need a table, know no azimuth, or are a file's own, not all do.
pub fn supported(spec: &SamplerSpec, facts: &[MaterialFacts]) -> bool {
    facts.iter().all(|f| spec.check_supports(f).is_ok())
}

/// Ways to take the light into account.
fn with_light(spec: SamplerSpec, quick: bool) -> Vec<Competitor> {
    let mut techniques = vec![Technique::Light, Technique::Mis(Heuristic::Power)];
    if !quick {
        techniques.push(Technique::Mis(Heuristic::Balance));
    }
    techniques
        .into_iter()
        .map(|technique| Competitor { spec, technique })
        .collect()
}
