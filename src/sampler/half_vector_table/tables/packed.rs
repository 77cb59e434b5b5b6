//! 16-bit numbers of two neighbouring tables side by side, mixed to 32 bits, and the arrays that hold them.
#![allow(clippy::needless_range_loop)] // Several columns are read at the same lane.

use std::hint::select_unpredictable;

use super::lookup::WEIGHT_ONE;

/// Slopes are in units of 1/128.
pub const SLOPE_UNIT: f32 = 1.0 / 128.0;
/// Rows that are compared with a probability at once.
pub(in crate::sampler) const GROUP: usize = 8;

/// Segments that are summed together before they are told apart.
pub(in crate::sampler) const BLOCK: usize = 4;

/// A number of the first table in the lower half, and one of the second in the upper: what columns hold until they are mixed.
#[derive(Clone, Copy, Debug, Default)]
pub struct PackedPair(u32);

impl PackedPair {
    #[inline(always)]
    pub(in crate::sampler) fn new(first: u16, second: u16) -> Self {
        Self(u32::from(first) | u32::from(second) << 16)
    }

    fn from_slopes(first: i8, second: i8) -> Self {
        Self::new(i16::from(first) as u16, i16::from(second) as u16)
    }

    /// Step 5, mix(a, b): `first · (WEIGHT_ONE − weight) + second · weight`, which fits 32 bits: exact, by one product modulo 2³².
    #[inline(always)]
    pub(in crate::sampler) fn mix(self, weight: u32) -> u32 {
        let (first, second) = (self.0 & 0xffff, self.0 >> 16);
        (first * WEIGHT_ONE).wrapping_add(second.wrapping_sub(first).wrapping_mul(weight))
    }

    /// Step 5 for slopes: the density's slope over a row, in (−1, 1).
    #[inline(always)]
    pub(in crate::sampler) fn mix_slopes(self, weight: u32) -> f32 {
        let (first, second) = ((self.0 << 16) as i32 >> 16, self.0 as i32 >> 16);
        let mixed = first * (WEIGHT_ONE - weight) as i32 + second * weight as i32;
        mixed as f32 * (SLOPE_UNIT / WEIGHT_ONE as f32)
    }
}

/// What the rows of probabilities are found in.
#[derive(Clone, Copy)]
pub(in crate::sampler) struct RowSearch<'a> {
    pub(in crate::sampler) rows: &'a [u16],
    pub(in crate::sampler) stride: usize,
}

/// A row in which a probability passes a target, and the probabilities below it and up to its end.
#[derive(Clone, Copy)]
pub(in crate::sampler) struct FoundRow {
    pub(in crate::sampler) index: u32,
    pub(in crate::sampler) below: u32,
    pub(in crate::sampler) end: u32,
}

impl RowSearch<'_> {
    /// Step 7: the row in which the probability passes `target`, which is below 1 in units of 1/`ROW_TOTAL`, between two tables.
    ///
    /// Bisection finds the group of rows, in as many steps for every draw, so that nothing is mispredicted. The rows of a group
    /// are compared at once. What fills up the last group is above every target.
    #[inline(always)]
    pub(in crate::sampler) fn find(&self, tables: [u32; 2], weight: u32, target: u32) -> FoundRow {
        let [first, second] = [self.table(tables[0]), self.table(tables[1])];
        // Place GROUP·g holds the probability below group g.
        let mut group = 0;
        let mut left = (self.stride - 1) / GROUP;
        while left > 1 {
            let half = left / 2;
            let place = GROUP * (group + half);
            let passed = PackedPair::new(first[place], second[place]).mix(weight) <= target;
            group = select_unpredictable(passed, group + half, group);
            left -= half;
        }
        let start = GROUP * group;
        let (first, second) = (&first[start..][..GROUP + 1], &second[start..][..GROUP + 1]);
        let mut row = 0;
        for k in 1..=GROUP {
            let sum = PackedPair::new(first[k], second[k]).mix(weight);
            row += usize::from(sum <= target);
        }
        let row = row.min(GROUP - 1);
        FoundRow {
            index: (start + row) as u32,
            below: PackedPair::new(first[row], second[row]).mix(weight),
            end: PackedPair::new(first[row + 1], second[row + 1]).mix(weight),
        }
    }

    /// The probabilities below a row and up to its end.
    #[inline(always)]
    pub(in crate::sampler) fn ends(&self, row: u32, tables: [u32; 2]) -> [PackedPair; 2] {
        let first = &self.table(tables[0])[row as usize..][..2];
        let second = &self.table(tables[1])[row as usize..][..2];
        [
            PackedPair::new(first[0], second[0]),
            PackedPair::new(first[1], second[1]),
        ]
    }

    #[inline(always)]
    fn table(&self, table: u32) -> &[u16] {
        &self.rows[table as usize * self.stride..][..self.stride]
    }
}

