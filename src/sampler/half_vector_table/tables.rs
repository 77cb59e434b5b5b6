//! Probabilities and densities in 16 bits, and what lies between the tables of two angles.
//!
//! Integers make the tables small and the sums exact: a mixture of two normalised tables is normalised to the last bit, and
//! rising probabilities stay rising.

use std::hint::select_unpredictable;

use super::mixture::{Mixture, NODE_UNIT, Row, Segment};
use super::square::{Edge, PARTS};

/// Probability 1 of a cumulative table.
pub const ONE: u16 = u16::MAX;
/// What the nodes of a row sum to, every inner one counted twice.
pub const NODE_SUM: u32 = 2 * (ONE as u32 / 2);
/// Slopes are in units of 1/128.
pub const SLOPE_UNIT: f32 = 1.0 / 128.0;
/// The steepest slope: densities stay above 0 at both ends of a row.
pub const STEEPEST: i8 = 122;

/// Shares of two tables are in units of 2⁻¹⁶.
pub const SHARES: u32 = 1 << 16;

/// What a file holds: one table for each of a few `wo`.
#[derive(Clone, Debug, PartialEq)]
pub struct Stored {
    /// cos θo of each table, falling from 1; the last is above 0.
    pub cosines: Vec<f32>,
    /// Edges of the rows, as edges of the square's parts; one more than rows.
    pub edges: Vec<u16>,
    /// `[table, row]`: probability of the rows up to and with this one, in units of 1/[`ONE`]; rises to [`ONE`].
    pub rows: Vec<u16>,
    /// `[table, row]`: slope of the density over a row, in units of [`SLOPE_UNIT`].
    pub slopes: Vec<i8>,
    /// `[table, row, node]`: density over the azimuth, at equidistant nodes and linear between; > 0, see [`NODE_SUM`].
    pub nodes: Vec<u16>,
    /// Nodes a row.
    pub width: usize,
}

/// Tables and what speeds up their use.
#[derive(Clone, Debug)]
pub struct Tables {
    stored: Stored,
    /// Edges of the rows.
    lines: Vec<Edge>,
    /// The row that holds each part of the square.
    row_of: [u8; PARTS],
    /// `[table, row, block]`: sum of the nodes at both ends of the segments up to and with a block, but for the last.
    blocks: Vec<u16>,
    /// Blocks that have a sum.
    block_count: usize,
}

/// Segments that are summed together before they are told apart.
const BLOCK: usize = 4;

/// Blocks of a row that have a sum: all but the last.
const fn blocks_of(segments: usize) -> usize {
    (segments - 1) / BLOCK
}

/// Bytes of all arrays of so many tables, rows and segments.
pub const fn bytes(tables: usize, rows: usize, segments: usize) -> usize {
    let row = size_of::<u16>() * (1 + segments + 1 + blocks_of(segments)) + size_of::<i8>();
    let edge = size_of::<u16>() + size_of::<Edge>();
    tables * (size_of::<f32>() + rows * row) + (rows + 1) * edge + PARTS
}

/// Two tables and their shares.
#[derive(Clone, Copy, Debug)]
pub struct Blend<'a> {
    pub(super) tables: &'a Tables,
    first: usize,
    second: usize,
    share: u32,
}

impl Tables {
    /// Adds the derived tables to arrays that keep the rules of [`Stored`].
    pub fn new(stored: Stored) -> Self {
        let lines = stored
            .edges
            .iter()
            .map(|&e| Edge::of_part(usize::from(e)))
            .collect();
        let row_of = std::array::from_fn(|part| {
            stored.edges[1..].partition_point(|&e| usize::from(e) <= part) as u8
        });
        let block_count = blocks_of(stored.width - 1);
        let sums = |row: &[u16]| {
            let mut sum = 0;
            let add = |block: usize| {
                let nodes = &row[block * BLOCK..=(block + 1) * BLOCK];
                sum += nodes.windows(2).map(|pair| pair[0] + pair[1]).sum::<u16>();
                sum
            };
            (0..block_count).map(add).collect::<Vec<u16>>()
        };
        let blocks = stored.nodes.chunks(stored.width).flat_map(sums).collect();
        Self {
            stored,
            lines,
            row_of,
            blocks,
            block_count,
        }
    }

    /// What a file holds of them.
    pub fn stored(&self) -> &Stored {
        &self.stored
    }

    /// Bytes of all arrays.
    pub fn bytes(&self) -> usize {
        bytes(
            self.stored.cosines.len(),
            self.row_count(),
            self.stored.width - 1,
        )
    }

    /// Number of rows.
    #[inline]
    pub(super) fn row_count(&self) -> usize {
        self.lines.len() - 1
    }

    /// The row that holds a part of the square.
    #[inline]
    pub fn row_of(&self, part: usize) -> usize {
        usize::from(self.row_of[part])
    }

    /// The edges of a row.
    #[inline]
    pub fn edges(&self, row: usize) -> [Edge; 2] {
        [self.lines[row], self.lines[row + 1]]
    }

