//! The built-in environment: an overcast sky with two softboxes and a small sun.

use glam::DVec3;

use super::map::{Environment, SkySampling};
use crate::color::Rgb;

/// Size of the map: fine enough for the sun's soft edge, small enough for a cache.
const WIDTH: usize = 512;
const HEIGHT: usize = 256;

/// A lamp in the sky, seen from the scene as a rectangle with a soft edge.
struct Softbox {
    /// Towards its centre.
    towards: DVec3,
    /// Half its extent across and up, as tangents of angles.
    half: [f64; 2],
    /// Width of the edge, as a tangent.
    edge: f64,
    radiance: Rgb,
}

impl Softbox {
    fn radiance(&self, direction: DVec3) -> Rgb {
        let across = DVec3::Y.cross(self.towards).normalize_or(DVec3::X);
        let up = self.towards.cross(across);
        let depth = direction.dot(self.towards);
        if depth <= 0.0 {
            return Rgb::ZERO;
        }
        // Projected from the scene's middle to the plane of the box at the distance 1, offsets are tangents.
        let coverage = self.coverage(direction.dot(across) / depth, self.half[0])
            * self.coverage(direction.dot(up) / depth, self.half[1]);
        self.radiance * coverage as f32
    }

    /// 1 inside the box along one of its sides and 0 outside, with a soft edge: 3t² − 2t³ with t from 0 to 1 across the edge.
    fn coverage(&self, offset: f64, half: f64) -> f64 {
        let t = ((half - offset.abs()) / self.edge + 0.5).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }
}

/// A procedural studio under an overcast sky, radiance around 1: a large key light to the left, in front, a tall strip to
/// the right, and a small warm sun behind; it needs no file.
///
/// See [`Light`](crate::light::Light) for an example that samples an environment.
pub fn studio(sampling: SkySampling) -> Environment {
    let softboxes = softboxes();
    Environment::procedural(WIDTH, HEIGHT, sampling, |direction| {
        let mut radiance = sky(direction);
        for softbox in &softboxes {
            radiance += softbox.radiance(direction);
        }
        radiance
    })
}

fn softboxes() -> [Softbox; 3] {
    [
        Softbox {
            towards: DVec3::new(-0.75, 0.75, 0.65).normalize(),
            half: [0.42, 0.32],
            edge: 0.03,
            radiance: Rgb::new(7.0, 6.9, 6.7),
        },
        Softbox {
            towards: DVec3::new(1.0, 0.45, 0.25).normalize(),
            half: [0.12, 0.5],
            edge: 0.03,
            radiance: Rgb::new(4.6, 4.9, 5.3),
        },
        Softbox {
            towards: DVec3::new(0.35, 0.8, -0.9).normalize(),
            half: [0.05, 0.05],
            edge: 0.03,
            radiance: Rgb::new(75.0, 62.0, 45.0),
        },
    ]
}

/// From a light horizon to a darker blue zenith; a dark floor below.
fn sky(direction: DVec3) -> Rgb {
    let horizon = Rgb::new(0.62, 0.66, 0.72);
    let zenith = Rgb::new(0.16, 0.24, 0.40);
    let near = Rgb::new(0.20, 0.19, 0.18);
    let nadir = Rgb::new(0.07, 0.07, 0.07);
    let up = direction.y as f32;
    if up >= 0.0 {
        horizon.lerp(zenith, up.sqrt())
    } else {
        near.lerp(nadir, (-up).sqrt())
    }
}
