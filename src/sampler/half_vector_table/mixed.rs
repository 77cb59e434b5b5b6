//! Both tables of a blend mixed beforehand: for many draws about one `wo`.

use super::mixture::{Mixture, Row, Segment};
use super::tables::Blend;

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
        let (mut nodes, mut sums) = (
            Vec::with_capacity(n * (segments + 1)),
            Vec::with_capacity(n * segments),
        );
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
        Self {
            segments,
            guide,
            slopes: (0..n).map(|i| blend.slope(i)).collect(),
            rows,
            nodes,
            sums,
        }
    }
}

impl Mixture for &Mixed {
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
        Segment {
            index: index as u32 as f32,
            low: nodes[0],
            high: nodes[1],
        }
    }
}
