//! How the cells of a table are kept in memory: as they were read, or rounded to a half or a quarter of their bytes.

use glam::Vec4;

/// How the cells of a table are kept in memory. Compact cells are rounded when the table is loaded, and read in less time where
/// memory is what a lookup waits for.
///
/// [`MerlTable::with_cell_format`](crate::material::merl::MerlTable::with_cell_format) rounds a table, and measures by how much.
///
/// # Examples
/// ```
/// use merlkit::material::merl::{CellFormat, decode_embedded};
///
/// let nickel = decode_embedded("nickel").unwrap();
/// let compact = nickel.clone().with_cell_format(CellFormat::F16)?;
/// assert_eq!(2 * compact.bytes(), nickel.bytes());
/// for error in compact.rounding_errors().unwrap() {
///     assert!(error.greatest <= 2f32.powi(-11));
/// }
/// # Ok::<(), merlkit::Error>(())
/// ```
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "lowercase")]
pub enum CellFormat {
    /// The values as they were read: 16 bytes a cell.
    #[default]
    F32,
    /// 16 bits a channel, 8 bytes a cell: ten bits of mantissa, as IEEE's half precision has them, and six of exponent, since no
    /// value has a sign. Relative errors are at most 2⁻¹¹ down to 2⁻⁶¹ of the greatest value.
    F16,
    /// Nine bits of mantissa a channel and five of an exponent that the channels share, 4 bytes a cell. Errors are at most 0.2 % of
    /// the cell's greatest channel, down to 2⁻³¹ of the greatest value; a channel that is much darker than another of its
    /// cell loses digits.
    Rgb9e5,
}

impl CellFormat {
    /// All formats, the most exact first.
    pub const ALL: [Self; 3] = [Self::F32, Self::F16, Self::Rgb9e5];

    /// The format's name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F16 => "f16",
            Self::Rgb9e5 => "rgb9e5",
        }
    }
}

/// How far a table's values in one channel are from those that were read.
///
/// The example of [`CellFormat`] rounds a table.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct RoundingError {
    /// Median of the relative errors of valid values above 0.
    pub median: f32,
    /// The relative error that one such value in a thousand exceeds.
    pub permille: f32,
    /// The greatest relative error; 1 for a value that became 0.
    pub greatest: f32,
    /// Values above 0 that became 0.
    pub zeroed: u64,
}

impl RoundingError {
    /// The worst of the channels in each figure, and all values that became 0.
    pub fn worst(channels: [Self; 3]) -> Self {
        let mut worst = Self::default();
        for channel in channels {
            worst.median = worst.median.max(channel.median);
            worst.permille = worst.permille.max(channel.permille);
            worst.greatest = worst.greatest.max(channel.greatest);
            worst.zeroed += channel.zeroed;
        }
        worst
    }
}

/// Cells that can be read one at a time.
pub(super) trait ReadCells {
    /// RGB and validity of a cell, as [`MerlTable::cell`](super::MerlTable::cell) has them.
    fn read(&self, cell: usize) -> Vec4;
}

impl ReadCells for [Vec4] {
    #[inline(always)]
    fn read(&self, cell: usize) -> Vec4 {
        self[cell]
    }
}

/// Cells of `WORDS` words, to be decoded without a branch or a look-up, so that loops over columns of words become vector code.
pub(super) trait CompactCells<const WORDS: usize>: ReadCells {
    /// The words of a cell.
    fn words(&self, cell: usize) -> [u32; WORDS];

    /// What [`ReadCells::read`] gives for a cell of these words.
    fn decode(&self, words: [u32; WORDS]) -> [f32; 4];
}

/// The exponent of the greatest value that compact cells can hold: above, the scale of f16 is no f32.
pub(super) const GREATEST_EXPONENT: i32 = 62;

/// 2 to an integer power from −149 to 127.
pub(super) fn power_of_two(exponent: i32) -> f32 {
    2f64.powi(exponent) as f32
}

/// The exponent e of a positive value 2ᵉ ≤ `value` < 2ᵉ⁺¹; 0 for 0.
pub(super) fn binary_exponent(value: f32) -> i32 {
    // Every f32 but 0 is a normal number in f64.
    match value > 0.0 {
        true => (f64::from(value).to_bits() >> 52) as i32 - 1023,
        false => 0,
    }
}
