//! Words for what [`crate::measure`] returns: plain tables, JSON and CSV.
//!
//! JSON keeps full precision and fixed units, whatever a table on the screen shows. Where the output goes is the caller's
//! business.

mod beside_thesis;
mod charts;
mod check;
mod compare;
mod cost;
mod curve_charts;
mod digits;
mod export;
mod fit;
mod fitted;
mod hard;
mod import;
mod info;
mod material_charts;
mod page;
mod profile;
mod provenance;
mod repeated;
mod sheet;
mod summary;
mod surface_charts;
mod thesis;
mod thesis_ranking;
mod tune;

pub use beside_thesis::{ThesisTable, beside_thesis};
pub use charts::{ChartSubject, SLICE};
pub use check::CheckResult;
pub use compare::{ComparisonDocument, comparison_csv, picture_sheet, targets};
pub use curve_charts::{CurveCharts, CurveOptions};
pub use export::{drawn_row, export_row, export_sheet, table_sheet};
pub use fit::{
    FitDocument, fit_matrix, fit_ranking, fit_summary, fit_text, fits_csv, fits_sheet,
    parameters_sheet,
};
pub use fitted::{FitFormat, best_held, fitted_text};
pub use hard::HardSheets;
pub use import::resampling_sheet;
pub use info::Info;
pub use material_charts::material_charts;
pub use page::{comparison_page, fit_page, thesis_page};
pub use profile::{SamplerReport, thesis_legend};
pub use provenance::{Machine, MaterialChecksum, Provenance};
pub use repeated::{ThesisDocument, result_sheet};
pub use sheet::Sheet;
pub use summary::summary;
pub use surface_charts::{SurfaceOptions, check_surfaces, surface_chart};
pub use thesis::{ThesisFigures, thesis_figures, thesis_uniform_memory};
pub use tune::{tuning_sheet, tuning_summary};

use serde::Serialize;
use std::io::{self, Write};

/// Version of the JSON documents' shape; it grows when a field changes its name, place or meaning.
pub const JSON_SCHEMA: u32 = 3;

/// Writes `{"schema": …, "kind": kind, "provenance": …, "results": results}` and a line feed. Numbers that are not finite
/// become `null`.
///
/// # Errors
/// Those of `out`.
pub fn write_json<T: Serialize + ?Sized>(
    out: &mut dyn Write,
    kind: &str,
    provenance: &Provenance,
    results: &T,
) -> io::Result<()> {
    write_document(out, kind, Some(provenance), results)
}

/// [`write_json`] of results that are the same bytes whoever writes them, and therefore have no `provenance`.
///
/// # Errors
/// Those of `out`.
pub fn write_shared_json<T: Serialize + ?Sized>(
    out: &mut dyn Write,
    kind: &str,
    results: &T,
) -> io::Result<()> {
    write_document(out, kind, None, results)
}

fn write_document<T: Serialize + ?Sized>(
    out: &mut dyn Write,
    kind: &str,
    provenance: Option<&Provenance>,
    results: &T,
) -> io::Result<()> {
    #[derive(Serialize)]
    struct Document<'a, T: ?Sized> {
        schema: u32,
        kind: &'a str,
        #[serde(skip_serializing_if = "Option::is_none")]
        provenance: Option<&'a Provenance>,
        results: &'a T,
    }
    serde_json::to_writer_pretty(
        &mut *out,
        &Document {
            schema: JSON_SCHEMA,
            kind,
            provenance,
            results,
        },
    )?;
    writeln!(out)
}
