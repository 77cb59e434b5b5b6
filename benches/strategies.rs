//! What each way of finding light costs and how exact it is: errors at equal samples of a point and of a picture under the
//! studio, and pictures of a target error. `cargo bench --bench strategies`.

use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;
use merlkit::brdf::Importance;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::distribution::Heuristic;
use merlkit::geometry::{POINTS_PER_BIN, spherical};
use merlkit::light::{EnvironmentSource, LightSpec, SkySampling, studio};
use merlkit::material::merl::decode_embedded;
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::points::PointSet;
use merlkit::render::{
    Budget, Film, PlanRequest, RenderSettings, Scene, SceneSpec, Strategy, Surface, render,
};
use merlkit::sampler::{Cosine, HalfVectorSettings, HalfVectorTable};
use merlkit_evaluate::measure::convergence::{Incident, LitPoint, Runs, Technique};

const MATERIALS: [&str; 3] = ["nickel", "teflon", "chrome"];
const N: u64 = 64;
const SETTINGS: RenderSettings = RenderSettings {
    width: 64,
    height: 64,
    seed: 1,
    points: PointSet::Sobol,
    budget: Budget::Even(N),
};

const WAYS: [(&str, Technique, Strategy); 6] = [
    ("light", Technique::Light, Strategy::Light),
    ("brdf", Technique::Brdf, Strategy::Brdf),
    (
        "mis, power",
        Technique::Mis(Heuristic::Power),
        Strategy::Mis(Heuristic::Power),
    ),
    (
        "mis, balance",
        Technique::Mis(Heuristic::Balance),
        Strategy::Mis(Heuristic::Balance),
    ),
    (
        "ris, 4 candidates",
        Technique::Ris(4),
        Strategy::Ris { candidates: 4 },
    ),
    (
        "ris, 16 candidates",
        Technique::Ris(16),
        Strategy::Ris { candidates: 16 },
    ),
];

