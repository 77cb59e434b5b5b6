//! The sphere of nickel under the studio that is rendered in all sizes.

use merlkit::light::{EnvironmentSource, LightSpec};
use merlkit::points::PointSet;
use merlkit::render::{
    Budget, Film, PlanRequest, RenderSettings, Scene, SceneSpec, Surface, render,
};
use merlkit::sampler::HalfVectorSettings;
use merlkit::{LookupRule, Material, SamplerSpec};

pub struct Picture {
    scene: Scene,
}

impl Picture {
    /// Linear lookup, the half-vector table of 64 KB.
    pub fn new() -> Self {
        let spec = SceneSpec {
            lights: vec![LightSpec::Environment(EnvironmentSource::Studio)],
            ..SceneSpec::row(&["nickel".to_owned()], 1.0)
        };
        let scene = Scene::build(&spec, PlanRequest::AsNeeded, |_, _| {
            let material = Material::resolve("nickel")?.load(LookupRule::Linear)?;
            let sampler = SamplerSpec::new(HalfVectorSettings::default()).build(&material)?;
            Ok(Surface {
                brdf: material.brdf().clone(),
                sampler: Some(sampler.shared()),
            })
        });
        Self {
            scene: scene.expect("a scene"),
        }
    }

    pub fn render(&self, side: usize, paths: u64, progress: &(dyn Fn(usize) + Sync)) -> Film {
        let settings = RenderSettings {
            width: side,
            height: side,
            seed: 1,
            points: PointSet::Lattice,
            budget: Budget::Even(paths),
        };
        let rendered = render(&self.scene, &settings, progress);
        rendered.expect("a picture").film
    }
}