/// The sums and nodes of all rows.
#[derive(Clone, Copy)]
pub(in crate::sampler) struct Records<'a> {
    pub(in crate::sampler) values: &'a [u16],
    pub(in crate::sampler) table_count: usize,
    pub(in crate::sampler) record: usize,
    pub(in crate::sampler) block_count: usize,
}

/// The records of a row in two tables.
#[derive(Clone, Copy)]
pub(in crate::sampler) struct RecordPair<'a> {
    first: &'a [u16],
    second: &'a [u16],
    block_count: usize,
}

impl<'a> Records<'a> {
    #[inline(always)]
    pub(in crate::sampler) fn pair(&self, row: u32, [first, second]: [u32; 2]) -> RecordPair<'a> {
        let row = row as usize * self.table_count;
        RecordPair {
            first: &self.values[(row + first as usize) * self.record..][..self.record + BLOCK],
            second: &self.values[(row + second as usize) * self.record..][..self.record + BLOCK],
            block_count: self.block_count,
        }
    }
}

impl<'a> RecordPair<'a> {
    /// Step 12, coarse: the block of segments in which the sum passes `target`, and the sum below it.
    #[inline(always)]
    pub(in crate::sampler) fn find_block(&self, weight: u32, target: u32) -> (u32, u32) {
        let (mut block, mut below) = (0, 0);
        let (first, second) = (
            &self.first[..self.block_count],
            &self.second[..self.block_count],
        );
        for k in 0..self.block_count {
            let sum = PackedPair::new(first[k], second[k]).mix(weight);
            let passed = sum <= target;
            block += u32::from(passed);
            below = if passed { sum } else { below };
        }
        (block, below)
    }

    /// The nodes at the ends of a block's segments.
    #[inline(always)]
    pub(in crate::sampler) fn block_nodes(&self, block: u32) -> [PackedPair; BLOCK + 1] {
        let place = self.block_count + block as usize * BLOCK;
        let (first, second) = (
            &self.first[place..][..BLOCK + 1],
            &self.second[place..][..BLOCK + 1],
        );
        let mut packed = [PackedPair::default(); BLOCK + 1];
        for k in 0..=BLOCK {
            packed[k] = PackedPair::new(first[k], second[k]);
        }
        packed
    }

    /// The nodes at both ends of a segment.
    #[inline(always)]
    pub(in crate::sampler) fn segment_nodes(&self, index: u32) -> [PackedPair; 2] {
        let place = self.block_count + index as usize;
        let (first, second) = (&self.first[place..][..2], &self.second[place..][..2]);
        [
            PackedPair::new(first[0], second[0]),
            PackedPair::new(first[1], second[1]),
        ]
    }

    /// All nodes of the row.
    #[inline(always)]
    pub(in crate::sampler) fn nodes(&self) -> (&'a [u16], &'a [u16]) {
        (
            &self.first[self.block_count..],
            &self.second[self.block_count..],
        )
    }
}

/// The slopes of all rows.
#[derive(Clone, Copy)]
pub(in crate::sampler) struct Slopes<'a> {
    pub(in crate::sampler) values: &'a [i8],
    pub(in crate::sampler) table_count: usize,
}

impl Slopes<'_> {
    #[inline(always)]
    pub(in crate::sampler) fn pair(&self, row: u32, [first, second]: [u32; 2]) -> PackedPair {
        let row = &self.values[row as usize * self.table_count..][..self.table_count];
        PackedPair::from_slopes(row[first as usize], row[second as usize])
    }
}
