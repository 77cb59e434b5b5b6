//! Cells of 8 bytes: 16 bits for each channel and for the validity.

use glam::Vec4;

use super::cell_format::{GREATEST_EXPONENT, ReadCells, binary_exponent, power_of_two};

/// Bits of f32's mantissa that are rounded off.
const DROPPED: u32 = 13;
/// The exponent field of the greatest value of a table. The next one is free, for a value that rounding carries past a power of two.
const TOP: i32 = 62;
/// Exponent field of 1 in f32.
const BIAS: i32 = 127;
/// The fourth number of a valid cell: 1 at the scale of validity, which is that of a table whose greatest value is 1.
const VALID: u16 = (TOP as u16) << (23 - DROPPED);

/// Cells of unsigned 16-bit numbers: six bits of exponent and ten of mantissa, to be multiplied by a power of two.
///
/// The bits are those of an f32 below 2⁻⁶³, without its first three, which are 0, and its last thirteen. So a shift and a product decode them,
/// and the product is exact.
#[derive(Clone)]
pub(super) struct HalfCells {
    words: Vec<[u16; 4]>,
    /// What the four numbers of a cell are multiplied by; the last is the scale of validity.
    scale: Vec4,
}

impl HalfCells {
    /// Rounds `cells`, whose greatest channel is `greatest` and below 2 to the power of [`GREATEST_EXPONENT`] + 1, to the nearest.
    pub fn round(cells: &[Vec4], greatest: f32) -> Self {
        // The scale 2^s puts the greatest value's exponent into the field TOP: 2^e = 2^(TOP − BIAS) · 2^s.
        debug_assert!(binary_exponent(greatest) <= GREATEST_EXPONENT);
        let exponent = binary_exponent(greatest) + BIAS - TOP;
        let mut words = Vec::with_capacity(cells.len());
        let inverse = power_of_two(-exponent);
        for cell in cells {
            let [red, green, blue, valid] = cell.to_array();
            words.push([
                encode(red * inverse),
                encode(green * inverse),
                encode(blue * inverse),
                if valid == 1.0 { VALID } else { 0 },
            ]);
        }
        let scale = power_of_two(exponent);
        Self {
            words,
            scale: Vec4::new(scale, scale, scale, power_of_two(BIAS - TOP)),
        }
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        size_of_val(self.words.as_slice())
    }
}

/// The nearest 16-bit number of a value in [0, 2⁻⁶³), even ones first.
fn encode(value: f32) -> u16 {
    let bits = value.to_bits();
    let odd = bits >> DROPPED & 1;
    ((bits + (1 << (DROPPED - 1)) - 1 + odd) >> DROPPED) as u16
}

impl ReadCells for HalfCells {
    const READS_AHEAD: bool = true;

    #[inline(always)]
    fn count(&self) -> usize {
        self.words.len()
    }

    #[inline(always)]
    fn get(&self, cell: usize) -> Vec4 {
        let words = self.words[cell];
        let mut values = [0.0; 4];
        for i in 0..4 {
            values[i] = f32::from_bits(u32::from(words[i]) << DROPPED);
        }
        Vec4::from_array(values) * self.scale
    }

    #[inline(always)]
    fn peek(&self, cell: usize) -> u32 {
        u32::from(self.words[cell][0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_rounded_to_the_nearest_of_eleven_bits() {
        let values = [
            0.0,
            1.0,
            1.0 + 2f32.powi(-11),
            1.0 + 3.0 * 2f32.powi(-11),
            1.0 + 2f32.powi(-11) + f32::EPSILON,
            1000.0,
            1023.9999,
            2f32.powi(-51),
            0.3,
        ];
        let cells = values.map(|v| Vec4::new(v, v, v, 1.0));
        let found = HalfCells::round(&cells, 1023.9999);
        // Halfway goes to the even neighbour; the greatest value is carried to the next power of two.
        assert_eq!(found.get(0), Vec4::new(0.0, 0.0, 0.0, 1.0));
        assert_eq!(found.get(1), Vec4::ONE);
        assert_eq!(found.get(2), Vec4::ONE);
        assert_eq!(found.get(3).x, 1.0 + 2f32.powi(-9));
        assert_eq!(found.get(4).x, 1.0 + 2f32.powi(-10));
        assert_eq!(found.get(5).x, 1000.0);
        assert_eq!(found.get(6).x, 1024.0);
        assert_eq!(found.get(7).x, 2f32.powi(-51));
        assert!((found.get(8).x / 0.3 - 1.0).abs() < 2f32.powi(-11));
    }

    #[test]
    fn every_scale_keeps_its_digits() {
        for exponent in -149..=GREATEST_EXPONENT {
            let value = power_of_two(exponent);
            let cells = [Vec4::new(value, 0.0, value, 1.0), Vec4::ZERO];
            let found = HalfCells::round(&cells, value);
            assert_eq!([found.get(0), found.get(1)], cells, "{exponent}");
        }
    }
}
