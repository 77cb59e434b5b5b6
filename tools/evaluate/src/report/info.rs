//! A material's facts, worded.

use serde::Serialize;

use super::Sheet;
use crate::measure::{Albedo, Facts};

/// The facts of a named material.
#[derive(Clone, Debug, Serialize)]
pub struct Info {
    /// Short name.
    pub material: String,
    /// Where the values come from: a path, or "embedded".
    pub source: String,
    /// What was measured.
    #[serde(flatten)]
    pub facts: Facts,
}

impl Info {
    /// One line a fact.
    pub fn sheet(&self) -> Sheet {
        let mut sheet = Sheet::new(&[&self.material, &self.source]);
        let mut line = |name: &str, value: String| sheet.push(vec![name.into(), value]);
        self.table_lines(&mut line);
        line("lookup", self.facts.lookup.name().into());
        for a in &self.facts.albedo {
            line(&format!("albedo at {}°", a.theta_o_degrees), albedo(a));
        }
        line("albedo above 1", self.above_one());
        let asymmetry = &self.facts.asymmetry;
        let [h, d] = asymmetry.greatest_at;
        let greatest = percent(asymmetry.greatest);
        line("φd asymmetry, mean", percent(asymmetry.mean));
        line(
            "φd asymmetry, greatest",
            format!("{greatest} (θh bin {h}, θd bin {d})"),
        );
        sheet
    }

    fn table_lines(&self, line: &mut dyn FnMut(&str, String)) {
        let table = &self.facts.table;
        let [h, d, p] = table.dimensions;
        let invalid = table.invalid;
        line("bins θh × θd × φd", format!("{h} × {d} × {p}"));
        line("bytes in memory", table.table_bytes.to_string());
        line("bytes as MERL binary", table.file_bytes.to_string());
        let share = percent(invalid.invalid() as f64 / (h * d * p) as f64);
        line("invalid cells", format!("{} ({share})", invalid.invalid()));
        line("  NaN", invalid.nan.to_string());
        line("  infinite", invalid.infinite.to_string());
        line("  negative", invalid.negative.to_string());
        line(
            "  above the horizon",
            table.invalid_above_horizon.to_string(),
        );
        line("least value, sr⁻¹", rgb(table.min));
        line("greatest value, sr⁻¹", rgb(table.max));
        line("peak / mean", format!("{:.1}", table.peak_to_mean));
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

fn albedo(a: &Albedo) -> String {
    let [r, g, b] = a.rgb;
    format!("{r:.4} {g:.4} {b:.4} (± {:.1e})", a.error)
}

fn rgb(value: [f32; 3]) -> String {
    value.map(|x| format!("{x:.4e}")).join(" ")
}

fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}
