//! Cumulative sums in integers, searched sixteen values at a time.

/// Values of a cache line. They are compared at once, as vector code.
const LINE: usize = 16;

/// Lines of the topmost level, at most: all of them are compared.
const TOP: usize = 4;

/// Probability 1, in units.
const TOTAL: u32 = u32::MAX;

/// Cumulative distributions over equally many cells, in units of 1/(2³² − 1).
///
/// Every cell of positive weight has at least one unit, cells without weight have none, and the units of a distribution sum
/// to the total exactly. A cell's units are its exact probability, rounded up or down; where cells before it would have less
/// than one unit each, it may have a unit less for each of these. So a probability is off by 2⁻³² in the usual case, and by
/// at most 2⁻³² for each cell. [`Self::probability`] is computed from the same units and is exactly that of the draws, so
/// that rounding costs variance and no bias.
///
/// A search goes down a tree. A line of the lowest level holds the sums up to and with each of 16 cells, and a line of a
/// level above it the last sums of 16 lines. The topmost level has at most 64 sums, all of which are compared. Sixteen
/// comparisons cost less than the branches that would save some of them.
#[derive(Clone, Debug)]
pub(crate) struct IntegerCdfs {
    cells: usize,
    top: SumLevel,
    /// Between the topmost and the lowest level, from above; none up to 1024 cells.
    middle: Vec<SumLevel>,
    leaves: SumLevel,
}

/// The lines that a level of the tree has for all distributions.
#[derive(Clone, Debug)]
struct SumLevel {
    /// Lines of one distribution.
    stride: usize,
    /// `[distribution][line]`, filled up with the total.
    lines: Vec<SumLine>,
}

/// A cache line of sums.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct SumLine([u32; LINE]);

/// A cell, and a place in it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct CellPlace {
    pub(crate) cell: u32,
    /// Where in the cell, [0, 1].
    pub(crate) fraction: f64,
}

/// How far a search has come when only the lowest level is left.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LeafSearch {
    /// The sum that is searched for, in units.
    target: f64,
    /// The distribution's line that holds it.
    line: u32,
}

impl IntegerCdfs {
    /// No distribution yet, over `cells` > 0 cells, with room for `count` of them.
    pub(crate) fn new(cells: usize, count: usize) -> Self {
        debug_assert!(cells > 0);
        let leaves = SumLevel::new(cells, count);
        let mut top = SumLevel::new(leaves.stride, count);
        let mut middle = Vec::new();
        while top.stride > TOP {
            let above = SumLevel::new(top.stride, count);
            middle.insert(0, std::mem::replace(&mut top, above));
        }
        Self {
            cells,
            top,
            middle,
            leaves,
        }
    }

    /// Appends a distribution in proportion to `weights`, one for each cell, finite and ≥ 0; their sum is finite. Without
    /// any weight, the last cell has the total.
    pub(crate) fn push(&mut self, weights: &[f64]) {
        debug_assert_eq!(weights.len(), self.cells);
        let mut sums = self.leaves.push(&cumulate(weights));
        for level in self.middle.iter_mut().rev() {
            sums = level.push(&sums);
        }
        self.top.push(&sums);
    }

    /// Probability of a cell, exactly that of [`Self::find`] choosing it.
    pub(crate) fn probability(&self, distribution: usize, cell: usize) -> f64 {
        let (below, end) = self.bounds(distribution, cell as u32);
        f64::from(end - below) / f64::from(TOTAL)
    }

    /// Bytes of memory that the sums hold.
    pub(crate) fn bytes(&self) -> usize {
        let mut lines = self.top.lines.len() + self.leaves.lines.len();
        for level in &self.middle {
            lines += level.lines.len();
        }
        lines * size_of::<SumLine>()
    }

    /// The place at which a distribution reaches `u` in [0, 1). What is outside is clamped, and NaN counts as 0.
    #[inline(always)]
    pub(crate) fn find(&self, distribution: usize, u: f64) -> CellPlace {
        self.find_cell(distribution, self.find_leaf(distribution, u))
    }

    /// All steps of [`Self::find`] but the last, which reads from the largest level. Where many searches take this step
    /// together, they wait for memory together.
    #[inline(always)]
    pub(crate) fn find_leaf(&self, distribution: usize, u: f64) -> LeafSearch {
        let target = scale(u);
        let units = whole_units(target);
        // The number of sums up to the target is the index of the sum beyond it, and of the line below that sum.
        let first = distribution * self.top.stride;
        let mut line = 0;
        for sums in &self.top.lines[first..first + self.top.stride] {
            line += sums.count_up_to(units);
        }
        for level in &self.middle {
            let sums = &level.lines[distribution * level.stride + line as usize];
            line = line * LINE as u32 + sums.count_up_to(units);
        }
        LeafSearch { target, line }
    }

