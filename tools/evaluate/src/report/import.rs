//! What a table makes of the file that it was resampled from.

use super::Sheet;
use crate::measure::{ResamplingErrors, ValueErrors};

/// Errors of a table, and the part of each cause.
pub fn resampling_sheet(errors: &ResamplingErrors) -> Sheet {
    let mut sheet = Sheet::new(&["difference of f_r", "median %", "95th %", "albedo %"]);
    let rows = [
        ("table from file", &errors.whole),
        ("by forced reciprocity", &errors.reciprocity),
        ("by the table's bins", &errors.bins),
    ];
    for (name, errors) in rows {
        sheet.push(row(name, errors));
    }
    sheet
}

fn row(name: &str, errors: &ValueErrors) -> Vec<String> {
    vec![
        name.into(),
        format!("{:.3}", 100.0 * errors.median),
        format!("{:.2}", 100.0 * errors.percentile_95),
        format!("{:.2}", 100.0 * errors.albedo),
    ]
}
