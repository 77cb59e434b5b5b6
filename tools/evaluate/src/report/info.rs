//! A material's facts, worded.

use serde::Serialize;

use super::Sheet;
use crate::measure::{Albedo, Facts, TableFacts};
use merlkit::geometry::Symmetry;
use merlkit::material::merl::RoundingError;

/// The facts of a named material.
#[derive(Clone, Debug, Serialize)]
pub struct Info {
    /// Short name.
    pub material: String,
    /// Where the values come from: a path, "built in", or a formula.
    pub source: String,
    /// How its file was read, as [`merlkit::material::Loaded::file_access`]; left out for others than MERL binaries.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub read: Option<String>,
    /// What was measured.
    #[serde(flatten)]
    pub facts: Facts,
}

impl Info {
    /// The albedos of materials, a row for each angle, with all their digits.
    pub fn albedo_csv<'a>(infos: impl Iterator<Item = &'a Self>) -> Sheet {
        let heading = ["material", "theta_o [°]", "red", "green", "blue", "error"];
        let mut sheet = Sheet::new(&heading);
        for info in infos {
            for albedo in &info.facts.albedo {
                let mut row = vec![info.material.clone(), albedo.theta_o_degrees.to_string()];
                row.extend(albedo.rgb.map(|channel| channel.to_string()));
                row.push(albedo.error.to_string());
                sheet.push(row);
            }
        }
        sheet
    }

    /// One line a fact; facts of a table where there is one.
    pub fn sheet(&self) -> Sheet {
        let mut sheet = Sheet::new(&[&self.material, &self.source]);
        let mut line = |name: &str, value: String| sheet.push(vec![name.into(), value]);
        if let Some(read) = &self.read {
            line("read", read.clone());
        }
        match &self.facts.table {
            Some(table) => table_lines(table, &mut line),
            None => line("bytes in memory", self.facts.bytes.to_string()),
        }
        match self.facts.lookup {
            Some(rule) => line("lookup", rule.name().into()),
            None => line("values", self.facts.reading.clone()),
        }
        let azimuth = match self.facts.symmetry {
            Symmetry::Isotropic => "",
            _ => ", azimuth 0°",
        };
        line("symmetry", symmetry_text(self.facts.symmetry).into());
        for a in &self.facts.albedo {
            let name = format!("albedo at {}°{azimuth}", a.theta_o_degrees);
            line(&name, albedo(a));
        }
        line(&format!("albedo above 1{azimuth}"), self.above_one());
        if let Some(asymmetry) = &self.facts.asymmetry {
            let [h, d] = asymmetry.greatest_at;
            let greatest = percent(asymmetry.greatest);
            line("φd asymmetry, mean", percent(asymmetry.mean));
            line(
                "φd asymmetry, greatest",
                format!("{greatest} (θh bin {h}, θd bin {d})"),
            );
        }
        sheet
    }

    fn above_one(&self) -> String {
        let a = &self.facts.albedo_above_one;
        let greatest = format!("greatest {:.4} at {}°", a.greatest, a.greatest_at_degrees);
        if a.ranges_degrees.is_empty() {
            return format!("nowhere ({greatest})");
        }
        let ranges: Vec<_> = a
            .ranges_degrees
            .iter()
            .map(|[first, last]| format!("{first}°–{last}°"))
            .collect();
        format!("{} ({greatest})", ranges.join(", "))
    }
}

fn table_lines(table: &TableFacts, line: &mut dyn FnMut(&str, String)) {
    let [h, d, p] = table.dimensions;
    let invalid = table.invalid;
    line("bins θh × θd × φd", format!("{h} × {d} × {p}"));
    line("bytes in memory", table.table_bytes.to_string());
    line("cells in memory", table.cell_format.name().into());
    if let Some(errors) = table.rounding_errors {
        rounding_lines(errors, line);
    }
    line("bytes as MERL binary", table.file_bytes.to_string());
    let fraction = percent(invalid.invalid() as f64 / (h * d * p) as f64);
    line(
        "invalid cells",
        format!("{} ({fraction})", invalid.invalid()),
    );
    line("  NaN", invalid.nan.to_string());
    line("  infinite", invalid.infinite.to_string());
    line(
        "  negative, MERL's mark for no value",
        invalid.negative.to_string(),
    );
    line(
        "  with both directions above the horizon",
        table.invalid_above_horizon.to_string(),
    );
    let reading = match (table.mixed_cells, table.channels_apart) {
        (0, _) => "",
        (_, true) => " (invalid in these channels alone)",
        (_, false) => " (invalid as a whole)",
    };
    line(
        "cells with some channels unusable",
        format!("{}{reading}", table.mixed_cells),
    );
    line("least value, sr⁻¹", rgb(table.min));
    line("greatest value, sr⁻¹", rgb(table.max));
    line("peak / mean", format!("{:.1}", table.peak_to_mean));
}

/// How far compact cells are from the values that were read, by channel.
fn rounding_lines(errors: [RoundingError; 3], line: &mut dyn FnMut(&str, String)) {
    line("  relative error, median", rgb(errors.map(|e| e.median)));
    let permille = rgb(errors.map(|e| e.permille));
    line("  exceeded by one value in 1000", permille);
    line("  greatest", rgb(errors.map(|e| e.greatest)));
    let [red, green, blue] = errors.map(|e| e.zeroed);
    line("  values that became 0", format!("{red} {green} {blue}"));
}

/// Which turns and mirror images leave the material as it is.
fn symmetry_text(symmetry: Symmetry) -> &'static str {
    match symmetry {
        Symmetry::Isotropic => "isotropic",
        Symmetry::Quarter => "anisotropic, both axes mirrored",
        Symmetry::Half => "anisotropic, half a turn",
        Symmetry::Whole => "anisotropic, none",
    }
}

fn albedo(a: &Albedo) -> String {
    let [r, g, b] = a.rgb;
    format!("{r:.4} {g:.4} {b:.4} (± {:.1e})", a.error)
}

fn rgb(value: [f32; 3]) -> String {
    value.map(|x| format!("{x:.4e}")).join(" ")
}

fn percent(fraction: f64) -> String {
    format!("{:.2} %", 100.0 * fraction)
}
