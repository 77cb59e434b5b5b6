//! What lies between the tables of two angles, mixed at every question.

use super::super::tables::IndexedTables;
use super::super::tables::lookup::{
    AzimuthSegment, InterpolatedRow, InterpolatedTable, WEIGHT_ONE,
};
use super::super::tables::packed::{BLOCK, PackedPair, RecordPair};

/// Two neighbouring tables, and the weight of the second: the table that is interpolated between them.
#[derive(Clone, Copy, Debug)]
pub struct TablePair<'a> {
    pub(in crate::sampler) tables: &'a IndexedTables,
    first: usize,
    second: usize,
    weight: u32,
}

impl IndexedTables {
    /// The tables about a polar angle, with weights that are linear in its cosine; beyond the last one, the last.
    #[inline(always)]
    pub fn interpolate(&self, cos_o: f32) -> TablePair<'_> {
        // Step 4: b = number of cosines above cosO, at most T − 1. Counting all is sooner done than searching: comparisons
        // don't wait for each other.
        let mut above = 0;
        for &cosine in self.cosines() {
            above += u32::from(cosine > cos_o);
        }
        self.pair_at(above as usize, cos_o)
    }

    /// [`Self::interpolate`] where the number of cosines above that of `wo` is known.
    #[inline(always)]
    pub(in crate::sampler) fn pair_at(&self, above: usize, cos_o: f32) -> TablePair<'_> {
        // Step 4: a = max(b − 1, 0).
        let second = above.min(self.cosines().len() - 1);
        let first = second.saturating_sub(1);
        let (high, low) = (self.cosines()[first], self.cosines()[second]);
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

impl<'a> TablePair<'a> {
    /// Step 5, as [`PackedPair::mix`].
    #[inline(always)]
    pub(in crate::sampler) fn mix(&self, first: u16, second: u16) -> u32 {
        PackedPair::new(first, second).mix(self.weight)
    }

    /// The numbers of the two tables.
    #[inline(always)]
    pub(in crate::sampler) fn numbers(&self) -> [u32; 2] {
        [self.first as u32, self.second as u32]
    }

    /// Weight of the second table, in units of 1/[`WEIGHT_ONE`].
    #[inline(always)]
    pub(in crate::sampler) fn weight(&self) -> u32 {
        self.weight
    }

    #[inline(always)]
    fn record(&self, row: usize) -> RecordPair<'a> {
        self.tables.records().pair(row as u32, self.numbers())
    }

    /// Nodes of a row of both tables.
    #[inline(always)]
    pub(in crate::sampler) fn nodes(&self, row: usize) -> (&'a [u16], &'a [u16]) {
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
        search.find(self.numbers(), self.weight, target).index as usize
    }

    #[inline(always)]
    fn row(&self, index: usize) -> InterpolatedRow {
        let [below, end] = self.tables.row_search().ends(index as u32, self.numbers());
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
    use super::super::super::tables::lookup::{invert_segment, invert_slope, slope_cdf};
    use super::super::super::tables::tests::example;
    use super::super::batch::PremixedTable;
    use super::*;

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
