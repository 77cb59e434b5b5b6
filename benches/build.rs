//! Building each sampler for nickel, on all cores; RAYON_NUM_THREADS=1 gives the time on one.

use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use merlkit::geometry::spherical;
use merlkit::material::Loaded;
use merlkit::material::merl::decode_embedded;
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::points::PointSet;
use merlkit::sampler::{
    AdaptiveDiscSettings, CascadeCdfSettings, HalfVectorSettings, LeafChoice, SamplerSpec,
};

fn benches(c: &mut Criterion) {
    let brdf = Arc::new(MerlBrdf::new(
        Arc::new(decode_embedded("nickel").unwrap()),
        LookupRule::Floor,
    ));
    let material = Loaded::from_table(brdf);
    let wo = spherical(0.7, 0.3).as_vec3();
    let mut group = c.benchmark_group("build");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2));
    for (name, spec) in [
        (
            "half-vector 2KB",
            SamplerSpec::new(HalfVectorSettings::PRESETS[0].1),
        ),
        (
            "half-vector 64KB",
            SamplerSpec::new(HalfVectorSettings::default()),
        ),
        (
            "half-vector 1MB",
            SamplerSpec::new(HalfVectorSettings::PRESETS[7].1),
        ),
        (
            "adaptive disc",
            SamplerSpec::new(AdaptiveDiscSettings::default()),
        ),
        (
            "adaptive disc, rejection-free",
            SamplerSpec::new(AdaptiveDiscSettings {
                leaves: LeafChoice::Warp,
                ..Default::default()
            }),
        ),
        (
            "adaptive disc as published",
            SamplerSpec::new(AdaptiveDiscSettings::as_published()),
        ),
        (
            "cascade CDF 1024x512 compressed",
            SamplerSpec::new(CascadeCdfSettings::default()),
        ),
        (
            "cascade CDF 256x32 whole",
            SamplerSpec::new(CascadeCdfSettings::uniform()),
        ),
    ] {
        let sampler = spec.build(&material).unwrap();
        let draw = sampler.sample(wo, PointSet::Sobol.point(1, 0, 0)).unwrap();
        assert_eq!(draw.pdf, sampler.pdf(wo, draw.wi), "{name}");
        group.bench_function(name, |b| {
            b.iter(|| black_box(&spec).build(black_box(&material)).unwrap())
        });
    }
    group.finish();
}

criterion_group!(build_benches, benches);
criterion_main!(build_benches);
