//! Build a sampler, draw directions and estimate the albedo from them.
//!
//! `cargo run --release --example build_and_draw`

use merlkit::geometry::spherical;
use merlkit::glam::{Vec2, Vec3};
use merlkit::{LookupRule, Material, SamplerSpec};

pub fn main() -> merlkit::Result<()> {
    let material = Material::resolve("nickel")?.load(LookupRule::Floor)?;

    // The text that the command line takes after --sampler; `merlkit samplers` lists all of them.
    let spec: SamplerSpec = "half-vector:64KB".parse()?;
    let sampler = spec.build(&material)?;
    println!("{spec}: {} bytes", sampler.as_dyn().bytes());

    // E[f_r·cosθ/pdf] over the draws is the albedo at `wo`.
    let wo = spherical(0.5, 0.0).as_vec3();
    let mut sum = Vec3::ZERO;
    let side = 64;
    for i in 0..side * side {
        // Any points of the unit square will do; the better they are spread, the less noise.
        let u = Vec2::new((i / side) as f32 + 0.5, (i % side) as f32 + 0.5) / side as f32;
        // A failed draw counts as a sample of weight 0. This sampler never fails.
        if let Some(sample) = sampler.as_dyn().sample(wo, u) {
            sum += material.brdf().eval_cos(wo, sample.wi) / sample.pdf;
        }
    }
    println!("albedo at 28.6°: {}", sum / (side * side) as f32);
    Ok(())
}
