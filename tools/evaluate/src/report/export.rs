//! What exported files make of their materials.

use super::Sheet;
use crate::measure::{DrawQuality, ValueErrors};

/// A sheet for [`export_row`]s. The files' densities follow luminance, so that of luminance is the spread they answer for.
pub fn export_sheet() -> Sheet {
    Sheet::new(&[
        "file",
        "MB",
        "median %",
        "95th %",
        "albedo %",
        "colour %",
        "relstd of luminance",
        "draws below the horizon %",
    ])
}

/// A file, its length, the largest error of a colour in it (a share), errors of its values and how it draws.
pub fn export_row(
    file: String,
    bytes: u64,
    colour: f64,
    errors: &ValueErrors,
    draws: &DrawQuality,
) -> Vec<String> {
    vec![
        file,
        megabytes(bytes),
        format!("{:.3}", 100.0 * errors.median),
        format!("{:.2}", 100.0 * errors.percentile_95),
        format!("{:.2}", 100.0 * errors.albedo),
        format!("{:.4}", 100.0 * colour),
        relstd(draws),
        format!("{:.2}", 100.0 * draws.failed),
    ]
}

/// A sheet for [`drawn_row`]s. The spread is that of `report`, of the mean of red, green and blue.
pub fn table_sheet() -> Sheet {
    Sheet::new(&["file", "MB", "content", "relstd of mean RGB"])
}

/// A file of values, of a half-vector table, or of both: its length, what it holds, and how its table draws if it has one.
pub fn drawn_row(
    file: String,
    bytes: u64,
    holds: &str,
    draws: Option<&DrawQuality>,
) -> Vec<String> {
    let relstd = draws.map_or_else(|| "-".into(), relstd);
    vec![file, megabytes(bytes), holds.into(), relstd]
}

fn megabytes(bytes: u64) -> String {
    format!("{:.2}", bytes as f64 * 1e-6)
}

fn relstd(draws: &DrawQuality) -> String {
    format!("{:.3} to {:.3}", draws.least_relstd, draws.largest_relstd)
}
