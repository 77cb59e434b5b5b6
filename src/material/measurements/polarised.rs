//! `.pbsdf` files: polarimetric reflectance (Baek et al. 2020, "Image-based acquisition and modeling of polarimetric
//! reflectance"), as Mitsuba 3's `measured_polarized` reads it.
//!
//! A tensor file holds a Mueller matrix `M` for each φd, θd, θh and wavelength: f32 of shape `[phi_d, theta_d, theta_h, wvls, 4, 4]`,
//! f_r without the cosine, NaN where nothing was measured and below the horizon. The angles are radians, φd that of the light
//! about the half vector over a whole turn; wavelengths are nm. The element in row 0 and column 0 of a matrix is the reflectance
//! that unpolarised light sees. Only it is read.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::path::Path;

use glam::{DVec3, Vec3};

use super::grid::{MeasuredGrid, Neighbours, interpolate};
use crate::files::RegularFile;
use crate::geometry::HalfDiff;
use crate::material::rgl::{F32, FieldList, U16, VISIBLE, colour_weights};
use crate::{Error, Result};

/// Bytes of a Mueller matrix.
const MATRIX: usize = 64;
/// Bytes that are read at a time, or those of one spectrum of matrices if they are more.
const PIECE: usize = 1 << 20;
/// Grids of more points are refused; those of the database have three million, and 36 MB once read.
const MOST_POINTS: usize = 1 << 24;
/// More wavelengths are refused; the files of the database have five.
const MOST_WAVELENGTHS: usize = 1 << 10;
/// More points of an axis are refused.
const MOST_ANGLES: usize = 1 << 16;

/// The unpolarised reflectance of a file, in linear sRGB.
pub(super) struct PolarisedGrid {
    phi_d: Vec<f64>,
    theta_d: Vec<f64>,
    theta_h: Vec<f64>,
    /// f_r by φd, θd, θh; NaN without a value.
    rgb: Vec<Vec3>,
}

/// Whether a file has the fields of a `.pbsdf` file.
pub(super) fn is_polarised(file: &mut RegularFile) -> bool {
    FieldList::read(file).is_ok_and(|list| list.is_polarised())
}

/// Reads a file; says in words what was left out or taken for granted.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] naming what does not fit, and where.
pub(super) fn read_polarised(path: &Path) -> Result<(PolarisedGrid, Vec<String>)> {
    let mut file = RegularFile::open(path)?;
    let list = FieldList::read(&mut file)?;
    let mut read = MatrixReader {
        file: &mut file,
        list: &list,
    };
    let phi_d = read.rising("phi_d", -TAU, TAU)?;
    read.require_turn(&phi_d)?;
    let theta_d = read.rising("theta_d", 0.0, FRAC_PI_2)?;
    let theta_h = read.rising("theta_h", 0.0, FRAC_PI_2)?;
    let wavelengths = read.wavelengths()?;
    let axes = [phi_d.len(), theta_d.len(), theta_h.len()];
    let rgb = read.unpolarised(axes, &wavelengths)?;
    let [first, last] = [0, wavelengths.len() - 1].map(|k| wavelengths[k]);
    let notes = vec![
        "polarisation was left out: only the reflectance of unpolarised light, M00 of each Mueller matrix, is used".into(),
        format!(
            "{} wavelengths from {first} to {last} nm, constant outside, are seen in light of D65",
            wavelengths.len()
        ),
    ];
    let grid = PolarisedGrid {
        phi_d,
        theta_d,
        theta_h,
        rgb,
    };
    Ok((grid, notes))
}

impl MeasuredGrid for PolarisedGrid {
    fn value(&self, wo: Vec3, wi: Vec3) -> Option<DVec3> {
        let angles = HalfDiff::from_directions(wo.as_dvec3(), wi.as_dvec3())?;
        let axes = [
            Neighbours::periodic(&self.phi_d, angles.phi_d),
            Neighbours::clamped(&self.theta_d, angles.theta_d),
            Neighbours::clamped(&self.theta_h, angles.theta_h),
        ];
        interpolate(axes, |[p, d, h]| {
            self.rgb[h + self.theta_h.len() * (d + self.theta_d.len() * p)].as_dvec3()
        })
    }

    fn count(&self) -> usize {
        self.rgb.iter().filter(|rgb| rgb.is_finite()).count()
    }
}

struct MatrixReader<'a> {
    file: &'a mut RegularFile,
    list: &'a FieldList,
}

