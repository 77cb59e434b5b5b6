//! How seconds and bytes grow with pixels, paths, materials, threads, and the sizes of tables and environments, with fitted
//! exponents. It prints the tables of `docs/growth.md`.
//!
//! `cargo bench --bench growth -- [SECTION…]`; without a section, all of them in some ten minutes. Seconds are CPU time of one
//! thread, sizes in turn, the lower quartile of the rounds; bytes are the most that the heap held at once.

mod fit;
mod peak;
mod picture;
mod table;
mod threads;

use std::f64::consts::TAU;
use std::hint::black_box;

use glam::{DVec2, DVec3, Vec2, Vec3};
use merlkit::geometry::spherical;
use merlkit::light::{Environment, Light, SkySampling, studio};
use merlkit::material::merl::embedded_names;
use merlkit::points::PointSet;
use merlkit::sampler::HalfVectorSettings;
use merlkit::{Loaded, LookupRule, Material, Sampler, SamplerSpec, Wo};

use peak::peak_bytes;
use picture::Picture;
use table::{Column, Unit, Works, print_table};

/// Directions that a renderer asks for at once.
const LANES: usize = 64;
/// Calls of a timed work.
const CALLS: usize = 1 << 14;

fn pixels() {
    const SIDES: [usize; 5] = [64, 128, 256, 512, 1024];
    const PATHS: u64 = 4;
    let picture = Picture::new();
    let mut works = Works::default();
    let (mut labels, mut sizes, mut bytes) = (Vec::new(), Vec::new(), Vec::new());
    for side in SIDES {
        labels.push(format!("{side} × {side}"));
        sizes.push((side * side) as f64);
        bytes.push(peak_bytes(|| picture.render(side, PATHS, &|_| {})) as f64);
        let picture = &picture;
        works.add(move || picture.render(side, PATHS, &|_| {}));
    }
    println!("\n## Pixels\n\n{PATHS} paths a pixel.");
    let columns = picture_columns(works.seconds(8), bytes);
    print_table("pixels", &labels, &sizes, &columns);
}

fn paths() {
    const PATHS: [u64; 4] = [4, 16, 64, 256];
    const SIDE: usize = 96;
    let picture = Picture::new();
    let mut works = Works::default();
    let (mut labels, mut sizes, mut bytes) = (Vec::new(), Vec::new(), Vec::new());
    for paths in PATHS {
        labels.push(paths.to_string());
        sizes.push(paths as f64);
        bytes.push(peak_bytes(|| picture.render(SIDE, paths, &|_| {})) as f64);
        let picture = &picture;
        works.add(move || picture.render(SIDE, paths, &|_| {}));
    }
    println!("\n## Paths\n\n{SIDE} × {SIDE} pixels.");
    let columns = picture_columns(works.seconds(12), bytes);
    print_table("paths a pixel", &labels, &sizes, &columns);
}

fn picture_columns(seconds: Vec<f64>, bytes: Vec<f64>) -> [Column; 2] {
    [
        Column {
            name: "rendering",
            unit: Unit::Seconds,
            values: seconds,
        },
        Column {
            name: "heap",
            unit: Unit::Kilobytes,
            values: bytes,
        },
    ]
}

/// A material with its sampler.
fn load_and_build(name: &str) -> (Loaded, Sampler) {
    let material = Material::resolve(name).expect("an embedded material");
    let material = material.load(LookupRule::Linear).expect("its table");
    let sampler = SamplerSpec::new(HalfVectorSettings::default()).build(&material);
    (material, sampler.expect("a sampler"))
}

fn load_and_build_all(names: &[String]) -> Vec<(Loaded, Sampler)> {
    names.iter().map(|name| load_and_build(name)).collect()
}