    /// The tables about a polar angle, with shares that are linear in its cosine; beyond the last one, the last.
    #[inline]
    pub fn at(&self, cos_o: f32) -> Blend<'_> {
        let cosines = &self.stored.cosines;
        let last = cosines.len() - 1;
        // Counting all is sooner done than searching: comparisons don't wait for each other.
        let second =
            (cosines.iter().map(|&c| u32::from(c > cos_o)).sum::<u32>() as usize).min(last);
        let first = second.saturating_sub(1);
        let (high, low) = (cosines[first], cosines[second]);
        let share = if high > low {
            ((high - cos_o) / (high - low)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        Blend {
            tables: self,
            first,
            second,
            share: (share * SHARES as f32 + 0.5) as u32,
        }
    }
}

impl Blend<'_> {
    /// `first · (SHARES − share) + second · share`, which fits 32 bits: exact, by one product modulo 2³².
    #[inline(always)]
    pub(super) fn mix(&self, first: u16, second: u16) -> u32 {
        let (first, second) = (u32::from(first), u32::from(second));
        (first * SHARES).wrapping_add(second.wrapping_sub(first).wrapping_mul(self.share))
    }

    /// Row `row` of both tables, of `values` that hold `rows` of `width` for every table.
    #[inline(always)]
    fn both<'b, T>(
        &self,
        values: &'b [T],
        rows: usize,
        row: usize,
        width: usize,
    ) -> (&'b [T], &'b [T]) {
        let at = |table: usize| (table * rows + row) * width;
        (
            &values[at(self.first)..][..width],
            &values[at(self.second)..][..width],
        )
    }

    #[inline(always)]
    pub(super) fn nodes(&self, row: usize) -> (&[u16], &[u16]) {
        let tables = self.tables;
        self.both(
            &tables.stored.nodes,
            tables.row_count(),
            row,
            tables.stored.width,
        )
    }

    /// The block in which the sum passes `target`, and the sum below it.
    #[inline(always)]
    fn find_block(&self, row: usize, target: u32) -> (usize, u32) {
        let tables = self.tables;
        let (first, second) =
            self.both(&tables.blocks, tables.row_count(), row, tables.block_count);
        let (mut block, mut below) = (0, 0);
        for (&a, &b) in first.iter().zip(second) {
            let sum = self.mix(a, b);
            let passed = sum <= target;
            block += usize::from(passed);
            below = if passed { sum } else { below };
        }
        (block, below)
    }

    /// Nodes of all rows.
    #[inline]
    pub fn node_count(&self) -> usize {
        self.tables.row_count() * self.tables.stored.width
    }

    /// Segments a row, and the unit that makes densities at nodes 1 on average over [0, 1].
    #[inline]
    pub fn scale(&self) -> (f32, f32) {
        let segments = (self.tables.stored.width - 1) as f32;
        (segments, 2.0 * segments * NODE_UNIT)
    }
}

