//! Many piecewise-linear CDFs in three arrays.

/// A piece of a CDF: x from `x0` to `x1`, probability from `c0` to `c1`.
///
/// See [`Curves`](crate::distribution::Curves) for an example.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Segment {
    /// Number of the piece within its curve.
    pub index: usize,
    /// Where it starts, in grid units.
    pub x0: f64,
    /// Where it ends, in grid units.
    pub x1: f64,
    /// Probability below `x0`.
    pub c0: f64,
    /// Probability below `x1`.
    pub c1: f64,
}

/// A probability of 1 in a curve.
///
/// See [`Curves`](crate::distribution::Curves) for an example.
pub const WHOLE: u16 = u16::MAX;
const PROBABILITY: f64 = 1.0 / WHOLE as f64;

/// CDF curves over the grid 0, 1 … n, each with its own knots at grid positions, or all with a knot at every position.
///
/// A curve rises from 0 to [`WHOLE`], strictly over every piece that has mass, however little; one that is 0 everywhere
/// is an empty distribution. The density drawn from is the derivative of the curve as stored, so rounding to 16
/// bits costs variance, at most, and no exactness.
///
/// # Examples
/// ```
/// use merlkit::distribution::{Curves, cumulated, simplify};
///
/// // The CDF of four masses, and the knots that keep it within 1 %.
/// let cdf = cumulated([1.0, 1.0, 4.0, 4.0]);
/// let knots = simplify(&cdf, 0.01 * 10.0);
/// assert_eq!(knots, [0, 2, 4]);
///
/// let mut curves = Curves::new();
/// curves.push(&cdf, Some(&knots));
/// let segment = curves.find(0, 0.5);
/// assert_eq!((segment.x0, segment.x1), (2.0, 4.0));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curves {
    /// Start of each curve in the arrays below, and their length at the end.
    pub starts: Vec<u32>,
    /// Knots' grid positions; empty if every curve has a knot at every position.
    pub positions: Vec<u16>,
    /// Probability below each knot, in units of 1/[`WHOLE`].
    pub cdf: Vec<u16>,
    /// Halvings that find a piece in the longest curve.
    halvings: u32,
}

impl Curves {
    /// No curves yet.
    pub fn new() -> Self {
        Self {
            starts: vec![0],
            ..Self::default()
        }
    }

    /// Curves from their arrays: `starts` from 0 to the number of knots, at least two knots a curve.
    pub fn from_parts(starts: Vec<u32>, positions: Vec<u16>, cdf: Vec<u16>) -> Self {
        let mut longest = 0;
        for pair in starts.windows(2) {
            longest = longest.max(pair[1].saturating_sub(pair[0]));
        }
        Self {
            starts,
            positions,
            cdf,
            halvings: halvings(longest),
        }
    }

    /// How many curves there are.
    pub fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes held by the arrays.
    pub fn bytes(&self) -> usize {
        size_of_val(self.starts.as_slice())
            + size_of_val(self.positions.as_slice())
            + size_of_val(self.cdf.as_slice())
    }

    /// Adds a curve from the cumulated masses at every grid position, with knots at `knots`, or everywhere.
    ///
    /// `cumulated` starts at 0 and never falls. All curves of one set must be given knots, or none, and fewer than
    /// [`WHOLE`] of them.
    pub fn push(&mut self, cumulated: &[f64], knots: Option<&[usize]>) {
        debug_assert!(cumulated.is_sorted());
        match knots {
            Some(knots) => {
                self.positions.extend(knots.iter().map(|&k| k as u16));
                let at: Vec<f64> = knots.iter().map(|&k| cumulated[k]).collect();
                self.cdf.extend(rising(&at));
            }
            None => self.cdf.extend(rising(cumulated)),
        }
        self.end_curve();
    }

    /// Adds copies of all curves of `more`.
    pub fn append(&mut self, more: &Self) {
        let offset = self.cdf.len() as u32;
        self.starts
            .extend(more.starts.iter().skip(1).map(|s| s + offset));
        self.positions.extend_from_slice(&more.positions);
        self.cdf.extend_from_slice(&more.cdf);
        self.halvings = self.halvings.max(more.halvings);
    }

    fn end_curve(&mut self) {
        let start = self.starts[self.starts.len() - 1];
        let end = self.cdf.len() as u32;
        self.halvings = self.halvings.max(halvings(end - start));
        self.starts.push(end);
    }

    /// Pieces of curve `curve`.
    pub fn segments(&self, curve: usize) -> usize {
        (self.starts[curve + 1] - self.starts[curve]).saturating_sub(1) as usize
    }