fn materials() {
    const COUNTS: [usize; 5] = [1, 3, 10, 30, 100];
    let mut works = Works::default();
    let (mut labels, mut sizes, mut bytes) = (Vec::new(), Vec::new(), Vec::new());
    for count in COUNTS {
        labels.push(count.to_string());
        sizes.push(count as f64);
        let names = &embedded_names()[..count];
        bytes.push(peak_bytes(|| load_and_build_all(names)) as f64);
        works.add(move || load_and_build_all(names));
    }
    println!(
        "\n## Materials\n\nEmbedded networks made into tables, and a half-vector table of 64 KB for each; all are kept."
    );
    let columns = [
        Column {
            name: "loading and building",
            unit: Unit::Seconds,
            values: works.seconds(1),
        },
        Column {
            name: "heap",
            unit: Unit::Kilobytes,
            values: bytes,
        },
    ];
    print_table("materials", &labels, &sizes, &columns);
}

/// Viewers nearly equal within each [`LANES`], and points of the unit square.
fn views() -> (Vec<Vec3>, Vec<Vec2>) {
    let (mut wo, mut u) = (Vec::new(), Vec::new());
    for i in 0..CALLS as u64 {
        let pixel = PointSet::Random.point(1, i / LANES as u64, 0).as_dvec2();
        let within = PointSet::Random.point(2, i, 0).as_dvec2() * 0.01;
        let view = spherical(pixel.x * 1.47 + within.x, pixel.y * TAU + within.y);
        wo.push(view.as_vec3());
        u.push(PointSet::Random.point(3, i, 0));
    }
    (wo, u)
}

fn tables() {
    let material = Material::resolve("nickel").expect("an embedded material");
    let material = material.load(LookupRule::Floor).expect("its table");
    let (mut labels, mut sizes, mut heap) = (Vec::new(), Vec::new(), Vec::new());
    let mut samplers = Vec::new();
    let mut builds = Works::default();
    for (name, settings) in HalfVectorSettings::PRESETS {
        let spec = SamplerSpec::new(settings);
        heap.push(peak_bytes(|| spec.build(&material)) as f64);
        let sampler = spec.build(&material).expect("a sampler");
        labels.push(name.to_owned());
        sizes.push(sampler.as_dyn().bytes() as f64);
        samplers.push(sampler);
        let material = &material;
        builds.add(move || spec.build(material));
    }
    let [batches, singles] = draw_seconds(&samplers);
    println!(
        "\n## Tables\n\nHalf-vector tables of nickel; the exponents are against the bytes of the tables."
    );
    let columns = [
        Column {
            name: "tables",
            unit: Unit::Kilobytes,
            values: sizes.clone(),
        },
        Column {
            name: "building",
            unit: Unit::Seconds,
            values: builds.seconds(16),
        },
        Column {
            name: "heap while building",
            unit: Unit::Kilobytes,
            values: heap,
        },
        Column {
            name: "a draw, batches of 64",
            unit: Unit::Nanoseconds,
            values: batches,
        },
        Column {
            name: "a single draw",
            unit: Unit::Nanoseconds,
            values: singles,
        },
    ];
    print_table("size", &labels, &sizes, &columns);
}

/// Seconds a draw of each sampler, in batches and singly.
fn draw_seconds(samplers: &[Sampler]) -> [Vec<f64>; 2] {
    let (wo, u) = &views();
    let (mut batches, mut singles) = (Works::default(), Works::default());
    for sampler in samplers {
        let sampler = sampler.as_dyn();
        let mut drawn = vec![None; LANES];
        batches.add(move || {
            for (wo, u) in wo.chunks(LANES).zip(u.chunks(LANES)) {
                sampler.sample_batch(Wo::Each(black_box(wo)), u, &mut drawn);
            }
        });
        singles.add(move || {
            for (&wo, &u) in wo.iter().zip(u) {
                black_box(sampler.sample(black_box(wo), u));
            }
        });
    }
    [batches, singles].map(|works| a_call(works.seconds(48)))
}

fn a_call(seconds: Vec<f64>) -> Vec<f64> {
    seconds.into_iter().map(|s| s / CALLS as f64).collect()
}

