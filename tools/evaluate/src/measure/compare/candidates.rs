//! Who competes.

use serde::{Deserialize, Serialize};

use crate::measure::convergence::Technique;
use merlkit::Result;
use merlkit::distribution::Heuristic;
use merlkit::material::MaterialFacts;
use merlkit::render::Strategy;
use merlkit::sampler::{CosineSettings, FactoredSettings, SamplerSpec};

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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Competitor {
    /// What draws from the BRDF; [`Technique::Light`], which draws from the light alone, never asks it.
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

    /// Its name in tables and plots: that of the sampler, and how it is combined with the light's directions.
    pub fn label(&self) -> String {
        match self.technique {
            Technique::Light => "light sampling".into(),
            Technique::Brdf => self.spec.to_string(),
            technique => format!("{} of light and {}", technique.name(), self.spec),
        }
    }
}

/// Samplers that are compared in every case.
const USUAL: [&str; 8] = [
    "half-vector:2KB",
    "half-vector:64KB",
    "cascade-cdf",
    "adaptive-disc",
    "adaptive-disc:rejection-free",
    "cosine",
    "lobe:cosine",
    "lobe:ggx",
];

/// Samplers that nobody would choose between, or that say little more than others.
const UNUSUAL: [&str; 6] = [
    "lobe:cosine-sphere",
    "lobe:blinn",
    "lobe:ward",
    "lobe:ashikhmin-shirley",
    "half-vector:1MB",
    "adaptive-disc:rejection",
];

/// The sampler that is combined with the light's directions.
const WITH_LIGHT: &str = "half-vector:64KB";

/// All that are compared for materials of these facts, as far as every one of the materials supports them; `quick` leaves out
/// those that nobody would choose between.
///
/// # Errors
/// As [`SamplerSpec::parse_all`].
pub fn competitors(quick: bool, facts: &[MaterialFacts]) -> Result<Vec<Competitor>> {
    let mut specs = SamplerSpec::parse_all(&USUAL)?;
    if !quick {
        specs.extend(SamplerSpec::parse_all(&UNUSUAL)?);
    }
    specs.extend(SamplerSpec::parse_all(&["factored", "file"])?);
    specs.retain(|spec| supported(spec, facts));
    let mut all: Vec<Competitor> = specs.into_iter().map(Competitor::brdf).collect();
    all.extend(with_light(&WITH_LIGHT.parse()?, quick));
    Ok(all)
}

/// All whose pictures are compared: as [`competitors`], and resampling, which saves rays in a picture; `quick` leaves out the
/// factored BRDF, which takes seconds to fit, and resampling of the disc.
///
/// # Errors
/// As [`competitors`].
pub fn picture_competitors(quick: bool, facts: &[MaterialFacts]) -> Result<Vec<Competitor>> {
    let mut all = competitors(quick, facts)?;
    all.retain(|c| !quick || c.spec.settings::<FactoredSettings>().is_none());
    let mut resampled = SamplerSpec::parse_all(&[WITH_LIGHT, "cosine"])?;
    if !quick {
        // As in the thesis's table 6.22.
        resampled.extend(SamplerSpec::parse_all(&["adaptive-disc", "factored"])?);
        resampled.retain(|spec| supported(spec, facts));
    }
    for spec in resampled {
        all.push(Competitor {
            spec,
            technique: Technique::Ris(Strategy::CANDIDATES),
        });
    }
    Ok(all)
}

/// Whether every material supports a sampler: not all have one of their own.
pub fn supported(spec: &SamplerSpec, facts: &[MaterialFacts]) -> bool {
    facts.iter().all(|f| spec.check_supports(f).is_ok())
}

/// Ways to take the light into account.
fn with_light(spec: &SamplerSpec, quick: bool) -> Vec<Competitor> {
    let mut techniques = vec![Technique::Light, Technique::Mis(Heuristic::Power)];
    if !quick {
        techniques.push(Technique::Mis(Heuristic::Balance));
    }
    techniques
        .into_iter()
        .map(|technique| Competitor {
            spec: match technique {
                // The technique asks no sampler: the cosine, which has no tables, stands in.
                Technique::Light => SamplerSpec::new(CosineSettings {}),
                _ => spec.clone(),
            },
            technique,
        })
        .collect()
}
