//! The sampler that a material's own file holds, such as a `.bsdf` file's density.

use std::sync::Arc;

use super::{Field, Method, Needs, Settings};
use crate::direction_sampler::DirectionSampler;
use crate::material::Loaded;
use crate::sampler::store::TensorWriter;
use crate::{Error, Result};

/// A material's own sampler has no settings.
///
/// See [`DirectionSampler`](crate::direction_sampler::DirectionSampler) for an example of drawing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct OwnSamplerSettings {}

impl Settings for OwnSamplerSettings {
    type Method = OwnSampler;

    fn fields() -> Vec<Field<Self>> {
        Vec::new()
    }
}

/// A material's own sampler.
///
/// See [`DirectionSampler`](crate::direction_sampler::DirectionSampler) for an example of drawing.
#[derive(Clone)]
pub struct OwnSampler(Arc<dyn DirectionSampler>);

impl Method for OwnSampler {
    const NAME: &'static str = "file";
    const SUMMARY: &'static str = "the density that a .bsdf file itself holds";
    const NEEDS: Needs = Needs::OwnSampler;
    const IS_STORED: bool = false;
    type Settings = OwnSamplerSettings;

    fn build(material: &Loaded, _: &OwnSamplerSettings) -> Result<Self> {
        match material.own_sampler() {
            Some(sampler) => Ok(Self(sampler.clone())),
            None => Err(Error::argument(
                format!("the sampler file needs {}", Self::NEEDS),
                "choose another sampler",
            )),
        }
    }

    fn settings(&self) -> OwnSamplerSettings {
        OwnSamplerSettings {}
    }

    fn sampler(self: Arc<Self>) -> Arc<dyn DirectionSampler> {
        self.0.clone()
    }

    fn write(&self, _: &mut TensorWriter) -> Result<()> {
        Err(Error::argument(
            "the sampler file is stored in the .bsdf file already",
            "name that file in its place",
        ))
    }
}
