//! The samplers that the thesis's scenes compare.

use merlkit::Result;
use merlkit::material::Loaded;
use merlkit::sampler::SamplerSpec;

use super::bench::published_disc;
use super::plan::ThesisPlan;
use super::stage::SceneSampler;
use super::subjects::factorisation;

/// Fraction of cosine draws that keeps the factored BRDF from leaving out directions.
const FLOOR: f64 = 0.01;
/// Candidates of resampling; the thesis doesn't say how many it has.
pub(super) const CANDIDATES: u32 = 16;

/// A sampler of the thesis's scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    Uniform,
    LobeSphere,
    LobeHemisphere,
    /// The same two with the thesis's first exponent, 30, for every BRDF.
    LobeSphere30,
    LobeHemisphere30,
    Factored,
    Disc,
    DiscAsPublished,
}

impl Way {
    /// The thesis's name in its tables; ours for what it lacks.
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::LobeSphere => "lobe_sphere",
            Self::LobeHemisphere => "lobe_hemisphere",
            Self::LobeSphere30 => "lobe_sphere, exponent 30",
            Self::LobeHemisphere30 => "lobe_hemisphere, exponent 30",
            Self::Factored => "factored",
            Self::Disc => "adaptive_disc",
            Self::DiscAsPublished => "adaptive_disc, as published",
        }
    }

    /// What draws from a material, whose name in the thesis's tables is `subject`.
    pub fn spec(self, subject: &str, material: &Loaded, plan: &ThesisPlan) -> Result<SamplerSpec> {
        match self {
            Self::Uniform => "cosine".parse(),
            Self::LobeSphere => "lobe:cosine".parse(),
            Self::LobeHemisphere => "lobe:cosine-hemisphere".parse(),
            Self::LobeSphere30 => "lobe:cosine,parameters=30/30/0".parse(),
            Self::LobeHemisphere30 => "lobe:cosine-hemisphere,parameters=30/30/0".parse(),
            Self::Factored => factorisation(subject, FLOOR),
            Self::Disc => disc(material, plan),
            Self::DiscAsPublished => published_disc([plan.trees, plan.image], material, ""),
        }
    }

    /// This sampler of one material, at the plan's numbers of samples.
    pub fn contend(
        self,
        subject: &str,
        material: &Loaded,
        plan: &ThesisPlan,
    ) -> Result<SceneSampler> {
        Ok(SceneSampler {
            name: self.name(),
            specs: vec![self.spec(subject, material, plan)?],
            candidates: 1,
            samples: plan.samples.clone(),
        })
    }
}

/// Our disc, which leaves out no direction.
pub(super) fn disc(material: &Loaded, plan: &ThesisPlan) -> Result<SamplerSpec> {
    let azimuths = match material.facts().is_isotropic() {
        true => "",
        false => ",azimuths=2",
    };
    let trees = if plan.quick { 6 } else { 20 };
    format!("adaptive-disc:tables={trees}{azimuths}").parse()
}
