//! A sphere under two directional lights: what a fit looks like.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use merlkit::Result;
use merlkit::brdf::Brdf;
use merlkit::geometry::Frame;
use merlkit::image::{Image, encode_srgb};

/// Directions towards the lights and their irradiances: one from above on the left, and a weaker one from the right, at whose
/// edge directions graze.
const LIGHTS: [([f64; 3], f64); 2] = [([-0.5, 0.6, 0.7], PI), ([0.9, 0.2, 0.1], 0.4 * PI)];

/// Distances between the samples of a pixel's side, of which there are two.
const SAMPLES: [f64; 2] = [0.25, 0.75];

/// The sphere seen from +z without perspective, `side` pixels wide; a white diffuse material that faces the first light has the
/// value 1.
///
/// # Errors
/// None for a side above 0.
pub fn sphere_image(brdf: &dyn Brdf, side: usize) -> Result<Image> {
    let mut pixels = Vec::with_capacity(side * side);
    for row in 0..side {
        for column in 0..side {
            let mut sum = DVec3::ZERO;
            for dx in SAMPLES {
                for dy in SAMPLES {
                    let x = 2.0 * (column as f64 + dx) / side as f64 - 1.0;
                    let y = 1.0 - 2.0 * (row as f64 + dy) / side as f64;
                    sum += shade(brdf, x, y);
                }
            }
            pixels.push((0.25 * sum).as_vec3());
        }
    }
    Image::new(side, side, pixels)
}

/// The radiance of the sphere at (x, y), 0 outside.
fn shade(brdf: &dyn Brdf, x: f64, y: f64) -> DVec3 {
    let z2 = 1.0 - x * x - y * y;
    if z2 <= 0.0 {
        return DVec3::ZERO;
    }
    let normal = DVec3::new(x, y, z2.sqrt());
    let frame = Frame::around(normal.as_vec3(), Vec3::Y);
    let wo = frame.to_local(Vec3::Z);
    let mut sum = DVec3::ZERO;
    for (towards, irradiance) in LIGHTS {
        let wi = frame.to_local(DVec3::from_array(towards).normalize().as_vec3());
        if wi.z > 0.0 {
            sum += irradiance * brdf.eval_cos(wo, wi).as_dvec3();
        }
    }
    sum
}

/// The root mean square of the differences of two spheres in a PNG's values, 0 to 255, over the pixels of the disc and the
/// channels.
pub fn sphere_difference(a: &Image, b: &Image) -> f64 {
    let (levels, others) = (encode_srgb(a, 0.0), encode_srgb(b, 0.0));
    let side = a.width();
    let (mut sum, mut count) = (0.0, 0);
    for (i, (a, b)) in levels.iter().zip(&others).enumerate() {
        let (x, y) = (
            disc_coordinate(i / 3 % side, side),
            disc_coordinate(i / 3 / side, side),
        );
        if x * x + y * y < 1.0 {
            sum += (f64::from(*a) - f64::from(*b)).powi(2);
            count += 1;
        }
    }
    (sum / f64::from(count.max(1))).sqrt()
}

/// Where the middle of a pixel lies between the edges of the disc, −1 to 1.
fn disc_coordinate(pixel: usize, side: usize) -> f64 {
    2.0 * (pixel as f64 + 0.5) / side as f64 - 1.0
}
