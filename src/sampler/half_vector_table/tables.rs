//! Probabilities and densities in 16 bits, and what lies between the tables of two angles.
//!
//! Integers make the tables small and the sums exact: a mixture of two normalised tables is normalised to the last bit, and
//! rising probabilities stay rising.

use super::lookup::{
    AzimuthSegment, InterpolatedRow, InterpolatedTable, NODE_UNIT, ONE, WEIGHT_ONE,
};
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

/// The tables as draws read them: what is needed together lies together.
#[derive(Clone, Debug)]
pub struct IndexedTables {
    /// cos θo of each table, falling from 1.
    cosines: Vec<f32>,
    /// Whether both sides of the plane of incidence are held as one.
    fold: bool,
    /// Segments of a row.
    pub(super) segments: usize,
    /// Edges of the rows.
    edges: Vec<ChartEdge>,
    /// The row that holds each part of the chart.
    part_rows: [u8; PARTS],
    /// `[pair][row_stride]`: of every two neighbouring tables 0, the probability up to and with each row, and 1 from there on.
    rows: Vec<PackedPair>,
    row_stride: usize,
    /// The probability of every pair up to and with each group of [`GROUP`] rows, and 1 from there on: the first eight groups,
    /// and the others, which few tables have.
    pivots: Vec<[[PackedPair; GROUP]; 2]>,
    /// `[row, table]`: slopes.
    slopes: Vec<i8>,
    /// `[row, table][record]`: the sums of the nodes at both ends of the segments up to and with each block but the last, then
    /// the nodes, then 0 as far as the last block could have some. Two tables about a polar angle are neighbours.
    records: Vec<u16>,
    /// Numbers in a record.
    record: usize,
    /// Blocks that have a sum.
    block_count: usize,
}

/// Rows that are compared with a probability at once.
const GROUP: usize = 8;

/// Segments that are summed together before they are told apart.
pub(super) const BLOCK: usize = 4;

/// Blocks of a row that have a sum: all but the last.
const fn blocks_of(segments: usize) -> usize {
    (segments - 1) / BLOCK
}

/// Numbers in the record of a row of so many segments.
const fn record_of(segments: usize) -> usize {
    blocks_of(segments) + (blocks_of(segments) + 1) * BLOCK + 1
}

/// Probabilities kept for a table of so many rows: whole groups, and 0 before them.
const fn row_stride_of(rows: usize) -> usize {
    1 + rows.div_ceil(GROUP) * GROUP
}

/// Pairs of neighbouring tables; one table is its own neighbour.
const fn pairs_of(tables: usize) -> usize {
    if tables > 1 { tables - 1 } else { 1 }
}

/// Bytes of all arrays of so many tables, rows and segments.
pub const fn bytes(tables: usize, rows: usize, segments: usize) -> usize {
    let row = size_of::<u16>() * record_of(segments) + size_of::<i8>();
    let search = size_of::<PackedPair>() * (row_stride_of(rows) + 2 * GROUP);
    tables * (size_of::<f32>() + rows * row)
        + pairs_of(tables) * search
        + (rows + 1) * size_of::<ChartEdge>()
        + PARTS
}

/// Two neighbouring tables, and the weight of the second: the table that is interpolated between them.
#[derive(Clone, Copy, Debug)]
pub struct TablePair<'a> {
    pub(super) tables: &'a IndexedTables,
    first: usize,
    second: usize,
    weight: u32,
}

