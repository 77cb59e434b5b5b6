//! From a reflectance function to the tensors of a `.bsdf` file.
//!
//! The square's x = √(2θm/π) is MERL's own axis of θh, so nothing need be stretched: `vndf` is 1, and with `ndf` 1 and `sigma` ¼
//! the colour is f_r·cosθᵢ itself. `luminance` is the density that draws in proportion to its luminance.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::file::{BsdfFile, Colour};
use super::spectrum::{PRIMARIES, WAVELENGTHS, to_spectra};
use super::tensors::Tensor;
use crate::color::{Rgb, luminance};
use crate::geometry::{reflect_about, spherical};

/// How finely a file resolves the given direction and the square of half vectors.
///
/// The example of [`BsdfFile`](crate::material::rgl::BsdfFile) tabulates a material and evaluates the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BsdfSize {
    /// Its name on the command line: about the bytes of an RGB file.
    pub name: &'static str,
    /// Polar angles of the given direction, at least 2.
    pub angles: usize,
    /// Nodes along each axis of the square, at least 2.
    pub side: usize,
}

impl BsdfSize {
    /// The presets, the smallest first.
    pub const ALL: [Self; 6] = [
        size("0.4MB", 12, 46),
        size("1.5MB", 24, 61),
        size("3MB", 23, 91),
        size("6MB", 46, 91),
        size("12MB", 90, 91),
        size("24MB", 46, 181),
    ];

    /// Bytes of the tables of an RGB file; one with spectra holds twice as many.
    pub fn bytes(self) -> usize {
        self.angles * self.side * self.side * 4 * size_of::<f32>()
    }
}

const fn size(name: &'static str, angles: usize, side: usize) -> BsdfSize {
    BsdfSize { name, angles, side }
}

/// The last polar angle, degrees: at 90 a slice would hold nothing.
const LAST: f64 = 89.5;
/// Least density of draws, in parts of a slice's mean: a slice without any could not be drawn from.
const FLOOR: f64 = 1e-6;

/// Tabulates an isotropic `value(wo, wi)` (f_r in sr⁻¹) as an RGB file, on all threads of the current pool.
///
/// The example of [`BsdfFile`](crate::material::rgl::BsdfFile) tabulates a material and evaluates the result.
pub fn tabulate(
    value: impl Fn(Vec3, Vec3) -> Rgb + Sync,
    size: BsdfSize,
    description: String,
) -> BsdfFile {
    let theta_i = angles(size.angles);
    let slices: Vec<ViewTables> = theta_i
        .par_iter()
        .map(|&theta| ViewTables::tabulate(f64::from(theta), size.side, &value))
        .collect();
    let (n, t) = (size.side, theta_i.len());
    let mut luminance = Vec::new();
    let mut rgb = Vec::new();
    for slice in &slices {
        luminance.extend_from_slice(&slice.luminance);
        rgb.extend_from_slice(&slice.rgb);
    }
    BsdfFile {
        notes: Vec::new(),
        description,
        jacobian: true,
        ndf: Tensor::filled(&[2, 2], 1.0),
        sigma: Tensor::filled(&[2, 2], 0.25),
        vndf: Tensor::filled(&[1, t, 2, 2], 1.0),
        luminance: Tensor {
            shape: vec![1, t, n, n],
            values: luminance,
        },
        colour: Colour::Rgb(Tensor {
            shape: vec![1, t, 3, n, n],
            values: rgb,
        }),
        phi_i: vec![0.0],
        theta_i,
    }
}

impl BsdfFile {
    /// Wavelengths in nm, and there the spectra of red, green and blue that [`Self::to_spectral`] mixes. They sum to 1, and are linear
    /// between the wavelengths and constant outside.
    pub fn primary_spectra() -> ([f32; 7], [[f32; 7]; 3]) {
        (WAVELENGTHS, PRIMARIES)
    }

    /// The same material with spectra for colours; itself if it has spectra.
    pub fn to_spectral(&self) -> Self {
        let Colour::Rgb(rgb) = &self.colour else {
            return self.clone();
        };
        let colour = Colour::Spectral {
            wavelengths: WAVELENGTHS.to_vec(),
            spectra: to_spectra(rgb),
        };
        Self {
            colour,
            ..self.clone()
        }
    }
}

/// Polar angles of the given direction, radians, closer towards the horizon: there the lobes narrow and grow. Against even
/// ones, the albedo's error and the spread of draws at grazing angles are up to a half smaller, the median error a tenth
/// larger.
fn angles(count: usize) -> Vec<f32> {
    let last = (count - 1) as f64;
    let mut angles = Vec::with_capacity(count);
    for k in 0..count {
        // θ = θ_last (1 − (1 − k/(n − 1))^(5/4)): the exponent above 1 draws the angles together at the end.
        let degrees = LAST * (1.0 - (1.0 - k as f64 / last).powf(1.25));
        angles.push(degrees.to_radians() as f32);
    }
    angles
}

/// One given direction's tables.
struct ViewTables {
    /// `[3, n, n]`.
    rgb: Vec<f32>,
    /// `[n, n]`.
    luminance: Vec<f32>,
}

impl ViewTables {
    fn tabulate(theta: f64, side: usize, value: &(impl Fn(Vec3, Vec3) -> Rgb + Sync)) -> Self {
        let wo = spherical(theta, 0.0);
        let mut rgb = vec![0.0; 3 * side * side];
        let mut mass = Vec::with_capacity(side * side);
        for k in 0..side * side {
            let node = SquareNode::new(k % side, k / side, side, wo);
            // With ndf 1 and sigma ¼ the colour is f_r·cosθᵢ itself.
            let f = node.value_cos(wo, value);
            for channel in 0..3 {
                rgb[channel * side * side + k] = f[channel];
            }
            // Density on the square: luminance times solid angle for a unit of its area.
            mass.push(f64::from(luminance(f)) * node.jacobian);
        }
        let mean = mass.iter().sum::<f64>() / mass.len() as f64;
        // Any scale will do: renderers normalise. This one keeps numbers near 1.
        let scale = if mean > 0.0 { 1.0 / mean } else { 0.0 };
        Self {
            rgb,
            luminance: mass.iter().map(|m| (m * scale).max(FLOOR) as f32).collect(),
        }
    }
}

/// A half vector and the direction `wo` is reflected to.
struct SquareNode {
    wi: DVec3,
    /// Solid angle of `wi` to a unit of area on the square.
    jacobian: f64,
}

impl SquareNode {
    fn new(column: usize, row: usize, side: usize, wo: DVec3) -> Self {
        let [x, y] = [column, row].map(|k| k as f64 / (side - 1) as f64);
        // θm = x²·π/2, φm = (2y − 1)·π.
        let theta_m = x * x * FRAC_PI_2;
        let m = spherical(theta_m, (2.0 * y - 1.0) * PI);
        // dω(wi) = 4 (wo·m) dω(m), dω(m) = 2π²·x·sinθm dx dy.
        let jacobian = TAU * PI * x * theta_m.sin() * 4.0 * wo.dot(m).max(0.0);
        Self {
            wi: reflect_about(wo, m),
            jacobian,
        }
    }

    fn value_cos(&self, wo: DVec3, value: &impl Fn(Vec3, Vec3) -> Rgb) -> Rgb {
        if self.wi.z <= 0.0 {
            return Rgb::ZERO;
        }
        value(wo.as_vec3(), self.wi.as_vec3()) * self.wi.z as f32
    }
}
