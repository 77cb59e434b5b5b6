//! Write a sampler outside the library and let the library's own checks judge it.
//!
//! Two samplers are checked: one that is right, and one whose density is not that of its draws.
//!
//! `cargo run --release --example check_your_own_sampler`

use std::f32::consts::{FRAC_1_PI, TAU};

use merlkit::geometry::unit_upper;
use merlkit::glam::{Vec2, Vec3};
use merlkit::{DirectionSample, DirectionSampler, LookupRule, Material};
use merlkit_evaluate::measure::check::{
    CheckReport, CheckSettings, check_directions, check_sampler,
};

/// Every direction above the horizon is equally likely.
struct UniformHemisphere {
    /// What `pdf` returns is multiplied by this; 1 is right.
    factor: f32,
}

impl DirectionSampler for UniformHemisphere {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        unit_upper(wo)?;
        // Equal areas of the sphere have equal heights (Archimedes): z = 1 − u₁ is uniform, and never 0.
        let z = 1.0 - u.x;
        let radius = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = (TAU * u.y).sin_cos();
        let wi = Vec3::new(radius * cos, radius * sin, z);
        Some(DirectionSample {
            wi,
            pdf: self.pdf(wo, wi),
        })
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if unit_upper(wo).is_none() || unit_upper(wi).is_none() {
            return 0.0;
        }
        self.factor * 0.5 * FRAC_1_PI
    }

    fn bytes(&self) -> usize {
        0
    }
}

/// Checks the sampler, whose density is off by `factor`, on a material.
pub fn check(factor: f32) -> merlkit::Result<CheckReport> {
    let material = Material::resolve("lambert:reflectance=0.5")?.load(LookupRule::Floor)?;
    let settings = CheckSettings {
        draws: 20_000,
        ..CheckSettings::default()
    };
    let sampler = UniformHemisphere { factor };
    Ok(check_sampler(
        &sampler,
        &**material.brdf(),
        &check_directions(),
        &settings,
    ))
}

pub fn main() -> merlkit::Result<()> {
    println!("right density: pass = {}", check(1.0)?.pass());
    let wrong = check(1.1)?;
    println!("density 10 % too high: pass = {}", wrong.pass());
    for failure in wrong.failures().take(3) {
        println!("  {failure:?}");
    }
    Ok(())
}
