//! What each effect costs: scenes by their plan, with each effect that it leaves out forced on, and with everything on.
//!
//! Also what an environment costs: to prepare, and for each direction.
//! Each variant is checked against the plan's picture before it is timed. `cargo bench --bench render`.

mod harness;

use std::hint::black_box;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use harness::{Group, Harness};
use merlkit::light::{EnvironmentSource, Light, LightSpec, SkySampling, studio};
use merlkit::material::merl::decode_embedded;
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::points::PointSet;
use merlkit::render::{
    Budget, Effect, EffectPlan, Film, PlanRequest, RenderSettings, Scene, SceneSpec, Surface,
    render,
};
use merlkit::sampler::Cosine;

const PATHS: u64 = 8;
const SETTINGS: RenderSettings = RenderSettings {
    width: 96,
    height: 64,
    seed: 1,
    points: PointSet::Sobol,
    budget: Budget::Even(PATHS),
};

fn row(count: usize) -> SceneSpec {
    let names: Vec<String> = (0..count).map(|i| i.to_string()).collect();
    SceneSpec::row(&names, 1.5)
}

fn scenes() -> [(&'static str, SceneSpec); 5] {
    let sky = LightSpec::Environment(EnvironmentSource::Studio);
    let lit = |spec: SceneSpec, light: LightSpec| SceneSpec {
        lights: vec![light],
        ..spec
    };
    let floor = |spec: SceneSpec| SceneSpec {
        floor: Some(0.35),
        ..spec
    };
    [
        (
            "one sphere, point",
            lit(row(1), row(1).light("point").expect("a light")),
        ),
        (
            "one sphere, area",
            lit(row(1), row(1).light("area").expect("a light")),
        ),
        ("one sphere, environment", lit(row(1), sky.clone())),
        (
            "three spheres and floor, directional",
            lit(floor(row(3)), row(3).light("directional").expect("a light")),
        ),
        (
            "three spheres and floor, environment",
            lit(floor(row(3)), sky),
        ),
    ]
}

/// The plan, each effect that it leaves out, and everything.
fn variants(spec: &SceneSpec) -> Vec<(String, PlanRequest)> {
    let plan = EffectPlan::for_scene(spec, PlanRequest::AsNeeded);
    let mut all = vec![("as planned".to_owned(), PlanRequest::AsNeeded)];
    for effect in Effect::ALL.into_iter().filter(|e| !plan.is_on(*e)) {
        all.push((format!("plus {}", effect.name()), PlanRequest::Plus(effect)));
    }
    all.push(("everything".to_owned(), PlanRequest::Everything));
    all
}

fn mean(film: &Film) -> f64 {
    let (width, height) = (film.width(), film.height());
    (0..width * height)
        .map(|i| film.mean(i % width, i / width).y)
        .sum::<f64>()
        / (width * height) as f64
}

fn picture(scene: &Scene) -> Film {
    let rendered = render(scene, &SETTINGS, &|_| {});
    rendered.expect("a picture").film
}

fn effects(harness: &mut Harness) {
    let table = Arc::new(decode_embedded("blue-metallic-paint").expect("an embedded material"));
    let brdf = Arc::new(MerlBrdf::new(table, LookupRule::Floor));
    let paths = (SETTINGS.width * SETTINGS.height) * PATHS as usize;
    for (name, spec) in scenes() {
        let mut group = Group::new(name, "path");
        let mut expected = None;
        for (variant, request) in variants(&spec) {
            let scene = Scene::build(&spec, request, |_, _| {
                Ok(Surface {
                    brdf: brdf.clone(),
                    sampler: Some(Arc::new(Cosine)),
                })
            });
            let scene = scene.expect("a scene");
            let value = mean(&picture(&scene));
            let planned = *expected.get_or_insert(value);
            assert!(
                (value / planned - 1.0).abs() < 0.02,
                "{name}, {variant}: {value}, planned {planned}"
            );
            group.add(variant, paths, move || picture(&scene));
        }
        harness.run(group);
    }
}

/// What is prepared before the first path: the sampling tables of an environment.
fn preparation(harness: &mut Harness) {
    assert_eq!(studio(SkySampling::Uniform).table_bytes(), 0);
    assert!(studio(SkySampling::Importance).table_bytes() > 0);
    let mut group = Group::new("built-in environment", "map");
    group.add("without tables", 1, || studio(SkySampling::Uniform));
    group.add("with tables", 1, || studio(SkySampling::Importance));
    harness.run(group);
}

/// Directions of a batch.
const COUNT: usize = 4096;
/// Directions that a renderer asks for at once.
const LANES: usize = 64;

/// Directions towards an environment and what rays see of it, one by one and many at once.
fn directions(harness: &mut Harness) {
    let sky: &dyn Light = &studio(SkySampling::Importance);
    let from = [DVec3::ZERO; COUNT];
    let reach = [f64::INFINITY; COUNT];
    let u: [DVec2; COUNT] =
        std::array::from_fn(|i| PointSet::Random.point(1, i as u64, 0).as_dvec2());
    let wi = u.map(|u| sky.sample(DVec3::ZERO, u).expect("a direction").wi);
    let (mut sampled, mut emitted) = (vec![None; COUNT], vec![None; COUNT]);
    sky.sample_batch(&from, &u, &mut sampled);
    sky.emitted_batch(&from, &wi, &reach, &mut emitted);
    for (sampled, emitted) in sampled.iter().zip(&emitted) {
        let (sampled, emitted) = (sampled.expect("a draw"), emitted.expect("a sky"));
        assert_eq!(sampled.pdf, emitted.pdf);
        let rounding = 1e-5 * sampled.radiance.max_element();
        assert!(sampled.radiance.abs_diff_eq(emitted.radiance, rounding));
    }
    let (mut sampled_singly, mut emitted_singly) = (sampled.clone(), emitted.clone());
    let mut group = Group::new("a direction to the built-in environment", "direction");
    group.add("sample_batch", COUNT, || {
        let lanes = u.chunks(LANES).zip(from.chunks(LANES));
        for (out, (u, from)) in sampled.chunks_mut(LANES).zip(lanes) {
            black_box(sky).sample_batch(from, u, out);
        }
    });
    group.add("sample", COUNT, || {
        for (out, &u) in sampled_singly.iter_mut().zip(&u) {
            *out = black_box(sky).sample(DVec3::ZERO, u);
        }
    });
    group.add("emitted_batch", COUNT, || {
        let rays = wi.chunks(LANES).zip(from.chunks(LANES));
        let rays = rays.zip(reach.chunks(LANES));
        for (out, ((wi, from), reach)) in emitted.chunks_mut(LANES).zip(rays) {
            black_box(sky).emitted_batch(from, wi, reach, out);
        }
    });
    group.add("emitted_along", COUNT, || {
        for (out, &wi) in emitted_singly.iter_mut().zip(&wi) {
            *out = black_box(sky).emitted_along(DVec3::ZERO, wi, f64::INFINITY);
        }
    });
    harness.run(group);
}

fn main() {
    let mut harness = Harness::new("render");
    effects(&mut harness);
    preparation(&mut harness);
    directions(&mut harness);
}