impl MatrixReader<'_> {
    /// The numbers of a field of one axis of 2 to `most`, or of several of which all but one have the length 1.
    fn axis(&mut self, name: &str, most: usize) -> Result<Vec<f64>> {
        let field = self.list.require(name)?;
        let count = field.shape.iter().copied().max().unwrap_or(0);
        let others = field.shape.iter().filter(|&&n| n != 1).count();
        if others > 1 || !(1..=most).contains(&count) || ![F32, U16].contains(&field.dtype) {
            let expected = format!("1 to {most} numbers of type {U16} or {F32} on one axis");
            let found = format!("type {} of shape {:?}", field.dtype, field.shape);
            return Err(self.list.wrong_entry(name, expected, found));
        }
        let mut bytes = vec![0; field.end - field.start];
        self.file.read_at(field.start as u64, &mut bytes)?;
        let mut values = Vec::new();
        if field.dtype == F32 {
            for number in bytes.as_chunks::<4>().0 {
                values.push(f64::from(f32::from_le_bytes(*number)));
            }
        } else {
            for number in bytes.as_chunks::<2>().0 {
                values.push(f64::from(u16::from_le_bytes(*number)));
            }
        }
        Ok(values)
    }

    /// An axis of at least two rising angles from `low` to `high`; 10⁻⁵ more is rounding.
    fn rising(&mut self, name: &str, low: f64, high: f64) -> Result<Vec<f64>> {
        let values = self.axis(name, MOST_ANGLES)?;
        if values.len() < 2 {
            return Err(self.list.wrong_entry(name, "at least 2 angles", "1"));
        }
        self.require_rising(name, &values, low - 1e-5, high + 1e-5)?;
        Ok(values)
    }

    fn require_rising(&self, name: &str, values: &[f64], low: f64, high: f64) -> Result<()> {
        for (k, value) in values.iter().enumerate() {
            let within = (low..=high).contains(value);
            if !within || k > 0 && *value <= values[k - 1] {
                let expected = format!("rising values from {low} to {high}");
                return Err(self.list.wrong_value(name, k, &expected, *value as f32));
            }
        }
        Ok(())
    }

    /// φd must go around: what is left between its last and its first angle is a step like the others.
    fn require_turn(&self, phi_d: &[f64]) -> Result<()> {
        let mut widest = 0.0f64;
        for pair in phi_d.windows(2) {
            widest = widest.max(pair[1] - pair[0]);
        }
        let span = phi_d[phi_d.len() - 1] - phi_d[0];
        // 10⁻⁴ is rounding.
        if (TAU - 1.5 * widest..=TAU + 1e-4).contains(&span) {
            return Ok(());
        }
        let found = format!("{:.1}°", span.to_degrees());
        Err(self
            .list
            .wrong_entry("phi_d", "angles over a whole turn", found))
    }

    /// Wavelengths in nm, rising, one of them at least visible.
    fn wavelengths(&mut self) -> Result<Vec<f32>> {
        let values = self.axis("wvls", MOST_WAVELENGTHS)?;
        self.require_rising("wvls", &values, 1.0, 1e6)?;
        let wavelengths: Vec<f32> = values.iter().map(|&nm| nm as f32).collect();
        if wavelengths.iter().any(|nm| VISIBLE.contains(nm)) {
            return Ok(wavelengths);
        }
        Err(self.list.wrong_entry(
            "wvls",
            "a wavelength from 380 to 780 nm, which have a colour",
            format!("{wavelengths:?}"),
        ))
    }

    /// M00 of every point of the grid in linear sRGB, read in pieces.
    fn unpolarised(&mut self, axes: [usize; 3], wavelengths: &[f32]) -> Result<Vec<Vec3>> {
        let [p, d, h] = axes;
        let field = self.list.field("M", F32, 6)?;
        let shape = [p, d, h, wavelengths.len(), 4, 4];
        if field.shape != shape {
            let found = format!("{:?}", field.shape);
            return Err(self
                .list
                .wrong_entry("M", format!("the shape {shape:?}"), found));
        }
        // The shape fits into the file, so the product does not overflow.
        let points = p * d * h;
        if points > MOST_POINTS {
            let expected = format!("at most {MOST_POINTS} directions");
            return Err(self.list.wrong_entry("M", expected, points.to_string()));
        }
        let weights = colour_weights(wavelengths);
        let spectrum = MATRIX * wavelengths.len();
        let at_once = (PIECE / spectrum).max(1);
        let mut bytes = vec![0; at_once * spectrum];
        let mut rgb = Vec::with_capacity(points);
        for start in (0..points).step_by(at_once) {
            let piece = &mut bytes[..at_once.min(points - start) * spectrum];
            self.file
                .read_at((field.start + start * spectrum) as u64, piece)?;
            for matrices in piece.chunks_exact(spectrum) {
                rgb.push(colour(matrices, &weights));
            }
        }
        match rgb.iter().any(|rgb| rgb.is_finite()) {
            true => Ok(rgb),
            false => Err(self.wrong_values()),
        }
    }

    fn wrong_values(&self) -> Error {
        self.list
            .wrong_entry("M", "a direction with a value", "none that is finite")
    }
}

/// Linear sRGB of a spectrum of Mueller matrices, by M00: Σ over wavelengths of weight·M00. NaN or infinite if one of them is.
fn colour(matrices: &[u8], weights: &[Vec<f32>; 3]) -> Vec3 {
    let mut rgb = [0.0f64; 3];
    for (k, matrix) in matrices.chunks_exact(MATRIX).enumerate() {
        let m00 = matrix
            .first_chunk::<4>()
            .map_or(f64::NAN, |b| f64::from(f32::from_le_bytes(*b)));
        for (sum, weights) in rgb.iter_mut().zip(weights) {
            *sum += f64::from(weights[k]) * m00;
        }
    }
    DVec3::from_array(rgb).as_vec3()
}
