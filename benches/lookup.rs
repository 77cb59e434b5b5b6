//! Evaluation by each lookup rule, for pairs anywhere, pairs near the mirror direction and pairs drawn for the material: one at
//! a time, each waiting for the one before, many at once, and the bins alone. Then evaluation of a `.bsdf` file that is made of
//! the same material, and draws and densities by the sampler that it holds.

use std::f64::consts::TAU;
use std::hint::black_box;
use std::sync::Arc;

use criterion::measurement::WallTime;
use criterion::{
    BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main,
};
use glam::{Vec2, Vec3};
use merlkit::Wo;
use merlkit::brdf::Brdf;
use merlkit::color::Rgb;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::geometry::{cosine_hemisphere, reflect_about, spherical};
use merlkit::material::merl::{BinIndex, LookupRule, MerlBrdf};
use merlkit::material::merl::{MerlTable, decode_embedded};
use merlkit::material::rgl::{BsdfSize, RglBrdf, tabulate};
use merlkit::points::PointSet;
use merlkit::sampler::{HalfVectorSettings, HalfVectorTable};

const PAIRS: u64 = 4096;

/// `wo` and `wi` of some pairs, and the place they come from.
struct Pairs {
    place: &'static str,
    wo: Vec<Vec3>,
    wi: Vec<Vec3>,
}

impl Pairs {
    fn anywhere() -> Self {
        let direction = |pair| {
            let u = move |i| PointSet::Random.point(1, i, pair).as_dvec2();
            (0..PAIRS)
                .map(|i| cosine_hemisphere(u(i)).as_vec3())
                .collect()
        };
        Self {
            place: "anywhere",
            wo: direction(0),
            wi: direction(1),
        }
    }

    /// Half vectors within 3° of the normal, viewers up to 80°.
    fn near_the_mirror() -> Self {
        let pair = |i| {
            let u = PointSet::Random.point4(2, i, 0).map(f64::from);
            let wo = spherical(u[0] * 1.4, u[1] * TAU);
            let h = spherical(u[2] * 0.05, u[3] * TAU);
            (wo.as_vec3(), reflect_about(wo, h).as_vec3())
        };
        let (wo, wi) = (0..PAIRS).map(pair).unzip();
        Self {
            place: "near the mirror",
            wo,
            wi,
        }
    }

    /// As paths of a renderer ask: viewers nearly equal within each 64, lights drawn from a half-vector table.
    fn drawn(brdf: &MerlBrdf) -> Self {
        let table = HalfVectorTable::build(brdf, HalfVectorSettings::default()).unwrap();
        let pair = |i| {
            let pixel = PointSet::Random.point(3, i / 64, 0).as_dvec2();
            let u = PointSet::Random.point4(4, i, 0);
            let wo = spherical(
                pixel.x * 1.47 + f64::from(u[0]) * 0.01,
                pixel.y * TAU + f64::from(u[1]) * 0.01,
            );
            (
                wo.as_vec3(),
                table
                    .sample(wo.as_vec3(), Vec2::new(u[2], u[3]))
                    .unwrap()
                    .wi,
            )
        };
        let (wo, wi) = (0..PAIRS).map(pair).unzip();
        Self {
            place: "drawn",
            wo,
            wi,
        }
    }

    fn iter(&self) -> impl Iterator<Item = (Vec3, Vec3)> {
        self.wo.iter().copied().zip(self.wi.iter().copied())
    }
}

fn sum(brdf: &MerlBrdf, pairs: &Pairs) -> Rgb {
    pairs.iter().map(|(wo, wi)| brdf.eval(wo, wi)).sum()
}

/// Sum of the positions of all pairs' bins in the table.
fn bins(table: &MerlTable, pairs: &Pairs) -> usize {
    let index = |b: BinIndex| table.index(b.theta_h, b.theta_d, b.phi_d);
    pairs
        .iter()
        .filter_map(|(wo, wi)| BinIndex::find(wo, wi, 180))
        .map(index)
        .sum()
}

fn rule(group: &mut BenchmarkGroup<WallTime>, brdf: &MerlBrdf, pairs: &Pairs) {
    let id = |how: &str| BenchmarkId::new(format!("{} {how}", brdf.rule().name()), pairs.place);
    let mut out = vec![Rgb::ZERO; pairs.wi.len()];
    group.bench_function(id("one"), |b| b.iter(|| sum(brdf, black_box(pairs))));

    let next =
        |z: f32, (wo, wi)| brdf.eval(wo + Vec3::splat(z), wi).x.min(1.0) * f32::MIN_POSITIVE * 0.0;
    group.bench_function(id("chain"), |b| {
        b.iter(|| black_box(pairs).iter().fold(0.0, next))
    });

    brdf.eval_batch(Wo::Each(&pairs.wo), &pairs.wi, &mut out);
    assert!(
        pairs
            .iter()
            .zip(&out)
            .all(|((wo, wi), &f)| f == brdf.eval(wo, wi))
    );
    group.bench_function(id("pairs"), |b| {
        b.iter(|| brdf.eval_batch(Wo::Each(black_box(&pairs.wo)), &pairs.wi, &mut out))
    });
    for count in [16, 32, 64] {
        group.bench_function(id(&format!("pairs of {count}")), |b| {
            b.iter(|| {
                let batches = pairs
                    .wo
                    .chunks(count)
                    .zip(pairs.wi.chunks(count))
                    .zip(out.chunks_mut(count));
                batches
                    .for_each(|((wo, wi), out)| brdf.eval_batch(Wo::Each(black_box(wo)), wi, out));
            })
        });
    }

    let wo = pairs.wo[7];
    brdf.eval_batch(Wo::One(wo), &pairs.wi, &mut out);
    assert!(
        pairs
            .wi
            .iter()
            .zip(&out)
            .all(|(&wi, &f)| f == brdf.eval(wo, wi))
    );
    group.bench_function(id("many wi"), |b| {
        b.iter(|| brdf.eval_batch(Wo::One(black_box(wo)), &pairs.wi, &mut out))
    });
}

