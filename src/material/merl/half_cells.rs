//! Cells of 8 bytes: 16 bits for each channel and for the validity.

use glam::Vec4;

use super::cell_format::{
    CompactCells, GREATEST_EXPONENT, ReadCells, binary_exponent, power_of_two,
};

/// Bits of f32's mantissa that are rounded off.
const DROPPED: u32 = 13;
/// The exponent field of the greatest value of a table. The next one is free, for a value that rounding carries past a power of two.
const TOP: i32 = 62;
/// Exponent field of 1 in f32.
const BIAS: i32 = 127;
/// The fourth number of a valid cell: 1 at the scale of validity, which is that of a table whose greatest value is 1.
const VALID: u32 = (TOP as u32) << (23 - DROPPED);

/// Cells of unsigned 16-bit numbers: six bits of exponent and ten of mantissa, to be multiplied by a power of two.
///
/// The bits are those of an f32 below 2⁻⁶³, without its first three, which are 0, and its last thirteen. So a shift and a product decode them,
/// and the product is exact.
#[derive(Clone)]
pub(super) struct HalfCells {
    /// Red and green, blue and validity, the first of a pair in the low bits.
    words: Vec<[u32; 2]>,
    /// What channels are multiplied by, and what the validity is.
    scales: [f32; 2],
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
            let valid = if valid == 1.0 { VALID } else { 0 };
            words.push([
                encode(red * inverse) | encode(green * inverse) << 16,
                encode(blue * inverse) | valid << 16,
            ]);
        }
        Self {
            words,
            scales: [power_of_two(exponent), power_of_two(BIAS - TOP)],
        }
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        size_of_val(self.words.as_slice())
    }
}

/// The nearest 16-bit number of a value in [0, 2⁻⁶³), even ones first.
fn encode(value: f32) -> u32 {
    let bits = value.to_bits();
    let odd = bits >> DROPPED & 1;
    (bits + (1 << (DROPPED - 1)) - 1 + odd) >> DROPPED
}

impl ReadCells for HalfCells {
    #[inline(always)]
    fn read(&self, cell: usize) -> Vec4 {
        Vec4::from_array(self.decode(self.words(cell)))
    }
}

impl CompactCells<2> for HalfCells {
    #[inline(always)]
    fn words(&self, cell: usize) -> [u32; 2] {
        self.words[cell]
    }

    #[inline(always)]
    fn decode(&self, [red_green, blue_valid]: [u32; 2]) -> [f32; 4] {
        let [scale, scale_of_valid] = self.scales;
        [
            f32::from_bits((red_green & 0xffff) << DROPPED) * scale,
            f32::from_bits((red_green >> 16) << DROPPED) * scale,
            f32::from_bits((blue_valid & 0xffff) << DROPPED) * scale,
            f32::from_bits((blue_valid >> 16) << DROPPED) * scale_of_valid,
        ]
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
        assert_eq!(found.read(0), Vec4::new(0.0, 0.0, 0.0, 1.0));
        assert_eq!(found.read(1), Vec4::ONE);
        assert_eq!(found.read(2), Vec4::ONE);
        assert_eq!(found.read(3).x, 1.0 + 2f32.powi(-9));
        assert_eq!(found.read(4).x, 1.0 + 2f32.powi(-10));
        assert_eq!(found.read(5).x, 1000.0);
        assert_eq!(found.read(6).x, 1024.0);
        assert_eq!(found.read(7).x, 2f32.powi(-51));
        assert!((found.read(8).x / 0.3 - 1.0).abs() < 2f32.powi(-11));
    }

    #[test]
    fn every_scale_keeps_its_digits() {
        for exponent in -149..=GREATEST_EXPONENT {
            let value = power_of_two(exponent);
            let cells = [Vec4::new(value, 0.0, value, 1.0), Vec4::ZERO];
            let found = HalfCells::round(&cells, value);
            assert_eq!([found.read(0), found.read(1)], cells, "{exponent}");
        }
    }
}
