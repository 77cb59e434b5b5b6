//! Files of the UTIA BRDF database (Filip & Vávra 2014, "Template-based sampling of anisotropic BRDFs").
//!
//! A file has no header: 64-bit numbers, little-endian, in planes of red, green and blue. A plane is an array
//! `[theta_i 6][phi_i 48][theta_v 6][phi_v 48]`, elevations in steps of 15° from 0 to 75°, azimuths in steps of 7.5°, i the light
//! and v the viewer. The database's own reader (`TBRDF.cpp`) interpolates the numbers linearly and returns them as they are.

use std::f64::consts::TAU;
use std::path::Path;

use glam::{DVec3, Vec3};

use super::grid::{MeasuredGrid, Neighbours, interpolate};
use crate::files::{RegularFile, UTIA_BYTES, is_utia_number};
use crate::geometry::to_spherical;
use crate::{Error, Result};

const ELEVATIONS: usize = 6;
const AZIMUTHS: usize = 48;
/// Degrees between elevations.
const STEP: f64 = 15.0;
/// Numbers of a plane.
const PLANE: usize = ELEVATIONS * AZIMUTHS * ELEVATIONS * AZIMUTHS;
/// Elevations beyond the last by so many degrees are rounding.
const SLACK: f64 = 1e-4;

/// The mean over rotations about the normal of a file's reflectance.
pub(super) struct UtiaGrid {
    /// Elevations in degrees.
    theta: Vec<f64>,
    /// Azimuths in radians.
    phi: Vec<f64>,
    /// f_r by θ of the light, θ of the viewer, and azimuth from the light to the viewer.
    means: Vec<DVec3>,
}

/// How far a material's values are from their means over rotations.
struct Anisotropy {
    /// Σ|f − f̄|/Σ|f̄|.
    mean: f64,
    /// Greatest |f − f̄|/f̄ of the mean of the channels.
    greatest: f64,
    /// Elevations of light and viewer there, degrees.
    place: [f64; 2],
}

/// Reads a file; says in words what was lost or taken for granted.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] for another length, or with the place of what is no reflectance.
pub(super) fn read_utia(path: &Path) -> Result<(UtiaGrid, Vec<String>)> {
    let bytes = RegularFile::open(path)?.read_all(UTIA_BYTES)?;
    let values = read_values(&bytes, path)?;
    let (means, anisotropy) = mean_over_rotations(&values);
    let mut notes = vec![
        "a file of the UTIA database by its size: 6 elevations to 75° and 48 azimuths of light and viewer, whose numbers are \
         taken for linear f_r in sr⁻¹, as the database's own reader returns them"
            .into(),
        format!(
            "anisotropy was left out: the table is the mean over the rotation about the normal, from which f_r differs by \
             {:.2} % (mean) and {:.2} % (largest, light at {}°, viewer at {}°)",
            100.0 * anisotropy.mean,
            100.0 * anisotropy.greatest,
            anisotropy.place[0],
            anisotropy.place[1],
        ),
    ];
    let negative = values.iter().filter(|v| v.min_element() < 0.0).count();
    if negative > 0 {
        notes.push(format!(
            "measured values with a negative channel, which enter the means as they are: {negative} of {PLANE}"
        ));
    }
    notes.push("nothing was measured beyond 75°: cells there are gaps".into());
    let grid = UtiaGrid {
        theta: (0..ELEVATIONS).map(|k| STEP * k as f64).collect(),
        phi: (0..AZIMUTHS)
            .map(|k| TAU * k as f64 / AZIMUTHS as f64)
            .collect(),
        means,
    };
    Ok((grid, notes))
}

impl MeasuredGrid for UtiaGrid {
    fn value(&self, wo: Vec3, wi: Vec3) -> Option<DVec3> {
        let (theta_i, phi_i) = to_spherical(wi.as_dvec3());
        let (theta_v, phi_v) = to_spherical(wo.as_dvec3());
        let last = STEP * (ELEVATIONS - 1) as f64 + SLACK;
        let [theta_i, theta_v] = [theta_i, theta_v].map(f64::to_degrees);
        if theta_i > last || theta_v > last {
            return None;
        }
        let axes = [
            Neighbours::clamped(&self.theta, theta_i),
            Neighbours::clamped(&self.theta, theta_v),
            Neighbours::periodic(&self.phi, phi_v - phi_i),
        ];
        interpolate(axes, |[i, v, azimuth]| {
            self.means[azimuth + AZIMUTHS * (v + ELEVATIONS * i)]
        })
    }

