//! What each effect costs: scenes by their plan, with each effect that it leaves out forced on, and with everything on.
//!
//! Each variant is checked against the plan's picture before it is timed. `cargo bench --bench render`.

use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use merlkit::brdf::{LookupRule, Measured};
use merlkit::merl::decode_embedded;
use merlkit::points::PointSet;
use merlkit::render::{
    Effect, EffectPlan, EnvironmentSource, Film, LightSpec, Scene, SceneSpec, Settings, Surface, render,
};
use merlkit::sampler::Cosine;

const SETTINGS: Settings = Settings { width: 96, height: 64, samples: 8, seed: 1, points: PointSet::Sobol };

fn row(count: usize) -> SceneSpec {
    let names: Vec<String> = (0..count).map(|i| i.to_string()).collect();
    SceneSpec::row(&names, 1.5)
}

fn scenes() -> [(&'static str, SceneSpec); 5] {
    let studio = LightSpec::Environment(EnvironmentSource::Studio);
    let lit = |spec: SceneSpec, light: LightSpec| SceneSpec { lights: vec![light], ..spec };
    let floor = |spec: SceneSpec| SceneSpec { floor: Some(0.35), ..spec };
    [
        ("one sphere, point", lit(row(1), row(1).row_point())),
        ("one sphere, area", lit(row(1), row(1).row_area())),
        ("one sphere, environment", lit(row(1), studio.clone())),
        ("three spheres and floor, directional", lit(floor(row(3)), row(3).row_directional())),
        ("three spheres and floor, environment", lit(floor(row(3)), studio)),
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
    (0..width * height).map(|i| film.mean(i % width, i / width).y).sum::<f64>() / (width * height) as f64
}

fn effects(c: &mut Criterion) {
    let table = Arc::new(decode_embedded("blue-metallic-paint").expect("an embedded material"));
    let surface = |_, _| {
        let brdf = Arc::new(Measured::new(table.clone(), LookupRule::Floor));
        Ok(Surface { brdf, sampler: Some(Arc::new(Cosine)) })
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
            assert!((value / planned - 1.0).abs() < 0.02, "{name}, {variant}: {value}, planned {planned}");
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
        ("without tables", merlkit::light::SkySampling::Uniform),
        ("with tables", merlkit::light::SkySampling::Importance),
    ] {
        let build = || merlkit::light::studio(sampling).expect("a sky");
        assert_eq!(build().table_bytes() > 0, name == "with tables");
        group.bench_function(name, |b| b.iter(|| black_box(build())));
    }
    group.finish();
}

criterion_group!(benches, effects, preparation);
criterion_main!(benches);
