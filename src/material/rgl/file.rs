//! What a `.bsdf` file of a measured material holds (Dupuy & Jakob 2018), checked.

use std::f32::consts::{FRAC_PI_2, TAU};
use std::ops::RangeInclusive;
use std::path::Path;

use super::spectrum::to_rgb;
use super::tensors::{Data, FieldList, Tensor, TensorFile, write};
use crate::files::{Overwrite, RegularFile};
use crate::geometry::Symmetry;
use crate::{Error, Result};

/// Values that are negative by at most this fraction of the largest are residues of rounding in f32.
const RESIDUE: f32 = 1e-6;
/// Wavelengths that the CIE observer sees, nm.
pub(in crate::material) const VISIBLE: RangeInclusive<f32> = 380.0..=780.0;

/// The tensors of a measured material, as Mitsuba 3 and pbrt-v4 read them.
///
/// Axes: x = √(2θ/π) is the last, y = φ/2π + ½ the one before. P is the number of `phi_i`, T that of `theta_i`.
///
/// # Examples
/// ```
/// use merlkit::glam::Vec3;
/// use merlkit::material::rgl::{BsdfSize, RglBrdf, tabulate};
/// use merlkit::{Brdf, LookupRule, Material};
///
/// let material = Material::resolve("lambert:reflectance=0.5")?.load(LookupRule::Floor)?;
/// let brdf = material.brdf();
///
/// // `file.write` stores it for Mitsuba 3 and pbrt-v4, and `BsdfFile::open` reads one.
/// let file = tabulate(|wo, wi| brdf.eval(wo, wi), BsdfSize::ALL[0], "half grey".into());
/// let read = RglBrdf::new(file);
/// let value = read.eval(Vec3::Z, Vec3::Z);
/// assert!((value.x / brdf.eval(Vec3::Z, Vec3::Z).x - 1.0).abs() < 0.01);
/// # Ok::<(), merlkit::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct BsdfFile {
    /// What the material is, in words.
    pub description: String,
    /// Polar angles of the given direction, radians; rising, within [0, π/2].
    pub theta_i: Vec<f32>,
    /// Azimuths of the given direction, radians; rising, within ±2π. At most two: the material is isotropic.
    pub phi_i: Vec<f32>,
    /// Whether values are multiplied by `ndf`/(4 `sigma`).
    pub jacobian: bool,
    /// Distribution of half vectors, `[h, w]`, ≥ 0.
    pub ndf: Tensor,
    /// Projected area of the half vectors towards the given direction, `[h, w]`, ≥ 0.
    pub sigma: Tensor,
    /// Density by which the unit square is stretched over half vectors, `[P, T, h, w]`; ≥ 0, no slice zero.
    pub vndf: Tensor,
    /// Density of draws on the square, `[P, T, n, n]`; ≥ 0, no slice zero.
    pub luminance: Tensor,
    /// Values on the square.
    pub colour: Colour,
    /// What reading changed, in words. Empty for a file that was made here; never written.
    pub notes: Vec<String>,
}

/// Values of f_r·cosθ, up to `ndf`/(4 `sigma`), on the square of `luminance`.
///
/// The example of [`BsdfFile`](crate::material::rgl::BsdfFile) tabulates a material and evaluates the result.
#[derive(Clone, Debug, PartialEq)]
pub enum Colour {
    /// Linear sRGB, `[P, T, 3, n, n]`.
    Rgb(Tensor),
    /// Spectra over wavelengths.
    Spectral {
        /// Wavelengths, nm; rising.
        wavelengths: Vec<f32>,
        /// `[P, T, wavelengths, n, n]`.
        spectra: Tensor,
    },
}

impl Colour {
    /// Linear sRGB, `[P, T, 3, n, n]`; spectra are seen in light of D65, in which a spectrum of ones is white.
    pub fn to_rgb(&self) -> Tensor {
        match self {
            Self::Rgb(rgb) => rgb.clone(),
            Self::Spectral {
                wavelengths,
                spectra,
            } => to_rgb(wavelengths, spectra),
        }
    }
}

impl BsdfFile {
    /// Reads a file.
    ///
    /// # Errors
    /// [`crate::Error::Io`]; [`crate::Error::Unsupported`] for what is no regular file or of more than 4 GiB, and for a `.pbsdf` file, before
    /// its data are read; [`crate::Error::Invalid`] naming what does not fit, and where.
    pub fn open(path: &Path) -> Result<Self> {
        // A gigabyte of polarised values need not be read to be refused.
        let fields = FieldList::read(&mut RegularFile::open(path)?);
        if fields.is_ok_and(|list| list.is_polarised()) {
            return Err(Error::Unsupported {
                path: path.to_owned(),
                what: "a polarimetric measurement (.pbsdf)".into(),
                fix: "`merlkit import` makes a MERL binary of its unpolarised part".into(),
            });
        }
        Self::from_tensors(&TensorFile::open(path)?)
    }

