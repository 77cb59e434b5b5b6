//! What the columns of a list of measurements mean.

use glam::{DVec3, Vec3};

use crate::geometry::spherical;
use crate::material::merl::pair_of_angles;
use crate::material::rgl::{VISIBLE, colour_weights};

/// Unit of the angles in a list of measurements.
///
/// The example of [`Measurements`](crate::material::measurements::Measurements) makes a table from a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AngleUnit {
    /// Degrees, as lists with named columns have them unless they say otherwise.
    Degrees,
    /// Radians, as ASTM E1392 and Cornell's lists have them.
    Radians,
}

/// The angles that can be named, in the order of [`ListColumns::angles`].
const ANGLES: [(&str, &[&str]); 7] = [
    ("theta_i", &["thetai", "thetain", "ti"]),
    ("phi_i", &["phii", "phiin", "pi"]),
    (
        "theta_o",
        &["thetao", "thetas", "thetar", "thetav", "thetaout", "to"],
    ),
    ("phi_o", &["phio", "phis", "phir", "phiv", "phiout", "po"]),
    ("theta_h", &["thetah", "th"]),
    ("theta_d", &["thetad", "td"]),
    ("phi_d", &["phid", "pd"]),
];
const COLOURS: [&[&str]; 3] = [&["r", "red"], &["g", "green"], &["b", "blue"]];
const GREY: &[&str] = &["f", "fr", "brdf", "value", "y", "grey", "gray"];

/// The position of each quantity in a row.
#[derive(Clone, Debug)]
pub(super) struct ListColumns {
    /// Columns of theta_i, phi_i, theta_o, phi_o, theta_h, theta_d and phi_d.
    angles: [Option<usize>; 7],
    /// What each column adds to red, green and blue.
    weights: Vec<(usize, DVec3)>,
    /// Number of columns of a row.
    pub count: usize,
    /// The unit that the names of the columns state.
    pub stated_unit: Option<AngleUnit>,
    /// What was taken for granted, in words.
    pub notes: Vec<String>,
}

impl ListColumns {
    /// Reads the names of columns; fails with what is missing, in words.
    pub fn from_names(names: &[&str]) -> Result<Self, String> {
        let mut columns = Self {
            angles: [None; 7],
            weights: Vec::new(),
            count: names.len(),
            stated_unit: None,
            notes: Vec::new(),
        };
        let mut rgb = [None; 3];
        let mut grey = None;
        let mut spectrum = Vec::new();
        for (column, name) in names.iter().enumerate() {
            let (word, unit) = split_unit(name);
            columns.stated_unit = columns.stated_unit.or(unit);
            let word = word.as_str();
            if let Some(k) = ANGLES.iter().position(|angle| angle.1.contains(&word)) {
                columns.angles[k] = Some(column);
            } else if let Some(k) = COLOURS.iter().position(|names| names.contains(&word)) {
                rgb[k] = Some(column);
            } else if GREY.contains(&word) {
                grey = Some(column);
            } else if let Some(nm) = wavelength(word) {
                spectrum.push((nm, column));
            }
        }
        columns.require_angles()?;
        columns.weights = match (rgb, grey) {
            ([Some(r), Some(g), Some(b)], _) => {
                vec![(r, DVec3::X), (g, DVec3::Y), (b, DVec3::Z)]
            }
            _ if !spectrum.is_empty() => weights_of_spectrum(spectrum)?,
            (_, Some(column)) => vec![(column, DVec3::ONE)],
            _ => {
                return Err(
                    "columns r, g and b, a column value, or columns of wavelengths as 550nm".into(),
                );
            }
        };
        Ok(columns)
    }

    /// Columns theta_i, phi_i, theta_o, phi_o, then one for each wavelength.
    pub fn from_wavelengths(wavelengths: &[f32]) -> Result<Self, String> {
        let spectrum = wavelengths.iter().enumerate();
        Ok(Self {
            angles: [Some(0), Some(1), Some(2), Some(3), None, None, None],
            weights: weights_of_spectrum(spectrum.map(|(k, nm)| (*nm, 4 + k)).collect())?,
            count: 4 + wavelengths.len(),
            stated_unit: Some(AngleUnit::Radians),
            notes: Vec::new(),
        })
    }