fn benches(c: &mut Criterion) {
    let table = Arc::new(decode_embedded("nickel").unwrap());
    let mut group = c.benchmark_group("lookup");
    group.throughput(Throughput::Elements(PAIRS));
    let floor = MerlBrdf::new(table.clone(), LookupRule::Floor);
    for pairs in [
        Pairs::anywhere(),
        Pairs::near_the_mirror(),
        Pairs::drawn(&floor),
    ] {
        let floor = sum(&floor, &pairs);
        group.bench_function(BenchmarkId::new("bins alone", pairs.place), |b| {
            b.iter(|| bins(&table, black_box(&pairs)))
        });
        for by in LookupRule::ALL {
            let brdf = MerlBrdf::new(table.clone(), by);
            let ratio = sum(&brdf, &pairs) / floor;
            assert!(
                ratio.min_element() > 0.5 && ratio.max_element() < 2.0,
                "{by:?} {}: {ratio}",
                pairs.place
            );
            rule(&mut group, &brdf, &pairs);
        }
    }
    group.finish();
}

/// A file of 3 MB made of nickel: many more polar angles than the eight of the RGL database, and tables of like size for each.
fn measured_file() -> RglBrdf {
    let table = Arc::new(decode_embedded("nickel").unwrap());
    let nickel = MerlBrdf::new(table, LookupRule::Linear);
    let size = BsdfSize::ALL.into_iter().find(|s| s.name == "3MB").unwrap();
    RglBrdf::new(tabulate(
        |wo, wi| nickel.eval(wo, wi),
        size,
        "nickel".into(),
    ))
}

fn measured(c: &mut Criterion) {
    let rgl = measured_file();
    let mut group = c.benchmark_group("measured");
    group.throughput(Throughput::Elements(PAIRS));
    for pairs in [Pairs::anywhere(), Pairs::near_the_mirror()] {
        evaluation(&mut group, &rgl, &pairs);
        own_sampler(&mut group, &rgl, &pairs);
    }
    group.finish();
}

fn evaluation(group: &mut BenchmarkGroup<WallTime>, rgl: &RglBrdf, pairs: &Pairs) {
    let mut out = vec![Rgb::ZERO; pairs.wi.len()];
    rgl.eval_batch(Wo::Each(&pairs.wo), &pairs.wi, &mut out);
    assert!(
        pairs
            .iter()
            .zip(&out)
            .all(|((wo, wi), &f)| f == rgl.eval(wo, wi))
    );
    let id = |how: &str| BenchmarkId::new(how, pairs.place);
    group.bench_function(id("eval one"), |b| {
        b.iter(|| {
            let pairs = black_box(pairs);
            pairs.iter().map(|(wo, wi)| rgl.eval(wo, wi)).sum::<Rgb>()
        })
    });
    group.bench_function(id("eval pairs"), |b| {
        b.iter(|| rgl.eval_batch(Wo::Each(black_box(&pairs.wo)), &pairs.wi, &mut out))
    });
    let wo = pairs.wo[7];
    group.bench_function(id("eval many wi"), |b| {
        b.iter(|| rgl.eval_batch(Wo::One(black_box(wo)), &pairs.wi, &mut out))
    });
}

fn own_sampler(group: &mut BenchmarkGroup<WallTime>, rgl: &RglBrdf, pairs: &Pairs) {
    let id = |how: &str| BenchmarkId::new(how, pairs.place);
    let points: Vec<Vec2> = (0..PAIRS)
        .map(|i| PointSet::Random.point(3, i, 0))
        .collect();
    let (mut drawn, mut pdfs) = (vec![None; points.len()], vec![0.0; points.len()]);
    let wo = pairs.wo[7];
    rgl.sample_batch(Wo::One(wo), &points, &mut drawn);
    // Some draws end below the horizon.
    assert!(drawn.iter().flatten().count() > points.len() / 2);
    group.bench_function(id("sample many"), |b| {
        b.iter(|| rgl.sample_batch(Wo::One(black_box(wo)), &points, &mut drawn))
    });
    group.bench_function(id("pdf pairs"), |b| {
        b.iter(|| rgl.pdf_batch(Wo::Each(black_box(&pairs.wo)), &pairs.wi, &mut pdfs))
    });
}

criterion_group!(lookup_benches, benches, measured);
criterion_main!(lookup_benches);
