//! Probabilities and densities in 16 bits, and what lies between the tables of two angles.
//!
//! Integers make the tables small and the sums exact: a mixture of two normalised tables is normalised to the last bit, and
//! rising probabilities stay rising.

use std::hint::select_unpredictable;

use super::lookup::{AzimuthSegment, InterpolatedRow, InterpolatedTable, NODE_UNIT, WEIGHT_ONE};
use crate::geometry::half_vector_chart::{ChartEdge, PARTS};

/// Slopes are in units of 1/128.
pub const SLOPE_UNIT: f32 = 1.0 / 128.0;
/// The steepest slope: densities stay above 0 at both ends of a row.
pub const STEEPEST: i8 = 122;

/// What a file holds: one table for each of a few `wo`.
#[derive(Clone, Debug, PartialEq)]
pub struct Stored {
    /// cos θo of each table, falling from 1; the last is above 0.
    pub cosines: Vec<f32>,
    /// Edges of the rows, as numbers of the chart's edges; one more than rows.
    pub edges: Vec<u16>,
    /// `[table, row]`: probability of the rows up to and with this one, in units of 1/65535; rises to 65535.
    pub rows: Vec<u16>,
    /// `[table, row]`: slope of the density over a row, in units of [`SLOPE_UNIT`].
    pub slopes: Vec<i8>,
    /// `[table, row, node]`: density over the azimuth, at equidistant nodes and linear between; > 0, each row's trapezoids sum to 65534.
    pub nodes: Vec<u16>,
    /// Nodes a row.
    pub width: usize,
}

/// Tables and the indices that speed up their use.
#[derive(Clone, Debug)]
pub struct IndexedTables {
    stored: Stored,
    /// Whether both sides of the plane of incidence are held as one.
    fold: bool,
    /// Edges of the rows.
    edges: Vec<ChartEdge>,
    /// The row that holds each part of the chart.
    part_rows: [u8; PARTS],
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
    let edge = size_of::<u16>() + size_of::<ChartEdge>();
    tables * (size_of::<f32>() + rows * row) + (rows + 1) * edge + PARTS
}

/// Two tables, and the weight of the second: the table that is interpolated between them.
#[derive(Clone, Copy, Debug)]
pub struct TablePair<'a> {
    pub(super) tables: &'a IndexedTables,
    first: usize,
    second: usize,
    weight: u32,
}

impl IndexedTables {
    /// Adds the derived tables to arrays that keep the rules of [`Stored`].
    pub fn new(stored: Stored, fold: bool) -> Self {
        let edges = stored
            .edges
            .iter()
            .map(|&e| ChartEdge::new(usize::from(e)))
            .collect();
        let part_rows = std::array::from_fn(|part| {
            stored.edges[1..].partition_point(|&e| usize::from(e) <= part) as u8
        });
        let block_count = blocks_of(stored.width - 1);
        // In each row, the sums of the nodes' pairs up to the end of each block.
        let mut blocks = Vec::with_capacity(stored.nodes.len() / stored.width * block_count);
        for row in stored.nodes.chunks(stored.width) {
            let mut sum = 0;
            for block in 0..block_count {
                for k in block * BLOCK..(block + 1) * BLOCK {
                    sum += row[k] + row[k + 1];
                }
                blocks.push(sum);
            }
        }
        Self {
            stored,
            fold,
            edges,
            part_rows,
            blocks,
            block_count,
        }
    }

    /// What a file holds of them.
    pub fn stored(&self) -> &Stored {
        &self.stored
    }

    /// Whether both sides of the plane of incidence are held as one.
    #[inline]
    pub fn fold(&self) -> bool {
        self.fold
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
        self.edges.len() - 1
    }

    /// The row that holds a part of the chart.
    #[inline]
    pub fn row_of_part(&self, part: usize) -> usize {
        usize::from(self.part_rows[part])
    }

    /// The edges of a row.
    #[inline]
    pub fn edges(&self, row: usize) -> [ChartEdge; 2] {
        [self.edges[row], self.edges[row + 1]]
    }

