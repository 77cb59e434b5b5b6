//! The thesis's experiments as sheets and JSON.

use serde::Serialize;

use super::Sheet;
use crate::thesis::{Exhibit, ResultCell, ResultTable, ThesisPlan};

/// What `merlkit thesis --json` writes.
#[derive(Clone, Debug, Serialize)]
pub struct ThesisDocument<'a> {
    /// How much was run.
    pub plan: &'a ThesisPlan,
    /// Day of the first piece.
    pub begun: &'a str,
    /// The experiments, in the order in which they were named.
    pub experiments: &'a [Exhibit],
}

/// A table of results as text.
pub fn result_sheet(result: &ResultTable) -> Sheet {
    let mut sheet = Sheet {
        heading: result.heading.clone(),
        rows: Vec::new(),
    };
    for row in &result.rows {
        sheet.push(row.iter().map(write_entry).collect());
    }
    sheet
}

fn write_entry(entry: &ResultCell) -> String {
    match entry {
        ResultCell::Number(number) => write_number(*number),
        ResultCell::Words(words) => words.clone(),
        ResultCell::Missing => "–".into(),
    }
}

/// Whole numbers in full, others to three or four digits.
fn write_number(number: f64) -> String {
    match number.abs() {
        size if size == size.trunc() && size < 1e7 => format!("{number}"),
        size if size >= 1e7 => format!("{number:.2e}"),
        size if size >= 100.0 => format!("{number:.0}"),
        size if size >= 10.0 => format!("{number:.1}"),
        size if size >= 0.1 => format!("{number:.2}"),
        size if size >= 0.001 => format!("{number:.4}"),
        _ => format!("{number:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_matter() {
        for (number, text) in [
            (2500.0, "2500"),
            (0.0, "0"),
            (-3.0, "-3"),
            (846.15, "846"),
            (26.04, "26.0"),
            (0.953, "0.95"),
            (0.0123, "0.0123"),
            (4.2e-5, "4.2e-5"),
            (1.5e9, "1.50e9"),
        ] {
            assert_eq!(write_number(number), text);
        }
    }
}
