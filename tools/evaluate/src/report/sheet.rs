//! Rows of text under a heading: what every table and CSV file is made from.

use std::io::{self, Write};

use serde::Serialize;

/// A heading and rows of cells, as many in each as in the heading.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Sheet {
    /// Names of the columns.
    pub heading: Vec<String>,
    /// The cells.
    pub rows: Vec<Vec<String>>,
}

impl Sheet {
    /// A sheet without rows.
    pub fn new(heading: &[&str]) -> Self {
        Self {
            heading: heading.iter().map(|&h| h.into()).collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row.
    pub fn push(&mut self, row: Vec<String>) {
        self.rows.push(row);
    }

    /// Writes the sheet as CSV (RFC 4180, but lines end in a line feed alone).
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_csv(&self, out: &mut dyn Write) -> io::Result<()> {
        for row in std::iter::once(&self.heading).chain(&self.rows) {
            let cells: Vec<_> = row.iter().map(|c| quoted(c)).collect();
            writeln!(out, "{}", cells.join(","))?;
        }
        Ok(())
    }
}

fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn csv_quotes_what_would_split() {
        let mut sheet = Sheet::new(&["name", "value"]);
        sheet.push(vec!["a,b".into(), "say \"c\"".into()]);
        let mut out = Vec::new();
        sheet.write_csv(&mut out).unwrap();
        assert_eq!(
            String::from_utf8(out).unwrap(),
            "name,value\n\"a,b\",\"say \"\"c\"\"\"\n"
        );
    }
}
