//! The decoded table: one cell of RGB and validity for every bin.

use glam::{Vec3, Vec4};

use super::cell_format::{CellFormat, RoundingError};
use super::cells::Cells;
use super::header::{Header, SCALE};
use crate::color::Rgb;
use crate::geometry::merl_axes::{THETA_D_BINS, THETA_H_BINS, theta_d, theta_h_edge};
use crate::{Error, Result};

/// The last 16 bits of a raw value that was filled in, in all three channels: they are far below the precision of f32, and three
/// measured values end in them once in 3·10¹⁴ cells.
pub(super) const FILLED_MARK: u64 = 0xf111;

/// Heights below this are rounding: some corners of bins lie on the horizon exactly.
const LEAST_HEIGHT: f64 = 1e-12;

/// Counts of cells that carry no usable value, by the first reason that applies in the order of the fields.
///
/// The example of [`MerlTable`](crate::material::merl::MerlTable) makes a table and evaluates it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Census {
    /// A channel is not a number.
    pub nan: u64,
    /// A channel is infinite, or beyond the range of `f32` once scaled.
    pub infinite: u64,
    /// A channel is negative: the original files mark pairs below the horizon so.
    pub negative: u64,
}

impl Census {
    /// All invalid cells.
    pub fn invalid(self) -> u64 {
        self.nan + self.infinite + self.negative
    }
}

/// A decoded MERL table: f_r in sr⁻¹ for each bin `[theta_h, theta_d, phi_d]`, 90 × 90 × 180 (or 360).
///
/// Invalid cells hold 0 and are marked; every valid value is finite and ≥ 0. A cell in which some channels alone are unusable is
/// invalid as a whole, unless the table keeps channels apart ([`Self::keeps_channels_apart`]). The table owns its memory and
/// does not know the file it came from.
///
/// # Examples
/// ```
/// use std::sync::Arc;
///
/// use merlkit::color::Rgb;
/// use merlkit::glam::Vec3;
/// use merlkit::material::merl::{Header, MerlBrdf, MerlTable};
/// use merlkit::{Brdf, Loaded, LookupRule};
///
/// // A grey table of 90 × 90 × 180 bins with one gap. `merl::write` stores it as a MERL binary, and `merl::load` reads one.
/// let table = MerlTable::from_fn(Header { phi_d_bins: 180 }, |theta_h, theta_d, phi_d| {
///     match (theta_h, theta_d, phi_d) {
///         (3, 7, 20) => [-1.0; 3],
///         _ => [0.25; 3],
///     }
/// });
/// assert_eq!(table.census().invalid(), 1);
/// assert!(!table.is_valid(3, 7, 20));
///
/// let brdf = MerlBrdf::new(Arc::new(table), LookupRule::Floor);
/// assert_eq!(brdf.eval(Vec3::Z, Vec3::Z), Rgb::splat(0.25));
/// let loaded = Loaded::from_table(Arc::new(brdf));
/// assert!(loaded.require_table("this example").is_ok());
/// ```
#[derive(Clone)]
pub struct MerlTable {
    header: Header,
    /// x, y, z = RGB; w as [`validity`] has it.
    cells: Cells,
    /// Of compact cells, how far each channel is from what was read.
    rounding: Option<[RoundingError; 3]>,
    census: Census,
    /// Cells with usable and unusable channels.
    mixed: u64,
    channels_apart: bool,
    /// Cells whose value was filled in, rising.
    filled: Vec<u32>,
}

impl MerlTable {
    /// Builds a table of f_r from `value(theta_h, theta_d, phi_d)`, in bin indices.
    ///
    /// A cell with a negative, NaN or infinite channel becomes invalid and is counted.
    pub fn from_fn(header: Header, value: impl FnMut(usize, usize, usize) -> [f64; 3]) -> Self {
        Self::collect(header, false, value)
    }

