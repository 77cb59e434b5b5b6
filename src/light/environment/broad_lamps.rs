//! The built-in light for measuring BRDF samplers: everything broad.

use glam::DVec3;

use super::map::{Environment, SkySampling};
use crate::color::Rgb;

/// Size of the map: a cell is a tenth of the narrower lamp.
const WIDTH: usize = 256;
const HEIGHT: usize = 128;

/// Two lamps of 30° and 15° half width over a gradient, all grey and smooth. There is no small light in it whose noise would
/// be that of every BRDF sampler alike.
///
/// See [`Light`](crate::light::Light) for an example that samples an environment.
pub fn broad_lamps(sampling: SkySampling) -> Environment {
    Environment::procedural(WIDTH, HEIGHT, sampling, |w| Rgb::splat(radiance(w) as f32))
}

fn radiance(w: DVec3) -> f64 {
    let gradient = (0.2 + 0.3 * w.y).max(0.05);
    gradient
        + 4.0 * lobe(w, DVec3::new(0.5, 0.8, -0.3), 8)
        + 2.0 * lobe(w, DVec3::new(-0.8, 0.4, -0.2), 30)
}

/// max(w·t, 0)ⁿ about the axis `towards`, of any length.
fn lobe(w: DVec3, towards: DVec3, n: i32) -> f64 {
    w.dot(towards.normalize()).max(0.0).powi(n)
}
