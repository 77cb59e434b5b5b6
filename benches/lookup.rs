//! One evaluation by each lookup rule, for pairs anywhere and for pairs near the mirror direction.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use merlkit::brdf::{Brdf, LookupRule, Measured};
use merlkit::color::Rgb;
use merlkit::geom::{cosine_hemisphere, reflect_about, spherical};
use merlkit::merl::decode_embedded;
use merlkit::points::PointSet;

const PAIRS: u64 = 4096;

fn anywhere() -> Vec<(Vec3, Vec3)> {
    let direction = |i, pair| cosine_hemisphere(PointSet::Random.point(1, i, pair).as_dvec2()).as_vec3();
    (0..PAIRS).map(|i| (direction(i, 0), direction(i, 1))).collect()
}

/// Half vectors within 3° of the normal, viewers up to 80°.
fn near_the_mirror() -> Vec<(Vec3, Vec3)> {
    let pair = |i| {
        let u = PointSet::Random.point4(2, i, 0).map(f64::from);
        let wo = spherical(u[0] * 1.4, u[1] * std::f64::consts::TAU);
        let h = spherical(u[2] * 0.05, u[3] * std::f64::consts::TAU);
        (wo.as_vec3(), reflect_about(wo, h).as_vec3())
    };
    (0..PAIRS).map(pair).collect()
}

fn sum(brdf: &Measured, pairs: &[(Vec3, Vec3)]) -> Rgb {
    pairs.iter().map(|&(wo, wi)| brdf.eval(wo, wi)).sum()
}

fn benches(c: &mut Criterion) {
    let table = Arc::new(decode_embedded("nickel").unwrap());
    let mut group = c.benchmark_group("lookup");
    group.throughput(Throughput::Elements(PAIRS));
    for (place, pairs) in [("anywhere", anywhere()), ("near the mirror", near_the_mirror())] {
        let floor = sum(&Measured::new(table.clone(), LookupRule::Floor), &pairs);
        for rule in LookupRule::ALL {
            let brdf = Measured::new(table.clone(), rule);
            let ratio = sum(&brdf, &pairs) / floor;
            assert!(ratio.min_element() > 0.5 && ratio.max_element() < 2.0, "{rule:?} {place}: {ratio}");
            group.bench_with_input(BenchmarkId::new(rule.name(), place), &pairs, |b, pairs| {
                b.iter(|| sum(&brdf, black_box(pairs)))
            });
        }
    }
    group.finish();
}

criterion_group!(lookup_benches, benches);
criterion_main!(lookup_benches);
