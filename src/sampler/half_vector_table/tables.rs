//! Probabilities and densities in 16 bits, and what lies between the tables of two angles.
//!
//! Integers make the tables small and the sums exact: a mixture of two normalised tables is normalised to the last bit, and
//! rising probabilities stay rising.

/// Probability 1 of a cumulative table.
pub const ONE: u16 = u16::MAX;
/// What the nodes of a row sum to, every inner one counted twice.
pub const NODE_SUM: u32 = 2 * (ONE as u32 / 2);
/// Slopes are in units of 1/128.
pub const SLOPE_UNIT: f64 = 1.0 / 128.0;
/// The steepest slope: densities stay above 0 at both ends of a row.
pub const STEEPEST: i8 = 122;

/// Shares of two tables are in units of 2⁻¹⁶.
const SHARES: u32 = 1 << 16;

/// One table for each of a few `wo`.
#[derive(Clone, Debug, PartialEq)]
pub struct Tables {
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
pub struct RowPart {
    /// Which.
    pub row: usize,
    /// Probability below it.
    pub below: f64,
    /// Its own probability.
    pub mass: f64,
}

impl Tables {
    /// Number of rows.
    #[inline]
    pub fn row_count(&self) -> usize {
        self.edges.len() - 1
    }

    /// Bytes of all arrays.
    pub fn bytes(&self) -> usize {
        size_of_val(self.cosines.as_slice())
            + size_of_val(self.edges.as_slice())
            + size_of_val(self.rows.as_slice())
            + size_of_val(self.slopes.as_slice())
            + size_of_val(self.nodes.as_slice())
    }

    /// The tables about a polar angle, with shares that are linear in its cosine; beyond the last one, the last.
    #[inline]
    pub fn at(&self, cos_o: f64) -> Blend<'_> {
        let last = self.cosines.len() - 1;
        // Counting all is sooner done than searching: comparisons don't wait for each other.
        let cosine = cos_o as f32;
        let second = (self.cosines.iter().map(|&c| u32::from(c > cosine)).sum::<u32>() as usize).min(last);
        let first = second.saturating_sub(1);
        let (high, low) = (f64::from(self.cosines[first]), f64::from(self.cosines[second]));
        let share = if high > low { ((high - cos_o) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
        Blend { tables: self, first, second, share: (share * f64::from(SHARES) + 0.5) as u32 }
    }
}

/// Units of a blend's row probabilities.
const ROW_TOTAL: f64 = ONE as f64 * SHARES as f64;
const ROW_UNIT: f64 = 1.0 / ROW_TOTAL;
/// Units of a blend's node densities.
const NODE_TOTAL: f64 = NODE_SUM as f64 * SHARES as f64;
const NODE_UNIT: f64 = 1.0 / NODE_TOTAL;

impl Blend<'_> {
    /// Exact: both factors fit 32 bits together.
    #[inline]
    fn mix(&self, first: u16, second: u16) -> u32 {
        u32::from(first) * (SHARES - self.share) + u32::from(second) * self.share
    }

    /// Row `row` of both tables, of `values` that hold `rows` of `width` for every table.
    #[inline]
    fn both<'b, T>(&self, values: &'b [T], rows: usize, row: usize, width: usize) -> (&'b [T], &'b [T]) {
        let at = |table: usize| (table * rows + row) * width;
        (&values[at(self.first)..][..width], &values[at(self.second)..][..width])
    }

    #[inline]
    fn node_row(&self, row: usize) -> (&[u16], &[u16]) {
        self.both(&self.tables.nodes, self.tables.row_count(), row, self.tables.width)
    }

    /// The row in which the probability passes `u` in [0, 1).
    #[inline]
    pub fn find_row(&self, u: f64) -> RowPart {
        let n = self.tables.row_count();
        let (first, second) = self.both(&self.tables.rows, 1, 0, n);
        let target = (u * ROW_TOTAL) as u32;
        let passed = |i: usize| usize::from(self.mix(first[i], second[i]) <= target);
        // Two counts of independent comparisons are sooner done than a search whose steps wait for each other.
        let coarse = (1..=(n - 1) / STRIDE).map(|k| passed(k * STRIDE - 1)).sum::<usize>() * STRIDE;
        let row = coarse + (coarse..(coarse + STRIDE - 1).min(n - 1)).map(passed).sum::<usize>();
        self.row(row)
    }

    /// Row `row`.
    #[inline]
    pub fn row(&self, row: usize) -> RowPart {
        let n = self.tables.row_count();
        let (first, second) = self.both(&self.tables.rows, 1, 0, n);
        let to = |i: usize| self.mix(first[i], second[i]);
        let below = if row == 0 { 0 } else { to(row - 1) };
        let mass = f64::from(to(row) - below) * ROW_UNIT;
        RowPart { row, below: f64::from(below) * ROW_UNIT, mass }
    }

    /// Slope of the density over a row, in (−1, 1).
    #[inline]
    pub fn slope(&self, row: usize) -> f64 {
        let (first, second) = self.both(&self.tables.slopes, self.tables.row_count(), row, 1);
        let (first, second) = (i32::from(first[0]), i32::from(second[0]));
        f64::from(first * (SHARES - self.share) as i32 + second * self.share as i32)
            * (SLOPE_UNIT / f64::from(SHARES))
    }

    /// Where on [0, 1] the azimuth's probability in a row passes `u` in [0, 1].
    #[inline]
    pub fn find_azimuth(&self, row: usize, u: f64) -> f64 {
        let (first, second) = self.node_row(row);
        let target = u * NODE_TOTAL;
        let (segment, below) = self.find_segment(first, second, target as u32);
        let [low, high] = [segment, segment + 1].map(|i| f64::from(self.mix(first[i], second[i])));
        let rest = (target - f64::from(below)).max(0.0);
        let share = rest / (low + (low * low + (high - low) * rest).max(0.0).sqrt());
        (segment as f64 + share.min(1.0)) / (first.len() - 1) as f64
    }

