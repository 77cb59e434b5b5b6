//! The grammar of lists: which line names the columns, and where the rows are.
//!
//! Three kinds are told apart by their first line that is neither blank nor a comment (`#`):
//! - a whole number alone: the number of wavelengths, these, then rows (Cornell's lists);
//! - a line `VARS …` further down: ASTM E1392, with keywords in front of it;
//! - otherwise names of columns, then rows (CSV, by commas, semicolons, tabs or blanks).

use std::path::Path;

use super::columns::{AngleUnit, ListColumns};
use crate::{Error, Result};

/// A list as it was read: what its columns mean, and its rows.
pub(super) struct List {
    pub columns: ListColumns,
    pub unit: AngleUnit,
    /// Rows of as many numbers as there are columns, one after another.
    pub numbers: Vec<f64>,
}

/// A line with its offset in the file.
#[derive(Clone, Copy)]
struct Line<'a> {
    text: &'a str,
    offset: usize,
}

/// Reads a list; `path` is for messages.
///
/// # Errors
/// [`Error::Invalid`] where it breaks the grammar.
pub(super) fn read_list(text: &str, path: &Path) -> Result<List> {
    let lines = significant_lines(text);
    let Some(first) = lines.first() else {
        return Err(invalid(path, 0, "names of columns", "no line but comments"));
    };
    if let Ok(count) = first.text.parse::<usize>() {
        return read_spectral(&lines, count, path);
    }
    let vars = lines.iter().position(|line| line.text.starts_with("VARS "));
    let (heading, default) = match vars {
        Some(k) => (k, AngleUnit::Radians),
        None => (0, AngleUnit::Degrees),
    };
    let names = lines[heading].text.trim_start_matches("VARS ");
    let columns = ListColumns::from_names(&split_row(names))
        .map_err(|missing| invalid(path, lines[heading].offset, &missing, names))?;
    let numbers = read_rows(&lines[heading + 1..], columns.count, path)?;
    check_count(
        &lines[..heading],
        numbers.len() / columns.count,
        text.len(),
        path,
    )?;
    Ok(List {
        unit: columns.stated_unit.unwrap_or(default),
        columns,
        numbers,
    })
}

/// `count` wavelengths over any number of lines, then rows.
fn read_spectral(lines: &[Line], count: usize, path: &Path) -> Result<List> {
    let mut wavelengths = Vec::new();
    let mut next = 1;
    while wavelengths.len() < count {
        let Some(line) = lines.get(next) else {
            let found = format!("{} of them", wavelengths.len());
            return Err(invalid(
                path,
                lines[0].offset,
                &format!("{count} wavelengths"),
                &found,
            ));
        };
        wavelengths.extend(read_numbers(line, path)?.iter().map(|&nm| nm as f32));
        next += 1;
    }
    let columns = if wavelengths.len() == count {
        ListColumns::from_wavelengths(&wavelengths)
    } else {
        Err(format!("{count} wavelengths"))
    };
    let columns = columns.map_err(|expected| {
        let found = format!("{} numbers", wavelengths.len());
        invalid(path, lines[0].offset, &expected, &found)
    })?;
    let numbers = read_rows(&lines[next..], columns.count, path)?;
    Ok(List {
        columns,
        unit: AngleUnit::Radians,
        numbers,
    })
}

fn significant_lines(text: &str) -> Vec<Line<'_>> {
    let mut out = Vec::new();
    let mut offset = 0;
    for line in text.split_inclusive('\n') {
        let trimmed = line.trim();
        if !trimmed.is_empty() && !trimmed.starts_with('#') {
            out.push(Line {
                text: trimmed,
                offset,
            });
        }
        offset += line.len();
    }
    out
}

/// Cells by the first of these separators that a row has: semicolon, comma, blanks.
fn split_row(row: &str) -> Vec<&str> {
    for separator in [';', ','] {
        if row.contains(separator) {
            return row
                .split(separator)
                .map(|cell| cell.trim().trim_matches('"'))
                .collect();
        }
    }
    row.split_whitespace()
        .map(|cell| cell.trim_matches('"'))
        .collect()
}

fn read_numbers(line: &Line, path: &Path) -> Result<Vec<f64>> {
    let mut out = Vec::new();
    for cell in split_row(line.text) {
        match cell.parse::<f64>() {
            Ok(number) => out.push(number),
            Err(_) => return Err(invalid(path, line.offset, "numbers", cell)),
        }
    }
    Ok(out)
}

fn read_rows(lines: &[Line], width: usize, path: &Path) -> Result<Vec<f64>> {
    let mut numbers = Vec::new();
    for line in lines {
        let row = read_numbers(line, path)?;
        if row.len() != width {
            let found = format!("{} in \"{}\"", row.len(), shortened(line.text));
            return Err(invalid(
                path,
                line.offset,
                &format!("{width} numbers"),
                &found,
            ));
        }
        numbers.extend(row);
    }
    if numbers.is_empty() {
        return Err(invalid(path, 0, "rows of numbers", "none"));
    }
    Ok(numbers)
}

/// A list that promises `NUM_POINTS` must have them.
fn check_count(keywords: &[Line], rows: usize, length: usize, path: &Path) -> Result<()> {
    for line in keywords {
        let promised = line.text.strip_prefix("NUM_POINTS");
        if let Some(count) = promised.and_then(|text| text.trim().parse::<usize>().ok())
            && count != rows
        {
            return Err(invalid(
                path,
                length,
                &format!("{count} rows, as NUM_POINTS says"),
                &format!("{rows}"),
            ));
        }
    }
    Ok(())
}

fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}

fn invalid(path: &Path, offset: usize, expected: &str, found: &str) -> Error {
    Error::invalid(
        path,
        offset as u64,
        expected,
        shortened(found),
        "docs/import.md describes the lists that are read",
    )
}
