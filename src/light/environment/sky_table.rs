//! Which cell of a map a direction is chosen in.

use glam::DVec2;

use crate::distribution::{CellPlace, IntegerCdfs, LeafSearch};

/// Chooses cells of a map in proportion to their weights: a row, and a column within the row.
pub(super) struct SkyTable {
    /// One distribution over the rows.
    rows: IntegerCdfs,
    /// A distribution over the columns for each row.
    columns: IntegerCdfs,
}

/// A chosen direction: where it lies in the map, and in which pixel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ChosenPlace {
    /// Longitude, in columns of the map.
    pub(super) column: f64,
    /// Cosine of the polar angle.
    pub(super) cos: f64,
    /// Index of the pixel, among those of the map and around it.
    pub(super) cell: u32,
}

impl SkyTable {
    /// A table for weights `[row][width]`, finite and ≥ 0, with a finite sum; `None` if all of them are 0.
    pub(super) fn new(width: usize, weights: &[f64]) -> Option<Self> {
        let height = weights.len() / width;
        let mut columns = IntegerCdfs::new(width, height);
        let mut sums = Vec::with_capacity(height);
        for row in weights.chunks_exact(width) {
            columns.push(row);
            sums.push(row.iter().sum());
        }
        if sums.iter().all(|&sum| sum == 0.0) {
            return None;
        }
        let mut rows = IntegerCdfs::new(height, 1);
        rows.push(&sums);
        Some(Self { rows, columns })
    }

    /// Probability of choosing a cell.
    pub(super) fn probability(&self, column: usize, row: usize) -> f64 {
        // p(x, y) = p(y)·p(x | y)
        self.rows.probability(0, row) * self.columns.probability(row, column)
    }

    /// Bytes of memory.
    pub(super) fn bytes(&self) -> usize {
        self.rows.bytes() + self.columns.bytes()
    }

    /// The row and the column that `u` in [0, 1)² chooses; coordinates outside are clamped.
    #[inline(always)]
    pub(super) fn find(&self, u: DVec2) -> (CellPlace, CellPlace) {
        let (row, search) = self.find_row(u);
        (row, self.find_column(row, search))
    }

    /// The row, and the search for the column, as far as it goes in the smaller levels of its tree.
    #[inline(always)]
    pub(super) fn find_row(&self, u: DVec2) -> (CellPlace, LeafSearch) {
        let row = self.rows.find(0, u.y);
        (row, self.columns.find_leaf(row.cell as usize, u.x))
    }

    /// Reads a word that [`Self::find_column`] will read from the large table; it has no meaning.
    #[inline(always)]
    pub(super) fn touch(&self, row: CellPlace, search: LeafSearch) -> u32 {
        self.columns.touch(row.cell as usize, search)
    }

    /// The column, in the end.
    #[inline(always)]
    pub(super) fn find_column(&self, row: CellPlace, search: LeafSearch) -> CellPlace {
        self.columns.find_cell(row.cell as usize, search)
    }
}