    /// The segment in which the sum of nodes passes `target`, and the sum below it. First blocks are told apart, then their
    /// segments, without a branch that depends on the target.
    #[inline]
    fn find_segment(&self, first: &[u16], second: &[u16], target: u32) -> (usize, u32) {
        let segments = first.len() - 1;
        let (mut segment, mut below, mut sum) = (0, 0u32, 0u32);
        for start in (0..segments.saturating_sub(BLOCK)).step_by(BLOCK) {
            // A row's sums stay below NODE_TOTAL, which fits.
            sum += block(&first[start..]) * (SHARES - self.share) + block(&second[start..]) * self.share;
            let passed = sum <= target;
            segment += if passed { BLOCK } else { 0 };
            below = if passed { sum } else { below };
        }
        let (first, second) = (&first[segment..], &second[segment..]);
        let (mut low, mut sum) = (self.mix(first[0], second[0]), below);
        for (&a, &b) in first[1..].iter().zip(&second[1..]).take((segments - segment).min(BLOCK) - 1) {
            let high = self.mix(a, b);
            sum += low + high;
            low = high;
            let passed = sum <= target;
            segment += usize::from(passed);
            below = if passed { sum } else { below };
        }
        (segment, below)
    }

    /// Density at `y` in [0, 1] of a row's azimuth, 1 on average.
    #[inline]
    pub fn azimuth_density(&self, row: usize, y: f64) -> f64 {
        let (segment, share) = self.segment(y);
        let [low, high] = self.node_pair(row, segment);
        let unit = (self.tables.width - 1) as f64 * (2.0 * NODE_UNIT);
        (low + (high - low) * share) * unit
    }

    /// Probability of a row's azimuths below `y`: the inverse of [`Self::find_azimuth`].
    pub fn azimuth_below(&self, row: usize, y: f64) -> f64 {
        let (segment, share) = self.segment(y);
        let pairs = (0..segment).map(|s| self.node_pair(row, s));
        let below: f64 = pairs.map(|[low, high]| low + high).sum();
        let [low, high] = self.node_pair(row, segment);
        (below + share * (2.0 * low + (high - low) * share)) * NODE_UNIT
    }

    #[inline]
    fn segment(&self, y: f64) -> (usize, f64) {
        let segments = self.tables.width - 1;
        let at = y * segments as f64;
        let segment = (at as usize).min(segments - 1);
        (segment, at - segment as f64)
    }

    #[inline]
    fn node_pair(&self, row: usize, segment: usize) -> [f64; 2] {
        let (first, second) = self.node_row(row);
        [segment, segment + 1].map(|i| f64::from(self.mix(first[i], second[i])))
    }
}

/// Rows that one comparison of the first count stands for.
const STRIDE: usize = 8;

/// Segments that are summed together before they are told apart.
const BLOCK: usize = 4;

/// The sum over a block's segments of the nodes at both their ends; 0 past the end.
#[inline]
fn block(nodes: &[u16]) -> u32 {
    match nodes {
        &[a, b, c, d, e, ..] => {
            u32::from(a) + u32::from(e) + 2 * (u32::from(b) + u32::from(c) + u32::from(d))
        }
        _ => 0,
    }
}

/// Where on [0, 1] the probability of a density 1 + slope·(2x − 1) passes `u`.
#[inline]
pub fn find_on_slope(slope: f64, u: f64) -> f64 {
    let start = 1.0 - slope;
    2.0 * u / (start + (start * start + 4.0 * slope * u).max(0.0).sqrt())
}

/// Probability below `x` of that density.
pub fn below_on_slope(slope: f64, x: f64) -> f64 {
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
        let nodes = (0..33).flat_map(|i| quantise_nodes(&random(6, 10 + i))).collect();
        Tables {
            cosines: vec![1.0, 0.5, 0.1],
            edges: (0..=11).collect(),
            rows,
            slopes: (0..33).map(|i| (i * 7 - 110) as i8).collect(),
            nodes,
            width: 6,
        }
    }

    #[test]
    fn searches_invert_probabilities() {
        let tables = example();
        for cos_o in [1.0, 0.9, 0.5, 0.333, 0.1, 1e-9] {
            let blend = tables.at(cos_o);
            for i in 0..=1000 {
                let u = f64::from(i) / 1000.0;
                let part = blend.find_row(u.min(1.0 - 1e-9));
                let above = part.below + part.mass;
                assert!(part.below <= u + 1e-9 && u <= above + 1e-9, "{cos_o} {u}: {part:?}");
                let y = blend.find_azimuth(part.row, u);
                assert!((blend.azimuth_below(part.row, y) - u).abs() < 1e-7, "{cos_o} {u} {y}");
                assert!(blend.azimuth_density(part.row, y) > 0.0);
                let slope = blend.slope(part.row);
                assert!((below_on_slope(slope, find_on_slope(slope, u)) - u).abs() < 1e-12);
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

    /// Densities are the derivatives of the probabilities.
    #[test]
    fn densities_integrate_to_one() {
        let tables = example();
        let blend = tables.at(0.4);
        for row in 0..11 {
            let sum: f64 = (0..5000).map(|i| blend.azimuth_density(row, (f64::from(i) + 0.5) / 5000.0)).sum();
            assert!((sum / 5000.0 - 1.0).abs() < 1e-6, "{row}: {sum}");
        }
    }
}