    /// [`Self::from_fn`] of a table that may keep channels apart.
    pub(in crate::material) fn collect(
        header: Header,
        channels_apart: bool,
        mut value: impl FnMut(usize, usize, usize) -> [f64; 3],
    ) -> Self {
        let mut table = TableBuilder::new(header, channels_apart);
        for h in 0..THETA_H_BINS {
            for d in 0..THETA_D_BINS {
                for p in 0..header.phi_d_bins {
                    table.push(value(h, d, p));
                }
            }
        }
        table.finish()
    }

    /// Dimensions.
    pub fn header(&self) -> Header {
        self.header
    }

    /// Bins of φd: 180 or 360.
    pub fn phi_d_bins(&self) -> usize {
        self.header.phi_d_bins
    }

    /// The same table with its cells in `format`, rounded to the nearest. It says how far that moved its values
    /// ([`Self::rounding_errors`]); a table that is compact already is rounded again, and measured against what it held.
    ///
    /// # Errors
    /// [`Error::Argument`] for a compact format if a cell has a value in some channels only, which needs `f32`, or a value is 2⁶³ or more.
    pub fn with_cell_format(self, format: CellFormat) -> Result<Self> {
        if format == self.cell_format() {
            return Ok(self);
        }
        if self.has_partial_cells() && format != CellFormat::F32 {
            return Err(Error::argument(
                format!(
                    "{} cells hold a value in some channels only, which {} cells can't say",
                    self.mixed,
                    format.name()
                ),
                "keep the table as f32 (--table f32), or drop these cells as a whole (--invalid cell)",
            ));
        }
        let exact: Vec<Vec4> = self.cells().collect();
        let cells = Cells::round(&exact, format)?;
        let rounding = match format {
            CellFormat::F32 => None,
            CellFormat::F16 | CellFormat::Rgb9e5 => Some(cells.measure_rounding(&exact)),
        };
        Ok(Self {
            cells,
            rounding,
            ..self
        })
    }

    /// How its cells are kept in memory.
    pub fn cell_format(&self) -> CellFormat {
        self.cells.format()
    }

    /// How far red, green and blue of compact cells are from the values that were read; `None` for those as they were read.
    pub fn rounding_errors(&self) -> Option<[RoundingError; 3]> {
        self.rounding
    }

    /// Position of a bin in [`Self::cells`].
    #[inline]
    pub fn index(&self, theta_h: usize, theta_d: usize, phi_d: usize) -> usize {
        phi_d + self.header.phi_d_bins * (theta_d + THETA_D_BINS * theta_h)
    }

    /// A cell by its position in [`Self::cells`]: `xyz` is RGB, `w` is 1 where valid, 0 where invalid, and in between
    /// where [`Self::valid_channels`] are some of the three.
    #[inline(always)]
    pub fn cell(&self, cell: usize) -> Vec4 {
        self.cells.get(cell)
    }

