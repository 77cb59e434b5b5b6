//! Which style is whose, below the chart.

use super::style::Style;
use super::svg::{Anchor, Svg, TEXT, shortened, width_of};

/// One entry.
pub(super) struct Entry {
    pub label: String,
    pub style: Style,
    /// Whether a piece of line is shown.
    pub line: bool,
    /// Whether a mark is shown.
    pub mark: bool,
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
    /// Lays entries out in as many rows as they need on a sheet of that width.
    pub fn new(entries: Vec<Entry>, sheet_width: f64) -> Self {
        // More room than this no entry takes.
        let widest = sheet_width - 2.0 * LEFT;
        let (mut x, mut row) = (LEFT, 0);
        let mut placed = Vec::with_capacity(entries.len());
        for mut entry in entries {
            entry.label = shortened(&entry.label, TEXT, widest - SAMPLE);
            let width = SAMPLE + width_of(&entry.label, TEXT);
            if x > LEFT && x + width > LEFT + widest {
                (x, row) = (LEFT, row + 1);
            }
            placed.push((entry, x, row));
            x += width + GAP;
        }
        let rows = if placed.is_empty() { 0 } else { row + 1 };
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
    pub fn draw(&self, svg: &mut Svg, y: f64) {
        for (entry, x, row) in &self.entries {
            let middle = y + (*row as f64 + 0.5) * ROW;
            if entry.line {
                svg.line(
                    (*x, middle),
                    (x + SAMPLE - 8.0, middle),
                    &entry.style.stroke(),
                );
            }
            if entry.mark {
                let mark = entry.style.mark((x + (SAMPLE - 8.0) / 2.0, middle));
                svg.push(&format!("<path d=\"{mark}\" {}/>", entry.style.marks()));
            }
            svg.label(
                (x + SAMPLE - 3.0, middle + 4.0),
                Anchor::Start,
                &entry.label,
            );
        }
    }
}
