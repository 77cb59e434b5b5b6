//! One draw, draws in batches and one density of each sampler for nickel, at angles of `wo` from normal to grazing; and draws
//! and densities for pairs, each of another `wo`: alone, each waiting for the one before, and 16 to 64 at once.
//! `cargo bench --bench sample`.

mod harness;

use std::f32::consts::TAU;
use std::hint::black_box;

use glam::{Vec2, Vec3};
use harness::{Group, Harness};
use merlkit::brdf::{Brdf, Importance};
use merlkit::color;
use merlkit::geometry::{POINTS_PER_BIN, Quadrature, spherical};
use merlkit::points::PointSet;
use merlkit::{
    DirectionSample, DirectionSampler, Loaded, LookupRule, Material, Sampler, SamplerSpec, Wo,
};
use merlkit_evaluate::measure::accuracy::weight_spread;

const DRAWS: u64 = 2048;
const ANGLES: [f64; 4] = [0.76, 29.75, 60.25, 84.7];

/// The samplers that are timed: the name of the measurement, and the sampler as the command line names it.
const SAMPLERS: [(&str, &str); 9] = [
    ("cosine", "cosine"),
    ("half-vector 2KB", "half-vector:2KB"),
    ("half-vector 64KB", "half-vector:64KB"),
    ("disc mixture", "adaptive-disc"),
    ("disc nearest", "adaptive-disc:nearest"),
    ("disc rejection-free", "adaptive-disc:rejection-free"),
    ("cdf mixture", "cascade-cdf"),
    ("cdf nearest", "cascade-cdf:nearest"),
    ("cdf whole", "cascade-cdf:uniform"),
];

fn nickel() -> Loaded {
    let material = Material::resolve("nickel").unwrap();
    material.load(LookupRule::Floor).unwrap()
}

fn build(text: &str, material: &Loaded) -> Sampler {
    let spec: SamplerSpec = text.parse().unwrap();
    spec.build(material).unwrap()
}

/// The draws estimate the albedo, within six standard errors by quadrature.
fn assert_albedo(built: &Sampler, brdf: &dyn Brdf, wo: Vec3, points: &[Vec2]) {
    let sampler = built.as_dyn();
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
    assert!(
        (ratio - 1.0).abs() < allowed,
        "{} {wo}: {ratio}, {spread:?}",
        built.spec()
    );
}

/// Draws, draws in batches and densities of one sampler at one angle; `call` is which of them.
fn add_call<'a>(
    group: &mut Group<'a>,
    call: &str,
    (name, built): &'a (&str, Sampler),
    wo: Vec3,
    points: &'a [Vec2],
) {
    let sampler = built.as_dyn();
    if call == "sample" {
        group.add(*name, points.len(), move || {
            let drawn = points
                .iter()
                .filter_map(|&u| sampler.sample(black_box(wo), u));
            drawn.count()
        });
    } else if call == "batch" {
        let mut drawn = vec![None; points.len()];
        group.add(*name, points.len(), move || {
            sampler.sample_batch(Wo::One(black_box(wo)), points, &mut drawn);
        });
    } else {
        let drawn = points.iter().filter_map(|&u| sampler.sample(wo, u));
        let drawn: Vec<Vec3> = drawn.map(|s| s.wi).collect();
        group.add(*name, drawn.len(), move || {
            let pdfs = drawn.iter().map(|&wi| sampler.pdf(black_box(wo), wi));
            pdfs.sum::<f32>()
        });
    }
}

