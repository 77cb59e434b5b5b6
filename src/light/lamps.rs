//! The built-in light for measuring BRDF samplers: everything broad.

use glam::DVec3;

use super::environment::{Environment, SkySampling};
use crate::Result;
use crate::color::Rgb;
use crate::geom::spherical;

/// Size of the map: a cell is a tenth of the narrower lamp.
const WIDTH: usize = 256;
const HEIGHT: usize = 128;

/// Two lamps of 30° and 15° half width over a gradient, all grey and smooth. There is no small light in it whose noise would
/// be that of every BRDF sampler alike.
///
/// # Errors
/// None in practice: every pixel is finite.
pub fn lamps(sampling: SkySampling) -> Result<Environment> {
    let mut pixels = Vec::with_capacity(WIDTH * HEIGHT);
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            let theta = (y as f64 + 0.5) / HEIGHT as f64 * std::f64::consts::PI;
            let phi = ((x as f64 + 0.5) / WIDTH as f64 - 0.5) * std::f64::consts::TAU;
            // `spherical` has its pole at z and its zero at x: here they are +y and −z.
            let w = spherical(theta, phi);
            pixels.push(Rgb::splat(radiance(DVec3::new(w.y, w.z, -w.x)) as f32));
        }
    }
    Environment::new(WIDTH, HEIGHT, pixels, sampling)
}

fn radiance(w: DVec3) -> f64 {
    let lobe = |towards: DVec3, n: i32| w.dot(towards.normalize()).max(0.0).powi(n);
    let gradient = (0.2 + 0.3 * w.y).max(0.05);
    gradient + 4.0 * lobe(DVec3::new(0.5, 0.8, -0.3), 8) + 2.0 * lobe(DVec3::new(-0.8, 0.4, -0.2), 30)
}
