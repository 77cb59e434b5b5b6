//! Probabilities and densities in 16 bits.
//!
//! Integers make the tables small and the sums exact: a mixture of two normalised tables is normalised to the last bit, and
//! rising probabilities stay rising.

pub(in crate::sampler) mod lookup;
pub(super) mod packed;

use self::lookup::{NODE_UNIT, ONE};
use self::packed::{BLOCK, GROUP, Records, RowSearch, Slopes};
use crate::geometry::half_vector_chart::{ChartEdge, PARTS};

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
    /// `[table, row]`: slope of the density over a row, in units of [`self::packed::SLOPE_UNIT`].
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
    /// `[table][row_stride]`: 0, the probability up to and with each row, and 1 from there on.
    rows: Vec<u16>,
    row_stride: usize,
    /// `[row, table]`: slopes.
    slopes: Vec<i8>,
    /// `[row, table][record]`: the sums of the nodes at both ends of the segments up to and with each block but the last, then
    /// the nodes. Two tables about a polar angle are neighbours. A block is read whole, also where it passes the record's end.
    records: Vec<u16>,
    /// Numbers in a record.
    record: usize,
    /// Blocks that have a sum.
    block_count: usize,
}

/// Blocks of a row that have a sum: all but the last.
const fn blocks_of(segments: usize) -> usize {
    (segments - 1) / BLOCK
}

/// Numbers in the record of a row of so many segments.
const fn record_of(segments: usize) -> usize {
    blocks_of(segments) + segments + 1
}

/// Probabilities kept for a table of so many rows: whole groups, and 0 before them.
const fn row_stride_of(rows: usize) -> usize {
    1 + rows.div_ceil(GROUP) * GROUP
}

/// Bytes of all arrays of so many tables, rows and segments.
pub const fn bytes(tables: usize, rows: usize, segments: usize) -> usize {
    let row = size_of::<u16>() * record_of(segments) + size_of::<i8>();
    let search = size_of::<u16>() * row_stride_of(rows);
    tables * (size_of::<f32>() + rows * row + search)
        + (rows + 1) * size_of::<ChartEdge>()
        + PARTS
        + BLOCK * size_of::<u16>()
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
            slopes: Vec::with_capacity(table_count * row_count),
            records: Vec::with_capacity(table_count * row_count * record_of(segments) + BLOCK),
            record: record_of(segments),
            block_count: blocks_of(segments),
        };
        for cumulative in stored.rows.chunks(row_count) {
            let start = tables.rows.len();
            tables.rows.push(0);
            tables.rows.extend_from_slice(cumulative);
            tables.rows.resize(start + tables.row_stride, ONE);
        }
        for row in 0..row_count {
            for table in 0..table_count {
                let k = table * row_count + row;
                tables.slopes.push(stored.slopes[k]);
                tables.push_record(&stored.nodes[k * stored.width..][..stored.width]);
            }
        }
        // The last block may pass the end of the last record.
        tables.records.extend_from_slice(&[0; BLOCK]);
        tables
    }

    /// Adds the record of a row of nodes.
    fn push_record(&mut self, nodes: &[u16]) {
        let mut sum = 0;
        for block in 0..self.block_count {
            for k in block * BLOCK..(block + 1) * BLOCK {
                sum += nodes[k] + nodes[k + 1];
            }
            self.records.push(sum);
        }
        self.records.extend_from_slice(nodes);
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
            let rows = &self.rows[table * self.row_stride + 1..][..row_count];
            stored.rows.extend_from_slice(rows);
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
            rows: &self.rows,
            stride: self.row_stride,
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
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::build::{quantise_nodes, quantise_rows};
    use super::*;
    use crate::points::Stream;

    fn random(count: usize, seed: u64) -> Vec<f64> {
        let mut stream = Stream::new(seed);
        (0..count).map(|_| stream.next_f64().powi(8)).collect()
    }

    pub fn example() -> IndexedTables {
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
    fn bytes_are_those_of_the_arrays() {
        let t = example();
        let arrays = size_of_val(&t.cosines[..])
            + size_of_val(&t.edges[..])
            + size_of_val(&t.part_rows)
            + size_of_val(&t.rows[..])
            + size_of_val(&t.slopes[..])
            + size_of_val(&t.records[..]);
        assert_eq!(t.bytes(), arrays);
    }

    #[test]
    fn what_was_stored_comes_back() {
        let stored = example_stored();
        assert_eq!(IndexedTables::new(&stored, false).to_stored(), stored);
    }
}
