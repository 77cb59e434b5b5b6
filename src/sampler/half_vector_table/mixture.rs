//! What lies between two tables, and how it is searched.

use super::tables::{NODE_SUM, ONE, SHARES};

/// Units of a blend's row probabilities.
pub const ROW_TOTAL: f64 = ONE as f64 * SHARES as f64;
pub const ROW_UNIT: f32 = (1.0 / ROW_TOTAL) as f32;
/// Units of a blend's node densities.
pub const NODE_TOTAL: f64 = NODE_SUM as f64 * SHARES as f64;
pub const NODE_UNIT: f32 = (1.0 / NODE_TOTAL) as f32;

/// A row of a blend.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row {
    /// Which.
    pub index: usize,
    /// Probability below it, in units of a blend.
    pub(super) below: u32,
    /// Its own probability.
    pub(super) mass: u32,
}

impl Row {
    /// Probability below its end, in units of a blend.
    #[inline(always)]
    pub(super) fn end(&self) -> u32 {
        self.below + self.mass
    }

    /// Its probability.
    #[inline(always)]
    pub fn mass(&self) -> f32 {
        self.mass as f32 * ROW_UNIT
    }

    /// Probability below a share of it.
    pub fn probability(&self, share: f64) -> f64 {
        (f64::from(self.below) + f64::from(self.mass) * share) / ROW_TOTAL
    }
}

/// A segment between two nodes, in units of a blend.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Segment {
    /// Which.
    pub index: f32,
    /// Density at its first node.
    pub low: f32,
    /// Density at its second node.
    pub high: f32,
}

/// What draws and densities ask of the mixture of two tables, mixed at every question or beforehand: the same bits.
pub trait Mixture {
    /// Segments of a row.
    fn segments(&self) -> usize;
    /// The row in which the probability passes `target`, in units of a blend.
    fn index_of(&self, target: u32) -> usize;
    /// Row `index`.
    fn row(&self, index: usize) -> Row;
    /// Slope of the density over a row, in (−1, 1).
    fn slope(&self, row: usize) -> f32;
    /// The segment of a row in which the sum passes `target`, and the sum below it, in units of a blend.
    fn segment_of(&self, row: usize, target: u32) -> (usize, u32);
    /// Segment `index` of a row.
    fn segment(&self, row: usize, index: usize) -> Segment;

    /// The row in which the probability passes `u` in [0, 1), and the share of it below `u`, in [0, 1].
    #[inline(always)]
    fn find_row(&self, u: f32) -> (Row, f32) {
        let target = (f64::from(u) * ROW_TOTAL) as u32;
        let row = self.row(self.index_of(target));
        (
            row,
            (target.saturating_sub(row.below) as f32 / row.mass as f32).min(1.0),
        )
    }

    /// The segment of a row in which the azimuth's probability passes `u` in [0, 1], and what is left of it within.
    #[inline(always)]
    fn find_segment(&self, row: usize, u: f32) -> (Segment, f32) {
        let target = (f64::from(u) * NODE_TOTAL) as u32;
        let (index, below) = self.segment_of(row, target);
        (
            self.segment(row, index),
            target.saturating_sub(below) as f32,
        )
    }

    /// The segment at `y` in [0, 1] of a row's azimuth, and the position within it.
    #[inline(always)]
    fn segment_at(&self, row: usize, y: f32) -> (Segment, f32) {
        let at = y * self.segments() as f32;
        let index = (at as u32 as usize).min(self.segments() - 1);
        (self.segment(row, index), at - index as u32 as f32)
    }

    /// Probability of a row's azimuths below `y`: the inverse of [`Self::find_segment`] and [`find_in`].
    fn azimuth_below(&self, row: usize, y: f32) -> f64 {
        let (here, share) = self.segment_at(row, y);
        let (low, high, share) = (f64::from(here.low), f64::from(here.high), f64::from(share));
        let before = (0..here.index as usize).map(|i| self.segment(row, i));
        let below: f64 = before.map(|s| f64::from(s.low) + f64::from(s.high)).sum();
        (below + share * (2.0 * low + (high - low) * share)) / NODE_TOTAL
    }
}

/// Where on [0, 1] a segment's probability passes `rest`.
#[inline(always)]
pub fn find_in(segment: Segment, rest: f32) -> f32 {
    let (low, high) = (segment.low, segment.high);
    (rest / (low + (low * low + (high - low) * rest).max(0.0).sqrt())).min(1.0)
}

/// Where on [0, 1] the probability of a density 1 + slope·(2x − 1) passes `u`.
#[inline(always)]
pub fn find_on_slope(slope: f32, u: f32) -> f32 {
    let start = 1.0 - slope;
    (2.0 * u / (start + (start * start + 4.0 * slope * u).max(0.0).sqrt())).min(1.0)
}

/// Probability below `x` of that density.
pub fn below_on_slope(slope: f32, x: f32) -> f64 {
    let (slope, x) = (f64::from(slope), f64::from(x));
    x * (1.0 - slope + slope * x)
}
