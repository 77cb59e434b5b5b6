//! Which sampler, with which settings: what a command line asks for and what a file records.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::{
    AdaptiveDisc, AdaptiveDiscSettings, CascadeCdf, CascadeCdfSettings, Construction, Cosine,
    DirectionSample, DirectionSampler,
};
use crate::Result;
use crate::brdf::Measured;

/// A sampler that can be built for any measured material.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(tag = "sampler", rename_all = "kebab-case")]
pub enum SamplerSpec {
    /// Uniform on the disc.
    Cosine,
    /// Quadtrees on the disc.
    AdaptiveDisc(AdaptiveDiscSettings),
    /// CDFs of the half vector.
    CascadeCdf(CascadeCdfSettings),
}

impl SamplerSpec {
    /// The method's name on the command line and in files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Cosine => "cosine",
            Self::AdaptiveDisc(_) => "adaptive-disc",
            Self::CascadeCdf(_) => "cascade-cdf",
        }
    }

    /// The name with the settings that tell variants apart, for tables: "cascade-cdf 1024×512 ±0.001".
    pub fn label(&self) -> String {
        match self {
            Self::Cosine => self.name().into(),
            Self::AdaptiveDisc(s) => match s.construction {
                Construction::Refined => format!("{}, {} trees", self.name(), s.tables),
                Construction::Grid(side) => {
                    format!("{}, {} trees from {side}² pixels", self.name(), s.tables)
                }
            },
            Self::CascadeCdf(s) => {
                let cells = format!("{} {}×{}×{}", self.name(), s.tables, s.theta_h, s.phi_h);
                s.tolerance.map_or_else(|| format!("{cells} whole"), |t| format!("{cells} ±{t}"))
            }
        }
    }

    /// Builds the sampler on the threads of the current pool.
    ///
    /// # Errors
    /// [`crate::Error::Argument`] for settings outside their domains.
    pub fn build(&self, brdf: &Arc<Measured>) -> Result<Sampler> {
        Ok(match self {
            Self::Cosine => Sampler::Cosine(Cosine),
            Self::AdaptiveDisc(settings) => {
                Sampler::AdaptiveDisc(AdaptiveDisc::build(brdf.clone(), *settings)?)
            }
            Self::CascadeCdf(settings) => Sampler::CascadeCdf(CascadeCdf::build(&**brdf, *settings)?),
        })
    }
}

/// A sampler of any of the kinds here.
#[derive(Clone, Debug)]
pub enum Sampler {
    /// Uniform on the disc.
    Cosine(Cosine),
    /// Quadtrees on the disc.
    AdaptiveDisc(AdaptiveDisc),
    /// CDFs of the half vector.
    CascadeCdf(CascadeCdf),
}

impl Sampler {
    /// What it was built from.
    pub fn spec(&self) -> SamplerSpec {
        match self {
            Self::Cosine(_) => SamplerSpec::Cosine,
            Self::AdaptiveDisc(s) => SamplerSpec::AdaptiveDisc(*s.settings()),
            Self::CascadeCdf(s) => SamplerSpec::CascadeCdf(*s.settings()),
        }
    }

    /// The sampler behind the common interface.
    pub fn as_dyn(&self) -> &dyn DirectionSampler {
        match self {
            Self::Cosine(s) => s,
            Self::AdaptiveDisc(s) => s,
            Self::CascadeCdf(s) => s,
        }
    }
}

impl DirectionSampler for Sampler {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        self.as_dyn().sample(wo, u)
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.as_dyn().pdf(wo, wi)
    }

    fn bytes(&self) -> usize {
        self.as_dyn().bytes()
    }

    fn sample_many(&self, wo: Vec3, count: usize, seed: u64) -> Vec<Option<DirectionSample>> {
        self.as_dyn().sample_many(wo, count, seed)
    }
}