    fn count(&self) -> usize {
        PLANE
    }
}

/// RGB of all pairs, in the order of a plane.
fn read_values(bytes: &[u8], path: &Path) -> Result<Vec<DVec3>> {
    let fix = "name a .bin file of the UTIA BRDF database; docs/import.md has its layout";
    if bytes.len() as u64 != UTIA_BYTES {
        let expected = format!("{UTIA_BYTES} bytes");
        let found = format!("{} bytes", bytes.len());
        return Err(Error::invalid(path, 0, expected, found, fix));
    }
    let mut numbers = Vec::with_capacity(3 * PLANE);
    for (k, number) in bytes.as_chunks::<8>().0.iter().enumerate() {
        let value = f64::from_le_bytes(*number);
        if !is_utia_number(value) {
            let place = 8 * k as u64;
            return Err(Error::invalid(
                path,
                place,
                "a reflectance in double precision",
                format!("{value:e}"),
                fix,
            ));
        }
        numbers.push(value);
    }
    let mut values = Vec::with_capacity(PLANE);
    for k in 0..PLANE {
        values.push(DVec3::new(
            numbers[k],
            numbers[PLANE + k],
            numbers[2 * PLANE + k],
        ));
    }
    Ok(values)
}

/// Index into a plane; azimuths are in steps and may be beyond a turn.
fn plane_index(theta_i: usize, phi_i: usize, theta_v: usize, phi_v: usize) -> usize {
    let row = theta_v + ELEVATIONS * (phi_i % AZIMUTHS + AZIMUTHS * theta_i);
    phi_v % AZIMUTHS + AZIMUTHS * row
}

/// The mean of all pairs that a rotation about the normal carries into each other, and how far the values are from it:
///
/// ```text
/// f̄(θᵢ, θᵥ, Δφ) = (1/48) Σₖ f(θᵢ, φₖ, θᵥ, φₖ + Δφ)
/// ```
///
/// Where one direction is the normal, Δφ has no meaning, and the mean is over it as well.
fn mean_over_rotations(values: &[DVec3]) -> (Vec<DVec3>, Anisotropy) {
    let mut means = Vec::with_capacity(ELEVATIONS * ELEVATIONS * AZIMUTHS);
    let mut out = Anisotropy {
        mean: 0.0,
        greatest: 0.0,
        place: [0.0; 2],
    };
    let (mut difference, mut total) = (0.0, 0.0);
    for theta_i in 0..ELEVATIONS {
        for theta_v in 0..ELEVATIONS {
            let mut row = row_means(values, theta_i, theta_v);
            if theta_i == 0 || theta_v == 0 {
                let mean = row.iter().sum::<DVec3>() / AZIMUTHS as f64;
                row.fill(mean);
            }
            for (turn, mean) in row.iter().enumerate() {
                for phi in 0..AZIMUTHS {
                    let value = values[plane_index(theta_i, phi, theta_v, phi + turn)];
                    difference += (value - *mean).abs().element_sum();
                    total += mean.abs().element_sum();
                    let grey = mean.element_sum();
                    let relative = (value.element_sum() - grey).abs() / grey;
                    if grey > 0.0 && relative > out.greatest {
                        out.greatest = relative;
                        out.place = [theta_i, theta_v].map(|k| STEP * k as f64);
                    }
                }
            }
            means.extend(row);
        }
    }
    if total > 0.0 {
        out.mean = difference / total;
    }
    (means, out)
}

/// Means over rotations for each azimuth between light and viewer.
fn row_means(values: &[DVec3], theta_i: usize, theta_v: usize) -> Vec<DVec3> {
    let mut row = vec![DVec3::ZERO; AZIMUTHS];
    for (turn, mean) in row.iter_mut().enumerate() {
        for phi in 0..AZIMUTHS {
            *mean += values[plane_index(theta_i, phi, theta_v, phi + turn)];
        }
        *mean /= AZIMUTHS as f64;
    }
    row
}