    /// A file from its bytes; `path` is for messages.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`].
    pub fn from_bytes(bytes: Vec<u8>, path: &Path) -> Result<Self> {
        Self::from_tensors(&TensorFile::from_bytes(bytes, path)?)
    }

    fn from_tensors(file: &TensorFile) -> Result<Self> {
        let theta_i = rising(file, "theta_i", 0.0, FRAC_PI_2)?;
        let phi_i = rising(file, "phi_i", -TAU, TAU)?;
        let slices = [phi_i.len(), theta_i.len()];
        let mut read = Reader {
            file,
            slices,
            notes: Vec::new(),
        };
        let jacobian = match file.bytes("jacobian")? {
            [flag] => *flag != 0,
            other => {
                return Err(file.wrong_entry(
                    "jacobian",
                    "one byte",
                    format!("{} bytes", other.len()),
                ));
            }
        };
        let luminance = read.density("luminance")?;
        let side = luminance.shape[2];
        if luminance.shape[3] != side {
            let found = format!("{} × {side}", luminance.shape[3]);
            return Err(file.wrong_entry("luminance", "as many columns as rows", found));
        }
        Ok(Self {
            description: String::from_utf8_lossy(file.bytes("description")?).into_owned(),
            jacobian,
            ndf: read.grid("ndf")?,
            sigma: read.grid("sigma")?,
            vndf: read.density("vndf")?,
            luminance,
            colour: read.colour(side)?,
            theta_i,
            phi_i,
            notes: read.notes,
        })
    }

    /// Writes the file: all of it appears, or nothing does. Returns its length in bytes.
    ///
    /// # Errors
    /// As [`crate::files::write_new`].
    pub fn write(&self, path: &Path, overwrite: Overwrite) -> Result<u64> {
        let jacobian = [u8::from(self.jacobian)];
        let axis_theta = [self.theta_i.len()];
        let axis_phi = [self.phi_i.len()];
        let mut fields = vec![
            ("description", Data::Bytes(self.description.as_bytes())),
            ("jacobian", Data::Bytes(&jacobian)),
            ("theta_i", Data::Floats(&axis_theta, &self.theta_i)),
            ("phi_i", Data::Floats(&axis_phi, &self.phi_i)),
        ];
        for (name, tensor) in [
            ("ndf", &self.ndf),
            ("sigma", &self.sigma),
            ("vndf", &self.vndf),
            ("luminance", &self.luminance),
        ] {
            fields.push((name, Data::Floats(&tensor.shape, &tensor.values)));
        }
        let axis;
        match &self.colour {
            Colour::Rgb(rgb) => fields.push(("rgb", Data::Floats(&rgb.shape, &rgb.values))),
            Colour::Spectral {
                wavelengths,
                spectra,
            } => {
                axis = [wavelengths.len()];
                fields.push(("wavelengths", Data::Floats(&axis, wavelengths)));
                fields.push(("spectra", Data::Floats(&spectra.shape, &spectra.values)));
            }
        }
        write(path, overwrite, &fields)
    }

    /// Which azimuths of the given direction represent all others. At most two `phi_i`: the material is isotropic. More: the
    /// azimuths outside their span are turns or mirror images of those inside.
    pub fn symmetry(&self) -> Symmetry {
        let span = match self.phi_i.as_slice() {
            [first, _, .., last] => f64::from(last - first),
            _ => return Symmetry::Isotropic,
        };
        match (std::f64::consts::TAU / span).round() as u32 {
            0 | 1 => Symmetry::Whole,
            4 => Symmetry::Quarter,
            _ => Symmetry::Half,
        }
    }
}

/// Reads tensors that begin with the axes P and T.
struct Reader<'a> {
    file: &'a TensorFile,
    slices: [usize; 2],
    notes: Vec<String>,
}

