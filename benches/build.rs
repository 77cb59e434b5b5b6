//! Building each sampler for nickel, in CPU time of one thread. `cargo bench --bench build`.

mod harness;

use std::hint::black_box;

use harness::{Group, Harness};
use merlkit::geometry::spherical;
use merlkit::points::PointSet;
use merlkit::{LookupRule, Material, SamplerSpec};

/// The samplers that are built: the name of the measurement, and the sampler as the command line names it.
const SAMPLERS: [(&str, &str); 8] = [
    ("half-vector 64KB", "half-vector:64KB"),
    ("half-vector 2KB", "half-vector:2KB"),
    ("half-vector 1MB", "half-vector:1MB"),
    ("adaptive disc", "adaptive-disc"),
    (
        "adaptive disc, rejection-free",
        "adaptive-disc:rejection-free",
    ),
    ("adaptive disc as published", "adaptive-disc:published"),
    ("cascade CDF 1024x512 compressed", "cascade-cdf"),
    ("cascade CDF 256x32 whole", "cascade-cdf:uniform"),
];

fn main() {
    let mut harness = Harness::new("build");
    let material = Material::resolve("nickel").unwrap();
    let material = material.load(LookupRule::Floor).unwrap();
    let wo = spherical(0.7, 0.3).as_vec3();
    let mut group = Group::new("build", "sampler");
    for (name, text) in SAMPLERS {
        let spec: SamplerSpec = text.parse().unwrap();
        let sampler = spec.build(&material).unwrap();
        let draw = sampler
            .as_dyn()
            .sample(wo, PointSet::Sobol.point(1, 0, 0))
            .unwrap();
        assert_eq!(draw.pdf, sampler.as_dyn().pdf(wo, draw.wi), "{name}");
        let material = &material;
        group.add(name, 1, move || {
            black_box(&spec).build(black_box(material)).unwrap()
        });
    }
    harness.run(group);
}