/// The studio by pixels.
fn sky_pixels(width: usize, height: usize) -> Vec<Vec3> {
    let sky = studio(SkySampling::Uniform);
    let mut pixels = Vec::new();
    for i in 0..width * height {
        let theta = ((i / width) as f64 + 0.5) / height as f64 * std::f64::consts::PI;
        let phi = ((i % width) as f64 + 0.5) / width as f64 * TAU;
        let (x, z) = (theta.sin() * phi.sin(), theta.sin() * phi.cos());
        pixels.push(sky.radiance(DVec3::new(x, theta.cos(), z)));
    }
    pixels
}

fn environments() {
    const HEIGHTS: [usize; 6] = [32, 64, 128, 256, 512, 1024];
    let (mut labels, mut sizes, mut heap) = (Vec::new(), Vec::new(), Vec::new());
    let mut skies = Vec::new();
    let mut builds = Works::default();
    for height in HEIGHTS {
        let width = 2 * height;
        let pixels = sky_pixels(width, height);
        labels.push(format!("{width} × {height}"));
        sizes.push((width * height) as f64);
        heap.push(peak_bytes(|| sky_of(width, pixels.clone())) as f64);
        skies.push(sky_of(width, pixels.clone()));
        builds.add(move || sky_of(width, pixels.clone()));
    }
    let [draws, looks] = direction_seconds(&skies);
    println!("\n## Environments\n\nThe studio as maps of pixels, with its sampling tables.");
    let columns = [
        Column {
            name: "building",
            unit: Unit::Seconds,
            values: builds.seconds(16),
        },
        Column {
            name: "heap",
            unit: Unit::Kilobytes,
            values: heap,
        },
        Column {
            name: "a draw, batches of 64",
            unit: Unit::Nanoseconds,
            values: draws,
        },
        Column {
            name: "radiance and density of a direction, batches of 64",
            unit: Unit::Nanoseconds,
            values: looks,
        },
    ];
    print_table("pixels", &labels, &sizes, &columns);
}

/// Seconds of a draw of a direction towards each sky, and of the radiance and density of one, in batches.
fn direction_seconds(skies: &[Environment]) -> [Vec<f64>; 2] {
    let u: Vec<DVec2> = views().1.iter().map(|u| u.as_dvec2()).collect();
    let u = &u;
    let (mut draws, mut looks) = (Works::default(), Works::default());
    for sky in skies {
        let from = [DVec3::ZERO; LANES];
        let mut sampled = vec![None; LANES];
        draws.add(move || {
            for u in u.chunks(LANES) {
                sky.sample_batch(&from, black_box(u), &mut sampled);
            }
        });
        let drawn = u.iter().filter_map(|&u| sky.sample(DVec3::ZERO, u));
        let wi: Vec<DVec3> = drawn.map(|s| s.wi).collect();
        let mut emitted = vec![None; LANES];
        looks.add(move || {
            for wi in wi.chunks_exact(LANES) {
                sky.emitted_batch(&from, black_box(wi), &[f64::INFINITY; LANES], &mut emitted);
            }
        });
    }
    [draws, looks].map(|works| a_call(works.seconds(48)))
}

fn sky_of(width: usize, pixels: Vec<Vec3>) -> Environment {
    let height = pixels.len() / width;
    Environment::new(width, height, pixels, SkySampling::Importance).expect("a map")
}

const SECTIONS: [(&str, fn()); 6] = [
    ("pixels", pixels),
    ("paths", paths),
    ("materials", materials),
    ("threads", threads::print),
    ("tables", tables),
    ("environments", environments),
];

fn main() {
    let asked: Vec<String> = std::env::args().skip(1).collect();
    let asked: Vec<&String> = asked.iter().filter(|a| *a != "--bench").collect();
    // Parallel work is done by this thread, so that its CPU time is all there is. `threads` makes pools of its own.
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread()
        .build();
    let _pool = pool.expect("a pool of this thread");
    for (name, section) in SECTIONS {
        if asked.is_empty() || asked.iter().any(|a| *a == name) {
            section();
        }
    }
}