impl IndexedTables {
    /// Arranges arrays that keep the rules of [`Stored`].
    pub fn new(stored: &Stored, fold: bool) -> Self {
        let segments = stored.width - 1;
        let row_count = stored.edges.len() - 1;
        let table_count = stored.cosines.len();
        debug_assert!(stored.cosines.is_sorted_by(|a, b| a > b));
        debug_assert_eq!(stored.nodes.len(), table_count * row_count * stored.width);
        let mut edges = Vec::with_capacity(row_count + 1);
        for &edge in &stored.edges {
            edges.push(ChartEdge::new(usize::from(edge)));
        }
        let part_rows = std::array::from_fn(|part| {
            stored.edges[1..].partition_point(|&e| usize::from(e) <= part) as u8
        });
        let mut tables = Self {
            cosines: stored.cosines.clone(),
            fold,
            segments,
            edges,
            part_rows,
            rows: Vec::new(),
            row_stride: row_stride_of(row_count),
            pivots: Vec::with_capacity(pairs_of(table_count)),
            slopes: Vec::with_capacity(table_count * row_count),
            records: Vec::with_capacity(table_count * row_count * record_of(segments)),
            record: record_of(segments),
            block_count: blocks_of(segments),
        };
        for pair in 0..pairs_of(table_count) {
            let second = (pair + 1).min(table_count - 1);
            let [first, second] =
                [pair, second].map(|table| &stored.rows[table * row_count..][..row_count]);
            tables.push_search(first, second);
        }
        for row in 0..row_count {
            for table in 0..table_count {
                let k = table * row_count + row;
                tables.slopes.push(stored.slopes[k]);
                tables.push_record(&stored.nodes[k * stored.width..][..stored.width]);
            }
        }
        tables
    }

    /// Adds what the row of a probability is found by between two tables.
    fn push_search(&mut self, first: &[u16], second: &[u16]) {
        let start = self.rows.len();
        self.rows.push(PackedPair::default());
        for (&first, &second) in first.iter().zip(second) {
            self.rows.push(PackedPair::new(first, second));
        }
        let one = PackedPair::new(ONE, ONE);
        self.rows.resize(start + self.row_stride, one);
        let mut pivots = [[one; GROUP]; 2];
        let groups = self.rows[start + 1..].chunks(GROUP);
        for (pivot, group) in pivots.as_flattened_mut().iter_mut().zip(groups) {
            *pivot = group[GROUP - 1];
        }
        self.pivots.push(pivots);
    }

    /// Adds the record of a row of nodes.
    fn push_record(&mut self, nodes: &[u16]) {
        let start = self.records.len();
        let mut sum = 0;
        for block in 0..self.block_count {
            for k in block * BLOCK..(block + 1) * BLOCK {
                sum += nodes[k] + nodes[k + 1];
            }
            self.records.push(sum);
        }
        self.records.extend_from_slice(nodes);
        self.records.resize(start + self.record, 0);
    }

    /// What a file holds of them.
    pub fn to_stored(&self) -> Stored {
        let (table_count, row_count) = (self.cosines.len(), self.row_count());
        let mut stored = Stored {
            cosines: self.cosines.clone(),
            edges: Vec::with_capacity(row_count + 1),
            rows: Vec::with_capacity(table_count * row_count),
            slopes: Vec::with_capacity(table_count * row_count),
            nodes: Vec::with_capacity(table_count * row_count * (self.segments + 1)),
            width: self.segments + 1,
        };
        // A row begins at the first part that it holds; the last row ends where the chart does.
        for row in 0..row_count {
            let first = self.part_rows.partition_point(|&r| usize::from(r) < row);
            stored.edges.push(first as u16);
        }
        stored.edges.push(PARTS as u16);
        for table in 0..table_count {
            // A table is the first of its pair; the last one is the second of the last pair.
            let pair = table.min(pairs_of(table_count) - 1);
            for row in &self.rows[pair * self.row_stride + 1..][..row_count] {
                let [first, second] = row.halves();
                stored.rows.push(if table == pair { first } else { second });
            }
            for row in 0..row_count {
                let k = row * table_count + table;
                stored.slopes.push(self.slopes[k]);
                let nodes = &self.records[k * self.record + self.block_count..];
                stored.nodes.extend_from_slice(&nodes[..stored.width]);
            }
        }
        stored
    }

    /// Whether both sides of the plane of incidence are held as one.
    #[inline(always)]
    pub fn fold(&self) -> bool {
        self.fold
    }

    /// Bytes of all arrays.
    pub fn bytes(&self) -> usize {
        bytes(self.cosines.len(), self.row_count(), self.segments)
    }

    /// cos θo of each table, falling from 1.
    #[inline(always)]
    pub(super) fn cosines(&self) -> &[f32] {
        &self.cosines
    }

