//! Errors of pictures by how their numbers are spread, and by where their paths go: a sphere under the studio. Then CPU time of
//! a path. `cargo bench --bench points`.

mod harness;

use std::sync::Arc;

use harness::{Group, Harness};
use merlkit::direction_sampler::DirectionSampler;
use merlkit::light::{EnvironmentSource, LightSpec};
use merlkit::material::merl::decode_embedded;
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::points::PointSet;
use merlkit::render::{
    Budget, Film, PlanRequest, RenderSettings, Scene, SceneSpec, Surface, render,
};
use merlkit::sampler::{HalfVectorSettings, HalfVectorTable};

const MATERIALS: [&str; 5] = [
    "nickel",
    "chrome",
    "blue-metallic-paint",
    "teflon",
    "red-plastic",
];
/// Pixels a side.
const SIDE: usize = 128;
const SAMPLES: [u64; 3] = [16, 40, 64];
/// Pixels a side of pictures of many paths.
const SMALL_SIDE: usize = 32;
const MANY_SAMPLES: [u64; 6] = [64, 128, 256, 512, 1024, 4096];
/// Pictures of each, of which the error is the spread.
const SEEDS: u64 = 8;
/// Pixels a side and paths of pictures that are timed.
const TIMED: (usize, u64) = (64, 64);

/// How paths are spread, over the unit square and over the picture.
#[derive(Clone, Copy)]
struct Spread {
    name: &'static str,
    points: PointSet,
    adaptive: bool,
}

const SPREADS: [Spread; 4] = [
    Spread {
        name: "random",
        points: PointSet::Random,
        adaptive: false,
    },
    Spread {
        name: "sobol",
        points: PointSet::Sobol,
        adaptive: false,
    },
    Spread {
        name: "lattice",
        points: PointSet::Lattice,
        adaptive: false,
    },
    Spread {
        name: "adaptive",
        points: PointSet::Lattice,
        adaptive: true,
    },
];

struct Picture {
    scene: Scene,
}

impl Picture {
    fn new(material: &str) -> Self {
        let lights = vec![LightSpec::Environment(EnvironmentSource::Studio)];
        let spec = SceneSpec {
            lights,
            ..SceneSpec::row(&[material.to_owned()], 1.0)
        };
        let surface = |_, _| {
            let table = Arc::new(decode_embedded(material).expect("an embedded material"));
            let brdf = Arc::new(MerlBrdf::new(table, LookupRule::Linear));
            let sampler = HalfVectorTable::build(&*brdf, HalfVectorSettings::default())?;
            Ok(Surface {
                brdf,
                sampler: Some(Arc::new(sampler) as Arc<dyn DirectionSampler>),
            })
        };
        let scene = Scene::build(&spec, PlanRequest::AsNeeded, surface).expect("a scene");
        Self { scene }
    }

    fn film(&self, spread: Spread, side: usize, samples: u64, seed: u64) -> Film {
        let budget = if spread.adaptive {
            Budget::Adaptive(samples)
        } else {
            Budget::Even(samples)
        };
        let settings = RenderSettings {
            width: side,
            height: side,
            seed,
            points: spread.points,
            budget,
        };
        let rendered = render(&self.scene, &settings, &|_| {});
        rendered.expect("a picture").film
    }

    /// relMSE over all pixels from the spread of seeds.
    fn error(&self, spread: Spread, side: usize, samples: u64) -> f64 {
        let films: Vec<Film> = (0..SEEDS)
            .map(|seed| self.film(spread, side, samples, seed))
            .collect();
        let n = SEEDS as f64;
        let moments: Vec<(f64, f64)> = (0..side * side)
            .map(|i| {
                let values: Vec<f64> = films
                    .iter()
                    .map(|f| f.mean(i % side, i / side).element_sum() / 3.0)
                    .collect();
                let mean = values.iter().sum::<f64>() / n;
                (
                    mean,
                    values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0),
                )
            })
            .collect();
        let pixels = moments.len() as f64;
        let level = moments.iter().map(|m| m.0).sum::<f64>() / pixels;
        let error =
            |&(mean, variance): &(f64, f64)| variance / (mean * mean + 0.01 * level * level);
        moments.iter().map(error).sum::<f64>() / pixels
    }
}

fn main() {
    println!(
        "{SIDE} × {SIDE} pixels, linear lookup, relMSE over all pixels from the spread of {SEEDS} seeds"
    );
    let pictures = MATERIALS.map(Picture::new);
    for (material, picture) in MATERIALS.iter().zip(&pictures) {
        for samples in SAMPLES {
            print_errors(material, picture, &SPREADS, SIDE, samples);
        }
    }
    println!("{SMALL_SIDE} × {SMALL_SIDE} pixels: from how many paths on Sobol points are ahead");
    for (material, picture) in MATERIALS.iter().zip(&pictures) {
        for samples in MANY_SAMPLES {
            // Sobol points and lattices.
            print_errors(material, picture, &SPREADS[1..3], SMALL_SIDE, samples);
        }
    }
    time_paths(&pictures);
}

/// CPU time of a path, by how paths are spread.
fn time_paths(pictures: &[Picture]) {
    let mut harness = Harness::new("points");
    let (side, samples) = TIMED;
    for (material, picture) in MATERIALS.iter().zip(pictures) {
        let mut group = Group::new(*material, "path");
        for spread in SPREADS {
            group.add(spread.name, side * side * samples as usize, move || {
                picture.film(spread, side, samples, 1)
            });
        }
        harness.run(group);
    }
}

fn print_errors(material: &str, picture: &Picture, spreads: &[Spread], side: usize, samples: u64) {
    let mut columns = Vec::new();
    for spread in spreads {
        let error = picture.error(*spread, side, samples);
        columns.push(format!("{} {error:.2e}", spread.name));
    }
    println!("{material}, {samples} paths: {}", columns.join(", "));
}
