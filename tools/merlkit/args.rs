//! Options that several commands share.

use std::collections::BTreeSet;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use glam::DVec3;
use merlkit::Error;
use merlkit::material::merl::{CellFormat, embedded_names};
use merlkit::material::{Loaded, LookupRule, Material};
use merlkit::sampler::store::Record;

use crate::batch::{self, Unreadable};
use crate::output;

/// Parses a lookup rule by its name.
pub fn lookup_rule() -> impl TypedValueParser<Value = LookupRule> {
    PossibleValuesParser::new(LookupRule::ALL.map(LookupRule::name)).map(|name| {
        LookupRule::ALL
            .into_iter()
            .find(|r| r.name() == name)
            .unwrap_or_default()
    })
}

/// What is invalid where a channel of a cell is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InvalidPart {
    /// The cell as a whole.
    Cell,
    /// The channel alone.
    Channel,
}

const INVALID_PARTS: &[(&str, InvalidPart)] = &[
    ("cell", InvalidPart::Cell),
    ("channel", InvalidPart::Channel),
];

/// How the cells of a table are read of which some channels are unusable.
#[derive(Clone, clap::Args)]
pub struct Invalid {
    /// Reject a whole table cell if one channel is invalid, or only that channel [default: cell]
    #[arg(long, value_name = "cell|channel", hide_possible_values = true, value_parser = named(INVALID_PARTS))]
    invalid: Option<InvalidPart>,
}

impl Invalid {
    /// Whether a channel can be invalid alone.
    pub fn is_by_channel(&self) -> bool {
        self.invalid == Some(InvalidPart::Channel)
    }

    /// Whether the option was given, and says something else than a sampler file that was built so or not.
    fn contradicts(&self, channels_apart: bool) -> bool {
        self.invalid.is_some() && self.is_by_channel() != channels_apart
    }

    /// Resolves a material that is read so.
    pub fn resolve(&self, argument: &str) -> Result<Material, Error> {
        Ok(self.apply(Material::resolve(argument)?))
    }

    fn apply(&self, material: Material) -> Material {
        material.with_channels_apart(self.is_by_channel())
    }
}

const CELL_FORMATS: &[(&str, CellFormat)] = &[
    ("f32", CellFormat::F32),
    ("f16", CellFormat::F16),
    ("rgb9e5", CellFormat::Rgb9e5),
];

/// How the tables of materials are read and kept, apart from the lookup rule.
#[derive(Clone, clap::Args)]
pub struct TableOptions {
    #[command(flatten)]
    invalid: Invalid,
    /// Memory of a table cell: f32 16 bytes (as read), f16 8 bytes (off by at most 0.05 %), rgb9e5 4 bytes (off by at most 0.2 %
    /// of its greatest channel) [default: f32]
    #[arg(long, value_name = "f32|f16|rgb9e5", hide_possible_values = true, value_parser = named(CELL_FORMATS))]
    table: Option<CellFormat>,
}

impl TableOptions {
    /// The options given that say something else than how the table of a sampler file was read.
    pub fn contradiction(&self, record: &Record) -> Option<&'static str> {
        if self.invalid.contradicts(record.channels_apart) {
            return Some("--invalid");
        }
        let differs = self
            .table
            .is_some_and(|format| format != record.cell_format);
        differs.then_some("--table")
    }

    /// The options as words, without those that change nothing.
    pub fn words(&self) -> Vec<String> {
        let mut words = Vec::new();
        if self.invalid.is_by_channel() {
            words.push("--invalid channel".into());
        }
        let format = self.table.unwrap_or_default();
        if format != CellFormat::F32 {
            words.push(format!("--table {}", format.name()));
        }
        words
    }

    /// Resolves a material that is read so.
    pub fn resolve(&self, argument: &str) -> Result<Material, Error> {
        Ok(self.apply(Material::resolve(argument)?))
    }

    fn apply(&self, material: Material) -> Material {
        self.invalid
            .apply(material)
            .with_cell_format(self.table.unwrap_or_default())
    }
}

/// Unit direction of a polar angle and an azimuth in degrees; exact where they are multiples of 90.
pub fn direction(theta: f64, phi: f64) -> DVec3 {
    let ((sin_theta, cos_theta), (sin_phi, cos_phi)) =
        (sin_cos_degrees(theta), sin_cos_degrees(phi));
    DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
}

