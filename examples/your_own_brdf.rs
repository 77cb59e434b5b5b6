//! Write a BRDF outside the library, and build, check and compare the library's samplers on it.
//!
//! `cargo run --release --example your_own_brdf`

use std::f32::consts::PI;
use std::sync::Arc;

use merlkit::color::Rgb;
use merlkit::geometry::unit_upper;
use merlkit::glam::Vec3;
use merlkit::{Brdf, Loaded, SamplerSpec};
use merlkit_evaluate::measure::check::{
    CheckReport, CheckSettings, check_directions, check_sampler,
};

/// The Phong lobe around the mirror direction, as Lafortune and Willems (1994) normalise it, over a diffuse floor.
struct Phong {
    exponent: f32,
    specular: Rgb,
    diffuse: Rgb,
}

impl Brdf for Phong {
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        // Zero, never NaN, for what is no direction above the horizon.
        let (Some(wo), Some(wi)) = (unit_upper(wo), unit_upper(wi)) else {
            return Rgb::ZERO;
        };
        // f_r = ρd/π + ρs·(n + 2)/(2π)·cosⁿα, with α the angle between wi and the mirror direction of wo.
        let mirror = Vec3::new(-wo.x, -wo.y, wo.z);
        let cos_alpha = wi.dot(mirror).clamp(0.0, 1.0);
        let lobe = (self.exponent + 2.0) / (2.0 * PI) * cos_alpha.powf(self.exponent);
        self.diffuse / PI + self.specular * lobe
    }

    fn is_isotropic(&self) -> bool {
        true
    }
}

/// Builds a sampler on the BRDF and checks it.
pub fn check(sampler: &str) -> merlkit::Result<CheckReport> {
    let material = Loaded::from_brdf(Arc::new(Phong {
        exponent: 40.0,
        specular: Rgb::splat(0.4),
        diffuse: Rgb::new(0.3, 0.1, 0.1),
    }));
    let spec: SamplerSpec = sampler.parse()?;
    let sampler = spec.build(&material)?;
    let settings = CheckSettings {
        draws: 20_000,
        ..CheckSettings::default()
    };
    Ok(check_sampler(
        sampler.as_dyn(),
        &**material.brdf(),
        &check_directions(),
        &settings,
    ))
}

pub fn main() -> merlkit::Result<()> {
    for sampler in ["half-vector:64KB", "cascade-cdf", "lobe:ggx", "cosine"] {
        println!("{sampler}: pass = {}", check(sampler)?.pass());
    }
    Ok(())
}
