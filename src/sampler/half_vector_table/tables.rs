//! Probabilities and densities in 16 bits, and what lies between the tables of two angles.
//!
//! Integers make the tables small and the sums exact: a mixture of two normalised tables is normalised to the last bit, and
//! rising probabilities stay rising.

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
const SHARES: u32 = 1 << 16;
/// Units of a blend's row probabilities.
const ROW_TOTAL: f64 = ONE as f64 * SHARES as f64;
const ROW_UNIT: f32 = (1.0 / ROW_TOTAL) as f32;
/// Units of a blend's node densities.
const NODE_TOTAL: f64 = NODE_SUM as f64 * SHARES as f64;
const NODE_UNIT: f32 = (1.0 / NODE_TOTAL) as f32;

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
    tables: &'a Tables,
    first: usize,
    second: usize,
    share: u32,
}

/// A row of a blend.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Which.
    pub index: usize,
    /// Probability below it, in units of a blend.
    below: u32,
    /// Its own probability.
    mass: u32,
}

impl Row {
    /// Probability below its end, in units of a blend.
    #[inline(always)]
    fn end(&self) -> u32 {
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

/// A segment between two nodes, and a probability within it, all in units of a blend.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Segment {
    /// Which.
    pub index: f32,
    /// Densities at its ends.
    pub low: f32,
    /// Densities at its ends.
    pub high: f32,
}

impl Tables {
    /// Adds the derived tables to arrays that keep the rules of [`Stored`].
    pub fn new(stored: Stored) -> Self {
        let lines = stored.edges.iter().map(|&e| Edge::of_part(usize::from(e))).collect();
        let row_of =
            std::array::from_fn(|part| stored.edges[1..].partition_point(|&e| usize::from(e) <= part) as u8);
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
        Self { stored, lines, row_of, blocks, block_count }
    }

    /// What a file holds of them.
    pub fn stored(&self) -> &Stored {
        &self.stored
    }

    /// Bytes of all arrays.
    pub fn bytes(&self) -> usize {
        bytes(self.stored.cosines.len(), self.row_count(), self.stored.width - 1)
    }

    /// Number of rows.
    #[inline]
    fn row_count(&self) -> usize {
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
        let second = (cosines.iter().map(|&c| u32::from(c > cos_o)).sum::<u32>() as usize).min(last);
        let first = second.saturating_sub(1);
        let (high, low) = (cosines[first], cosines[second]);
        let share = if high > low { ((high - cos_o) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
        Blend { tables: self, first, second, share: (share * SHARES as f32 + 0.5) as u32 }
    }
}

impl Blend<'_> {
    /// Exact: both factors fit 32 bits together.
    #[inline(always)]
    fn mix(&self, first: u16, second: u16) -> u32 {
        u32::from(first) * (SHARES - self.share) + u32::from(second) * self.share
    }

    /// Row `row` of both tables, of `values` that hold `rows` of `width` for every table.
    #[inline(always)]
    fn both<'b, T>(&self, values: &'b [T], rows: usize, row: usize, width: usize) -> (&'b [T], &'b [T]) {
        let at = |table: usize| (table * rows + row) * width;
        (&values[at(self.first)..][..width], &values[at(self.second)..][..width])
    }

    #[inline(always)]
    fn nodes(&self, row: usize) -> (&[u16], &[u16]) {
        let tables = self.tables;
        self.both(&tables.stored.nodes, tables.row_count(), row, tables.stored.width)
    }

    #[inline(always)]
    fn row_index(&self, target: u32) -> usize {
        let n = self.tables.row_count();
        let (first, second) = self.both(&self.tables.stored.rows, 1, 0, n);
        let passed = |i: usize| usize::from(self.mix(first[i], second[i]) <= target);
        // Two counts of independent comparisons are sooner done than a search whose steps wait for each other.
        let coarse = (1..=(n - 1) / STRIDE).map(|k| passed(k * STRIDE - 1)).sum::<usize>() * STRIDE;
        coarse + (coarse..(coarse + STRIDE - 1).min(n - 1)).map(passed).sum::<usize>()
    }

