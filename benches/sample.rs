//! One draw, draws in batches and one density of each sampler for nickel, at angles of `wo` from normal to grazing; and draws
//! and densities for pairs, each of another `wo`: alone, each waiting for the one before, and 16 to 64 at once.

use std::f32::consts::TAU;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{Vec2, Vec3};
use merlkit::Wo;
use merlkit::brdf::{Brdf, Importance};
use merlkit::color;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::geometry::{POINTS_PER_BIN, Quadrature, spherical};
use merlkit::material::Loaded;
use merlkit::material::merl::decode_embedded;
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::points::PointSet;
use merlkit::sampler::{
    AdaptiveDiscSettings, CascadeCdfSettings, CosineSettings, HalfVectorSettings, LeafChoice,
    SamplerSpec, TableChoice,
};
use merlkit_evaluate::measure::accuracy::weight_spread;

const DRAWS: u64 = 2048;
const ANGLES: [f64; 4] = [0.76, 29.75, 60.25, 84.7];

fn specs() -> [(&'static str, SamplerSpec); 9] {
    let disc = |choice| {
        SamplerSpec::new(AdaptiveDiscSettings {
            choice,
            ..Default::default()
        })
    };
    let cascade = |choice| {
        SamplerSpec::new(CascadeCdfSettings {
            choice,
            ..Default::default()
        })
    };
    [
        ("cosine", SamplerSpec::new(CosineSettings {})),
        (
            "half-vector 2KB",
            SamplerSpec::new(HalfVectorSettings::PRESETS[0].1),
        ),
        (
            "half-vector 64KB",
            SamplerSpec::new(HalfVectorSettings::default()),
        ),
        ("disc mixture", disc(TableChoice::Mixture)),
        ("disc nearest", disc(TableChoice::Nearest)),
        ("disc rejection-free", rejection_free()),
        ("cdf mixture", cascade(TableChoice::Mixture)),
        ("cdf nearest", cascade(TableChoice::Nearest)),
        ("cdf whole", SamplerSpec::new(CascadeCdfSettings::uniform())),
    ]
}

fn rejection_free() -> SamplerSpec {
    SamplerSpec::new(AdaptiveDiscSettings {
        leaves: LeafChoice::Warp,
        ..Default::default()
    })
}

/// The draws estimate the albedo, within six standard errors by quadrature.
fn assert_albedo(sampler: &dyn DirectionSampler, brdf: &MerlBrdf, wo: Vec3, points: &[Vec2]) {
    let spread = weight_spread(
        sampler,
        brdf,
        &Quadrature::new(wo, POINTS_PER_BIN),
        Importance::Mean,
    );
    let weight = |&u: &Vec2| {
        let weight = sampler
            .sample(wo, u)
            .map(|s| color::mean(brdf.eval_cos(wo, s.wi)) / s.pdf);
        f64::from(weight.unwrap_or(0.0))
    };
    let ratio = points.iter().map(weight).sum::<f64>() / points.len() as f64 / spread.mean;
    let allowed = 1e-3 + 6.0 * spread.relstd / (points.len() as f64).sqrt();
    assert!((ratio - 1.0).abs() < allowed, "{wo}: {ratio}, {spread:?}");
}

fn benches(c: &mut Criterion) {
    let brdf = Arc::new(MerlBrdf::new(
        Arc::new(decode_embedded("nickel").unwrap()),
        LookupRule::Floor,
    ));
    let points: Vec<Vec2> = (0..DRAWS)
        .map(|i| PointSet::Random.point(1, i, 0))
        .collect();
    let samplers =
        specs().map(|(name, spec)| (name, spec.build(&Loaded::from_table(brdf.clone())).unwrap()));
    for call in ["sample", "batch", "pdf"] {
        let mut group = c.benchmark_group(call);
        group
            .throughput(Throughput::Elements(DRAWS))
            .sample_size(15);
        group
            .warm_up_time(Duration::from_millis(200))
            .measurement_time(Duration::from_secs(1));
        for (name, sampler) in &samplers {
            for degrees in ANGLES {
                let wo = spherical(degrees.to_radians(), 0.4).as_vec3();
                assert_albedo(&**sampler, &brdf, wo, &points);
                let id = BenchmarkId::new(*name, degrees);
                if call == "sample" {
                    group.bench_with_input(id, &wo, |b, &wo| {
                        b.iter(|| {
                            points
                                .iter()
                                .filter_map(|&u| sampler.sample(black_box(wo), u))
                                .count()
                        })
                    });
                } else if call == "batch" {
                    group.bench_with_input(id, &wo, |b, &wo| {
                        let mut drawn = vec![None; points.len()];
                        b.iter(|| sampler.sample_batch(Wo::One(black_box(wo)), &points, &mut drawn))
                    });
                } else {
                    let drawn: Vec<Vec3> = points
                        .iter()
                        .filter_map(|&u| sampler.sample(wo, u))
                        .map(|s| s.wi)
                        .collect();
                    group.throughput(Throughput::Elements(drawn.len() as u64));
                    group.bench_with_input(id, &wo, |b, &wo| {
                        b.iter(|| {
                            drawn
                                .iter()
                                .map(|&wi| sampler.pdf(black_box(wo), wi))
                                .sum::<f32>()
                        })
                    });
                }
            }
        }
        group.finish();
    }
}

/// Paths of one pixel, whose `wo` are nearly equal, as many as go through a batch together.
const PIXEL: u64 = 64;

/// A `wo` for each draw: nearly equal within a pixel, anywhere up to 85° among pixels.
fn views() -> Vec<Vec3> {
    let view = |i: u64| {
        let pixel = PointSet::Random.point(2, i / PIXEL, 0);
        let within = PointSet::Random.point(3, i, 0) * 0.01;
        let (theta, phi) = (
            f64::from(pixel.x * 1.47 + within.x),
            f64::from(pixel.y * TAU + within.y),
        );
        spherical(theta, phi).as_vec3()
    };
    (0..DRAWS).map(view).collect()
}

/// A nothing that can't be known before `value` is.
fn nothing_after(value: f32) -> Vec3 {
    Vec3::splat(value.min(1.0) * f32::MIN_POSITIVE * 0.0)
}

fn pairs(c: &mut Criterion) {
    let brdf = Arc::new(MerlBrdf::new(
        Arc::new(decode_embedded("nickel").unwrap()),
        LookupRule::Floor,
    ));
    let points: Vec<Vec2> = (0..DRAWS)
        .map(|i| PointSet::Random.point(1, i, 0))
        .collect();
    let wo = views();
    for (name, spec) in specs().into_iter().take(3) {
        let sampler = spec.build(&Loaded::from_table(brdf.clone())).unwrap();
        let single: Vec<_> = wo
            .iter()
            .zip(&points)
            .map(|(&wo, &u)| sampler.sample(wo, u))
            .collect();
        let wi: Vec<Vec3> = single.iter().map(|s| s.unwrap().wi).collect();
        let (mut drawn, mut pdfs) = (vec![None; wi.len()], vec![0.0; wi.len()]);
        sampler.sample_batch(Wo::Each(&wo), &points, &mut drawn);
        sampler.pdf_batch(Wo::Each(&wo), &wi, &mut pdfs);
        assert!(
            drawn == single
                && single
                    .iter()
                    .zip(&pdfs)
                    .all(|(s, &pdf)| s.is_some_and(|s| s.pdf == pdf))
        );
        let mut group = c.benchmark_group("pairs");
        group
            .throughput(Throughput::Elements(DRAWS))
            .sample_size(15);
        group
            .warm_up_time(Duration::from_millis(200))
            .measurement_time(Duration::from_secs(1));
        let id = |call: &str| BenchmarkId::new(call, name);
        group.bench_function(id("sample"), |b| {
            b.iter(|| {
                black_box(&wo)
                    .iter()
                    .zip(&points)
                    .filter_map(|(&wo, &u)| sampler.sample(wo, u))
                    .count()
            })
        });
        group.bench_function(id("sample in a chain"), |b| {
            b.iter(|| {
                let next =
                    |z, (&wo, &u)| nothing_after(sampler.sample(wo + z, u).map_or(0.0, |s| s.pdf));
                black_box(&wo).iter().zip(&points).fold(Vec3::ZERO, next)
            })
        });
        group.bench_function(id("pdf"), |b| {
            b.iter(|| {
                black_box(&wo)
                    .iter()
                    .zip(&wi)
                    .map(|(&wo, &wi)| sampler.pdf(wo, wi))
                    .sum::<f32>()
            })
        });
        group.bench_function(id("pdf in a chain"), |b| {
            let next = |z, (&wo, &wi): (&Vec3, &Vec3)| nothing_after(sampler.pdf(wo + z, wi));
            b.iter(|| black_box(&wo).iter().zip(&wi).fold(Vec3::ZERO, next))
        });
        for count in [16, 32, 64] {
            group.bench_function(id(&format!("sample_batch of {count}")), |b| {
                b.iter(|| {
                    let batches = wo
                        .chunks(count)
                        .zip(points.chunks(count))
                        .zip(drawn.chunks_mut(count));
                    batches.for_each(|((wo, u), out)| {
                        sampler.sample_batch(Wo::Each(black_box(wo)), u, out)
                    });
                })
            });
            group.bench_function(id(&format!("pdf_batch of {count}")), |b| {
                b.iter(|| {
                    let batches = wo
                        .chunks(count)
                        .zip(wi.chunks(count))
                        .zip(pdfs.chunks_mut(count));
                    batches.for_each(|((wo, wi), out)| {
                        sampler.pdf_batch(Wo::Each(black_box(wo)), wi, out)
                    });
                })
            });
        }
        group.finish();
    }
}

criterion_group!(sample_benches, benches, pairs);
criterion_main!(sample_benches);
