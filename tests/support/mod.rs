//! Slow, literal versions to compare with, and inputs that like to sit at the difficult places.
#![allow(dead_code)] // each test file uses its own part

pub mod anisotropic;
pub mod half_vector_oracle;
pub mod naive;
pub mod precise;
pub mod tampered;

use crate::ROOT;
use glam::Vec3;
use merlkit::geometry::spherical;
use merlkit::material::Loaded;
use merlkit::material::merl::{HardCase, Header, LookupRule, MerlBrdf, MerlTable, decode_embedded};
use merlkit::points::Stream;
use merlkit::sampler::{HalfVectorSettings, SamplerSpec};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

/// A table as a material in memory.
pub fn loaded(brdf: &Arc<MerlBrdf>) -> Loaded {
    Loaded::from_table(brdf.clone())
}

/// A built-in material, or a hard case, under a lookup rule.
pub fn measured_under(name: &str, rule: LookupRule) -> MerlBrdf {
    let table = match HardCase::named(name) {
        Some(case) => case.table(),
        None => decode_embedded(name).unwrap(),
    };
    MerlBrdf::new(Arc::new(table), rule)
}

/// [`measured_under`] the default rule, to be shared.
pub fn measured(name: &str) -> Arc<MerlBrdf> {
    Arc::new(measured_under(name, LookupRule::Floor))
}

/// The half-vector table's settings for a size, such as "64KB".
pub fn half_vector_preset(size: &str) -> HalfVectorSettings {
    let presets = HalfVectorSettings::PRESETS;
    presets.into_iter().find(|p| p.0 == size).unwrap().1
}

/// A sampler and its settings from their text.
pub fn sampler_spec(text: &str) -> SamplerSpec {
    text.parse().unwrap()
}

/// What the tables are compared with besides the cosine.
pub fn baselines() -> Vec<SamplerSpec> {
    SamplerSpec::parse_all(&[
        "lobe:cosine",
        "lobe:cosine-hemisphere",
        "lobe:cosine-sphere",
        "lobe:blinn",
        "lobe:ward",
        "lobe:ashikhmin-shirley",
        "lobe:ggx",
        "factored",
        "adaptive-disc:rejection",
    ])
    .unwrap()
}

/// Rows of a CSV in `tests/golden`, without its heading.
pub fn golden(name: &str) -> Vec<Vec<String>> {
    let path = format!("{ROOT}/tests/golden/{name}");
    let text = std::fs::read_to_string(path).unwrap();
    text.lines()
        .skip(1)
        .map(|l| l.split(',').map(str::to_owned).collect())
        .collect()
}

/// Pairs of directions above the horizon: anywhere, near grazing, near the mirror direction and nearly equal.
pub fn pairs(count: usize, seed: u64) -> impl Iterator<Item = (Vec3, Vec3)> {
    let mut random = Stream::new(seed);
    (0..count).map(move |i| {
        let mut x = || random.next_f64();
        let theta = if i % 3 == 0 {
            FRAC_PI_2 - x().powi(4) * 0.2
        } else {
            x() * FRAC_PI_2
        };
        let phi = x() * TAU;
        let wo = spherical(theta, phi);
        let tiny = x().powi(6);
        let wi = match i % 4 {
            0 => spherical(x() * FRAC_PI_2, x() * TAU),
            1 => spherical(theta + tiny * 0.1, phi + std::f64::consts::PI + tiny * x()),
            2 => spherical(theta - tiny * 0.1, phi + tiny * x()),
            _ => spherical(FRAC_PI_2 - x().powi(4) * 0.1, x() * TAU),
        };
        (
            wo.as_vec3(),
            Vec3::new(wi.x as f32, wi.y as f32, wi.z.abs() as f32),
        )
    })
}

/// A table of unrelated values between 0 and 4 in which one cell of `one_in` is invalid (none for 0).
pub fn noise_table(phi_d_bins: usize, one_in: u64, seed: u64) -> MerlTable {
    let mut random = Stream::new(seed);
    MerlTable::from_fn(Header { phi_d_bins }, |_, _, _| {
        let hole = one_in > 0 && random.next_u64().is_multiple_of(one_in);
        if hole {
            [-1.0; 3]
        } else {
            std::array::from_fn(|_| random.next_f64() * 4.0)
        }
    })
}