    /// All cells in file order: φd fastest, then θd, then θh. Each is as [`Self::cell`] has it.
    pub fn cells(&self) -> impl ExactSizeIterator<Item = Vec4> + '_ {
        (0..self.header.cells()).map(|cell| self.cell(cell))
    }

    /// All cells as they lie in memory, in the order of [`Self::cells`]; `None` for compact cells. Other languages read them in place.
    pub fn cells_in_memory(&self) -> Option<&[Vec4]> {
        match &self.cells {
            Cells::F32(cells) => Some(cells),
            Cells::F16(_) | Cells::Rgb9e5(_) => None,
        }
    }

    /// The words of [`CellFormat::Rgb9e5`] cells in the order of [`Self::cells`], and their unit; `None` for other formats.
    ///
    /// Bits 0 to 8 are red's integer, 9 to 17 green's, 18 to 26 blue's, and the five above a field e: the value of an integer m is
    /// m·2ᵉ·unit. An invalid cell is the word 0xf8000000.
    pub fn shared_exponent_words(&self) -> Option<(&[u32], f32)> {
        match &self.cells {
            Cells::Rgb9e5(cells) => Some((cells.all_words(), cells.unit())),
            Cells::F32(_) | Cells::F16(_) => None,
        }
    }

    /// The cells as they are kept, for those who read many.
    #[inline(always)]
    pub(super) fn stored_cells(&self) -> &Cells {
        &self.cells
    }

    /// RGB of a bin; 0 where invalid.
    pub fn rgb(&self, theta_h: usize, theta_d: usize, phi_d: usize) -> Rgb {
        self.cell(self.index(theta_h, theta_d, phi_d)).truncate()
    }

    /// Whether each channel of a cell, by its position in [`Self::cells`], holds a value.
    #[inline]
    pub fn valid_channels(&self, cell: usize) -> [bool; 3] {
        valid_channels(self.cell(cell).w)
    }

    /// Whether in a cell of which some channels are negative, NaN or infinite only these are invalid, rather than all three.
    pub fn keeps_channels_apart(&self) -> bool {
        self.channels_apart
    }

    /// Cells of which some channels are usable and some are not: invalid as a whole, and then part of the census, unless the
    /// table keeps channels apart.
    pub fn mixed_cells(&self) -> u64 {
        self.mixed
    }

    /// Whether a cell may have a value in some channels only.
    #[inline(always)]
    pub(crate) fn has_partial_cells(&self) -> bool {
        self.channels_apart && self.mixed > 0
    }

    /// Whether a bin holds a measured value, in one channel at least.
    pub fn is_valid(&self, theta_h: usize, theta_d: usize, phi_d: usize) -> bool {
        self.cell(self.index(theta_h, theta_d, phi_d)).w != 0.0
    }

    /// The same table, of which these cells, in rising order, were filled in rather than measured.
    pub(in crate::material) fn with_filled(self, filled: Vec<u32>) -> Self {
        Self { filled, ..self }
    }

    /// Positions in [`Self::cells`] whose value was filled in rather than measured, rising. Files keep the mark.
    pub fn filled(&self) -> &[u32] {
        &self.filled
    }

    /// Cells without a usable value.
    pub fn census(&self) -> Census {
        self.census
    }

    /// Invalid cells whose lower corner is a pair of directions above the horizon, so that a value would be expected.
    pub fn count_gaps(&self) -> u64 {
        let cos_phi: Vec<f64> = (0..self.phi_d_bins())
            .map(|p| (p as f64).to_radians().cos())
            .collect();
        let mut count = 0;
        for row in 0..THETA_H_BINS * THETA_D_BINS {
            let (sin_h, cos_h) = theta_h_edge(row / THETA_D_BINS).sin_cos();
            let (sin_d, cos_d) = theta_d((row % THETA_D_BINS) as f64).sin_cos();
            for (p, cos_phi) in cos_phi.iter().enumerate() {
                // The lower direction has the height cosθh·cosθd − sinθh·sinθd·|cosφd|.
                let height = cos_h * cos_d - sin_h * sin_d * cos_phi.abs();
                let is_invalid = self.cell(row * self.phi_d_bins() + p).w == 0.0;
                count += u64::from(is_invalid && height > LEAST_HEIGHT);
            }
        }
        count
    }

    /// Bytes of memory that the table holds.
    pub fn bytes(&self) -> usize {
        self.cells.bytes()
    }

    /// The raw value that a file stores for a channel of a cell: −1 where invalid, with [`FILLED_MARK`] where filled in.
    pub(super) fn raw(&self, cell: usize, channel: usize) -> f64 {
        let c = self.cell(cell);
        if !valid_channels(c.w)[channel] {
            return -1.0;
        }
        let raw = f64::from(c[channel]) / SCALE[channel];
        if self.filled.binary_search(&(cell as u32)).is_ok() {
            f64::from_bits(raw.to_bits() & !0xffff | FILLED_MARK)
        } else {
            raw
        }
    }
}

