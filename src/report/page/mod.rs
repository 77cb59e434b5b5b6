//! A page that shows a comparison.

use crate::measure::compare::Comparison;

/// One self-contained HTML page.
pub fn comparison_page(comparison: &Comparison) -> String {
    comparison.materials.iter().filter_map(|m| m.verdict.as_ref()).map(|v| v.sentence.as_str()).collect()
}
