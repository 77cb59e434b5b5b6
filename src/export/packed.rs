//! The half-vector table in words of 32 bits, as headers and run-time files hold it.

use crate::geometry::half_vector_chart::ChartEdge;
use crate::sampler::Stored;

/// The arrays of a table. Numbers of 16 and of 8 bits lie together in words, the first in the lowest bits.
pub(super) struct Packed {
    /// cos θo of each table.
    pub cosines: Vec<f32>,
    /// The edges of the rows: the cap of each is fixed + weight·top.
    pub edges_fixed: Vec<f32>,
    pub edges_weight: Vec<f32>,
    /// `[table, row]`, 16 bits each: probability of the rows up to and with this one.
    pub cdf: Vec<u32>,
    /// `[table, row]`, 8 bits each: slopes, and 128 more.
    pub slopes: Vec<u32>,
    /// `[table, row, node]`, 16 bits each: density over the azimuth.
    pub density: Vec<u32>,
}

impl Packed {
    pub fn new(stored: &Stored) -> Self {
        let mut edges_fixed = Vec::with_capacity(stored.edges.len());
        let mut edges_weight = Vec::with_capacity(stored.edges.len());
        for &edge in &stored.edges {
            let edge = ChartEdge::new(usize::from(edge));
            edges_fixed.push(edge.fixed());
            edges_weight.push(edge.weight());
        }
        Self {
            cosines: stored.cosines.clone(),
            edges_fixed,
            edges_weight,
            cdf: pack(&to_u32(&stored.rows), 16),
            slopes: pack_slopes(&stored.slopes),
            density: pack(&to_u32(&stored.nodes), 16),
        }
    }

    /// The three arrays of small numbers, one after the other.
    pub fn words(&self) -> impl Iterator<Item = u32> + '_ {
        let parts = [&self.cdf, &self.slopes, &self.density];
        parts.into_iter().flatten().copied()
    }
}

fn to_u32(numbers: &[u16]) -> Vec<u32> {
    numbers.iter().map(|&x| u32::from(x)).collect()
}

/// Slopes in words. A slope of −128 to 127 is stored as 0 to 255.
fn pack_slopes(slopes: &[i8]) -> Vec<u32> {
    let mut numbers = Vec::with_capacity(slopes.len());
    for &slope in slopes {
        numbers.push((i32::from(slope) + 128) as u32);
    }
    pack(&numbers, 8)
}

/// Numbers of `bits` each in words of 32, the first in the lowest bits.
fn pack(numbers: &[u32], bits: usize) -> Vec<u32> {
    let mut words = Vec::with_capacity(numbers.len().div_ceil(32 / bits));
    for chunk in numbers.chunks(32 / bits) {
        let mut word = 0;
        for &number in chunk.iter().rev() {
            word = word << bits | number;
        }
        words.push(word);
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_hold_numbers_from_the_lowest_bits() {
        assert_eq!(pack(&[1, 2, 3], 16), [0x0002_0001, 3]);
        assert_eq!(pack(&[1, 2, 3, 4, 255], 8), [0x0403_0201, 255]);
        assert_eq!(pack_slopes(&[-128, 0, 127]), [0x00ff_8000]);
    }
}
