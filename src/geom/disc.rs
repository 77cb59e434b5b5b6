//! Equal-area maps from the unit square to the disc, and from the disc to the hemisphere.

use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Shirley and Chiu's concentric map: [0,1)² to the unit disc, area preserving and continuous.
pub fn concentric_disc(u: DVec2) -> DVec2 {
    let p = 2.0 * u - DVec2::ONE;
    if p == DVec2::ZERO {
        return DVec2::ZERO;
    }
    let (r, phi) = if p.x.abs() > p.y.abs() {
        (p.x, FRAC_PI_4 * (p.y / p.x))
    } else {
        (p.y, FRAC_PI_2 - FRAC_PI_4 * (p.x / p.y))
    };
    r * DVec2::new(phi.cos(), phi.sin())
}

/// [0,1)² to the hemisphere with density cosθ/π per solid angle (Malley). `z` is 0 only on the rim of the disc.
pub fn cosine_hemisphere(u: DVec2) -> DVec3 {
    let d = concentric_disc(u);
    d.extend((1.0 - d.length_squared()).max(0.0).sqrt())
}
