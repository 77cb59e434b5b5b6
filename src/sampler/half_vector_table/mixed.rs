//! Both tables of a blend mixed beforehand: for many draws about one `wo`.

use super::mixture::{Mixture, Row, Segment};
use super::square::PARTS;
use super::tables::Blend;

/// A blend mixed beforehand: for many draws about one `wo`. `NODES` is the most nodes that it has room for: it lives on the
/// stack, as batches allocate nothing.
#[derive(Clone, Debug)]
pub struct Mixed<const NODES: usize> {
    row_count: usize,
    segments: usize,
    /// The first row that the guide's cell can mean.
    guide: [u8; GUIDE],
    rows: [Row; PARTS],
    slopes: [f32; PARTS],
    /// `[row, node]`.
    nodes: [f32; NODES],
    /// `[row, segment]`: sums up to and with each.
    sums: [u32; NODES],
}

/// Cells of the guide; a power of two.
const GUIDE: usize = 256;
const GUIDE_SHIFT: u32 = u32::BITS - GUIDE.trailing_zeros();

impl<const NODES: usize> Mixed<NODES> {
    /// Mixes all of a blend that has at most `NODES` nodes.
    pub fn new(blend: &Blend) -> Self {
        let mut mixed = Self {
            row_count: blend.tables.row_count(),
            segments: blend.segments(),
            guide: [0; GUIDE],
            rows: [Row::default(); PARTS],
            slopes: [0.0; PARTS],
            nodes: [0.0; NODES],
            sums: [0; NODES],
        };
        for row in 0..mixed.row_count {
            mixed.rows[row] = blend.row(row);
            mixed.slopes[row] = blend.slope(row);
            mixed.mix_row(blend, row);
        }
        mixed.fill_guide();
        mixed
    }

    /// Nodes and sums of a row.
    fn mix_row(&mut self, blend: &Blend, row: usize) {
        let (first, second) = blend.nodes(row);
        let nodes = &mut self.nodes[row * (self.segments + 1)..][..self.segments + 1];
        let sums = &mut self.sums[row * self.segments..][..self.segments];
        let mut last = blend.mix(first[0], second[0]);
        nodes[0] = last as f32;
        let mut sum = 0;
        for segment in 0..self.segments {
            let node = blend.mix(first[segment + 1], second[segment + 1]);
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

impl<const NODES: usize> Mixture for &Mixed<NODES> {
    #[inline(always)]
    fn segments(&self) -> usize {
        self.segments
    }

    #[inline(always)]
    fn index_of(&self, target: u32) -> usize {
        let mut row = usize::from(self.guide[(target >> GUIDE_SHIFT) as usize]);
        while row + 1 < self.row_count && self.rows[row].end() <= target {
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
        Segment {
            index: index as u32 as f32,
            low: nodes[0],
            high: nodes[1],
        }
    }
}
