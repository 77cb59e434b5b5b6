//! Kernels whose instructions are counted: each does the same fixed work whenever it is run.
//!
//! `tools/count_instructions` runs it in callgrind. By hand: `counted --prepare FOLDER` writes the material and the samplers, so
//! that little else is done in the counted process; `counted --once KERNEL N FOLDER` does the kernel's work N times;
//! `counted --kernels` prints each kernel with the calls of one N.

use std::f64::consts::TAU;
use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;

use glam::{DVec2, DVec3, Vec2, Vec3};
use merlkit::brdf::Brdf;
use merlkit::color::Rgb;
use merlkit::files::Overwrite;
use merlkit::geometry::spherical;
use merlkit::light::{EnvironmentSource, Light, LightSpec, SkySampling, studio};
use merlkit::material::merl::{MerlBrdf, decode_embedded, write};
use merlkit::points::PointSet;
use merlkit::render::{Budget, PlanRequest, RenderSettings, Scene, SceneSpec, Surface, render};
use merlkit::sampler::store::{SamplerFile, encode};
use merlkit::{DirectionSampler, Loaded, LookupRule, Material, Sampler, SamplerSpec, Wo};

/// Calls of one N of the kernels that are not pictures.
const CALLS: usize = 4096;
/// Lanes of a batch, as the renderer asks for them.
const LANES: usize = 64;
/// Pixels a side of the picture.
const SIDE: usize = 512;

/// Each kernel and the calls of one N.
const KERNELS: [(&str, usize); 12] = [
    ("half-vector-sample-pairs", CALLS),
    ("half-vector-pdf-pairs", CALLS),
    ("half-vector-sample-single", CALLS),
    ("linear-eval-pairs", CALLS),
    ("floor-eval-pairs", CALLS),
    ("environment-sample", CALLS),
    ("environment-emitted", CALLS),
    ("cascade-cdf-sample", CALLS),
    ("cascade-cdf-sample-pairs", CALLS),
    ("adaptive-disc-sample", CALLS),
    ("adaptive-disc-sample-pairs", CALLS),
    ("sphere-path", SIDE * SIDE),
];

/// Files of the samplers, and what the command line calls them.
const SAMPLERS: [(&str, &str); 3] = [
    ("half-vector", "half-vector:64KB"),
    ("cascade-cdf", "cascade-cdf"),
    ("adaptive-disc", "adaptive-disc"),
];

/// The prepared files.
struct Prepared<'a> {
    folder: &'a Path,
}

impl Prepared<'_> {
    fn write(&self) {
        let table = decode_embedded("nickel").expect("an embedded material");
        let path = self.folder.join("nickel.binary");
        write(&table, &path, Overwrite::Replace).expect("a table");
        let material = self.material();
        let loaded = material.load(LookupRule::Floor).expect("its table");
        for (name, text) in SAMPLERS {
            let spec: SamplerSpec = text.parse().expect("a sampler's text");
            let sampler = spec.build(&loaded).expect("a sampler");
            let bytes = encode(&sampler, &material).expect("a sampler file");
            std::fs::write(self.folder.join(name), bytes).expect("a file");
        }
    }

    fn material(&self) -> Material {
        let path = self.folder.join("nickel.binary");
        Material::resolve(path.to_str().expect("a path of text")).expect("the prepared material")
    }

    fn load(&self, rule: LookupRule) -> Loaded {
        self.material().load(rule).expect("the prepared material")
    }

    fn brdf(&self, rule: LookupRule) -> Arc<MerlBrdf> {
        let loaded = self.load(rule);
        loaded.table().expect("a MERL table").clone()
    }

    fn sampler(&self, name: &str) -> Sampler {
        let file = SamplerFile::open(&self.folder.join(name)).expect("a sampler file");
        let loaded = self.load(LookupRule::Floor);
        file.into_sampler(&loaded).expect("a sampler")
    }
}

/// Viewers nearly equal within each [`LANES`], as those of a pixel, and points of the unit square.
fn views() -> (Vec<Vec3>, Vec<Vec2>) {
    let (mut wo, mut u) = (Vec::new(), Vec::new());
    for i in 0..CALLS as u64 {
        let pixel = PointSet::Random.point(1, i / LANES as u64, 0).as_dvec2();
        let numbers = PointSet::Random.point4(2, i, 0);
        let within = DVec2::new(f64::from(numbers[0]), f64::from(numbers[1])) * 0.01;
        let view = spherical(pixel.x * 1.47 + within.x, pixel.y * TAU + within.y);
        wo.push(view.as_vec3());
        u.push(Vec2::new(numbers[2], numbers[3]));
    }
    (wo, u)
}

fn sample_pairs(sampler: &dyn DirectionSampler, times: usize) {
    let (wo, u) = views();
    let mut drawn = vec![None; LANES];
    for _ in 0..times {
        for (wo, u) in wo.chunks(LANES).zip(u.chunks(LANES)) {
            sampler.sample_batch(Wo::Each(black_box(wo)), u, &mut drawn);
            black_box(&drawn);
        }
    }
}

fn sample_singly(sampler: &dyn DirectionSampler, times: usize) {
    let (wo, u) = views();
    for _ in 0..times {
        for (&wo, &u) in wo.iter().zip(&u) {
            black_box(sampler.sample(black_box(wo), u));
        }
    }
}

