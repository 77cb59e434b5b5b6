//! The same seed gives the same bytes: for any number of threads, for fresh and loaded samplers, in every build.
//!
//! What may differ between processors and platforms are the last bits of what the system's sine, cosine, tangent, arc tangent
//! and exponential return, and all that follows from them: embedded materials, samplers' tables, draws, pictures. What must not
//! differ anywhere, optimised or not, is what needs no more than IEEE arithmetic: random numbers, hard cases and their files,
//! piecewise densities. `golden_*` holds that to constants.

use std::sync::Arc;

use glam::{DVec2, Vec2};
use merlkit::distribution::Piecewise2d;
use merlkit::geometry::spherical;
use merlkit::image::Image;
use merlkit::light::{EnvironmentSource, LightSpec};
use merlkit::material::Material;
use merlkit::material::merl::HardCase;
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::points::PointSet;
use merlkit::render::{Budget, PlanRequest, RenderSettings, Scene, SceneSpec, Surface, render};
use merlkit::sampler::store::{SamplerFile, encode};
use merlkit::sampler::{
    AdaptiveDiscSettings, CascadeCdfSettings, CosineSettings, HalfVectorSettings, LeafChoice,
    Sampler, SamplerSpec,
};
use merlkit_evaluate::measure::hard::{Thoroughness, check_hard};

/// FNV-1a.
struct Hash(u64);

