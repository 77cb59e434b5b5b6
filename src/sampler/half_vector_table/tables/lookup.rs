//! What lies between two tables, and how it is searched: questions that a pair of tables answers by mixing at every question
//! (`TablePair`) or from a mixture made beforehand (`PremixedTable`), to the same bits.

/// Probability 1 of a cumulative table.
pub const ONE: u16 = u16::MAX;
/// What the nodes of a row sum to, every inner one counted twice.
pub const NODE_SUM: u32 = 2 * (ONE as u32 / 2);
/// Weight 1 of a table: weights are in units of 2⁻¹⁶.
pub const WEIGHT_ONE: u32 = 1 << 16;

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
    pub(in crate::sampler) below: u32,
    /// Its own probability, in the same units.
    pub(in crate::sampler) mass: u32,
}

impl InterpolatedRow {
    /// Probability below its end, in the same units.
    #[inline(always)]
    pub(in crate::sampler) fn end(&self) -> u32 {
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
        let target = row_target(u);
        let row = self.row(self.find_row_index(target));
        // Step 8: x = (t − to(r − 1))/mass(r).
        let fraction = target.saturating_sub(row.below) as f32 / row.mass as f32;
        (row, fraction.min(1.0))
    }

    /// The segment of a row in which the azimuth's probability passes `u` in [0, 1], and what is left of it within.
    #[inline(always)]
    fn find_segment(&self, row: usize, u: f32) -> (AzimuthSegment, f32) {
        // Step 11: t = ⌊v·65534·65536⌋. Step 12: the first segment in which the sum passes it, and t less the sum before.
        let target = segment_target(u);
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

/// Step 7: t = ⌊u1·65535·65536⌋; a number that is not below 1 counts as the last that is.
#[inline(always)]
pub(in crate::sampler) fn row_target(u: f32) -> u32 {
    ((f64::from(u) * ROW_TOTAL) as u32).min(ROW_TOTAL as u32 - 1)
}

/// Step 11: t = ⌊v·65534·65536⌋.
#[inline(always)]
pub(in crate::sampler) fn segment_target(v: f32) -> u32 {
    (f64::from(v) * NODE_TOTAL) as u32
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