    /// Either both directions or the half and difference angles must be there.
    fn require_angles(&mut self) -> Result<(), String> {
        if self.missing_angles(&[4, 5, 6]).is_empty() {
            return Ok(());
        }
        let directions = self.missing_angles(&[0, 2]);
        if !directions.is_empty() {
            return Err(format!(
                "columns theta_i, phi_i, theta_o, phi_o or theta_h, theta_d, phi_d; {} not among them",
                directions.join(" and ")
            ));
        }
        if self.angles[3].is_none() {
            self.notes.push(
                "no column of phi_o: all pairs are taken for lying in the plane of incidence, theta_o above 0 on the side of \
                 the mirror direction"
                    .into(),
            );
        }
        Ok(())
    }

    /// The names of those of the `wanted` angles that have no column.
    fn missing_angles(&self, wanted: &[usize]) -> Vec<&'static str> {
        let mut missing = Vec::new();
        for &k in wanted {
            if self.angles[k].is_none() {
                missing.push(ANGLES[k].0);
            }
        }
        missing
    }

    /// All angles of a row.
    pub fn angles<'a>(&'a self, row: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.angles.iter().flatten().map(|&column| row[column])
    }

    /// `wo` and `wi` of a row whose angles are multiplied by `unit` to be radians; `None` unless both are above the horizon.
    pub fn pair(&self, row: &[f64], unit: f64) -> Option<(Vec3, Vec3)> {
        let angles = self
            .angles
            .map(|column| column.map(|column| row[column] * unit));
        let (wo, wi) = match angles {
            [.., Some(theta_h), Some(theta_d), Some(phi_d)] => {
                pair_of_angles(theta_h, theta_d, phi_d)
            }
            [theta_i, phi_i, theta_o, phi_o, ..] => {
                let phi_i = phi_i.unwrap_or(0.0);
                // In the plane of incidence the mirror direction is half a turn away.
                let phi_o = phi_o.unwrap_or(phi_i + std::f64::consts::PI);
                (spherical(theta_o?, phi_o), spherical(theta_i?, phi_i))
            }
        };
        // A height of rounding size is the horizon.
        (wo.z > 1e-9 && wi.z > 1e-9).then(|| (wo.as_vec3(), wi.as_vec3()))
    }

    /// Red, green and blue of a row.
    pub fn rgb(&self, row: &[f64]) -> DVec3 {
        let mut rgb = DVec3::ZERO;
        for &(column, weight) in &self.weights {
            rgb += weight * row[column];
        }
        rgb
    }
}

/// A name in lower case without `_`, blanks and `-`, and the unit that it ends in.
fn split_unit(name: &str) -> (String, Option<AngleUnit>) {
    let mut word = name.to_lowercase();
    word.retain(|c| c.is_alphanumeric() || c == '.');
    for (ending, unit) in [
        ("degrees", AngleUnit::Degrees),
        ("deg", AngleUnit::Degrees),
        ("radians", AngleUnit::Radians),
        ("rad", AngleUnit::Radians),
    ] {
        if let Some(start) = word.strip_suffix(ending) {
            return (start.to_owned(), Some(unit));
        }
    }
    (word, None)
}

/// "550nm", "550" or "w550" in nm; 100 to 10⁵.
fn wavelength(word: &str) -> Option<f32> {
    let number = word.strip_suffix("nm").unwrap_or(word);
    let number = number.trim_start_matches(['w', 'l']);
    let nm: f32 = number.parse().ok()?;
    (100.0..1e5).contains(&nm).then_some(nm)
}

/// What each column of a spectrum adds to linear sRGB in light of D65.
fn weights_of_spectrum(mut spectrum: Vec<(f32, usize)>) -> Result<Vec<(usize, DVec3)>, String> {
    spectrum.sort_by(|a, b| a.0.total_cmp(&b.0));
    if spectrum.windows(2).any(|pair| pair[0].0 == pair[1].0) {
        return Err("each wavelength once".into());
    }
    let wavelengths: Vec<f32> = spectrum.iter().map(|s| s.0).collect();
    if !wavelengths.iter().any(|nm| VISIBLE.contains(nm)) {
        return Err("a wavelength from 380 to 780 nm, which have a colour".into());
    }
    let [red, green, blue] = colour_weights(&wavelengths);
    let mut weights = Vec::with_capacity(spectrum.len());
    for (k, &(_, column)) in spectrum.iter().enumerate() {
        let weight = Vec3::new(red[k], green[k], blue[k]);
        weights.push((column, weight.as_dvec3()));
    }
    Ok(weights)
}
