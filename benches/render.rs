//! What each effect costs: scenes by their plan, with each effect that it leaves out forced on, and with everything on.
//!
//! Also what an environment costs: to prepare, and for each direction.
//! Each variant is checked against the plan's picture before it is timed. `cargo bench --bench render`.

use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec2, DVec3};
use merlkit::light::{Light, SkySampling, studio};
use merlkit::material::merl::decode_embedded;
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::points::PointSet;
use merlkit::render::{
    Effect, EffectPlan, EnvironmentSource, Film, LightSpec, Scene, SceneSpec, Settings, Surface,
    render,
};
use merlkit::sampler::Cosine;

const SETTINGS: Settings = Settings {
    width: 96,
    height: 64,
    samples: 8,
    seed: 1,
    points: PointSet::Sobol,
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
        ("one sphere, point", lit(row(1), row(1).row_point())),
        ("one sphere, area", lit(row(1), row(1).row_area())),
        ("one sphere, environment", lit(row(1), sky.clone())),
        (
            "three spheres and floor, directional",
            lit(floor(row(3)), row(3).row_directional()),
        ),
        (
            "three spheres and floor, environment",
            lit(floor(row(3)), sky),
        ),
    ]
}

/// The plan, each effect that it leaves out, and everything.
fn variants(spec: &SceneSpec) -> Vec<(String, EffectPlan)> {
    let plan = EffectPlan::of(spec);
    let mut all = vec![("as planned".to_owned(), plan.clone())];
    for effect in Effect::ALL.into_iter().filter(|e| !plan.is_on(*e)) {
        all.push((format!("plus {}", effect.name()), plan.clone().with(effect)));
    }
    all.push(("everything".to_owned(), EffectPlan::everything(spec)));
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
        let paths = (SETTINGS.width * SETTINGS.height) as u64 * SETTINGS.samples;
        group
            .sample_size(10)
            .measurement_time(Duration::from_secs(2))
            .throughput(Throughput::Elements(paths));
        let mut expected = None;
        for (variant, plan) in variants(&spec) {
            let scene = Scene::build(&spec, &plan, surface).expect("a scene");
            let picture = || render(&scene, &plan, &SETTINGS, &|_| {}).expect("a picture");
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
        let build = || studio(sampling).expect("a sky");
        assert_eq!(build().table_bytes() > 0, name == "with tables");
        group.bench_function(name, |b| b.iter(|| black_box(build())));
    }
    group.finish();
}

/// Directions towards an environment and what rays see of it, one by one and many at once.
fn directions(c: &mut Criterion) {
    const COUNT: usize = 4096;
    let sky: &dyn Light = &studio(SkySampling::Importance).expect("a sky");
    let from = [DVec3::ZERO; COUNT];
    let reach = [f64::INFINITY; COUNT];
    let point = |i: usize| PointSet::Random.point(1, i as u64, 0).as_dvec2();
    let u: [DVec2; COUNT] = std::array::from_fn(point);
    let wi = u.map(|u| sky.sample(DVec3::ZERO, u).expect("a direction").wi);
    let (mut sampled, mut seen) = ([None; COUNT], [None; COUNT]);
    sky.sample_many(&from, &u, &mut sampled);
    sky.seen_many(&from, &wi, &reach, &mut seen);
    for (sampled, seen) in sampled.iter().zip(&seen) {
        assert_eq!(
            sampled.map(|s| (s.radiance, s.pdf)),
            seen.map(|s| (s.radiance, s.pdf))
        );
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
    group.bench_function("sample_many", |b| {
        b.iter(|| {
            for ((s, u), from) in sampled
                .chunks_mut(64)
                .zip(u.chunks(64))
                .zip(from.chunks(64))
            {
                black_box(sky).sample_many(from, u, s);
            }
            black_box(sampled[COUNT - 1])
        })
    });
    group.bench_function("seen", |b| {
        b.iter(|| {
            for (s, &wi) in seen.iter_mut().zip(&wi) {
                *s = black_box(sky).seen(DVec3::ZERO, wi, f64::INFINITY);
            }
            black_box(seen[COUNT - 1])
        })
    });
    group.bench_function("seen_many", |b| {
        b.iter(|| {
            let rays = wi.chunks(64).zip(from.chunks(64)).zip(reach.chunks(64));
            for (s, ((wi, from), reach)) in seen.chunks_mut(64).zip(rays) {
                black_box(sky).seen_many(from, wi, reach, s);
            }
            black_box(seen[COUNT - 1])
        })
    });
    group.finish();
}

criterion_group!(benches, effects, preparation, directions);
criterion_main!(benches);