/// A material and its samplers, by name.
struct Material {
    brdf: Arc<MerlBrdf>,
    samplers: [(&'static str, Arc<dyn DirectionSampler>); 2],
}

impl Material {
    fn load(name: &str) -> Self {
        let table = decode_embedded(name).expect("an embedded material");
        let brdf = Arc::new(MerlBrdf::new(Arc::new(table), LookupRule::Floor));
        let table =
            HalfVectorTable::build(&*brdf, HalfVectorSettings::default()).expect("a sampler");
        Self {
            brdf,
            samplers: [
                ("half-vector", Arc::new(table)),
                ("cosine", Arc::new(Cosine)),
            ],
        }
    }
}

/// Relative RMSE of a point's estimates over 400 seeds, the root mean square of three angles of view.
fn point_error(material: &Material, sampler: usize, technique: Technique) -> f64 {
    let sky = studio(SkySampling::Importance);
    let runs = Runs {
        points: PointSet::Sobol,
        seeds: 400,
        first_seed: 1,
    };
    let square = |degrees: f64| {
        let wo = spherical(degrees.to_radians(), 0.8).as_vec3();
        let light = Incident::Environment(&sky);
        let point = LitPoint {
            brdf: &*material.brdf,
            importance: Importance::Mean,
            light,
            wo,
        };
        let (sampler, reference) = (
            &*material.samplers[sampler].1,
            point.reference(POINTS_PER_BIN),
        );
        let errors = point.errors_by(technique, sampler, reference, &[N as usize], runs);
        errors.expect("errors")[0].rmse.powi(2)
    };
    ([15.0, 45.0, 70.0].map(square).iter().sum::<f64>() / 3.0).sqrt()
}

fn scene(material: &Material, sampler: usize, strategy: Strategy) -> Scene {
    let lights = vec![LightSpec::Environment(EnvironmentSource::Studio)];
    let spec = SceneSpec {
        lights,
        strategy,
        ..SceneSpec::row(&["sphere".into()], 1.0)
    };
    let sampler = Some(material.samplers[sampler].1.clone());
    let surface = |_, _| {
        Ok(Surface {
            brdf: material.brdf.clone(),
            sampler: sampler.clone(),
        })
    };
    Scene::build(&spec, PlanRequest::AsNeeded, surface).expect("a scene")
}

fn truth(material: &Material) -> Film {
    let scene = scene(material, 0, Strategy::default());
    let settings = RenderSettings {
        budget: Budget::Even(1 << 13),
        seed: 99,
        ..SETTINGS
    };
    let rendered = render(&scene, &settings, &|_| {});
    rendered.expect("a picture").film
}

/// Relative RMSE of the middle half of the picture, where the sphere is, and seconds to render it.
fn picture_error(
    material: &Material,
    sampler: usize,
    strategy: Strategy,
    truth: &Film,
) -> (f64, f64) {
    let scene = scene(material, sampler, strategy);
    let start = Instant::now();
    let rendered = render(&scene, &SETTINGS, &|_| {});
    let seconds = start.elapsed().as_secs_f64();
    let film = rendered.expect("a picture").film;
    let (mut mean, mut square) = (DVec3::ZERO, DVec3::ZERO);
    let middle = SETTINGS.width / 4..3 * SETTINGS.width / 4;
    for (x, y) in middle
        .clone()
        .flat_map(|y| middle.clone().map(move |x| (x, y)))
    {
        mean += truth.mean(x, y);
        square += (film.mean(x, y) - truth.mean(x, y)).powf(2.0);
    }
    let values = 3.0 * (middle.len() * middle.len()) as f64;
    (
        (square.element_sum() * values).sqrt() / mean.element_sum(),
        seconds,
    )
}

fn equal_samples(materials: &[Material], truths: &[Film]) {
    println!("relative RMSE at {N} samples under the studio: point, picture (and its seconds)");
    for sampler in 0..2 {
        for (name, technique, strategy) in WAYS {
            let cells = materials.iter().zip(truths).map(|(material, truth)| {
                let (error, seconds) = picture_error(material, sampler, strategy, truth);
                let point = point_error(material, sampler, technique);
                format!(
                    "{:.2} %, {:.2} % ({seconds:.2} s)",
                    100.0 * point,
                    100.0 * error
                )
            });
            let cells: Vec<String> = cells.collect();
            println!(
                "| {} | {name} | {} |",
                materials[0].samplers[sampler].0,
                cells.join(" | ")
            );
        }
    }
}

fn target_errors(materials: &[Material], truths: &[Film]) {
    println!("target error: estimated, true, paths per pixel of 64 × 64, seconds");
    for target in [0.05, 0.02] {
        let cells = materials.iter().zip(truths).map(|(material, truth)| {
            let scene = scene(material, 0, Strategy::default());
            let start = Instant::now();
            let settings = RenderSettings {
                budget: Budget::ToError {
                    error: target,
                    most: 1 << 13,
                },
                ..SETTINGS
            };
            let rendered = render(&scene, &settings, &|_| {}).expect("a picture");
            let seconds = start.elapsed().as_secs_f64();
            let refined = rendered.refinement.expect("a target error");
            let error = refined
                .error_against(&rendered.film, truth)
                .expect("a reference of this size");
            assert!(error < 1.2 * target, "{error} for {target}");
            let paths = refined.traced as f64 / (SETTINGS.width * SETTINGS.height) as f64;
            format!(
                "{:.2} %, {:.2} %, {paths:.0}, {seconds:.2} s",
                100.0 * refined.error(),
                100.0 * error
            )
        });
        println!(
            "| {} % | {} |",
            100.0 * target,
            cells.collect::<Vec<_>>().join(" | ")
        );
    }
}

fn main() {
    let materials = MATERIALS.map(Material::load);
    let truths = materials.each_ref().map(truth);
    println!("{}", MATERIALS.join(", "));
    equal_samples(&materials, &truths);
    target_errors(&materials, &truths);
}
