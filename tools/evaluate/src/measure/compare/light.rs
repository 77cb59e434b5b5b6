//! What sampling the light needs.

use crate::measure::cost::time;
use merlkit::color::Rgb;
use merlkit::geometry::spherical;
use merlkit::light::{Environment, SkySampling};

/// The tables by which an environment chooses directions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightTables {
    /// Bytes that they hold; 0 if directions are chosen without.
    pub bytes: usize,
    /// Wall-clock seconds of building them again from the environment's pixels, without reading a file.
    pub build_seconds: f64,
}

impl LightTables {
    /// Counts the bytes of `sky`'s tables and times how long building as many takes.
    pub fn measure(sky: &Environment) -> Self {
        let bytes = sky.table_bytes();
        if bytes == 0 {
            return Self::default();
        }
        let [width, height] = sky.size();
        let pixels = pixels(sky, width, height);
        let (rebuilt, seconds) =
            time(|| Environment::new(width, height, pixels, SkySampling::Importance));
        // Pixels that were taken once are taken again; what is refused would have no tables to count.
        let build_seconds = rebuilt.map_or(0.0, |_| seconds.wall);
        Self {
            bytes,
            build_seconds,
        }
    }
}

/// Radiance towards the centre of each pixel.
fn pixels(sky: &Environment, width: usize, height: usize) -> Vec<Rgb> {
    let mut pixels = Vec::with_capacity(width * height);
    for row in 0..height {
        let theta = (row as f64 + 0.5) / height as f64 * std::f64::consts::PI;
        for column in 0..width {
            let phi = (column as f64 + 0.5) / width as f64 * std::f64::consts::TAU;
            let d = spherical(theta, phi);
            // The zenith of an environment is +y.
            pixels.push(sky.radiance(glam::DVec3::new(d.x, d.z, d.y)));
        }
    }
    pixels
}
