//! Cells of squared tangents: 64 octaves of 16 cells, found by the leading bits of an f64.

/// Number of cells.
pub(crate) const CELLS: usize = 1024;
/// Exponent and four bits of mantissa remain: a cell is at most 1/16 longer than its start, less than any two neighbouring
/// edges of bins are apart.
const SHIFT: u32 = 48;
/// Start of the first cell, an angle of 3.4·10⁻⁶ degrees.
pub(crate) const LOW: f64 = 1.0 / (1u64 << 48) as f64;
/// End of the last cell, an angle of 89.78 degrees.
pub(crate) const HIGH: f64 = 65536.0;
const FIRST: u64 = LOW.to_bits() >> SHIFT;

/// Cell of a squared tangent from [`LOW`] to below [`HIGH`]; past the last one for any other number and NaN.
#[inline(always)]
pub(crate) fn cell(tan2: f64) -> usize {
    // The bits of positive numbers rise with them. Smaller numbers wrap round and negative ones and NaN exceed all.
    (tan2.to_bits() >> SHIFT).wrapping_sub(FIRST) as usize
}

/// Start and end of a cell.
pub(crate) fn bounds(cell: usize) -> (f64, f64) {
    (first_in_cell(cell as u64), first_in_cell(cell as u64 + 1))
}

/// The least number of a cell.
fn first_in_cell(cell: u64) -> f64 {
    debug_assert!(cell <= CELLS as u64);
    f64::from_bits((FIRST + cell) << SHIFT)
}
