//! Which style is whose, below the chart.

use super::drawing::Drawing;
use super::style::Style;
use super::text::{Anchor, TEXT, shortened, width_of};

/// One entry.
pub(super) struct Entry {
    pub label: String,
    pub style: Style,
    /// Whether a piece of line is shown.
    pub line: bool,
    /// Whether a mark is shown.
    pub mark: bool,
}

impl Entry {
    /// Pixels that it takes across.
    fn width(&self) -> f64 {
        SAMPLE + width_of(&self.label, TEXT)
    }
}

const ROW: f64 = 18.0;
const SAMPLE: f64 = 34.0;
const GAP: f64 = 18.0;
const LEFT: f64 = 24.0;

/// Entries in rows.
pub(super) struct Legend {
    entries: Vec<(Entry, f64, usize)>,
    rows: usize,
}

impl Legend {
    /// Lays entries out on a sheet of that width: in one row, or else in columns as wide as the widest entry.
    pub fn new(mut entries: Vec<Entry>, sheet_width: f64) -> Self {
        // More room than this no entry takes.
        let widest = sheet_width - 2.0 * LEFT;
        for entry in &mut entries {
            entry.label = shortened(&entry.label, TEXT, widest - SAMPLE);
        }
        let widths: Vec<f64> = entries.iter().map(Entry::width).collect();
        let total: f64 = widths.iter().map(|width| width + GAP).sum();
        let column = widths.iter().copied().fold(0.0, f64::max) + GAP;
        let columns = if total <= widest + GAP {
            entries.len().max(1)
        } else {
            (((widest + GAP) / column) as usize).max(1)
        };
        let rows = entries.len().div_ceil(columns);
        let mut x = LEFT;
        let mut placed = Vec::with_capacity(entries.len());
        for (i, entry) in entries.into_iter().enumerate() {
            if i % columns == 0 {
                x = LEFT;
            }
            placed.push((entry, x, i / columns));
            x += if rows == 1 { widths[i] + GAP } else { column };
        }
        Self {
            entries: placed,
            rows,
        }
    }

    /// Pixels from its top to its end.
    pub fn height(&self) -> f64 {
        self.rows as f64 * ROW
    }

    /// Draws it with its top at `y`.
    pub fn draw(&self, drawing: &mut Drawing, y: f64) {
        for (entry, x, row) in &self.entries {
            let middle = y + (*row as f64 + 0.5) * ROW;
            if entry.line {
                drawing.line(
                    (*x, middle),
                    (x + SAMPLE - 8.0, middle),
                    entry.style.stroke(),
                );
            }
            if entry.mark {
                let mark = entry.style.mark((x + (SAMPLE - 8.0) / 2.0, middle));
                drawing.outlines(vec![mark], entry.style.marks());
            }
            drawing.label(
                (x + SAMPLE - 3.0, middle + 4.0),
                Anchor::Start,
                &entry.label,
            );
        }
    }
}