impl Reader<'_> {
    /// `[h, w]`, at least 2 × 2, values ≥ 0.
    fn grid(&mut self, name: &str) -> Result<Tensor> {
        let mut tensor = self.file.floats(name, 2)?;
        self.at_least_two(name, &tensor)?;
        self.raise_residues(name, &mut tensor)?;
        Ok(tensor)
    }

    /// `[P, T, h, w]`, at least 2 × 2 each; values ≥ 0, one of them above 0 in each slice.
    fn density(&mut self, name: &str) -> Result<Tensor> {
        let mut tensor = self.file.floats(name, 4)?;
        self.at_least_two(name, &tensor)?;
        self.of_slices(name, &tensor)?;
        self.raise_residues(name, &mut tensor)?;
        let slice = tensor.shape[2] * tensor.shape[3];
        match tensor
            .values
            .chunks_exact(slice)
            .position(|s| s.iter().all(|&v| v == 0.0))
        {
            Some(k) => {
                Err(self
                    .file
                    .wrong_value(name, k * slice, "a slice that is not all zero", 0.0))
            }
            None => Ok(tensor),
        }
    }

    /// Spectra where there are wavelengths, as the renderers have it; RGB otherwise.
    fn colour(&self, side: usize) -> Result<Colour> {
        if !self.file.has("wavelengths") {
            return Ok(Colour::Rgb(self.channels("rgb", 3, side)?));
        }
        let wavelengths = rising(self.file, "wavelengths", 1.0, 1e6)?;
        if !wavelengths.iter().any(|nm| VISIBLE.contains(nm)) {
            let [first, last] = [0, wavelengths.len() - 1].map(|k| wavelengths[k]);
            return Err(self.file.wrong_entry(
                "wavelengths",
                "a wavelength from 380 to 780 nm, which have a colour",
                format!("{first} to {last} nm"),
            ));
        }
        let spectra = self.channels("spectra", wavelengths.len(), side)?;
        Ok(Colour::Spectral {
            wavelengths,
            spectra,
        })
    }

    fn channels(&self, name: &str, count: usize, side: usize) -> Result<Tensor> {
        let tensor = self.file.floats(name, 5)?;
        self.of_slices(name, &tensor)?;
        if tensor.shape[2..] != [count, side, side] {
            let found = format!("{:?}", &tensor.shape[2..]);
            return Err(self.file.wrong_entry(
                name,
                format!("the shape [{count}, {side}, {side}]"),
                found,
            ));
        }
        Ok(tensor)
    }

    fn of_slices(&self, name: &str, tensor: &Tensor) -> Result<()> {
        if tensor.shape[..2] == self.slices {
            return Ok(());
        }
        let [p, t] = self.slices;
        let expected = format!("slices for {p} phi_i and {t} theta_i");
        Err(self
            .file
            .wrong_entry(name, expected, format!("the shape {:?}", tensor.shape)))
    }

    fn at_least_two(&self, name: &str, tensor: &Tensor) -> Result<()> {
        match tensor.shape.iter().rev().take(2).all(|&n| n >= 2) {
            true => Ok(()),
            false => {
                let found = format!("the shape {:?}", tensor.shape);
                Err(self
                    .file
                    .wrong_entry(name, "at least 2 rows and columns", found))
            }
        }
    }

    /// Raises to 0 what rounding left below it, and notes how many values that were; refuses values that are truly negative.
    fn raise_residues(&mut self, name: &str, tensor: &mut Tensor) -> Result<()> {
        let largest = tensor.values.iter().copied().fold(0.0, f32::max);
        let (mut count, mut least) = (0u64, 0.0f32);
        for (k, value) in tensor.values.iter_mut().enumerate() {
            if *value >= 0.0 {
                continue;
            }
            if *value < -RESIDUE * largest {
                return Err(self.file.wrong_value(name, k, "values ≥ 0", *value));
            }
            count += 1;
            least = least.min(*value);
            *value = 0.0;
        }
        if count > 0 {
            self.notes.push(format!(
                "{count} values of \"{name}\" were below 0 by rounding (least {least:e}, largest value {largest:e}) and count as 0"
            ));
        }
        Ok(())
    }
}

/// A field of rising numbers from `low` to `high`; 10⁻⁶ more is rounding.
fn rising(file: &TensorFile, name: &str, low: f32, high: f32) -> Result<Vec<f32>> {
    let values = file.floats(name, 1)?.values;
    let slack = 1e-6;
    if let Some(k) = values
        .iter()
        .position(|v| !(low - slack..=high + slack).contains(v))
    {
        return Err(file.wrong_value(name, k, &format!("values from {low} to {high}"), values[k]));
    }
    match values.windows(2).position(|pair| pair[1] <= pair[0]) {
        Some(k) => Err(file.wrong_value(name, k + 1, "rising values", values[k + 1])),
        None => Ok(values),
    }
}