fn angles(harness: &mut Harness, material: &Loaded) {
    let points: Vec<Vec2> = (0..DRAWS)
        .map(|i| PointSet::Random.point(1, i, 0))
        .collect();
    let samplers = SAMPLERS.map(|(name, text)| (name, build(text, material)));
    for degrees in ANGLES {
        let wo = spherical(degrees.to_radians(), 0.4).as_vec3();
        for (_, built) in &samplers {
            assert_albedo(built, &**material.brdf(), wo, &points);
        }
        for call in ["sample", "batch", "pdf"] {
            let noun = if call == "pdf" { "density" } else { "draw" };
            let mut group = Group::new(format!("{call} at {degrees}°"), noun);
            for sampler in &samplers {
                add_call(&mut group, call, sampler, wo, &points);
            }
            harness.run(group);
        }
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

/// Viewers, each with a point of the unit square and the direction that it gives.
struct ViewPairs {
    wo: Vec<Vec3>,
    u: Vec<Vec2>,
    wi: Vec<Vec3>,
}

impl ViewPairs {
    /// With the directions of a sampler, whose batches give the bits of single calls.
    fn new(sampler: &dyn DirectionSampler) -> Self {
        let wo = views();
        let points = (0..DRAWS).map(|i| PointSet::Random.point(1, i, 0));
        let u: Vec<Vec2> = points.collect();
        let single = wo.iter().zip(&u).map(|(&wo, &u)| sampler.sample(wo, u));
        let single: Vec<_> = single.collect();
        let wi: Vec<Vec3> = single.iter().map(|s| s.unwrap().wi).collect();
        let (mut drawn, mut pdfs) = (vec![None; wi.len()], vec![0.0; wi.len()]);
        sampler.sample_batch(Wo::Each(&wo), &u, &mut drawn);
        sampler.pdf_batch(Wo::Each(&wo), &wi, &mut pdfs);
        assert_eq!(drawn, single);
        for (sample, pdf) in single.iter().flatten().zip(&pdfs) {
            assert_eq!(sample.pdf, *pdf);
        }
        Self { wo, u, wi }
    }

    fn sample_singly(&self, sampler: &dyn DirectionSampler) -> usize {
        let pairs = black_box(&self.wo).iter().zip(&self.u);
        pairs.filter_map(|(&wo, &u)| sampler.sample(wo, u)).count()
    }

    fn sample_in_a_chain(&self, sampler: &dyn DirectionSampler) -> Vec3 {
        let mut nothing = Vec3::ZERO;
        for (&wo, &u) in black_box(&self.wo).iter().zip(&self.u) {
            nothing = nothing_after(sampler.sample(wo + nothing, u).map_or(0.0, |s| s.pdf));
        }
        nothing
    }

    fn pdf_singly(&self, sampler: &dyn DirectionSampler) -> f32 {
        let pairs = black_box(&self.wo).iter().zip(&self.wi);
        pairs.map(|(&wo, &wi)| sampler.pdf(wo, wi)).sum()
    }

    fn pdf_in_a_chain(&self, sampler: &dyn DirectionSampler) -> Vec3 {
        let mut nothing = Vec3::ZERO;
        for (&wo, &wi) in black_box(&self.wo).iter().zip(&self.wi) {
            nothing = nothing_after(sampler.pdf(wo + nothing, wi));
        }
        nothing
    }

    fn sample_in_batches(
        &self,
        sampler: &dyn DirectionSampler,
        count: usize,
        drawn: &mut [Option<DirectionSample>],
    ) {
        let lanes = self.wo.chunks(count).zip(self.u.chunks(count));
        for ((wo, u), out) in lanes.zip(drawn.chunks_mut(count)) {
            sampler.sample_batch(Wo::Each(black_box(wo)), u, out);
        }
    }

    fn pdf_in_batches(&self, sampler: &dyn DirectionSampler, count: usize, pdfs: &mut [f32]) {
        let lanes = self.wo.chunks(count).zip(self.wi.chunks(count));
        for ((wo, wi), out) in lanes.zip(pdfs.chunks_mut(count)) {
            sampler.pdf_batch(Wo::Each(black_box(wo)), wi, out);
        }
    }
}

fn pairs(harness: &mut Harness, material: &Loaded) {
    for (name, text) in SAMPLERS.into_iter().take(3) {
        let built = build(text, material);
        let sampler = built.as_dyn();
        let pairs = &ViewPairs::new(sampler);
        let calls = pairs.wo.len();
        let mut draws = Group::new(format!("pairs, {name}"), "draw");
        let mut densities = Group::new(format!("pairs, {name}"), "density");
        for count in [64, 32, 16] {
            let (mut drawn, mut pdfs) = (vec![None; calls], vec![0.0; calls]);
            draws.add(format!("sample_batch of {count}"), calls, move || {
                pairs.sample_in_batches(sampler, count, &mut drawn);
            });
            densities.add(format!("pdf_batch of {count}"), calls, move || {
                pairs.pdf_in_batches(sampler, count, &mut pdfs);
            });
        }
        draws.add("sample", calls, || pairs.sample_singly(sampler));
        draws.add("sample in a chain", calls, || {
            pairs.sample_in_a_chain(sampler)
        });
        densities.add("pdf", calls, || pairs.pdf_singly(sampler));
        densities.add("pdf in a chain", calls, || pairs.pdf_in_a_chain(sampler));
        harness.run(draws);
        harness.run(densities);
    }
}

fn main() {
    let mut harness = Harness::new("sample");
    let material = nickel();
    angles(&mut harness, &material);
    pairs(&mut harness, &material);
}
