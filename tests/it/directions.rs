//! Several directions of the BRDF at each vertex.

use std::sync::Arc;

use merlkit::SamplerSpec;
use merlkit::direction_sampler::{DirectionSample, DirectionSampler};
use merlkit::glam::{Vec2, Vec3};
use merlkit::light::{EnvironmentSource, LightSpec};
use merlkit::material::Loaded;
use merlkit::render::{PlanRequest, SceneSpec, Strategy};
use merlkit::sampler::Cosine;

use crate::scene_plans::{assert_same, compare, draw, draw_by, read};

/// The strategies that draw them.
fn strategies() -> [Strategy; 2] {
    [Strategy::default(), Strategy::Brdf]
}

/// A lamp that is weighted, with paths of several bounces; and an environment with tables.
fn scenes() -> [(&'static str, SceneSpec); 2] {
    let mut studio = read("jar.toml");
    studio.lights = vec![LightSpec::Environment(EnvironmentSource::Studio)];
    [("room", read("room.toml")), ("jar", studio)]
}

fn build(material: &Loaded, text: &str) -> Arc<dyn DirectionSampler> {
    let spec: SamplerSpec = text.parse().unwrap();
    spec.build(material).unwrap().shared()
}

/// By one descent of the disc, and by single draws of others: the same picture within noise.
#[test]
fn several_directions_give_the_picture_of_one() {
    for (name, spec) in scenes() {
        let one = draw(&spec, PlanRequest::AsNeeded, 1);
        for strategy in strategies() {
            for (sampler, directions) in [("adaptive-disc:tables=4", 9), ("cosine", 4)] {
                let several = SceneSpec {
                    directions,
                    strategy,
                    ..spec.clone()
                };
                let film = draw_by(&several, PlanRequest::AsNeeded, 2, |m| build(m, sampler));
                let name = format!("{name}, {strategy:?}, {sampler}");
                assert_same(&one, &film, &name);
            }
        }
    }
}

/// A sampler that leaves out the last of each four draws, and is right where one is drawn alone.
struct Forgetful;

impl DirectionSampler for Forgetful {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        Cosine.sample(wo, u)
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        Cosine.pdf(wo, wi)
    }

    fn bytes(&self) -> usize {
        0
    }

    fn draw_stratified(&self, wo: Vec3, count: usize, seed: u64) -> Vec<Option<DirectionSample>> {
        let mut draws = Cosine.draw_stratified(wo, count, seed);
        draws[count - 1] = None;
        draws
    }
}

/// The test above can fail.
#[test]
fn a_draw_that_is_left_out_is_missed() {
    for (name, spec) in scenes() {
        let several = SceneSpec {
            directions: 4,
            ..spec.clone()
        };
        let right = draw(&spec, PlanRequest::AsNeeded, 1);
        let wrong = draw_by(&several, PlanRequest::AsNeeded, 2, |_| Arc::new(Forgetful));
        let squares: f64 = compare(&right, &wrong).iter().map(|z| z * z).sum();
        assert!(squares > 200.0, "{name}: {squares}");
    }
}

/// Nothing is drawn together where directions find no light, and 0 directions are refused.
#[test]
fn directions_that_look_for_nothing_are_not_drawn() {
    let mut spec = read("spheres.toml");
    let one = draw(&spec, PlanRequest::AsNeeded, 3);
    spec.directions = 16;
    let several = draw(&spec, PlanRequest::AsNeeded, 3);
    for pixel in 0..24 * 24 {
        let (x, y) = (pixel % 24, pixel / 24);
        assert_eq!(one.mean(x, y), several.mean(x, y));
    }
    spec.directions = 0;
    let refused = merlkit::render::Scene::build(&spec, PlanRequest::AsNeeded, |_, _| {
        unreachable!("nothing is loaded")
    });
    let error = refused.err().unwrap().to_string();
    assert!(error.contains("0 directions"), "{error}");
}
