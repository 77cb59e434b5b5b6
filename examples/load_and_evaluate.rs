//! Load a material and evaluate it: one pair of directions, and many at once.
//!
//! `cargo run --release --example load_and_evaluate`

use merlkit::geometry::spherical;
use merlkit::glam::Vec3;
use merlkit::{LookupRule, Material, Wo};

pub fn main() -> merlkit::Result<()> {
    // An embedded name, a path to a MERL binary or a .bsdf file, or a formula.
    let material = Material::resolve("red-plastic")?;
    let loaded = material.load(LookupRule::Linear)?;
    let brdf = loaded.brdf();

    // Both directions leave the surface, in a frame whose z is the normal. Angles are radians.
    let wo = spherical(0.5, 0.0).as_vec3();
    let wi = spherical(0.6, 3.0).as_vec3();
    println!("f_r = {} per steradian", brdf.eval(wo, wi));
    println!("f_r·cosθ = {} per steradian", brdf.eval_cos(wo, wi));

    // Many `wi` for one `wo`: the same bits as one by one, sooner.
    let many: Vec<Vec3> = (0..90)
        .map(|degree| spherical(f64::from(degree).to_radians(), 3.0).as_vec3())
        .collect();
    let mut values = vec![Vec3::ZERO; many.len()];
    brdf.eval_batch(Wo::One(wo), &many, &mut values);
    let brightest = values.iter().map(|v| v.x).fold(0.0, f32::max);
    println!("brightest red of {} directions: {brightest}", many.len());

    // A table of red-plastic is isotropic; a .bsdf file may not be.
    println!("{:?}, {} bytes", brdf.symmetry(), loaded.bytes());
    Ok(())
}