    /// Whether curve `curve` has no mass.
    #[inline]
    pub fn is_void(&self, curve: usize) -> bool {
        let end = self.starts[curve + 1] as usize;
        end == self.starts[curve] as usize || self.cdf[end - 1] == 0
    }

    /// The piece of curve `curve` in which the probability passes `u` in [0, 1); it has mass. The curve must not be void.
    #[inline]
    pub fn find(&self, curve: usize, u: f64) -> Segment {
        debug_assert!(!self.is_void(curve));
        let range = self.range(curve);
        // cdf[i] ≤ 65535·u < cdf[i + 1]: for whole cdf[i] that is the same with ⌊65535·u⌋.
        let below = (u * f64::from(WHOLE)) as u16;
        let index = self.last_not_above(&self.cdf[range.clone()], below.min(WHOLE - 1));
        self.piece(range.start, index)
    }

    /// The piece of curve `curve` that holds grid coordinate `x` ≥ 0; the last one past the end.
    #[inline]
    pub fn find_segment(&self, curve: usize, x: f64) -> Segment {
        let range = self.range(curve);
        let index = if self.positions.is_empty() {
            (x as usize).min(range.len() - 2)
        } else {
            let positions = &self.positions[range.clone()];
            self.last_not_above(
                positions,
                (x as u16).min(positions[positions.len() - 1] - 1),
            )
        };
        self.piece(range.start, index)
    }

    /// [`Self::find`] for each of `curves`, into the same elements of `pieces`.
    ///
    /// A search waits for one load after another. Here [`SIDE_BY_SIDE`] of them wait together.
    pub(crate) fn find_each(&self, curves: &[u32], u: &[f64], pieces: &mut [Segment]) {
        let blocks = curves.chunks(SIDE_BY_SIDE).zip(u.chunks(SIDE_BY_SIDE));
        for ((curves, u), pieces) in blocks.zip(pieces.chunks_mut(SIDE_BY_SIDE)) {
            let mut search = CurveSearches::default();
            for (lane, (&curve, &u)) in curves.iter().zip(u).enumerate() {
                let below = (u * f64::from(WHOLE)) as u16;
                search.start(lane, self.range(curve as usize), below.min(WHOLE - 1));
            }
            search.run(&self.cdf, self.halvings);
            search.read(self, pieces);
        }
    }

    /// [`Self::find_segment`] for each of `curves`, into the same elements of `pieces`.
    pub(crate) fn find_each_segment(&self, curves: &[u32], x: &[f64], pieces: &mut [Segment]) {
        if self.positions.is_empty() {
            for ((piece, &curve), &x) in pieces.iter_mut().zip(curves).zip(x) {
                *piece = self.find_segment(curve as usize, x);
            }
            return;
        }
        let blocks = curves.chunks(SIDE_BY_SIDE).zip(x.chunks(SIDE_BY_SIDE));
        for ((curves, x), pieces) in blocks.zip(pieces.chunks_mut(SIDE_BY_SIDE)) {
            let mut search = CurveSearches::default();
            for (lane, (&curve, &x)) in curves.iter().zip(x).enumerate() {
                let range = self.range(curve as usize);
                let last = self.positions[range.end - 1];
                search.start(lane, range, (x as u16).min(last - 1));
            }
            search.run(&self.positions, self.halvings);
            search.read(self, pieces);
        }
    }

    /// Piece `index` of curve `curve`.
    pub fn segment(&self, curve: usize, index: usize) -> Segment {
        self.piece(self.starts[curve] as usize, index)
    }

    #[inline]
    fn range(&self, curve: usize) -> std::ops::Range<usize> {
        self.starts[curve] as usize..self.starts[curve + 1] as usize
    }

    /// Index of the last of `values` ≤ `limit`; they never fall, the first is ≤ `limit` and the last is above.
    ///
    /// Every curve takes as many halvings as the longest, and none has a branch: nothing is mispredicted, so that the
    /// searches of two tables run side by side.
    #[inline]
    fn last_not_above(&self, values: &[u16], limit: u16) -> usize {
        let end = values.len() - 1;
        debug_assert!(values[0] <= limit && values[end] > limit);
        (0..self.halvings).rev().fold(0, |i, bit| {
            let next = (i + (1 << bit)).min(end);
            i + (usize::from(values[next] <= limit) << bit)
        })
    }