/// Directions that a sampler draws for the viewers.
fn lights(sampler: &dyn DirectionSampler, wo: &[Vec3], u: &[Vec2]) -> Vec<Vec3> {
    let draws = wo.iter().zip(u).map(|(&wo, &u)| sampler.sample(wo, u));
    draws.map(|s| s.expect("a direction").wi).collect()
}

fn pdf_pairs(sampler: &dyn DirectionSampler, times: usize) {
    let (wo, u) = views();
    let wi = lights(sampler, &wo, &u);
    let mut pdfs = vec![0.0; LANES];
    for _ in 0..times {
        for (wo, wi) in wo.chunks(LANES).zip(wi.chunks(LANES)) {
            sampler.pdf_batch(Wo::Each(black_box(wo)), wi, &mut pdfs);
            black_box(&pdfs);
        }
    }
}

fn eval_pairs(brdf: &dyn Brdf, sampler: &dyn DirectionSampler, times: usize) {
    let (wo, u) = views();
    let wi = lights(sampler, &wo, &u);
    let mut values = vec![Rgb::ZERO; LANES];
    for _ in 0..times {
        for (wo, wi) in wo.chunks(LANES).zip(wi.chunks(LANES)) {
            brdf.eval_batch(Wo::Each(black_box(wo)), wi, &mut values);
            black_box(&values);
        }
    }
}

fn environment(is_sample: bool, times: usize) {
    let sky = studio(SkySampling::Importance);
    let (_, u) = views();
    let u: Vec<DVec2> = u.iter().map(|u| u.as_dvec2()).collect();
    let (from, reach) = ([DVec3::ZERO; LANES], [f64::INFINITY; LANES]);
    let drawn = u.iter().map(|&u| sky.sample(DVec3::ZERO, u));
    let wi: Vec<DVec3> = drawn.map(|s| s.expect("a direction").wi).collect();
    let (mut sampled, mut emitted) = (vec![None; LANES], vec![None; LANES]);
    for _ in 0..times {
        for (u, wi) in u.chunks(LANES).zip(wi.chunks(LANES)) {
            if is_sample {
                sky.sample_batch(&from, black_box(u), &mut sampled);
                black_box(&sampled);
            } else {
                sky.emitted_batch(&from, black_box(wi), &reach, &mut emitted);
                black_box(&emitted);
            }
        }
    }
}

/// A picture of the sphere under the studio, `times` paths in each pixel.
fn sphere(prepared: &Prepared<'_>, times: usize) {
    let spec = SceneSpec {
        lights: vec![LightSpec::Environment(EnvironmentSource::Studio)],
        depth: 1,
        ..SceneSpec::row(&["nickel".to_owned()], 1.0)
    };
    let brdf = prepared.brdf(LookupRule::Linear);
    let sampler = prepared.sampler("half-vector").shared();
    let scene = Scene::build(&spec, PlanRequest::AsNeeded, |_, _| {
        Ok(Surface {
            brdf: brdf.clone(),
            sampler: Some(sampler.clone()),
        })
    });
    let settings = RenderSettings {
        width: SIDE,
        height: SIDE,
        seed: 1,
        points: PointSet::Lattice,
        budget: Budget::Even(times as u64),
    };
    black_box(render(&scene.expect("a scene"), &settings, &|_| {}).expect("a picture"));
}

fn run(kernel: &str, times: usize, prepared: &Prepared<'_>) {
    // Parallel work is done by this thread.
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread()
        .build();
    let _pool = pool.expect("a pool of this thread");
    match kernel {
        "half-vector-sample-pairs" => sample_pairs(prepared.sampler("half-vector").as_dyn(), times),
        "half-vector-pdf-pairs" => pdf_pairs(prepared.sampler("half-vector").as_dyn(), times),
        "half-vector-sample-single" => {
            sample_singly(prepared.sampler("half-vector").as_dyn(), times)
        }
        "linear-eval-pairs" | "floor-eval-pairs" => {
            let is_linear = kernel.starts_with("linear");
            let rule = if is_linear {
                LookupRule::Linear
            } else {
                LookupRule::Floor
            };
            let sampler = prepared.sampler("half-vector");
            eval_pairs(&*prepared.brdf(rule), sampler.as_dyn(), times);
        }
        "environment-sample" => environment(true, times),
        "environment-emitted" => environment(false, times),
        "cascade-cdf-sample" => sample_singly(prepared.sampler("cascade-cdf").as_dyn(), times),
        "cascade-cdf-sample-pairs" => sample_pairs(prepared.sampler("cascade-cdf").as_dyn(), times),
        "adaptive-disc-sample-pairs" => {
            sample_pairs(prepared.sampler("adaptive-disc").as_dyn(), times)
        }
        "adaptive-disc-sample" => sample_singly(prepared.sampler("adaptive-disc").as_dyn(), times),
        "sphere-path" => sphere(prepared, times),
        other => panic!("no kernel {other}: see --kernels"),
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["--kernels"] => {
            for (name, calls) in KERNELS {
                println!("{name} {calls}");
            }
        }
        ["--prepare", folder] => Prepared {
            folder: Path::new(folder),
        }
        .write(),
        ["--once", kernel, times, folder] => {
            let times = times.parse().expect("how often");
            let folder = Path::new(folder);
            run(kernel, times, &Prepared { folder });
        }
        _ => println!("counted: run by tools/count_instructions"),
    }
}