impl Mixture for Blend<'_> {
    #[inline(always)]
    fn segments(&self) -> usize {
        self.tables.stored.width - 1
    }

    #[inline(always)]
    fn index_of(&self, target: u32) -> usize {
        let n = self.tables.row_count();
        let (first, second) = self.both(&self.tables.stored.rows, 1, 0, n);
        // Bisection of as many steps for every draw: nothing to mispredict, and draws of a batch don't wait for each other.
        let (mut index, mut left) = (0, n);
        while left > 1 {
            let half = left / 2;
            let last = index + half - 1;
            let passed = self.mix(first[last], second[last]) <= target;
            index = select_unpredictable(passed, index + half, index);
            left -= half;
        }
        index
    }

    #[inline(always)]
    fn row(&self, index: usize) -> Row {
        let (first, second) = self.both(&self.tables.stored.rows, 1, 0, self.tables.row_count());
        let below = if index == 0 {
            0
        } else {
            self.mix(first[index - 1], second[index - 1])
        };
        Row {
            index,
            below,
            mass: self.mix(first[index], second[index]) - below,
        }
    }

    #[inline(always)]
    fn slope(&self, row: usize) -> f32 {
        let (first, second) =
            self.both(&self.tables.stored.slopes, self.tables.row_count(), row, 1);
        let (first, second) = (i32::from(first[0]), i32::from(second[0]));
        let mixed = first * (SHARES - self.share) as i32 + second * self.share as i32;
        mixed as f32 * (SLOPE_UNIT / SHARES as f32)
    }

    #[inline(always)]
    fn segment_of(&self, row: usize, target: u32) -> (usize, u32) {
        let (first, second) = self.nodes(row);
        let (block, mut below) = self.find_block(row, target);
        let mut index = block * BLOCK;
        let (mut low, mut sum) = (self.mix(first[index], second[index]), below);
        let others = (first.len() - 1 - index).min(BLOCK) - 1;
        for i in index + 1..=index + others {
            let high = self.mix(first[i], second[i]);
            // A row's sums stay below NODE_TOTAL, which fits.
            sum += low + high;
            low = high;
            let passed = sum <= target;
            index += usize::from(passed);
            below = if passed { sum } else { below };
        }
        (index, below)
    }

    #[inline(always)]
    fn segment(&self, row: usize, index: usize) -> Segment {
        let (first, second) = self.nodes(row);
        let low = self.mix(first[index], second[index]) as f32;
        let high = self.mix(first[index + 1], second[index + 1]) as f32;
        Segment {
            index: index as u32 as f32,
            low,
            high,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::mixed::Mixed;
    use super::super::mixture::{below_on_slope, find_in, find_on_slope};
    use super::super::quantise::{quantise_nodes, quantise_rows};
    use super::*;
    use crate::points::Stream;

    fn random(count: usize, seed: u64) -> Vec<f64> {
        let mut stream = Stream::new(seed);
        (0..count).map(|_| stream.next_f64().powi(8)).collect()
    }

    fn example() -> Tables {
        let rows: Vec<u16> = [random(11, 1), random(11, 2), random(11, 3)]
            .iter()
            .flat_map(|m| {
                quantise_rows(
                    &m.iter()
                        .map(|x| x / m.iter().sum::<f64>())
                        .collect::<Vec<_>>(),
                )
            })
            .collect();
        let nodes = (0..33)
            .flat_map(|i| quantise_nodes(&random(12, 10 + i)))
            .collect();
        Tables::new(Stored {
            cosines: vec![1.0, 0.5, 0.1],
            edges: (0..=11).collect(),
            rows,
            slopes: (0..33).map(|i| (i * 7 - 110) as i8).collect(),
            nodes,
            width: 12,
        })
    }

    #[test]
    fn searches_invert_probabilities() {
        let tables = example();
        for cos_o in [1.0, 0.9, 0.5, 0.333, 0.1, 1e-9] {
            let blend = tables.at(cos_o);
            for i in 0..1000 {
                let u = i as f32 / 1000.0;
                let (row, share) = blend.find_row(u);
                assert!(
                    (row.probability(f64::from(share)) - f64::from(u)).abs() < 1e-6,
                    "{cos_o} {u}: {row:?}"
                );
                let (segment, rest) = blend.find_segment(row.index, u);
                let y = (segment.index + find_in(segment, rest)) / 11.0;
                let back = blend.azimuth_below(row.index, y);
                assert!(
                    (back - f64::from(u)).abs() < 1e-5,
                    "{cos_o} {u} {y}: {back}"
                );
                let slope = blend.slope(row.index);
                let back = below_on_slope(slope, find_on_slope(slope, u));
                assert!((back - f64::from(u)).abs() < 1e-6, "{slope} {u}: {back}");
            }
        }
    }

    #[test]
    fn mixing_beforehand_changes_no_bit() {
        let tables = example();
        for cos_o in [1.0, 0.77, 0.3, 0.01] {
            let blend = tables.at(cos_o);
            let mixed = &Mixed::<1024>::new(&blend);
            for i in 0..2000 {
                let u = if i == 1999 {
                    1f32.next_down()
                } else {
                    i as f32 / 2000.0
                };
                let ((a, x), (b, y)) = (blend.find_row(u), mixed.find_row(u));
                assert_eq!(
                    (a.index, a.below, a.mass, x),
                    (b.index, b.below, b.mass, y),
                    "{u}"
                );
                assert_eq!(blend.slope(a.index), mixed.slope(a.index));
                assert_eq!(
                    blend.find_segment(i % 11, u),
                    mixed.find_segment(i % 11, u),
                    "{u}"
                );
                assert_eq!(
                    blend.segment_at(i % 11, u),
                    mixed.segment_at(i % 11, u),
                    "{u}"
                );
            }
        }
    }

    #[test]
    fn shares_are_linear_in_the_cosine() {
        let tables = example();
        for (cos_o, first, second, share) in [
            (1.0, 0, 0, 0),
            (0.75, 0, 1, SHARES / 2),
            (0.5, 0, 1, SHARES),
            (0.1, 1, 2, SHARES),
            (0.01, 1, 2, SHARES),
        ] {
            let b = tables.at(cos_o);
            assert_eq!(
                (b.first, b.second, b.share),
                (first, second, share),
                "{cos_o}"
            );
        }
    }

    #[test]
    fn bytes_are_those_of_the_arrays() {
        let (t, s) = (example(), example().stored);
        let arrays = size_of_val(&s.cosines[..])
            + size_of_val(&s.edges[..])
            + size_of_val(&s.rows[..])
            + size_of_val(&s.slopes[..])
            + size_of_val(&s.nodes[..])
            + size_of_val(&t.lines[..])
            + size_of_val(&t.row_of)
            + size_of_val(&t.blocks[..]);
        assert_eq!(t.bytes(), arrays);
    }

    /// Densities are the derivatives of the probabilities.
    #[test]
    fn densities_integrate_to_one() {
        let tables = example();
        let blend = tables.at(0.4);
        let (_, unit) = blend.scale();
        let density = |row: usize, y: f32| {
            let (s, share) = blend.segment_at(row, y);
            f64::from((s.low + (s.high - s.low) * share) * unit)
        };
        for row in 0..11 {
            let sum: f64 = (0..5500)
                .map(|i| density(row, (i as f32 + 0.5) / 5500.0))
                .sum();
            assert!((sum / 5500.0 - 1.0).abs() < 1e-5, "{row}: {sum}");
        }
    }
}