    #[inline]
    fn piece(&self, start: usize, index: usize) -> Segment {
        let i = start + index;
        let (x0, x1) = if self.positions.is_empty() {
            (index as f64, (index + 1) as f64)
        } else {
            (
                f64::from(self.positions[i]),
                f64::from(self.positions[i + 1]),
            )
        };
        Segment {
            index,
            x0,
            x1,
            c0: f64::from(self.cdf[i]) * PROBABILITY,
            c1: f64::from(self.cdf[i + 1]) * PROBABILITY,
        }
    }
}

/// CurveSearches that wait for memory together.
const SIDE_BY_SIDE: usize = 8;

/// CurveSearches of several curves in one array of numbers that rise within each of them: for the last that is not above a limit.
#[derive(Default)]
struct CurveSearches {
    /// Where each curve starts in the array, and its last element.
    starts: [usize; SIDE_BY_SIDE],
    ends: [usize; SIDE_BY_SIDE],
    limits: [u16; SIDE_BY_SIDE],
    /// The last element that is known not to be above the limit.
    found: [usize; SIDE_BY_SIDE],
}

impl CurveSearches {
    #[inline(always)]
    fn start(&mut self, lane: usize, range: std::ops::Range<usize>, limit: u16) {
        self.starts[lane] = range.start;
        self.found[lane] = range.start;
        self.ends[lane] = range.end - 1;
        self.limits[lane] = limit;
    }

    /// Every lane halves the same number of times: see [`Curves::last_not_above`]. Lanes without a search stay at the first element.
    #[inline(always)]
    fn run(&mut self, values: &[u16], halvings: u32) {
        for bit in (0..halvings).rev() {
            for lane in 0..SIDE_BY_SIDE {
                let next = (self.found[lane] + (1 << bit)).min(self.ends[lane]);
                let goes_on = usize::from(values[next] <= self.limits[lane]);
                self.found[lane] += goes_on << bit;
            }
        }
    }

    #[inline(always)]
    fn read(&self, curves: &Curves, pieces: &mut [Segment]) {
        for (lane, piece) in pieces.iter_mut().enumerate() {
            let start = self.starts[lane];
            *piece = curves.piece(start, self.found[lane] - start);
        }
    }
}

/// The number of halvings that find one of the pieces between `knots` knots.
fn halvings(knots: u32) -> u32 {
    u32::BITS - knots.saturating_sub(2).leading_zeros()
}

/// `cumulated` over its last value, in units of 1/[`WHOLE`], rounded, but rising wherever `cumulated` does: every piece
/// with mass keeps at least one unit.
fn rising(cumulated: &[f64]) -> Vec<u16> {
    let total = cumulated.last().copied().unwrap_or(0.0);
    // Without mass the curve is void, and there is nothing to divide by.
    if total <= 0.0 {
        return vec![0; cumulated.len()];
    }
    // Step 1: each value rounded, and above the one before where the piece between them has mass.
    let mut units: Vec<u16> = Vec::with_capacity(cumulated.len());
    for (i, c) in cumulated.iter().enumerate() {
        let least = if i == 0 {
            0
        } else {
            units[i - 1].saturating_add(least_units(cumulated, i))
        };
        units.push(((c / total * f64::from(WHOLE)).round() as u16).max(least));
    }
    // Step 2: units that were added beyond the whole near the end are taken back from the largest pieces before it.
    let mut most = WHOLE;
    for i in (1..units.len()).rev() {
        units[i] = units[i].min(most);
        most = most.saturating_sub(least_units(cumulated, i));
    }
    debug_assert!(units.is_sorted());
    units
}

/// The least units of the piece that ends at value `i`: 1 if it has mass, else 0.
fn least_units(cumulated: &[f64], i: usize) -> u16 {
    u16::from(cumulated[i] > cumulated[i - 1])
}

