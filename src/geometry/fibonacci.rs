//! Points that cover a square evenly along both of its axes.

/// A Fibonacci lattice in the unit square.
///
/// Its points project to equidistant midpoints on both axes, so that a density that jumps along either axis is integrated
/// to 1/size, where a grid of as many points reaches only 1/√size (Niederreiter 1992, §5).
///
/// The example of [`Quadrature`](crate::geometry::Quadrature) integrates over the hemisphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FibonacciLattice {
    size: u64,
    generator: u64,
}

impl FibonacciLattice {
    /// The smallest Fibonacci lattice of at least `points` points (at least two, at most about 10⁹).
    pub fn at_least(points: usize) -> Self {
        let mut lattice = Self {
            size: 2,
            generator: 1,
        };
        while lattice.size < (points as u64).min(1 << 30) {
            // (F(k), F(k − 1)) is followed by (F(k + 1), F(k)).
            lattice = Self {
                size: lattice.size + lattice.generator,
                generator: lattice.size,
            };
        }
        lattice
    }

    /// Number of points.
    pub fn size(self) -> usize {
        self.size as usize
    }

    /// The points, both coordinates strictly inside (0, 1).
    pub fn points(self) -> impl Iterator<Item = (f64, f64)> {
        // For n = F(k), point i is ((i + ½)/n, ((i·F(k − 1) mod n) + ½)/n).
        let scale = 1.0 / self.size as f64;
        (0..self.size).map(move |i| {
            let column = i * self.generator % self.size;
            (midpoint(i, scale), midpoint(column, scale))
        })
    }
}

/// The middle of interval `i` of width `scale`.
#[inline(always)]
fn midpoint(i: u64, scale: f64) -> f64 {
    (i as f64 + 0.5) * scale
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lattices_project_to_midpoints() {
        let lattice = FibonacciLattice::at_least(89);
        assert_eq!(lattice.size(), 89);
        let mut second: Vec<f64> = lattice.points().map(|p| p.1).collect();
        second.sort_by(f64::total_cmp);
        for (i, y) in second.iter().enumerate() {
            assert!((y - (i as f64 + 0.5) / 89.0).abs() < 1e-12);
        }
    }
}
