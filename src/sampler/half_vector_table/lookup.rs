//! What lies between two tables, and how it is searched: questions that a pair of tables answers by mixing at every question
//! ([`super::tables::TablePair`]) or from a mixture made beforehand ([`PremixedTable`]), to the same bits.

use super::tables::{NODE_SUM, ONE, TablePair, WEIGHT_ONE};
use crate::geometry::half_vector_chart::PARTS;

/// Probability 1 of the rows of an interpolated table, in its units.
pub const ROW_TOTAL: f64 = ONE as f64 * WEIGHT_ONE as f64;
/// One unit of such a probability.
pub const ROW_UNIT: f32 = (1.0 / ROW_TOTAL) as f32;
/// Sum of the nodes of a row of an interpolated table, inner ones counted twice, in its units.
pub const NODE_TOTAL: f64 = NODE_SUM as f64 * WEIGHT_ONE as f64;
/// One unit of such a sum.
pub const NODE_UNIT: f32 = (1.0 / NODE_TOTAL) as f32;

/// A row of an interpolated table.
#[derive(Clone, Copy, Debug, Default)]
pub struct InterpolatedRow {
    /// Its number.
    pub index: usize,
    /// Probability below it, in units of 1/[`ROW_TOTAL`].
    pub(super) below: u32,
    /// Its own probability, in the same units.
    pub(super) mass: u32,
}

impl InterpolatedRow {
    /// Probability below its end, in the same units.
    #[inline(always)]
    pub(super) fn end(&self) -> u32 {
        self.below + self.mass
    }

    /// Its probability, 0 to 1.
    #[inline(always)]
    pub fn probability(&self) -> f32 {
        self.mass as f32 * ROW_UNIT
    }

    /// Step 23: probability below the point that leaves `fraction` of the row below it.
    pub fn cdf(&self, fraction: f64) -> f64 {
        (f64::from(self.below) + f64::from(self.mass) * fraction) / ROW_TOTAL
    }
}

/// A segment of a row's azimuth between two nodes; densities are in units of 1/[`NODE_TOTAL`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AzimuthSegment {
    /// Its number.
    pub index: f32,
    /// Density at its first node.
    pub low: f32,
    /// Density at its second node.
    pub high: f32,
}

/// What draws and densities ask of the table that is interpolated between two.
pub trait InterpolatedTable {
    /// Segments of a row.
    fn segments(&self) -> usize;
    /// Step 7: the row in which the probability passes `target`, in units of 1/[`ROW_TOTAL`].
    fn find_row_index(&self, target: u32) -> usize;
    /// Step 5: row `index`.
    fn row(&self, index: usize) -> InterpolatedRow;
    /// Step 5: slope of the density over a row, in (−1, 1).
    fn slope(&self, row: usize) -> f32;
    /// Step 12: the segment of a row in which the sum passes `target`, and the sum below it, in units of 1/[`NODE_TOTAL`].
    fn find_segment_index(&self, row: usize, target: u32) -> (usize, u32);
    /// Step 5: segment `index` of a row.
    fn segment(&self, row: usize, index: usize) -> AzimuthSegment;

    /// The row in which the probability passes `u` in [0, 1), and the fraction of it below `u`, in [0, 1].
    #[inline(always)]
    fn find_row(&self, u: f32) -> (InterpolatedRow, f32) {
        // Step 7: t = ⌊u1·65535·65536⌋, and the first row with to(r) > t.
        let target = (f64::from(u) * ROW_TOTAL) as u32;
        let row = self.row(self.find_row_index(target));
        // Step 8: x = (t − to(r − 1))/mass(r).
        let fraction = target.saturating_sub(row.below) as f32 / row.mass as f32;
        (row, fraction.min(1.0))
    }

    /// The segment of a row in which the azimuth's probability passes `u` in [0, 1], and what is left of it within.
    #[inline(always)]
    fn find_segment(&self, row: usize, u: f32) -> (AzimuthSegment, f32) {
        // Step 11: t = ⌊v·65534·65536⌋. Step 12: the first segment in which the sum passes it, and t less the sum before.
        let target = (f64::from(u) * NODE_TOTAL) as u32;
        let (index, below) = self.find_segment_index(row, target);
        (
            self.segment(row, index),
            target.saturating_sub(below) as f32,
        )
    }

    /// Step 21: the segment at `y` in [0, 1] of a row's azimuth, and the position within it.
    #[inline(always)]
    fn locate_segment(&self, row: usize, y: f32) -> (AzimuthSegment, f32) {
        let coordinate = y * self.segments() as f32;
        let index = (coordinate as u32 as usize).min(self.segments() - 1);
        (self.segment(row, index), coordinate - index as u32 as f32)
    }

    /// Step 24: probability of a row's azimuths below `y`, the inverse of [`Self::find_segment`] and [`invert_segment`].
    fn azimuth_cdf(&self, row: usize, y: f32) -> f64 {
        let (segment, position) = self.locate_segment(row, y);
        let low = f64::from(segment.low);
        let high = f64::from(segment.high);
        let position = f64::from(position);
        let mut below = 0.0;
        for index in 0..segment.index as usize {
            let passed = self.segment(row, index);
            below += f64::from(passed.low) + f64::from(passed.high);
        }
        (below + position * (2.0 * low + (high - low) * position)) / NODE_TOTAL
    }
}

