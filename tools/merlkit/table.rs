//! Sheets as text tables.

use comfy_table::{Table, presets};
use merlkit_evaluate::report::Sheet;

/// The sheet as a Markdown table, which reads well in a terminal and survives copying; ends in a line feed.
pub fn render(sheet: &Sheet) -> String {
    let mut table = Table::new();
    table
        .load_style(presets::ASCII_MARKDOWN)
        .set_header(&sheet.heading);
    table.add_rows(&sheet.rows);
    format!("{}\n", table.trim_fmt())
}