impl Hash {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn bytes(&mut self, bytes: &[u8]) {
        for b in bytes {
            self.0 = (self.0 ^ u64::from(*b)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn floats(&mut self, values: &[f32]) {
        values
            .iter()
            .for_each(|v| self.bytes(&v.to_bits().to_le_bytes()));
    }
}

fn specs() -> [SamplerSpec; 5] {
    let disc = AdaptiveDiscSettings {
        tables: 4,
        ..Default::default()
    };
    [
        SamplerSpec::new(CosineSettings {}),
        SamplerSpec::new(disc),
        SamplerSpec::new(AdaptiveDiscSettings {
            leaves: LeafChoice::Warp,
            ..disc
        }),
        SamplerSpec::new(CascadeCdfSettings {
            tables: 4,
            theta_h: 128,
            phi_h: 64,
            ..Default::default()
        }),
        SamplerSpec::new(HalfVectorSettings::default()),
    ]
}

/// Draws one by one, many at once, and densities.
fn draws(sampler: &Sampler) -> u64 {
    let mut hash = Hash::new();
    for degrees in [0.0, 33.3, 80.0f64] {
        let wo = spherical(degrees.to_radians(), 1.0).as_vec3();
        let points = (0..2000).map(|i| PointSet::Sobol.point(9, i, 0));
        let single = points.map(|u| sampler.sample(wo, u));
        for draw in single.chain(sampler.draw_stratified(wo, 500, 3)).flatten() {
            hash.floats(&[
                draw.wi.x,
                draw.wi.y,
                draw.wi.z,
                draw.pdf,
                sampler.pdf(wo, draw.wi),
            ]);
        }
    }
    hash.0
}

fn picture(brdf: &Arc<MerlBrdf>, sampler: &Sampler) -> Image {
    let row = SceneSpec::row(&["left".into(), "right".into()], 1.5);
    let lights = vec![
        row.light("area").unwrap(),
        row.light("point").unwrap(),
        LightSpec::Environment(EnvironmentSource::Studio),
    ];
    let spec = SceneSpec {
        lights,
        floor: Some(0.4),
        ..row
    };
    let surface = Surface {
        brdf: brdf.clone(),
        sampler: Some(sampler.shared()),
    };
    let scene = Scene::build(&spec, PlanRequest::AsNeeded, |_, _| Ok(surface.clone())).unwrap();
    let settings = RenderSettings {
        width: 30,
        height: 20,
        seed: 11,
        points: PointSet::Sobol,
        budget: Budget::Even(4),
    };
    render(&scene, &settings, &|_| {})
        .unwrap()
        .film
        .to_image()
        .unwrap()
}

/// Everything that a seed determines, on so many threads.
fn everything(threads: usize) -> Vec<u64> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    pool.install(|| {
        let material = Material::resolve("nickel").unwrap();
        let loaded = material.load(LookupRule::Floor).unwrap();
        let brdf = loaded.table().unwrap().clone();
        let mut all = Vec::new();
        for spec in specs() {
            let sampler = spec.build(&loaded).unwrap();
            let mut hash = Hash::new();
            if let Ok(file) = encode(&sampler, &material) {
                hash.bytes(&file);
            }
            hash.floats(bytemuck::cast_slice(picture(&brdf, &sampler).pixels()));
            all.extend([hash.0, draws(&sampler)]);
        }
        let case = [*HardCase::named("holes").unwrap()];
        let mut hash = Hash::new();
        let outcomes = check_hard(&case, Thoroughness::Quick, 1, &|| {}).unwrap();
        hash.bytes(serde_json::to_string(&outcomes).unwrap().as_bytes());
        all.push(hash.0);
        all
    })
}

#[test]
fn one_two_and_seven_threads_give_the_same_bytes() {
    let one = everything(1);
    assert_eq!(one, everything(2));
    assert_eq!(one, everything(7));
}

#[test]
fn a_loaded_sampler_draws_what_the_fresh_one_drew() {
    let folder = tempfile::tempdir().unwrap();
    let material = Material::resolve("nickel").unwrap();
    let centred = material.load(LookupRule::Centred).unwrap();
    let brdf = centred.table().unwrap().clone();
    for (i, spec) in specs().into_iter().enumerate() {
        let fresh = spec.build(&centred).unwrap();
        let Ok(bytes) = encode(&fresh, &material) else {
            continue;
        };
        let path = folder.path().join(i.to_string());
        std::fs::write(&path, &bytes).unwrap();
        let loaded = SamplerFile::open(&path)
            .unwrap()
            .into_sampler(&centred)
            .unwrap();
        assert_eq!(draws(&fresh), draws(&loaded), "{spec:?}");
        assert!(encode(&loaded, &material).unwrap() == bytes, "{spec:?}");
        let pictures = [fresh, loaded].map(|s| picture(&brdf, &s));
        assert!(pictures[0].pixels() == pictures[1].pixels(), "{spec:?}");
    }
}

#[test]
fn golden_bytes_are_the_same_on_every_machine_and_in_every_build() {
    let mut hash = Hash::new();
    for points in [PointSet::Random, PointSet::Sobol] {
        for index in (0..1000).chain((1 << 32) - 5..(1 << 32) + 5) {
            hash.floats(&points.point4(7, index, index as u32 % 9));
        }
    }
    let numbers = hash.0;
    let mut hash = Hash::new();
    for name in ["noise", "holes", "poisoned", "islands"] {
        for cell in HardCase::named(name).unwrap().table().cells() {
            hash.floats(&cell.to_array());
        }
    }
    let tables = hash.0;
    let mut hash = Hash::new();
    let weights: Vec<f64> = (0..64 * 32u32)
        .map(|i| f64::from(i * 7919 % 1009))
        .collect();
    let density = Piecewise2d::new(64, 32, &weights).unwrap();
    for i in 0..1000 {
        let p: DVec2 = density.sample(PointSet::Sobol.point(1, i, 0).as_dvec2());
        hash.floats(&[p.x as f32, p.y as f32, density.pdf(p) as f32]);
        let u: Vec2 = density.invert(p).unwrap().as_vec2();
        hash.floats(&[u.x, u.y]);
    }
    assert_eq!([numbers, tables, hash.0], GOLDEN);
}

const GOLDEN: [u64; 3] = [
    4_595_419_572_647_753_109,
    18_431_126_905_448_476_285,
    5_463_185_417_969_051_909,
];