    #[inline(always)]
    pub(super) fn row_search(&self) -> RowSearch<'_> {
        RowSearch {
            pivots: &self.pivots,
            rows: &self.rows,
            stride: self.row_stride,
            row_count: self.row_count(),
        }
    }

    #[inline(always)]
    pub(super) fn records(&self) -> Records<'_> {
        Records {
            values: &self.records,
            table_count: self.cosines.len(),
            record: self.record,
            block_count: self.block_count,
        }
    }

    #[inline(always)]
    pub(super) fn slopes(&self) -> Slopes<'_> {
        Slopes {
            values: &self.slopes,
            table_count: self.cosines.len(),
        }
    }

    /// Length of a segment on the azimuth's [0, 1].
    #[inline(always)]
    pub(super) fn per_segment(&self) -> f32 {
        1.0 / self.segments as f32
    }

    /// Unit of densities at nodes, per unit of the azimuth fraction: they are 1 on average over [0, 1], and half of that, as
    /// the fraction runs over [−1, 1].
    #[inline(always)]
    pub(super) fn density_unit(&self) -> f32 {
        0.5 * (2.0 * self.segments as f32 * NODE_UNIT)
    }

    /// Number of rows.
    #[inline(always)]
    pub(super) fn row_count(&self) -> usize {
        self.edges.len() - 1
    }

    /// The row that holds a part of the chart.
    #[inline(always)]
    pub fn row_of_part(&self, part: usize) -> usize {
        usize::from(self.part_rows[part])
    }

    /// The edges of a row.
    #[inline(always)]
    pub fn edges(&self, row: usize) -> [ChartEdge; 2] {
        [self.edges[row], self.edges[row + 1]]
    }

    /// The tables about a polar angle, with weights that are linear in its cosine; beyond the last one, the last.
    #[inline(always)]
    pub fn interpolate(&self, cos_o: f32) -> TablePair<'_> {
        // Step 4: b = number of cosines above cosO, at most T − 1. Counting all is sooner done than searching: comparisons
        // don't wait for each other.
        let mut above = 0;
        for &cosine in &self.cosines {
            above += u32::from(cosine > cos_o);
        }
        self.pair_at(above as usize, cos_o)
    }

    /// [`Self::interpolate`] where the number of cosines above that of `wo` is known.
    #[inline(always)]
    pub(super) fn pair_at(&self, above: usize, cos_o: f32) -> TablePair<'_> {
        // Step 4: a = max(b − 1, 0).
        let second = above.min(self.cosines.len() - 1);
        let first = second.saturating_sub(1);
        let (high, low) = (self.cosines[first], self.cosines[second]);
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

/// A number of the first table in the lower half, and one of the second in the upper: what columns hold until they are mixed.
#[derive(Clone, Copy, Debug, Default)]
pub struct PackedPair(u32);

impl PackedPair {
    #[inline(always)]
    fn new(first: u16, second: u16) -> Self {
        Self(u32::from(first) | u32::from(second) << 16)
    }

    fn halves(self) -> [u16; 2] {
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
    pivots: &'a [[[PackedPair; GROUP]; 2]],
    rows: &'a [PackedPair],
    stride: usize,
    row_count: usize,
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
        let pivots = &self.pivots[pair as usize];
        let mut group = count_passed(&pivots[0], weight, target);
        if self.row_count > GROUP * GROUP {
            group += count_passed(&pivots[1], weight, target);
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
    values: &'a [u16],
    table_count: usize,
    record: usize,
    block_count: usize,
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
            first: &self.values[(row + first as usize) * self.record..][..self.record],
            second: &self.values[(row + second as usize) * self.record..][..self.record],
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
    fn nodes(&self) -> (&'a [u16], &'a [u16]) {
        (
            &self.first[self.block_count..],
            &self.second[self.block_count..],
        )
    }
}

/// The slopes of all rows.
#[derive(Clone, Copy)]
pub(super) struct Slopes<'a> {
    values: &'a [i8],
    table_count: usize,
}

impl Slopes<'_> {
    #[inline(always)]
    pub(super) fn pair(&self, row: u32, [first, second]: [u32; 2]) -> PackedPair {
        let row = &self.values[row as usize * self.table_count..][..self.table_count];
        PackedPair::from_slopes(row[first as usize], row[second as usize])
    }
}

impl<'a> TablePair<'a> {
    /// Step 5, as [`PackedPair::mix`].
    #[inline(always)]
    pub(super) fn mix(&self, first: u16, second: u16) -> u32 {
        PackedPair::new(first, second).mix(self.weight)
    }