impl std::fmt::Debug for MerlTable {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MerlTable")
            .field("header", &self.header)
            .field("census", &self.census)
            .finish_non_exhaustive()
    }
}

/// The fourth component of a cell: 1 if all its channels are valid, else an eighth of a number whose bits are red, green and blue.
fn validity(valid: [bool; 3]) -> f32 {
    let [red, green, blue] = valid.map(|v| f32::from(u8::from(v)));
    match valid {
        [true, true, true] => 1.0,
        _ => (red + 2.0 * green + 4.0 * blue) / 8.0,
    }
}

/// The channels that [`validity`] says are valid.
#[inline]
fn valid_channels(validity: f32) -> [bool; 3] {
    let bits = if validity == 1.0 {
        7
    } else {
        (8.0 * validity) as u8
    };
    [bits & 1 != 0, bits & 2 != 0, bits & 4 != 0]
}

/// Whether a channel is a value: not NaN, negative, infinite or beyond the range of f32.
#[inline(always)]
pub(super) fn is_usable(rounded: f32, value: f64) -> bool {
    // One comparison a channel passes ordinary cells: NaN fails it, as do −x, ∞ and what overflows f32.
    value >= 0.0 && rounded <= f32::MAX
}

/// Collects cells in file order and takes the census as they pass.
pub(super) struct TableBuilder {
    header: Header,
    cells: Vec<Vec4>,
    census: Census,
    mixed: u64,
    channels_apart: bool,
    filled: Vec<u32>,
}

impl TableBuilder {
    pub(super) fn new(header: Header, channels_apart: bool) -> Self {
        Self {
            header,
            cells: Vec::with_capacity(header.cells()),
            census: Census::default(),
            mixed: 0,
            channels_apart,
            filled: Vec::new(),
        }
    }

    /// Notes that the next cell was filled in rather than measured.
    pub(super) fn mark_filled(&mut self) {
        self.filled.push(self.cells.len() as u32);
    }

    /// Adds cells all of whose channels are values.
    #[inline(always)]
    pub(super) fn extend(&mut self, cells: &[Vec4]) {
        self.cells.extend_from_slice(cells);
    }

    /// Adds the next cell: f_r, not a file's raw values.
    #[inline]
    pub(super) fn push(&mut self, value: [f64; 3]) {
        let rgb = Vec3::new(value[0] as f32, value[1] as f32, value[2] as f32);
        if is_usable(rgb.x, value[0]) && is_usable(rgb.y, value[1]) && is_usable(rgb.z, value[2]) {
            self.cells.push(rgb.extend(1.0));
        } else {
            self.reject(value, rgb);
        }
    }

    fn reject(&mut self, value: [f64; 3], rgb: Rgb) {
        let usable = [0, 1, 2].map(|channel| is_usable(rgb[channel], value[channel]));
        let is_mixed = usable.contains(&true);
        self.mixed += u64::from(is_mixed);
        if is_mixed && self.channels_apart {
            let kept = Vec3::select(usable.into(), rgb, Vec3::ZERO);
            self.cells.push(kept.extend(validity(usable)));
            return;
        }
        let reason = if value.iter().any(|v| v.is_nan()) {
            &mut self.census.nan
        } else if rgb.to_array().iter().any(|v| v.is_infinite()) {
            &mut self.census.infinite
        } else {
            &mut self.census.negative
        };
        *reason += 1;
        self.cells.push(Vec4::ZERO);
    }

    pub(super) fn finish(self) -> MerlTable {
        debug_assert_eq!(self.cells.len(), self.header.cells());
        MerlTable {
            header: self.header,
            cells: Cells::F32(self.cells),
            rounding: None,
            census: self.census,
            mixed: self.mixed,
            channels_apart: self.channels_apart,
            filled: self.filled,
        }
    }
}