    /// The tables about a polar angle, with weights that are linear in its cosine; beyond the last one, the last.
    #[inline]
    pub fn interpolate(&self, cos_o: f32) -> TablePair<'_> {
        // Step 4: b = number of cosines above cosO, at most T − 1; a = max(b − 1, 0).
        let cosines = &self.stored.cosines;
        let last = cosines.len() - 1;
        // Counting all is sooner done than searching: comparisons don't wait for each other.
        let second =
            (cosines.iter().map(|&c| u32::from(c > cos_o)).sum::<u32>() as usize).min(last);
        let first = second.saturating_sub(1);
        let (high, low) = (cosines[first], cosines[second]);
        // Step 4: w = ⌊65536·clamp((knot[a] − cosO)/(knot[a] − knot[b]), 0, 1) + ½⌋, the weight of table b.
        let weight = if high > low {
            ((high - cos_o) / (high - low)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        TablePair {
            tables: self,
            first,
            second,
            weight: (weight * WEIGHT_ONE as f32 + 0.5) as u32,
        }
    }
}

impl TablePair<'_> {
    /// Step 5, mix(a, b): `first · (WEIGHT_ONE − weight) + second · weight`, which fits 32 bits: exact, by one product modulo 2³².
    #[inline(always)]
    pub(super) fn mix(&self, first: u16, second: u16) -> u32 {
        let (first, second) = (u32::from(first), u32::from(second));
        (first * WEIGHT_ONE).wrapping_add(second.wrapping_sub(first).wrapping_mul(self.weight))
    }