    /// The numbers of the two tables.
    #[inline(always)]
    pub(super) fn numbers(&self) -> [u32; 2] {
        [self.first as u32, self.second as u32]
    }

    /// Weight of the second table, in units of 1/[`WEIGHT_ONE`].
    #[inline(always)]
    pub(super) fn weight(&self) -> u32 {
        self.weight
    }

    #[inline(always)]
    fn record(&self, row: usize) -> RecordPair<'a> {
        self.tables.records().pair(row as u32, self.numbers())
    }

    /// Nodes of a row of both tables.
    #[inline(always)]
    pub(super) fn nodes(&self, row: usize) -> (&'a [u16], &'a [u16]) {
        self.record(row).nodes()
    }

    /// Nodes of all rows.
    #[inline(always)]
    pub fn node_count(&self) -> usize {
        self.tables.row_count() * (self.tables.segments + 1)
    }
}

impl InterpolatedTable for TablePair<'_> {
    #[inline(always)]
    fn segments(&self) -> usize {
        self.tables.segments
    }

    #[inline(always)]
    fn find_row_index(&self, target: u32) -> usize {
        let search = self.tables.row_search();
        search.find(self.first as u32, self.weight, target).index as usize
    }

    #[inline(always)]
    fn row(&self, index: usize) -> InterpolatedRow {
        let [below, end] = self
            .tables
            .row_search()
            .ends(index as u32, self.first as u32);
        let below = below.mix(self.weight);
        InterpolatedRow {
            index,
            below,
            mass: end.mix(self.weight) - below,
        }
    }

    #[inline(always)]
    fn slope(&self, row: usize) -> f32 {
        let slopes = self.tables.slopes().pair(row as u32, self.numbers());
        slopes.mix_slopes(self.weight)
    }

    #[inline(always)]
    fn find_segment_index(&self, row: usize, target: u32) -> (usize, u32) {
        // Step 12: the block, then the segment in it.
        let record = self.record(row);
        let (block, mut below) = record.find_block(self.weight, target);
        let nodes = record.block_nodes(block);
        let start = block as usize * BLOCK;
        let mut index = start;
        let mut sum = below;
        let mut low = nodes[0].mix(self.weight);
        for (k, node) in nodes.iter().enumerate().take(BLOCK).skip(1) {
            // A row's sums stay below NODE_TOTAL, which fits; those that would pass the row's end are not counted.
            let high = node.mix(self.weight);
            sum = sum.wrapping_add(low).wrapping_add(high);
            low = high;
            let passed = (sum <= target) & (start + k < self.tables.segments);
            index += usize::from(passed);
            below = if passed { sum } else { below };
        }
        (index, below)
    }

    #[inline(always)]
    fn segment(&self, row: usize, index: usize) -> AzimuthSegment {
        let [low, high] = self.record(row).segment_nodes(index as u32);
        AzimuthSegment {
            index: index as u32 as f32,
            low: low.mix(self.weight) as f32,
            high: high.mix(self.weight) as f32,
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
        IndexedTables::new(&example_stored(), false)
    }

    fn example_stored() -> Stored {
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
        Stored {
            cosines: vec![1.0, 0.5, 0.1],
            edges: (0..=10).chain([PARTS as u16]).collect(),
            rows,
            slopes: (0..33).map(|i| (i * 7 - 110) as i8).collect(),
            nodes,
            width: 12,
        }
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
        let t = example();
        let arrays = size_of_val(&t.cosines[..])
            + size_of_val(&t.edges[..])
            + size_of_val(&t.part_rows)
            + size_of_val(&t.rows[..])
            + size_of_val(&t.pivots[..])
            + size_of_val(&t.slopes[..])
            + size_of_val(&t.records[..]);
        assert_eq!(t.bytes(), arrays);
    }

    #[test]
    fn what_was_stored_comes_back() {
        let stored = example_stored();
        assert_eq!(IndexedTables::new(&stored, false).to_stored(), stored);
    }

    /// Densities are the derivatives of the probabilities.
    #[test]
    fn densities_integrate_to_one() {
        let tables = example();
        let pair = tables.interpolate(0.4);
        let unit = 2.0 * tables.density_unit();
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
