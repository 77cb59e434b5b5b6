//! What each effect costs: scenes by their plan, with each effect that it leaves out forced on, and with everything on.
//!
//! Also what an environment costs: to prepare, and for each direction.
//! Each variant is checked against the plan's picture before it is timed. `cargo bench --bench render`.

use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec2, DVec3};
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

fn effects(c: &mut Criterion) {
    let table = Arc::new(decode_embedded("blue-metallic-paint").expect("an embedded material"));
    let surface = |_, _| {
        let brdf = Arc::new(MerlBrdf::new(table.clone(), LookupRule::Floor));
        Ok(Surface {
            brdf,
            sampler: Some(Arc::new(Cosine)),
        })
    };
    for (name, spec) in scenes() {
        let mut group = c.benchmark_group(name);
        let paths = (SETTINGS.width * SETTINGS.height) as u64 * PATHS;
        group
            .sample_size(10)
            .measurement_time(Duration::from_secs(2))
            .throughput(Throughput::Elements(paths));
        let mut expected = None;
        for (variant, request) in variants(&spec) {
            let scene = Scene::build(&spec, request, surface).expect("a scene");
            let picture = || {
                let rendered = render(&scene, &SETTINGS, &|_| {});
                rendered.expect("a picture").film
            };
            let value = mean(&picture());
            let planned = *expected.get_or_insert(value);
            assert!(
                (value / planned - 1.0).abs() < 0.02,
                "{name}, {variant}: {value}, planned {planned}"
            );
            group.bench_function(variant, |b| b.iter(|| black_box(picture())));
        }
        group.finish();
    }
}

/// What is prepared before the first path: the sampling tables of an environment.
fn preparation(c: &mut Criterion) {
    let mut group = c.benchmark_group("built-in environment");
    group.sample_size(10);
    for (name, sampling) in [
        ("without tables", SkySampling::Uniform),
        ("with tables", SkySampling::Importance),
    ] {
        let build = || studio(sampling);
        assert_eq!(build().table_bytes() > 0, name == "with tables");
        group.bench_function(name, |b| b.iter(|| black_box(build())));
    }
    group.finish();
}

/// Directions towards an environment and what rays see of it, one by one and many at once.
fn directions(c: &mut Criterion) {
    const COUNT: usize = 4096;
    let sky: &dyn Light = &studio(SkySampling::Importance);
    let from = [DVec3::ZERO; COUNT];
    let reach = [f64::INFINITY; COUNT];
    let point = |i: usize| PointSet::Random.point(1, i as u64, 0).as_dvec2();
    let u: [DVec2; COUNT] = std::array::from_fn(point);
    let wi = u.map(|u| sky.sample(DVec3::ZERO, u).expect("a direction").wi);
    let (mut sampled, mut emitted) = ([None; COUNT], [None; COUNT]);
    sky.sample_batch(&from, &u, &mut sampled);
    sky.emitted_batch(&from, &wi, &reach, &mut emitted);
    for (sampled, emitted) in sampled.iter().zip(&emitted) {
        let (sampled, emitted) = (sampled.expect("a draw"), emitted.expect("a sky"));
        assert_eq!(sampled.pdf, emitted.pdf);
        let rounding = 1e-5 * sampled.radiance.max_element();
        assert!(sampled.radiance.abs_diff_eq(emitted.radiance, rounding));
    }
    let mut group = c.benchmark_group("a direction to the built-in environment");
    group
        .throughput(Throughput::Elements(COUNT as u64))
        .measurement_time(Duration::from_secs(1));
    group.bench_function("sample", |b| {
        b.iter(|| {
            for (s, &u) in sampled.iter_mut().zip(&u) {
                *s = black_box(sky).sample(DVec3::ZERO, u);
            }
            black_box(sampled[COUNT - 1])
        })
    });
    group.bench_function("sample_batch", |b| {
        b.iter(|| {
            for ((s, u), from) in sampled
                .chunks_mut(64)
                .zip(u.chunks(64))
                .zip(from.chunks(64))
            {
                black_box(sky).sample_batch(from, u, s);
            }
            black_box(sampled[COUNT - 1])
        })
    });
    group.bench_function("emitted_along", |b| {
        b.iter(|| {
            for (s, &wi) in emitted.iter_mut().zip(&wi) {
                *s = black_box(sky).emitted_along(DVec3::ZERO, wi, f64::INFINITY);
            }
            black_box(emitted[COUNT - 1])
        })
    });
    group.bench_function("emitted_batch", |b| {
        b.iter(|| {
            let rays = wi.chunks(64).zip(from.chunks(64)).zip(reach.chunks(64));
            for (s, ((wi, from), reach)) in emitted.chunks_mut(64).zip(rays) {
                black_box(sky).emitted_batch(from, wi, reach, s);
            }
            black_box(emitted[COUNT - 1])
        })
    });
    group.finish();
}

criterion_group!(benches, effects, preparation, directions);
criterion_main!(benches);
