//! The cells of a table in memory, in one of three formats.

use glam::Vec4;
use rayon::prelude::*;

use super::cell_format::{
    CellFormat, GREATEST_EXPONENT, ReadCells, RoundingError, binary_exponent,
};
use super::half_cells::HalfCells;
use super::shared_exponent_cells::SharedExponentCells;
use crate::{Error, Result};

/// Cells in one of the formats. Who reads many of them asks once which.
#[derive(Clone)]
pub(super) enum Cells {
    F32(Vec<Vec4>),
    F16(HalfCells),
    Rgb9e5(SharedExponentCells),
}

impl Cells {
    /// The same cells, rounded to `format`. Each holds all of its channels or none.
    ///
    /// # Errors
    /// [`Error::Argument`] for a value that is too great for a compact format.
    pub fn round(cells: &[Vec4], format: CellFormat) -> Result<Self> {
        let mut greatest = 0.0f32;
        for cell in cells {
            greatest = greatest.max(cell.truncate().max_element());
        }
        if format != CellFormat::F32 && binary_exponent(greatest) > GREATEST_EXPONENT {
            return Err(Error::argument(
                format!(
                    "a table with values up to {greatest:.1e} sr⁻¹ doesn't fit {} cells",
                    format.name()
                ),
                "keep it as f32 (--table f32)",
            ));
        }
        Ok(match format {
            CellFormat::F32 => Self::F32(cells.to_vec()),
            CellFormat::F16 => Self::F16(HalfCells::round(cells, greatest)),
            CellFormat::Rgb9e5 => Self::Rgb9e5(SharedExponentCells::round(cells, greatest)),
        })
    }

    /// Their format.
    pub fn format(&self) -> CellFormat {
        match self {
            Self::F32(_) => CellFormat::F32,
            Self::F16(_) => CellFormat::F16,
            Self::Rgb9e5(_) => CellFormat::Rgb9e5,
        }
    }

    /// RGB and validity of a cell.
    #[inline(always)]
    pub fn get(&self, cell: usize) -> Vec4 {
        match self {
            Self::F32(cells) => cells.read(cell),
            Self::F16(cells) => cells.read(cell),
            Self::Rgb9e5(cells) => cells.read(cell),
        }
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        match self {
            Self::F32(cells) => size_of_val(cells.as_slice()),
            Self::F16(cells) => cells.bytes(),
            Self::Rgb9e5(cells) => cells.bytes(),
        }
    }

    /// How far each channel is from `exact`, over valid values above 0.
    pub fn measure_rounding(&self, exact: &[Vec4]) -> [RoundingError; 3] {
        let channels: Vec<_> = (0..3usize)
            .into_par_iter()
            .map(|channel| self.measure_channel(exact, channel))
            .collect();
        [channels[0], channels[1], channels[2]]
    }

    fn measure_channel(&self, exact: &[Vec4], channel: usize) -> RoundingError {
        let (mut errors, mut zeroed) = (Vec::with_capacity(exact.len()), 0);
        for (number, cell) in exact.iter().enumerate() {
            let value = cell[channel];
            if value > 0.0 {
                let rounded = self.get(number)[channel];
                zeroed += u64::from(rounded == 0.0);
                // In f64: the difference of neighbouring f32 must not be lost.
                let error = f64::from(rounded) / f64::from(value) - 1.0;
                errors.push(error.abs() as f32);
            }
        }
        if errors.is_empty() {
            return RoundingError::default();
        }
        let last = errors.len() - 1;
        RoundingError {
            median: order_statistic(&mut errors, last / 2),
            permille: order_statistic(&mut errors, last - last / 1000),
            greatest: order_statistic(&mut errors, last),
            zeroed,
        }
    }
}

/// The value that has `rank` others below it.
fn order_statistic(values: &mut [f32], rank: usize) -> f32 {
    *values.select_nth_unstable_by(rank, f32::total_cmp).1
}
