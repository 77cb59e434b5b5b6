//! 16-bit numbers of two neighbouring tables side by side, mixed to 32 bits, and the arrays that hold them.
#![allow(clippy::needless_range_loop)] // Several columns are read at the same lane.

use super::lookup::WEIGHT_ONE;

/// Slopes are in units of 1/128.
pub const SLOPE_UNIT: f32 = 1.0 / 128.0;
/// Rows that are compared with a probability at once.
pub(super) const GROUP: usize = 8;

/// Segments that are summed together before they are told apart.
pub(super) const BLOCK: usize = 4;

/// A number of the first table in the lower half, and one of the second in the upper: what columns hold until they are mixed.
#[derive(Clone, Copy, Debug, Default)]
pub struct PackedPair(u32);

impl PackedPair {
    #[inline(always)]
    pub(super) fn new(first: u16, second: u16) -> Self {
        Self(u32::from(first) | u32::from(second) << 16)
    }

    pub(super) fn halves(self) -> [u16; 2] {
        [self.0 as u16, (self.0 >> 16) as u16]
    }

    #[inline(always)]
    fn from_slopes(first: i8, second: i8) -> Self {
        Self::new(i16::from(first) as u16, i16::from(second) as u16)
    }

    /// Step 5, mix(a, b): `first · (WEIGHT_ONE − weight) + second · weight`, which fits 32 bits: exact, by one product modulo 2³².
    #[inline(always)]
    pub(super) fn mix(self, weight: u32) -> u32 {
        let (first, second) = (self.0 & 0xffff, self.0 >> 16);
        (first * WEIGHT_ONE).wrapping_add(second.wrapping_sub(first).wrapping_mul(weight))
    }

    /// Step 5 for slopes: the density's slope over a row, in (−1, 1).
    #[inline(always)]
    pub(super) fn mix_slopes(self, weight: u32) -> f32 {
        let (first, second) = ((self.0 << 16) as i32 >> 16, self.0 as i32 >> 16);
        let mixed = first * (WEIGHT_ONE - weight) as i32 + second * weight as i32;
        mixed as f32 * (SLOPE_UNIT / WEIGHT_ONE as f32)
    }
}

/// What the rows of probabilities are found in.
#[derive(Clone, Copy)]
pub(super) struct RowSearch<'a> {
    pub(super) pivots: &'a [[PackedPair; GROUP]],
    pub(super) late_pivots: &'a [[PackedPair; GROUP]],
    pub(super) rows: &'a [PackedPair],
    pub(super) stride: usize,
}

/// A row in which a probability passes a target, and the probabilities below it and up to its end.
#[derive(Clone, Copy)]
pub(super) struct FoundRow {
    pub(super) index: u32,
    pub(super) below: u32,
    pub(super) end: u32,
}

impl RowSearch<'_> {
    /// Step 7: the row in which the probability passes `target`, which is below 1 in units of 1/`ROW_TOTAL`, between table
    /// `pair` and its neighbour.
    ///
    /// Two levels of comparisons that don't wait for each other: the group of rows, then the row in it. What fills up the
    /// last group is above every target.
    #[inline(always)]
    pub(super) fn find(&self, pair: u32, weight: u32, target: u32) -> FoundRow {
        let mut group = count_passed(&self.pivots[pair as usize], weight, target);
        if let Some(late) = self.late_pivots.get(pair as usize) {
            group += count_passed(late, weight, target);
        }
        // Place `start` holds the probability below the group.
        let start = GROUP * group;
        let rows = &self.rows[pair as usize * self.stride + start..][..GROUP + 1];
        let mut row = 0;
        if let Some(group) = rows[1..].first_chunk() {
            row = count_passed(group, weight, target).min(GROUP - 1);
        }
        FoundRow {
            index: (start + row) as u32,
            below: rows[row].mix(weight),
            end: rows[row + 1].mix(weight),
        }
    }

    /// The probabilities below a row and up to its end.
    #[inline(always)]
    pub(super) fn ends(&self, row: u32, pair: u32) -> [PackedPair; 2] {
        let rows = &self.rows[pair as usize * self.stride + row as usize..][..2];
        [rows[0], rows[1]]
    }
}

/// How many of the mixed numbers are at most `target`.
#[inline(always)]
fn count_passed(numbers: &[PackedPair; GROUP], weight: u32, target: u32) -> usize {
    let mut passed = 0;
    for number in numbers {
        passed += u32::from(number.mix(weight) <= target);
    }
    passed as usize
}

/// The sums and nodes of all rows.
#[derive(Clone, Copy)]
pub(super) struct Records<'a> {
    pub(super) values: &'a [u16],
    pub(super) table_count: usize,
    pub(super) record: usize,
    pub(super) block_count: usize,
}

/// The records of a row in two tables.
#[derive(Clone, Copy)]
pub(super) struct RecordPair<'a> {
    first: &'a [u16],
    second: &'a [u16],
    block_count: usize,
}

impl<'a> Records<'a> {
    #[inline(always)]
    pub(super) fn pair(&self, row: u32, [first, second]: [u32; 2]) -> RecordPair<'a> {
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
    pub(super) fn find_block(&self, weight: u32, target: u32) -> (u32, u32) {
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
    pub(super) fn block_nodes(&self, block: u32) -> [PackedPair; BLOCK + 1] {
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
    pub(super) fn segment_nodes(&self, index: u32) -> [PackedPair; 2] {
        let place = self.block_count + index as usize;
        let (first, second) = (&self.first[place..][..2], &self.second[place..][..2]);
        [
            PackedPair::new(first[0], second[0]),
            PackedPair::new(first[1], second[1]),
        ]
    }

    /// All nodes of the row.
    #[inline(always)]
    pub(super) fn nodes(&self) -> (&'a [u16], &'a [u16]) {
        (
            &self.first[self.block_count..],
            &self.second[self.block_count..],
        )
    }
}

/// The slopes of all rows.
#[derive(Clone, Copy)]
pub(super) struct Slopes<'a> {
    pub(super) values: &'a [i8],
    pub(super) table_count: usize,
}

impl Slopes<'_> {
    #[inline(always)]
    pub(super) fn pair(&self, row: u32, [first, second]: [u32; 2]) -> PackedPair {
        let row = &self.values[row as usize * self.table_count..][..self.table_count];
        PackedPair::from_slopes(row[first as usize], row[second as usize])
    }
}