    #[inline(always)]
    fn row_between(&self, index: usize) -> Row {
        let (first, second) = self.both(&self.tables.stored.rows, 1, 0, self.tables.row_count());
        let to = |i: usize| self.mix(first[i], second[i]);
        let below = if index == 0 { 0 } else { to(index - 1) };
        Row { index, below, mass: to(index) - below }
    }

    /// The segment of a row in which the sum passes `target`, and the sum below it.
    #[inline(always)]
    fn segment_index(&self, row: usize, target: u32) -> (usize, u32) {
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

    /// The block in which the sum passes `target`, and the sum below it.
    #[inline]
    fn find_block(&self, row: usize, target: u32) -> (usize, u32) {
        let tables = self.tables;
        let (first, second) = self.both(&tables.blocks, tables.row_count(), row, tables.block_count);
        let (mut block, mut below) = (0, 0);
        for (&a, &b) in first.iter().zip(second) {
            let sum = self.mix(a, b);
            let passed = sum <= target;
            block += usize::from(passed);
            below = if passed { sum } else { below };
        }
        (block, below)
    }

    /// Segments a row, and the unit that makes densities at nodes 1 on average over [0, 1].
    #[inline]
    pub fn scale(&self) -> (f32, f32) {
        let segments = (self.tables.stored.width - 1) as f32;
        (segments, 2.0 * segments * NODE_UNIT)
    }
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
        (row, (target.saturating_sub(row.below) as f32 / row.mass as f32).min(1.0))
    }

    /// The segment of a row in which the azimuth's probability passes `u` in [0, 1], and what is left of it within.
    #[inline(always)]
    fn find_segment(&self, row: usize, u: f32) -> (Segment, f32) {
        let target = (f64::from(u) * NODE_TOTAL) as u32;
        let (index, below) = self.segment_of(row, target);
        (self.segment(row, index), target.saturating_sub(below) as f32)
    }

    /// The segment at `y` in [0, 1] of a row's azimuth, and the position within it.
    #[inline(always)]
    fn segment_at(&self, row: usize, y: f32) -> (Segment, f32) {
        let at = y * self.segments() as f32;
        let index = (at as usize).min(self.segments() - 1);
        (self.segment(row, index), at - index as f32)
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

impl Mixture for Blend<'_> {
    #[inline(always)]
    fn segments(&self) -> usize {
        self.tables.stored.width - 1
    }

    #[inline(always)]
    fn index_of(&self, target: u32) -> usize {
        self.row_index(target)
    }

    #[inline(always)]
    fn row(&self, index: usize) -> Row {
        self.row_between(index)
    }

    #[inline(always)]
    fn slope(&self, row: usize) -> f32 {
        let (first, second) = self.both(&self.tables.stored.slopes, self.tables.row_count(), row, 1);
        let (first, second) = (i32::from(first[0]), i32::from(second[0]));
        let mixed = first * (SHARES - self.share) as i32 + second * self.share as i32;
        mixed as f32 * (SLOPE_UNIT / SHARES as f32)
    }

    #[inline(always)]
    fn segment_of(&self, row: usize, target: u32) -> (usize, u32) {
        self.segment_index(row, target)
    }

    #[inline(always)]
    fn segment(&self, row: usize, index: usize) -> Segment {
        let (first, second) = self.nodes(row);
        let [low, high] = [index, index + 1].map(|i| self.mix(first[i], second[i]) as f32);
        Segment { index: index as f32, low, high }
    }
}

/// A blend mixed beforehand: for many draws about one `wo`.
#[derive(Clone, Debug)]
pub struct Mixed {
    segments: usize,
    /// The first row that the guide's cell can mean.
    guide: [u8; GUIDE],
    rows: Vec<Row>,
    slopes: Vec<f32>,
    /// `[row, node]`.
    nodes: Vec<f32>,
    /// `[row, segment]`: sums up to and with each.
    sums: Vec<u32>,
}

/// Cells of the guide; a power of two.
const GUIDE: usize = 256;
const GUIDE_SHIFT: u32 = u32::BITS - GUIDE.trailing_zeros();

impl Mixed {
    /// Mixes all of a blend.
    pub fn new(blend: &Blend) -> Self {
        let (n, segments) = (blend.tables.row_count(), blend.segments());
        let rows: Vec<Row> = (0..n).map(|i| blend.row(i)).collect();
        let (mut nodes, mut sums) =
            (Vec::with_capacity(n * (segments + 1)), Vec::with_capacity(n * segments));
        for row in 0..n {
            let (first, second) = blend.nodes(row);
            let (mut sum, mut last) = (0, None);
            for (&a, &b) in first.iter().zip(second) {
                let node = blend.mix(a, b);
                nodes.push(node as f32);
                if let Some(last) = last.replace(node) {
                    sum += last + node;
                    sums.push(sum);
                }
            }
        }
        let mut guide = [0; GUIDE];
        let mut row = 0;
        for (cell, first) in guide.iter_mut().enumerate() {
            let target = (cell as u32) << GUIDE_SHIFT;
            while row + 1 < n && rows[row].end() <= target {
                row += 1;
            }
            *first = row as u8;
        }
        Self { segments, guide, slopes: (0..n).map(|i| blend.slope(i)).collect(), rows, nodes, sums }
    }
}

impl Mixture for Mixed {
    #[inline(always)]
    fn segments(&self) -> usize {
        self.segments
    }