/// Step 13: the position on [0, 1] at which a segment's probability passes `rest`: rest/(n0 + √(n0² + (n1 − n0)·rest)).
#[inline(always)]
pub fn invert_segment(segment: AzimuthSegment, rest: f32) -> f32 {
    let (low, high) = (segment.low, segment.high);
    (rest / (low + (low * low + (high - low) * rest).max(0.0).sqrt())).min(1.0)
}

/// Step 8: the position on [0, 1] at which the probability of the density 1 + slope·(2x − 1) passes `u`:
/// 2u/(1 − slope + √((1 − slope)² + 4·slope·u)).
#[inline(always)]
pub fn invert_slope(slope: f32, u: f32) -> f32 {
    let start = 1.0 - slope;
    (2.0 * u / (start + (start * start + 4.0 * slope * u).max(0.0).sqrt())).min(1.0)
}

/// Step 23: probability below `x` of that density, x·(1 − slope + slope·x).
pub fn slope_cdf(slope: f32, x: f32) -> f64 {
    let (slope, x) = (f64::from(slope), f64::from(x));
    x * (1.0 - slope + slope * x)
}

/// A pair of tables mixed beforehand, for many draws about one `wo`: that halves the time of a draw and takes as long as some
/// hundred draws (`cargo bench --bench sample`). It has room for `NODES` nodes, on the stack, as batches allocate nothing.
#[derive(Clone, Debug)]
pub struct PremixedTable<const NODES: usize> {
    row_count: usize,
    segments: usize,
    /// The first row that the guide's cell can mean.
    guide: [u8; GUIDE],
    rows: [InterpolatedRow; PARTS],
    slopes: [f32; PARTS],
    /// `[row, node]`.
    nodes: [f32; NODES],
    /// `[row, segment]`: sums up to and with each.
    sums: [u32; NODES],
}

/// Cells of the guide; a power of two.
const GUIDE: usize = 256;
const GUIDE_SHIFT: u32 = u32::BITS - GUIDE.trailing_zeros();

impl<const NODES: usize> PremixedTable<NODES> {
    /// Mixes a pair of tables that have at most `NODES` nodes.
    pub fn new(pair: &TablePair) -> Self {
        let mut mixed = Self {
            row_count: pair.tables.row_count(),
            segments: pair.segments(),
            guide: [0; GUIDE],
            rows: [InterpolatedRow::default(); PARTS],
            slopes: [0.0; PARTS],
            nodes: [0.0; NODES],
            sums: [0; NODES],
        };
        for row in 0..mixed.row_count {
            mixed.rows[row] = pair.row(row);
            mixed.slopes[row] = pair.slope(row);
            mixed.mix_row(pair, row);
        }
        mixed.fill_guide();
        mixed
    }

    /// Nodes and sums of a row.
    fn mix_row(&mut self, pair: &TablePair, row: usize) {
        let (first, second) = pair.nodes(row);
        let nodes = &mut self.nodes[row * (self.segments + 1)..][..self.segments + 1];
        let sums = &mut self.sums[row * self.segments..][..self.segments];
        let mut last = pair.mix(first[0], second[0]);
        nodes[0] = last as f32;
        let mut sum = 0;
        for segment in 0..self.segments {
            let node = pair.mix(first[segment + 1], second[segment + 1]);
            nodes[segment + 1] = node as f32;
            sum += last + node;
            sums[segment] = sum;
            last = node;
        }
    }

    fn fill_guide(&mut self) {
        let mut row = 0;
        for (cell, first) in self.guide.iter_mut().enumerate() {
            let target = (cell as u32) << GUIDE_SHIFT;
            while row + 1 < self.row_count && self.rows[row].end() <= target {
                row += 1;
            }
            *first = row as u8;
        }
    }
}

impl<const NODES: usize> InterpolatedTable for &PremixedTable<NODES> {
    #[inline(always)]
    fn segments(&self) -> usize {
        self.segments
    }

    #[inline(always)]
    fn find_row_index(&self, target: u32) -> usize {
        let mut row = usize::from(self.guide[(target >> GUIDE_SHIFT) as usize]);
        while row + 1 < self.row_count && self.rows[row].end() <= target {
            row += 1;
        }
        row
    }

    #[inline(always)]
    fn row(&self, index: usize) -> InterpolatedRow {
        self.rows[index]
    }

    #[inline(always)]
    fn slope(&self, row: usize) -> f32 {
        self.slopes[row]
    }

    #[inline(always)]
    fn find_segment_index(&self, row: usize, target: u32) -> (usize, u32) {
        let sums = &self.sums[row * self.segments..][..self.segments];
        let passed = |sum: &u32| u32::from(*sum <= target);
        let index = sums[..self.segments - 1].iter().map(passed).sum::<u32>() as usize;
        (index, if index > 0 { sums[index - 1] } else { 0 })
    }

    #[inline(always)]
    fn segment(&self, row: usize, index: usize) -> AzimuthSegment {
        let nodes = &self.nodes[row * (self.segments + 1) + index..][..2];
        AzimuthSegment {
            index: index as u32 as f32,
            low: nodes[0],
            high: nodes[1],
        }
    }
}