    /// Reads a word of the line that [`Self::find_cell`] will read; it has no meaning.
    #[inline(always)]
    pub(crate) fn touch(&self, distribution: usize, search: LeafSearch) -> u32 {
        self.leaves.lines[distribution * self.leaves.stride + search.line as usize].0[0]
    }

    /// The last step of [`Self::find`].
    #[inline(always)]
    pub(crate) fn find_cell(&self, distribution: usize, search: LeafSearch) -> CellPlace {
        let LeafSearch { target, line } = search;
        let sums = &self.leaves.lines[distribution * self.leaves.stride + line as usize];
        let cell = line * LINE as u32 + sums.count_up_to(whole_units(target));
        // F(i − 1) ≤ target ≤ F(i) in a cell that has units, and (target − F(i − 1))/(F(i) − F(i − 1)) is the place in it.
        let (below, end) = self.bounds(distribution, cell);
        let fraction = (target - f64::from(below)) / f64::from(end - below);
        debug_assert!((0.0..=1.0).contains(&fraction));
        CellPlace { cell, fraction }
    }

    /// The sums below a cell, and up to and with it.
    #[inline(always)]
    fn bounds(&self, distribution: usize, cell: u32) -> (u32, u32) {
        let i = distribution * self.leaves.stride * LINE + cell as usize;
        let below = if cell == 0 { 0 } else { self.leaves.sum(i - 1) };
        (below, self.leaves.sum(i))
    }
}

impl SumLevel {
    /// A level of `sums` for each of `count` distributions, still empty.
    fn new(sums: usize, count: usize) -> Self {
        let stride = sums.div_ceil(LINE);
        Self {
            stride,
            lines: Vec::with_capacity(stride * count),
        }
    }

    /// Appends a distribution's sums, and returns those of the level above: the last of each line.
    fn push(&mut self, sums: &[u32]) -> Vec<u32> {
        let mut lasts = Vec::with_capacity(self.stride);
        for chunk in sums.chunks(LINE) {
            let mut line = [TOTAL; LINE];
            line[..chunk.len()].copy_from_slice(chunk);
            self.lines.push(SumLine(line));
            lasts.push(line[LINE - 1]);
        }
        lasts
    }

    #[inline(always)]
    fn sum(&self, i: usize) -> u32 {
        self.lines[i / LINE].0[i % LINE]
    }
}

impl SumLine {
    /// How many of the sums are not above `units`.
    #[inline(always)]
    fn count_up_to(&self, units: u32) -> u32 {
        let mut count = 0;
        for &sum in &self.0 {
            count += u32::from(sum <= units);
        }
        count
    }
}

/// The sum that `u` in [0, 1) reaches, in units: below the total, so that a cell ends beyond it.
#[inline(always)]
fn scale(u: f64) -> f64 {
    // Not a number counts as 0.
    u.max(0.0).min(1.0f64.next_down()) * f64::from(TOTAL)
}

/// A whole number of units up to `target`, and no more than one below it.
#[inline(always)]
fn whole_units(target: f64) -> u32 {
    // To this, numbers are added as integers, whose low bits can be taken: fewer instructions than a conversion.
    const ROUND: f64 = 1.5 * (1u64 << 52) as f64;
    ((target - 0.5) + ROUND).to_bits() as u32
}

