//! Files of measurements on grids of directions, as the KAIST and UTIA databases have them, written from a formula.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use merlkit::geometry::{reflect_about, spherical};

/// f_r of `wo` and `wi` at a wavelength in nm.
pub type Spectrum<'a> = &'a dyn Fn(DVec3, DVec3, f64) -> f64;
/// f_r of `wo` and `wi` in red, green and blue.
pub type Colour<'a> = &'a dyn Fn(DVec3, DVec3) -> [f64; 3];

pub const WAVELENGTHS: [u16; 5] = [450, 500, 550, 600, 650];

/// A field of a tensor file: name, type, shape and bytes.
pub type Field = (&'static str, u8, Vec<usize>, Vec<u8>);

fn floats(values: &[f64]) -> Vec<u8> {
    let mut out = Vec::new();
    for v in values {
        out.extend((*v as f32).to_le_bytes());
    }
    out
}

fn steps(first: f64, last: f64, count: usize) -> Vec<f64> {
    let step = |k: usize| first + (last - first) * k as f64 / (count - 1) as f64;
    (0..count).map(step).collect()
}

/// The fields of a `.pbsdf` file with so many angles φd, θd and θh. All elements but M00 are NaN or huge.
pub fn pbsdf_fields(counts: [usize; 3], f: Spectrum) -> Vec<Field> {
    let [p, d, h] = counts;
    let phi_d = steps(-PI, PI, p);
    let (theta_d, theta_h) = (steps(0.0, PI / 2.0, d), steps(0.0, PI / 2.0, h));
    let mut matrices = Vec::new();
    for phi_d in &phi_d {
        for theta_d in &theta_d {
            for theta_h in &theta_h {
                let half = spherical(*theta_h, 0.0);
                let turn = glam::DQuat::from_rotation_y(*theta_h);
                let wi = turn * spherical(*theta_d, *phi_d);
                let wo = reflect_about(wi, half);
                let is_upper = wi.z > 1e-9 && wo.z > 1e-9;
                for nm in WAVELENGTHS {
                    let value = match is_upper {
                        true => f(wo, wi, f64::from(nm)),
                        false => f64::NAN,
                    };
                    matrices.push(value);
                    matrices.extend([f64::NAN; 3]);
                    matrices.extend([1e30; 12]);
                }
            }
        }
    }
    let wavelengths = WAVELENGTHS.iter().flat_map(|nm| nm.to_le_bytes());
    vec![
        ("M", 10, vec![p, d, h, 5, 4, 4], floats(&matrices)),
        ("phi_d", 10, vec![1, p], floats(&phi_d)),
        ("theta_d", 10, vec![1, d], floats(&theta_d)),
        ("theta_h", 10, vec![1, h], floats(&theta_h)),
        ("wvls", 3, vec![5], wavelengths.collect()),
    ]
}

/// The bytes of a tensor file.
pub fn tensor_file(fields: &[Field]) -> Vec<u8> {
    let mut list = 18;
    for (name, _, shape, _) in fields {
        list += 13 + name.len() + 8 * shape.len();
    }
    let mut out = [
        &b"tensor_file\0\x01\0"[..],
        &(fields.len() as u32).to_le_bytes(),
    ]
    .concat();
    let mut at = list.next_multiple_of(8);
    for (name, dtype, shape, bytes) in fields {
        out.extend((name.len() as u16).to_le_bytes());
        out.extend(name.as_bytes());
        out.extend((shape.len() as u16).to_le_bytes());
        out.push(*dtype);
        out.extend((at as u64).to_le_bytes());
        for axis in shape {
            out.extend((*axis as u64).to_le_bytes());
        }
        at = (at + bytes.len()).next_multiple_of(8);
    }
    for (_, _, _, bytes) in fields {
        out.resize(out.len().next_multiple_of(8), 0);
        out.extend(bytes);
    }
    out
}

/// The bytes of a file of the UTIA database.
pub fn utia_file(f: Colour) -> Vec<u8> {
    let mut planes = [const { Vec::new() }; 3];
    for theta_i in 0..6 {
        for phi_i in 0..48 {
            for theta_v in 0..6 {
                for phi_v in 0..48 {
                    let wi = direction(theta_i, phi_i);
                    let wo = direction(theta_v, phi_v);
                    for (plane, value) in planes.iter_mut().zip(f(wo, wi)) {
                        plane.extend(value.to_le_bytes());
                    }
                }
            }
        }
    }
    planes.concat()
}

fn direction(theta: u32, phi: u32) -> DVec3 {
    spherical(
        (15.0 * f64::from(theta)).to_radians(),
        TAU * f64::from(phi) / 48.0,
    )
}