fn sin_cos_degrees(angle: f64) -> (f64, f64) {
    let quarter = (angle / 90.0).round();
    let (sin, cos) = (angle - 90.0 * quarter).to_radians().sin_cos();
    match quarter.rem_euclid(4.0) as u8 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// The materials of a command that takes any number of them.
#[derive(clap::Args)]
pub struct Materials {
    /// MERL binaries, .bsdf files or folders of either, names of built-in materials, or formulas such as
    /// lambert:reflectance=0.5
    // An option that conflicts with it, as --all does, lifts the requirement.
    #[arg(help_heading = None, required = true, value_name = "MATERIAL")]
    materials: Vec<String>,
    /// Process every built-in material
    #[arg(long, conflicts_with = "materials")]
    all: bool,
    #[command(flatten)]
    tables: TableOptions,
}

impl Materials {
    /// Whether `--all` was given.
    pub fn are_all(&self) -> bool {
        self.all
    }

    /// Resolves all of them before any work begins; what can't be read is set apart.
    pub fn resolve(&self) -> Result<(Vec<Material>, Unreadable), Error> {
        let (mut materials, unreadable) = batch::resolve(if self.all {
            embedded_names()
        } else {
            &self.materials
        })?;
        materials = materials
            .into_iter()
            .map(|material| self.tables.apply(material))
            .collect();
        Ok((materials, unreadable))
    }
}

/// Resolves the material arguments of a command that needs all of them; a folder means the materials in it.
pub fn resolve(arguments: &[String], tables: &TableOptions) -> Result<Vec<Material>, Error> {
    let arguments = batch::expand_folders(arguments)?;
    arguments.iter().map(|a| tables.resolve(a)).collect()
}

/// Loads a material, and prints on standard error what its users should know.
pub fn load(material: &Material, rule: LookupRule) -> Result<Loaded, Error> {
    let loaded = material.load(rule)?;
    output::print_notes(loaded.name(), loaded.notes());
    Ok(loaded)
}

/// Positions of the materials that reflect mirror directions, for the plan of a scene.
pub fn find_mirrors(materials: &[Material]) -> Result<Vec<usize>, Error> {
    let mut mirrors = Vec::new();
    for (i, material) in materials.iter().enumerate() {
        if material.facts()?.has_mirror {
            mirrors.push(i);
        }
    }
    Ok(mirrors)
}

/// Two materials of one name would be one file.
pub fn refuse_repeated(materials: &[Material]) -> Result<(), Error> {
    let mut seen = BTreeSet::new();
    match materials.iter().find(|m| !seen.insert(m.name())) {
        Some(m) => Err(Error::argument(
            format!("{} is named twice", m.name()),
            "name each material once",
        )),
        None => Ok(()),
    }
}

/// Before a command that needs MERL tables for `purpose` begins: materials that are none are refused.
pub fn require_tables(materials: &[Material], purpose: &str) -> Result<(), Error> {
    materials
        .iter()
        .try_for_each(|m| m.facts()?.require_table(m.name(), purpose))
}

/// Before a command begins whose `purpose` knows no azimuth of the surface: anisotropic materials are refused.
pub fn require_isotropic(materials: &[Material], purpose: &str) -> Result<(), Error> {
    materials
        .iter()
        .try_for_each(|m| m.facts()?.require_isotropic(m.name(), purpose))
}

/// Parses one of a few names.
pub fn named<T: Copy + Send + Sync + 'static>(
    values: &'static [(&'static str, T)],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(values.iter().map(|v| v.0))
        .map(move |name| values.iter().find(|v| v.0 == name).unwrap_or(&values[0]).1)
}

/// "0.05" or "5%" as a fraction above 0.
pub fn fraction(argument: &str) -> Result<f64, String> {
    let (number, unit) = match argument.strip_suffix('%') {
        Some(percent) => (percent, 0.01),
        None => (argument, 1.0),
    };
    let parsed = number.trim().parse::<f64>().ok().map(|v| v * unit);
    parsed
        .filter(|v| *v > 0.0 && v.is_finite())
        .ok_or_else(|| "expected a fraction above 0, such as 0.05 or 5%".into())
}

/// "0.05" or "5%" as a relative error to be reached: a fraction of at most 1, because a whole number is meant in per cent.
pub fn target_error(argument: &str) -> Result<f64, String> {
    let error = fraction(argument)?;
    if error > 1.0 {
        let meant = argument.trim_end_matches('%');
        return Err(match argument.ends_with('%') {
            true => format!("{argument} is above the maximum of 100%"),
            false => format!("{argument} is {}%; did you mean {meant}%?", 100.0 * error),
        });
    }
    Ok(error)
}

/// "4096", "64KB" or "1.5MB" as a number of bytes; 1 KB = 1000 bytes.
pub fn byte_count(argument: &str) -> Result<usize, String> {
    let text = argument.trim().to_ascii_uppercase();
    let (number, unit) = [("KB", 1e3), ("MB", 1e6), ("GB", 1e9), ("B", 1.0)]
        .into_iter()
        .find_map(|(suffix, bytes)| Some((text.strip_suffix(suffix)?, bytes)))
        .unwrap_or((&text, 1.0));
    let bytes = number.trim().parse::<f64>().map_or(f64::NAN, |n| n * unit);
    if bytes >= 1.0 && bytes < 2f64.powi(53) {
        Ok(bytes as usize)
    } else {
        Err("expected a number of bytes above 0, such as 4096, 64KB or 1MB".into())
    }
}

/// A number of stops.
pub fn stops(argument: &str) -> Result<f32, String> {
    argument
        .parse()
        .ok()
        .filter(|ev: &f32| ev.is_finite())
        .ok_or_else(|| "expected a finite number of stops".into())
}

/// "1024x512" as two counts, neither of them 0.
pub fn size(argument: &str) -> Result<(usize, usize), String> {
    let parts = argument.split_once(['x', 'X', '×']);
    parts
        .and_then(|(a, b)| Some((a.trim().parse().ok()?, b.trim().parse().ok()?)))
        .filter(|&(a, b)| a > 0 && b > 0)
        .ok_or_else(|| "expected two counts above 0, such as 1024x512".into())
}