    #[inline(always)]
    fn index_of(&self, target: u32) -> usize {
        let mut row = usize::from(self.guide[(target >> GUIDE_SHIFT) as usize]);
        while row + 1 < self.rows.len() && self.rows[row].end() <= target {
            row += 1;
        }
        row
    }

    #[inline(always)]
    fn row(&self, index: usize) -> Row {
        self.rows[index]
    }

    #[inline(always)]
    fn slope(&self, row: usize) -> f32 {
        self.slopes[row]
    }

    #[inline(always)]
    fn segment_of(&self, row: usize, target: u32) -> (usize, u32) {
        let sums = &self.sums[row * self.segments..][..self.segments];
        let passed = |sum: &u32| u32::from(*sum <= target);
        let index = sums[..self.segments - 1].iter().map(passed).sum::<u32>() as usize;
        (index, if index > 0 { sums[index - 1] } else { 0 })
    }

    #[inline(always)]
    fn segment(&self, row: usize, index: usize) -> Segment {
        let nodes = &self.nodes[row * (self.segments + 1) + index..][..2];
        Segment { index: index as f32, low: nodes[0], high: nodes[1] }
    }
}

/// Rows that one comparison of the first count stands for.
const STRIDE: usize = 8;

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

/// Cumulative probabilities of `masses`, which sum to 1 and are ≥ 0, each at least one unit: nothing is left out.
pub fn quantise_rows(masses: &[f64]) -> Vec<u16> {
    let (n, mut sum, mut last) = (masses.len(), 0.0, 0u32);
    let room = |i: usize| u32::from(ONE) - (n - 1 - i) as u32;
    let step = |(i, mass): (usize, &f64)| {
        sum += mass;
        let at = if i + 1 == n { u32::from(ONE) } else { (sum * f64::from(ONE)).round() as u32 };
        last = at.clamp(last + 1, room(i));
        last as u16
    };
    masses.iter().enumerate().map(step).collect()
}

/// Nodes of a density, ≥ 0 and not all 0, scaled to [`NODE_SUM`] and each at least one unit.
pub fn quantise_nodes(density: &[f64]) -> Vec<u16> {
    let last = density.len() - 1;
    // The two ends count once, the others twice.
    let weight = |i: usize| if i == 0 || i == last { 1 } else { 2 };
    let sum: f64 = density.iter().enumerate().map(|(i, d)| d * f64::from(weight(i))).sum();
    let scale = f64::from(NODE_SUM) / sum;
    let (mut nodes, mut spent, mut exact) = (Vec::with_capacity(last + 1), 0u32, 0.0);
    for (i, d) in density[..last].iter().enumerate() {
        let w = f64::from(weight(i));
        exact += d * scale * w;
        // What rounding took from the nodes before goes to this one.
        let node = ((exact - f64::from(spent)) / w).round().max(1.0) as u32;
        spent += node * weight(i);
        nodes.push(node);
    }
    // The last node takes the rest; if others at their least have used it up, the largest gives some back.
    while spent >= NODE_SUM {
        let largest = (0..last).max_by_key(|&i| nodes[i]).unwrap_or(0);
        nodes[largest] -= 1;
        spent -= weight(largest);
    }
    nodes.push(NODE_SUM - spent);
    nodes.into_iter().map(|n| n as u16).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::Stream;

    fn random(count: usize, seed: u64) -> Vec<f64> {
        let mut stream = Stream::new(seed);
        (0..count).map(|_| stream.next_f64().powi(8)).collect()
    }

    #[test]
    fn rows_rise_to_one_whatever_the_masses() {
        let spike = |at: usize| (0..79).map(|i| f64::from(u8::from(i == at))).collect::<Vec<_>>();
        for masses in [spike(0), spike(40), spike(78), vec![1.0 / 79.0; 79], vec![1.0]] {
            let rows = quantise_rows(&masses);
            assert!(rows[0] > 0 && rows.is_sorted_by(|a, b| a < b));
            assert_eq!(*rows.last().unwrap(), ONE);
        }
        let rows = quantise_rows(&[0.25, 0.0, 0.75]);
        assert_eq!(rows, [16384, 16385, ONE]);
    }

    #[test]
    fn nodes_keep_their_sum_and_their_shape() {
        for width in [2, 3, 4, 9, 17, 65, 256] {
            for (seed, end) in [(1, 0.0), (2, 0.0), (3, 1e6)] {
                let mut density = random(width, seed + 100 * width as u64);
                density[0] += end + 1e-9;
                let nodes = quantise_nodes(&density);
                let sum: u32 = nodes.windows(2).map(|p| u32::from(p[0]) + u32::from(p[1])).sum();
                assert_eq!(sum, NODE_SUM, "{width} {seed}");
                let total: f64 = density.windows(2).map(|p| p[0] + p[1]).sum();
                for (n, d) in nodes.iter().zip(&density) {
                    let exact = d / total * f64::from(NODE_SUM);
                    assert!(
                        *n >= 1 && (f64::from(*n) - exact).abs() <= 3.0 + 2.0 * width as f64,
                        "{width} {seed}: {n} {exact}"
                    );
                }
            }
        }
    }

    fn example() -> Tables {
        let rows: Vec<u16> = [random(11, 1), random(11, 2), random(11, 3)]
            .iter()
            .flat_map(|m| quantise_rows(&m.iter().map(|x| x / m.iter().sum::<f64>()).collect::<Vec<_>>()))
            .collect();
        let nodes = (0..33).flat_map(|i| quantise_nodes(&random(12, 10 + i))).collect();
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
                assert!((back - f64::from(u)).abs() < 1e-5, "{cos_o} {u} {y}: {back}");
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
            let mixed = Mixed::new(&blend);
            for i in 0..2000 {
                let u = if i == 1999 { 1f32.next_down() } else { i as f32 / 2000.0 };
                let ((a, x), (b, y)) = (blend.find_row(u), mixed.find_row(u));
                assert_eq!((a.index, a.below, a.mass, x), (b.index, b.below, b.mass, y), "{u}");
                assert_eq!(blend.slope(a.index), mixed.slope(a.index));
                assert_eq!(blend.find_segment(i % 11, u), mixed.find_segment(i % 11, u), "{u}");
                assert_eq!(blend.segment_at(i % 11, u), mixed.segment_at(i % 11, u), "{u}");
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
            assert_eq!((b.first, b.second, b.share), (first, second, share), "{cos_o}");
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
            let sum: f64 = (0..5500).map(|i| density(row, (i as f32 + 0.5) / 5500.0)).sum();
            assert!((sum / 5500.0 - 1.0).abs() < 1e-5, "{row}: {sum}");
        }
    }
}