/// Sums of the first 0, 1, 2 … of `masses`: one more than there are.
///
/// See [`Curves`](crate::distribution::Curves) for an example.
pub fn cumulated(masses: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut sum = 0.0;
    let sums = masses.into_iter().map(|mass| {
        sum += mass;
        sum
    });
    std::iter::once(0.0).chain(sums).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn three() -> Curves {
        let mut curves = Curves::new();
        curves.push(&[0.0, 0.0, 1.0, 1.0, 4.0, 4.0], Some(&[0, 1, 3, 4, 5]));
        curves.push(&[0.0; 6], Some(&[0, 5]));
        curves.push(&[0.0, 2.0, 2.0, 2.0, 2.0, 2.0], Some(&[0, 1, 5]));
        curves
    }

    #[test]
    fn finding_skips_pieces_without_mass() {
        let c = three();
        let first = c.find(0, 0.0);
        assert_eq!(
            (first.index, first.x0, first.x1, first.c0),
            (1, 1.0, 3.0, 0.0)
        );
        assert!((first.c1 - 0.25).abs() < 1e-5);
        assert_eq!(c.find(0, 0.25001).index, 2);
        assert_eq!(c.find(0, 1.0f64.next_down()).c1, 1.0);
        assert_eq!(c.find(2, 0.99999).x1, 1.0);
        assert!(c.is_void(1) && !c.is_void(0));
    }

    #[test]
    fn positions_are_found_in_their_pieces() {
        let c = three();
        for (x, index) in [
            (0.0, 0),
            (0.99, 0),
            (1.0, 1),
            (2.9, 1),
            (3.0, 2),
            (4.5, 3),
            (5.0, 3),
            (9.0, 3),
        ] {
            assert_eq!(c.find_segment(0, x).index, index, "{x}");
        }
        let mut uniform = Curves::new();
        uniform.push(&[0.0, 1.0, 2.0], None);
        assert!((uniform.find_segment(0, 1.5).c0 - 0.5).abs() < 1e-5);
        assert_eq!(uniform.find_segment(0, 7.0).index, 1);
    }
    /// Masses over eighteen orders of magnitude, none lost and none where there was none.
    #[test]
    fn every_piece_with_mass_keeps_some() {
        let masses: Vec<f64> = (0..2000)
            .map(|i| {
                if i % 7 == 3 {
                    0.0
                } else {
                    10f64.powi(-(i * 37 % 19))
                }
            })
            .collect();
        let mut sum = 0.0;
        let mut cumulated = vec![0.0];
        // Tiny masses after huge ones vanish in the sum, and with it from the curve.
        cumulated.extend(masses.iter().map(|m| {
            sum += m;
            sum
        }));
        for reversed in [false, true] {
            if reversed {
                cumulated = cumulated.iter().rev().map(|c| sum - c).collect();
            }
            let mut curves = Curves::new();
            curves.push(&cumulated, None);
            assert_eq!((curves.cdf[0], curves.cdf[2000]), (0, WHOLE));
            for i in 0..2000 {
                let (rises, mass) = (
                    curves.cdf[i + 1] > curves.cdf[i],
                    cumulated[i + 1] > cumulated[i],
                );
                assert_eq!(rises, mass, "piece {i}");
                assert!(curves.cdf[i + 1] >= curves.cdf[i]);
                let error = f64::from(curves.cdf[i]) * PROBABILITY - cumulated[i] / sum;
                assert!(error.abs() < 2000.0 * PROBABILITY, "knot {i}: {error}");
            }
        }
    }

    /// CurveSearches of one curve at many numbers, together and one by one.
    fn assert_searches_side_by_side(curves: &Curves, grid: usize) {
        let x: Vec<f64> = (0..4 * grid).map(|i| i as f64 / 4.0).collect();
        let u: Vec<f64> = x.iter().map(|x| x / grid as f64).collect();
        let same = vec![0; x.len()];
        let mut pieces = vec![Segment::default(); x.len()];
        curves.find_each(&same, &u, &mut pieces);
        for (piece, &u) in pieces.iter().zip(&u) {
            assert_eq!(*piece, curves.find(0, u));
        }
        curves.find_each_segment(&same, &x, &mut pieces);
        for (piece, &x) in pieces.iter().zip(&x) {
            assert_eq!(*piece, curves.find_segment(0, x));
        }
    }

    #[test]
    fn searches_agree_with_counting() {
        for knots in 2..70usize {
            let grid = 3 * knots;
            let positions: Vec<usize> = (0..knots)
                .map(|i| if i + 1 == knots { grid } else { 3 * i })
                .collect();
            let cumulated: Vec<f64> = (0..=grid).map(|i| (i as f64).powf(1.7)).collect();
            let mut curves = Curves::new();
            curves.push(&cumulated, Some(&positions));
            for i in 0..4 * grid {
                let x = i as f64 / 4.0;
                let by_count = positions.iter().filter(|&&p| p as f64 <= x).count() - 1;
                assert_eq!(
                    curves.find_segment(0, x).index,
                    by_count,
                    "{knots} knots, {x}"
                );
                let u = x / grid as f64;
                let s = curves.find(0, u);
                assert!(
                    s.c0 <= u && u < s.c1 + 1e-12 && s.c1 > s.c0,
                    "{knots} knots, {u}: {s:?}"
                );
            }
            assert_searches_side_by_side(&curves, grid);
        }
    }
}