/// Sums in units: rounded, at least one unit more after each cell of positive weight, the total after the last.
fn cumulate(weights: &[f64]) -> Vec<u32> {
    let mut whole = 0.0;
    let mut positive = 0;
    for &w in weights {
        whole += w;
        positive += u32::from(w > 0.0);
    }
    let mut sums = Vec::with_capacity(weights.len());
    let mut sum = 0.0;
    let mut units = 0;
    for &w in weights {
        if w > 0.0 {
            sum += w;
            positive -= 1;
            // F(i) in units, but above F(i − 1), and with a unit left for each cell of positive weight that follows.
            let rounded = (sum / whole * f64::from(TOTAL)).round() as u32;
            let most = TOTAL - positive;
            units = if positive == 0 {
                TOTAL
            } else {
                rounded.clamp(units + 1, most)
            };
        }
        sums.push(units);
    }
    if whole == 0.0 {
        sums[weights.len() - 1] = TOTAL;
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A number in [0, 1), well spread (the golden ratio's multiples).
    fn spread(i: usize) -> f64 {
        (i as f64 * 0.618_033_988_749_894_9).fract()
    }

    fn weights(kind: usize, cells: usize) -> Vec<f64> {
        let sun = cells * 2 / 3;
        let mut weights = Vec::new();
        for i in 0..cells {
            weights.push(match kind {
                0 => 1.0,
                1 => spread(i + 1).powi(12),
                // One bright cell, in the dark and in the black.
                2 if i == sun => 1e8,
                2 => spread(i),
                3 if i == sun => 1e-30,
                3 => 0.0,
                // Zeros in front, behind and between.
                4 if i % 3 == 1 || cells == 1 => 1.0 + spread(i),
                4 => 0.0,
                // Nearly all cells deserve less than a unit.
                5 if i == 0 || i == cells - 1 => 1e30,
                5 => spread(i) * f64::from(u32::from(i % 7 > 0)),
                _ => 0.0,
            });
        }
        weights
    }

    const SIZES: [usize; 17] = [
        1, 2, 3, 7, 15, 16, 17, 33, 63, 64, 65, 255, 512, 1024, 1025, 16_384, 16_385,
    ];

    #[test]
    fn each_cell_is_found_exactly_between_its_bounds() {
        for cells in SIZES {
            // The second distribution must not see the first.
            let mut cdfs = IntegerCdfs::new(cells, 8);
            for kind in 0..7 {
                cdfs.push(&weights(kind, cells));
            }
            for kind in 0..7 {
                let weights = weights(kind, cells);
                let mut sum = 0u64;
                for (cell, weight) in weights.iter().enumerate() {
                    let (below, end) = cdfs.bounds(kind, cell as u32);
                    assert_eq!(u64::from(below), sum, "{kind}: {cell} of {cells}");
                    sum = u64::from(end);
                    if kind < 6 {
                        assert_eq!(end > below, *weight > 0.0, "{kind}: {cell} of {cells}");
                    }
                    if end > below {
                        assert_found(&cdfs, kind, cell as u32);
                    }
                }
                assert_eq!(sum, u64::from(TOTAL));
            }
        }
    }

    /// The first and the last unit of a cell, and what is beyond them.
    fn assert_found(cdfs: &IntegerCdfs, distribution: usize, cell: u32) {
        let (below, end) = cdfs.bounds(distribution, cell);
        for units in [below, end - 1, below + (end - below) / 2] {
            // In the middle of a unit no rounding of u matters.
            let u = (f64::from(units) + 0.5) / f64::from(TOTAL);
            let found = cdfs.find(distribution, u);
            assert_eq!(found.cell, cell, "{units}");
            let place = (f64::from(units - below) + 0.5) / f64::from(end - below);
            assert!((found.fraction - place).abs() < 1e-5, "{units}");
        }
        let exact = f64::from(end - below) / f64::from(TOTAL);
        assert_eq!(cdfs.probability(distribution, cell as usize), exact);
    }

    #[test]
    fn probabilities_are_off_by_a_unit_for_each_cell_at_most() {
        for cells in SIZES {
            for kind in 0..6 {
                let weights = weights(kind, cells);
                let whole: f64 = weights.iter().sum();
                let mut cdfs = IntegerCdfs::new(cells, 1);
                cdfs.push(&weights);
                let mut most = 1.0 + 1e-3;
                for w in &weights {
                    most += f64::from(u8::from(w / whole * f64::from(TOTAL) < 1.0));
                }
                for (cell, w) in weights.iter().enumerate() {
                    let off = (cdfs.probability(0, cell) - w / whole) * f64::from(TOTAL);
                    assert!(off.abs() < most, "{kind}: {cell} of {cells}: {off}");
                }
            }
        }
    }

    #[test]
    fn numbers_at_and_beyond_the_ends_find_cells_with_units() {
        let ends = [
            -1.0,
            -0.0,
            0.0,
            f64::MIN_POSITIVE,
            1.0f64.next_down(),
            1.0,
            2.0,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NAN,
        ];
        for cells in SIZES {
            for kind in 0..7 {
                let mut cdfs = IntegerCdfs::new(cells, 1);
                cdfs.push(&weights(kind, cells));
                for u in ends {
                    let found = cdfs.find(0, u);
                    assert!(cdfs.probability(0, found.cell as usize) > 0.0, "{kind} {u}");
                    assert!((0.0..=1.0).contains(&found.fraction), "{kind} {u}");
                }
                let (first, last) = (cdfs.find(0, 0.0), cdfs.find(0, 1.0));
                assert!(first.cell <= last.cell && first.fraction == 0.0);
                assert!(
                    last.fraction > 0.999_999 || cdfs.probability(0, last.cell as usize) < 1e-6
                );
            }
        }
    }

    #[test]
    fn sums_have_four_bytes_a_cell_and_those_above_a_sixteenth() {
        let mut cdfs = IntegerCdfs::new(1024, 3);
        assert_eq!(cdfs.bytes(), 0);
        for _ in 0..3 {
            cdfs.push(&vec![1.0; 1024]);
        }
        assert_eq!(cdfs.bytes(), 3 * 4 * (1024 + 64));
    }
}