    /// Row `row` of both tables, of `values` that hold `rows` of `width` for every table.
    #[inline(always)]
    fn rows<'b, T>(
        &self,
        values: &'b [T],
        rows: usize,
        row: usize,
        width: usize,
    ) -> (&'b [T], &'b [T]) {
        let first = (self.first * rows + row) * width;
        let second = (self.second * rows + row) * width;
        (&values[first..][..width], &values[second..][..width])
    }

    /// Nodes of a row of both tables.
    #[inline(always)]
    pub(super) fn nodes(&self, row: usize) -> (&[u16], &[u16]) {
        let tables = self.tables;
        self.rows(
            &tables.stored.nodes,
            tables.row_count(),
            row,
            tables.stored.width,
        )
    }

    /// Step 12, coarse: the block of segments in which the sum passes `target`, and the sum below it.
    #[inline(always)]
    fn find_block(&self, row: usize, target: u32) -> (usize, u32) {
        let tables = self.tables;
        let (first, second) =
            self.rows(&tables.blocks, tables.row_count(), row, tables.block_count);
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

impl InterpolatedTable for TablePair<'_> {
    #[inline(always)]
    fn segments(&self) -> usize {
        self.tables.stored.width - 1
    }

    #[inline(always)]
    fn find_row_index(&self, target: u32) -> usize {
        let n = self.tables.row_count();
        let (first, second) = self.rows(&self.tables.stored.rows, 1, 0, n);
        // Bisection of as many steps for every draw: nothing to mispredict, and draws of a batch don't wait for each other.
        let mut index = 0;
        let mut left = n;
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
    fn row(&self, index: usize) -> InterpolatedRow {
        let (first, second) = self.rows(&self.tables.stored.rows, 1, 0, self.tables.row_count());
        let below = if index == 0 {
            0
        } else {
            self.mix(first[index - 1], second[index - 1])
        };
        InterpolatedRow {
            index,
            below,
            mass: self.mix(first[index], second[index]) - below,
        }
    }

    #[inline(always)]
    fn slope(&self, row: usize) -> f32 {
        let (first, second) =
            self.rows(&self.tables.stored.slopes, self.tables.row_count(), row, 1);
        let (first, second) = (i32::from(first[0]), i32::from(second[0]));
        let mixed = first * (WEIGHT_ONE - self.weight) as i32 + second * self.weight as i32;
        mixed as f32 * (SLOPE_UNIT / WEIGHT_ONE as f32)
    }

    #[inline(always)]
    fn find_segment_index(&self, row: usize, target: u32) -> (usize, u32) {
        let (first, second) = self.nodes(row);
        // Step 12: the block, then the segment within it.
        let (block, mut below) = self.find_block(row, target);
        let mut index = block * BLOCK;
        let mut low = self.mix(first[index], second[index]);
        let mut sum = below;
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
    fn segment(&self, row: usize, index: usize) -> AzimuthSegment {
        let (first, second) = self.nodes(row);
        let low = self.mix(first[index], second[index]) as f32;
        let high = self.mix(first[index + 1], second[index + 1]) as f32;
        AzimuthSegment {
            index: index as u32 as f32,
            low,
            high,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::batch::PremixedTable;
    use super::super::build::{quantise_nodes, quantise_rows};
    use super::super::lookup::{invert_segment, invert_slope, slope_cdf};
    use super::*;
    use crate::points::Stream;

    fn random(count: usize, seed: u64) -> Vec<f64> {
        let mut stream = Stream::new(seed);
        (0..count).map(|_| stream.next_f64().powi(8)).collect()
    }

    fn example() -> IndexedTables {
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
        let stored = Stored {
            cosines: vec![1.0, 0.5, 0.1],
            edges: (0..=11).collect(),
            rows,
            slopes: (0..33).map(|i| (i * 7 - 110) as i8).collect(),
            nodes,
            width: 12,
        };
        IndexedTables::new(stored, false)
    }

    #[test]
    fn searches_invert_probabilities() {
        let tables = example();
        for cos_o in [1.0, 0.9, 0.5, 0.333, 0.1, 1e-9] {
            let pair = tables.interpolate(cos_o);
            for i in 0..1000 {
                let u = i as f32 / 1000.0;
                let (row, fraction) = pair.find_row(u);
                assert!(
                    (row.cdf(f64::from(fraction)) - f64::from(u)).abs() < 1e-6,
                    "{cos_o} {u}: {row:?}"
                );
                let (segment, rest) = pair.find_segment(row.index, u);
                let y = (segment.index + invert_segment(segment, rest)) / 11.0;
                let back = pair.azimuth_cdf(row.index, y);
                assert!(
                    (back - f64::from(u)).abs() < 1e-5,
                    "{cos_o} {u} {y}: {back}"
                );
                let slope = pair.slope(row.index);
                let back = slope_cdf(slope, invert_slope(slope, u));
                assert!((back - f64::from(u)).abs() < 1e-6, "{slope} {u}: {back}");
            }
        }
    }

    #[test]
    fn mixing_beforehand_changes_no_bit() {
        let tables = example();
        for cos_o in [1.0, 0.77, 0.3, 0.01] {
            let pair = tables.interpolate(cos_o);
            let premixed = &PremixedTable::<1024>::new(&pair);
            for i in 0..2000 {
                let u = if i == 1999 {
                    1f32.next_down()
                } else {
                    i as f32 / 2000.0
                };
                let ((a, x), (b, y)) = (pair.find_row(u), premixed.find_row(u));
                assert_eq!(
                    (a.index, a.below, a.mass, x),
                    (b.index, b.below, b.mass, y),
                    "{u}"
                );
                assert_eq!(pair.slope(a.index), premixed.slope(a.index));
                assert_eq!(
                    pair.find_segment(i % 11, u),
                    premixed.find_segment(i % 11, u),
                    "{u}"
                );
                assert_eq!(
                    pair.locate_segment(i % 11, u),
                    premixed.locate_segment(i % 11, u),
                    "{u}"
                );
            }
        }
    }

    #[test]
    fn weights_are_linear_in_the_cosine() {
        let tables = example();
        for (cos_o, first, second, weight) in [
            (1.0, 0, 0, 0),
            (0.75, 0, 1, WEIGHT_ONE / 2),
            (0.5, 0, 1, WEIGHT_ONE),
            (0.1, 1, 2, WEIGHT_ONE),
            (0.01, 1, 2, WEIGHT_ONE),
        ] {
            let b = tables.interpolate(cos_o);
            assert_eq!(
                (b.first, b.second, b.weight),
                (first, second, weight),
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
            + size_of_val(&t.edges[..])
            + size_of_val(&t.part_rows)
            + size_of_val(&t.blocks[..]);
        assert_eq!(t.bytes(), arrays);
    }

    /// Densities are the derivatives of the probabilities.
    #[test]
    fn densities_integrate_to_one() {
        let tables = example();
        let pair = tables.interpolate(0.4);
        let (_, unit) = pair.scale();
        let density = |row: usize, y: f32| {
            let (s, position) = pair.locate_segment(row, y);
            f64::from((s.low + (s.high - s.low) * position) * unit)
        };
        for row in 0..11 {
            let sum: f64 = (0..5500)
                .map(|i| density(row, (i as f32 + 0.5) / 5500.0))
                .sum();
            assert!((sum / 5500.0 - 1.0).abs() < 1e-5, "{row}: {sum}");
        }
    }
}
