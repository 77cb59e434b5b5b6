//! Cells of 4 bytes: nine bits for each channel, and five of an exponent that they share.

use glam::Vec4;

use super::cell_format::{CompactCells, ReadCells, binary_exponent};

/// Bits of a channel's integer.
const MANTISSA: u32 = 9;
/// Where the exponent's field begins: red, green and blue lie below it.
const EXPONENT_SHIFT: u32 = 3 * MANTISSA;
/// The greatest field.
const TOP: i32 = 31;
/// The word of an invalid cell: the greatest exponent without a value. A black cell has the exponent 0.
const INVALID: u32 = (TOP as u32) << EXPONENT_SHIFT;
/// The bits of a channel.
const MASK: u32 = (1 << MANTISSA) - 1;
/// Exponent field of 1 in f32.
const BIAS: i32 = 127;

/// Cells of three integers below 512 and a field e: the value of an integer m is m · 2^(e + lowest).
#[derive(Clone)]
pub(super) struct SharedExponentCells {
    words: Vec<u32>,
    /// The bits of 2^lowest in f32.
    lowest: u32,
}

impl SharedExponentCells {
    /// Rounds `cells`, whose greatest channel is `greatest`, to the nearest.
    pub fn round(cells: &[Vec4], greatest: f32) -> Self {
        // The greatest value has the field TOP, unless it is so small that the lowest unit would not be a normal f32.
        let lowest = (exponent_of_unit(greatest) - TOP).max(1 - BIAS);
        let mut words = Vec::with_capacity(cells.len());
        for &cell in cells {
            words.push(match cell.w == 1.0 {
                true => encode(cell, lowest),
                false => INVALID,
            });
        }
        Self {
            words,
            lowest: ((lowest + BIAS) as u32) << 23,
        }
    }

    /// The words of all cells.
    pub fn all_words(&self) -> &[u32] {
        &self.words
    }

    /// The value of an integer 1 where the field is 0.
    pub fn unit(&self) -> f32 {
        f32::from_bits(self.lowest)
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        size_of_val(self.words.as_slice())
    }
}

/// The exponent of the unit by which a value, once rounded, is an integer from 256 to 511.
fn exponent_of_unit(value: f32) -> i32 {
    let exponent = binary_exponent(value) - (MANTISSA as i32 - 1);
    // Rounding may carry it to 512.
    match in_units(value, exponent) < 512 {
        true => exponent,
        false => exponent + 1,
    }
}

/// A value as an integer number of units 2^`exponent`, the nearest.
fn in_units(value: f32, exponent: i32) -> u32 {
    (f64::from(value) * 2f64.powi(-exponent)).round_ties_even() as u32
}

/// The word of a valid cell.
fn encode(cell: Vec4, lowest: i32) -> u32 {
    let greatest = cell.truncate().max_element();
    let exponent = match greatest > 0.0 {
        true => exponent_of_unit(greatest).max(lowest),
        false => lowest,
    };
    let mut word = ((exponent - lowest) as u32) << EXPONENT_SHIFT;
    for channel in 0..3 {
        word |= in_units(cell[channel], exponent) << (MANTISSA * channel as u32);
    }
    word
}

impl ReadCells for SharedExponentCells {
    #[inline(always)]
    fn read(&self, cell: usize) -> Vec4 {
        Vec4::from_array(self.decode(self.words(cell)))
    }
}

impl CompactCells<1> for SharedExponentCells {
    #[inline(always)]
    fn words(&self, cell: usize) -> [u32; 1] {
        [self.words[cell]]
    }

    #[inline(always)]
    fn decode(&self, [word]: [u32; 1]) -> [f32; 4] {
        let unit = f32::from_bits((word >> EXPONENT_SHIFT << 23) + self.lowest);
        // Signed integers are converted by one instruction; none of these is negative.
        let red = (word & MASK) as i32;
        let green = (word >> MANTISSA & MASK) as i32;
        let blue = (word >> (2 * MANTISSA) & MASK) as i32;
        [
            red as f32 * unit,
            green as f32 * unit,
            blue as f32 * unit,
            if word == INVALID { 0.0 } else { 1.0 },
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::super::cell_format::{GREATEST_EXPONENT, power_of_two};
    use super::*;

    #[test]
    fn channels_are_rounded_in_units_of_the_greatest() {
        let cells = [
            Vec4::new(1.0, 0.5, 0.001, 1.0),
            Vec4::new(511.6, 1.2, 0.0, 1.0),
            Vec4::new(0.0, 0.0, 0.0, 1.0),
            Vec4::ZERO,
            Vec4::new(2f32.powi(-22), 2f32.powi(-23), 2f32.powi(-24), 1.0),
        ];
        let found = SharedExponentCells::round(&cells, 511.6);
        assert_eq!(found.read(0), Vec4::new(1.0, 0.5, 0.0, 1.0));
        // Rounding carries it to 512, and the unit becomes 2.
        assert_eq!(found.read(1), Vec4::new(512.0, 2.0, 0.0, 1.0));
        assert_eq!(found.read(2), Vec4::new(0.0, 0.0, 0.0, 1.0));
        assert_eq!(found.read(3), Vec4::ZERO);
        // Below the least unit, 2⁻³⁰, nothing is left but what is near it.
        assert_eq!(found.read(4), cells[4]);
        let dark = [Vec4::new(2f32.powi(-31), 2f32.powi(-30), 0.0, 1.0)];
        let found = SharedExponentCells::round(&dark, 511.6);
        assert_eq!(found.read(0), Vec4::new(0.0, 2f32.powi(-30), 0.0, 1.0));
    }

    #[test]
    fn every_scale_keeps_its_digits() {
        for exponent in -126..=GREATEST_EXPONENT {
            let value = power_of_two(exponent);
            let cells = [Vec4::new(value, 0.0, value, 1.0), Vec4::ZERO];
            let found = SharedExponentCells::round(&cells, value);
            assert_eq!([found.read(0), found.read(1)], cells, "{exponent}");
        }
    }
}
