//! Many piecewise-linear CDFs in three arrays.

/// A piece of a CDF: x from `x0` to `x1`, probability from `c0` to `c1`.
#[derive(Clone, Copy, Debug, PartialEq)]
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

/// CDF curves over the grid 0, 1 … n, each with its own knots at grid positions, or all with a knot at every position.
///
/// A curve rises from 0 to 1 and never falls. One that is 0 everywhere stands for an empty distribution.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curves {
    /// Start of each curve in the arrays below, and their length at the end.
    pub starts: Vec<u32>,
    /// Knots' grid positions; empty if every curve has a knot at every position.
    pub positions: Vec<u16>,
    /// Probability below each knot.
    pub cdf: Vec<f32>,
}

impl Curves {
    /// No curves yet.
    pub fn new() -> Self {
        Self { starts: vec![0], positions: Vec::new(), cdf: Vec::new() }
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
    /// `cumulated` starts at 0 and never falls. All curves of one set must be given knots, or none.
    pub fn push(&mut self, cumulated: &[f64], knots: Option<&[usize]>) {
        let total = cumulated.last().copied().unwrap_or(0.0);
        let scale = if total > 0.0 { 1.0 / total } else { 0.0 };
        match knots {
            Some(knots) => {
                self.positions.extend(knots.iter().map(|&k| k as u16));
                self.cdf.extend(knots.iter().map(|&k| (cumulated[k] * scale) as f32));
            }
            None => self.cdf.extend(cumulated.iter().map(|c| (c * scale) as f32)),
        }
        self.starts.push(self.cdf.len() as u32);
    }

    /// Adds copies of all curves of `more`.
    pub fn append(&mut self, more: &Self) {
        let offset = self.cdf.len() as u32;
        self.starts.extend(more.starts.iter().skip(1).map(|s| s + offset));
        self.positions.extend_from_slice(&more.positions);
        self.cdf.extend_from_slice(&more.cdf);
    }

    /// Pieces of curve `curve`.
    pub fn segments(&self, curve: usize) -> usize {
        (self.starts[curve + 1] - self.starts[curve]).saturating_sub(1) as usize
    }

    /// Whether curve `curve` has no mass.
    #[inline]
    pub fn is_void(&self, curve: usize) -> bool {
        let end = self.starts[curve + 1] as usize;
        end == self.starts[curve] as usize || self.cdf[end - 1] <= 0.0
    }

    /// The piece of curve `curve` in which the probability passes `u` in [0, 1); it has mass. The curve must not be void.
    #[inline]
    pub fn find(&self, curve: usize, u: f64) -> Segment {
        let range = self.starts[curve] as usize..self.starts[curve + 1] as usize;
        let cdf = &self.cdf[range.clone()];
        // Floats that are not negative rise with their bits, which compare in half the time.
        let bits = round_down(u).to_bits();
        let index = cdf.partition_point(|&c| c.to_bits() <= bits).clamp(1, cdf.len() - 1) - 1;
        self.piece(range.start, index)
    }

    /// The piece of curve `curve` that holds grid coordinate `x` ≥ 0; the last one past the end.
    #[inline]
    pub fn at(&self, curve: usize, x: f64) -> Segment {
        let range = self.starts[curve] as usize..self.starts[curve + 1] as usize;
        let last = range.len() - 2;
        let index = if self.positions.is_empty() {
            (x as usize).min(last)
        } else {
            let floor = x as u16;
            self.positions[range.clone()].partition_point(|&p| p <= floor).saturating_sub(1).min(last)
        };
        self.piece(range.start, index)
    }

    /// Piece `index` of curve `curve`.
    pub fn segment(&self, curve: usize, index: usize) -> Segment {
        self.piece(self.starts[curve] as usize, index)
    }

    #[inline]
    fn piece(&self, start: usize, index: usize) -> Segment {
        let i = start + index;
        let (x0, x1) = if self.positions.is_empty() {
            (index as f64, (index + 1) as f64)
        } else {
            (f64::from(self.positions[i]), f64::from(self.positions[i + 1]))
        };
        Segment { index, x0, x1, c0: f64::from(self.cdf[i]), c1: f64::from(self.cdf[i + 1]) }
    }
}

/// The largest `f32` not above `u`, which is in [0, 1). Every other number rounds up, so there is no branch to guess.
#[inline]
fn round_down(u: f64) -> f32 {
    let near = u as f32;
    f32::from_bits(near.to_bits() - u32::from(f64::from(near) > u))
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
        assert_eq!(c.find(0, 0.0), Segment { index: 1, x0: 1.0, x1: 3.0, c0: 0.0, c1: 0.25 });
        assert_eq!(c.find(0, 0.25).index, 2);
        assert_eq!(c.find(0, 1.0f64.next_down()).c1, 1.0);
        assert_eq!(c.find(2, 0.99999).x1, 1.0);
        assert!(c.is_void(1) && !c.is_void(0));
    }

    #[test]
    fn positions_are_found_in_their_pieces() {
        let c = three();
        for (x, index) in [(0.0, 0), (0.99, 0), (1.0, 1), (2.9, 1), (3.0, 2), (4.5, 3), (5.0, 3), (9.0, 3)] {
            assert_eq!(c.at(0, x).index, index, "{x}");
        }
        let mut uniform = Curves::new();
        uniform.push(&[0.0, 1.0, 2.0], None);
        assert_eq!(uniform.at(0, 1.5).c0, 0.5);
        assert_eq!(uniform.at(0, 7.0).index, 1);
    }
}
