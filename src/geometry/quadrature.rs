//! Integrals over `wi` for a fixed `wo`, on half vectors aligned with MERL's bins.
//!
//! A lobe a tenth of a degree wide and a table that jumps at every bin edge defeat a grid over (θ, φ) of `wi`. Here the
//! range of θh is cut at MERL's bin edges, where measured tables jump, and at the two angles where the horizon begins to cut
//! the azimuths and where it ends them; dσ(wi) = 4 (wo·h) dσ(h). Each piece carries a Fibonacci lattice over θh and
//! azimuth; the azimuth covers exactly the range that reflects above the horizon.
//!
//! Convergence, with n points a bin and some 60 to 90 bins, θo from 0 to 89°: ∫cosθ/π dσ = 1 to 2·10⁻⁴ at n = 34, 8·10⁻⁶ at
//! 233, 2·10⁻⁶ at 987 and 7·10⁻⁷ at 2584. Densities that jump inside a bin converge as n⁻¹. The difference from a
//! quadrature of fewer points is a measure of the error.

use std::f64::consts::PI;

use glam::Vec3;

use super::merl_axes::{THETA_H_BINS, theta_h_edge};
use super::{FibonacciLattice, HalfVectorDomain};

/// Points a bin that settle the albedo of every embedded material to 10⁻⁴ and better.
///
/// The example of [`Quadrature`](crate::geometry::Quadrature) integrates over the hemisphere.
pub const POINTS_PER_BIN: usize = 987;

/// Nodes and weights over the directions `wi` above the horizon, for one `wo`.
///
/// # Examples
/// ```
/// use merlkit::geometry::{POINTS_PER_BIN, Quadrature};
/// use merlkit::glam::Vec3;
///
/// // ∫ cosθ dσ over the hemisphere is π.
/// let quadrature = Quadrature::new(Vec3::Z, POINTS_PER_BIN);
/// let integral = quadrature.integrate(|wi| f64::from(wi.z));
/// assert!((integral - std::f64::consts::PI).abs() < 1e-3);
/// ```
#[derive(Clone, Debug)]
pub struct Quadrature {
    wo: Vec3,
    domain: Option<HalfVectorDomain>,
    pieces: Vec<Piece>,
    lattice: FibonacciLattice,
}

impl Quadrature {
    /// Nodes about `wo`, with at least `points_per_bin` in each bin of θh (rounded up to a Fibonacci number).
    ///
    /// For a `wo` that is not finite or not above the horizon there are no nodes, and every integral is 0.
    pub fn new(wo: Vec3, points_per_bin: usize) -> Self {
        let domain = HalfVectorDomain::new(wo);
        let pieces = domain.as_ref().map(pieces).unwrap_or_default();
        Self {
            wo,
            domain,
            pieces,
            lattice: FibonacciLattice::at_least(points_per_bin),
        }
    }

    /// The given direction.
    pub fn wo(&self) -> Vec3 {
        self.wo
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.pieces.len() * self.lattice.size()
    }

    /// ∫ `value(wi)` dσ(wi), with more points in the bins of θh that need them: in each bin where two lattices in a row
    /// disagree, finer ones are taken, until the differences of all bins add up to at most `tolerance` of the integral.
    ///
    /// The points per bin run from 21 to 10,946; the number that this quadrature was made with has no effect. For values ≥ 0 from a measured table
    /// the error is a tenth of `tolerance`. Where values are noise two lattices can agree by chance, so a quarter of the
    /// difference before the last counts too.
    pub fn integrate_refined(&self, tolerance: f64, mut value: impl FnMut(Vec3) -> f64) -> f64 {
        let Some(domain) = &self.domain else {
            return 0.0;
        };
        // Step 1: the coarsest lattice in each bin; its error is unknown.
        let mut states = Vec::with_capacity(self.pieces.len());
        for piece in &self.pieces {
            states.push(State::first(piece.integrate(domain, 0, &mut value)));
        }
        // Step 2: the next finer lattice in the bins whose error exceeds an equal part of what is allowed, until
        // Σ errors ≤ tolerance · |Σ values|, or no bin has a finer lattice left.
        loop {
            let total: f64 = states.iter().map(|s| s.value).sum();
            let error: f64 = states.iter().map(|s| s.error).sum();
            let allowed = tolerance * total.abs() / states.len().max(1) as f64;
            let mut settled = error <= tolerance * total.abs();
            if !settled {
                settled = true;
                for (piece, state) in self.pieces.iter().zip(&mut states) {
                    if state.error > allowed && state.level + 1 < LEVELS.len() {
                        let finer = piece.integrate(domain, state.level + 1, &mut value);
                        *state = state.refined(finer);
                        settled = false;
                    }
                }
            }
            if settled {
                return total;
            }
        }
    }

    /// Calls `visit(wi, d_sigma)` at every node: a unit direction above the horizon and the solid angle that it represents, in sr.
    pub fn for_each(&self, mut visit: impl FnMut(Vec3, f64)) {
        let Some(domain) = &self.domain else {
            return;
        };
        for piece in &self.pieces {
            piece.for_each(domain, self.lattice, &mut visit);
        }
    }

    /// ∫ `value(wi)` dσ(wi) over the directions above the horizon.
    pub fn integrate(&self, mut value: impl FnMut(Vec3) -> f64) -> f64 {
        let mut sum = 0.0;
        self.for_each(|wi, d_sigma| sum += value(wi) * d_sigma);
        sum
    }
}

/// How far the refined integral over a piece has come.
struct State {
    level: usize,
    value: f64,
    /// Difference from the level before.
    difference: f64,
    error: f64,
}

impl State {
    fn first(value: f64) -> Self {
        Self {
            level: 0,
            value,
            difference: value.abs(),
            error: f64::INFINITY,
        }
    }

    fn refined(&self, value: f64) -> Self {
        let difference = (value - self.value).abs();
        Self {
            level: self.level + 1,
            value,
            difference,
            error: difference.max(0.25 * self.difference),
        }
    }
}

/// A range of θh and how the unit interval covers it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    low: f64,
    high: f64,
    spacing: Spacing,
    /// Nodes keep this far from both ends: nearer, the rounding of `wi` to f32 may carry them across an edge where values jump.
    margin: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Spacing {
    /// Uniform in θh², that is in area: about the pole.
    Area,
    /// Uniform in √θh, as MERL's bins.
    Root,
    /// Dense at both ends, where the range of azimuths opens or closes as a square root.
    Ends,
}

/// Points per bin of the refined integral.
const LEVELS: [usize; 7] = [21, 55, 144, 377, 987, 2584, 10_946];

impl Piece {
    /// Calls `visit(wi, d_sigma)` at every point of the lattice.
    #[inline]
    fn for_each(
        &self,
        domain: &HalfVectorDomain,
        lattice: FibonacciLattice,
        mut visit: impl FnMut(Vec3, f64),
    ) {
        // The azimuth coordinate runs over [−1, 1]: twice the unit square.
        let weight = 2.0 / lattice.size() as f64;
        for (s, t) in lattice.points() {
            let (theta_h, slope) = self.theta_h(s);
            let inside = theta_h.clamp(self.low + self.margin, self.high - self.margin);
            let (wi, jacobian) = domain.direction(inside, 2.0 * t - 1.0);
            visit(wi, jacobian * slope * weight);
        }
    }

    /// ∫ `value(wi)` dσ(wi) over the range by the lattice of a level.
    #[inline]
    fn integrate(
        &self,
        domain: &HalfVectorDomain,
        level: usize,
        value: &mut impl FnMut(Vec3) -> f64,
    ) -> f64 {
        let mut sum = 0.0;
        let lattice = FibonacciLattice::at_least(LEVELS[level]);
        self.for_each(domain, lattice, |wi, d_sigma| sum += value(wi) * d_sigma);
        sum
    }

    /// θh at `t` in (0, 1), and dθh/dt.
    pub(super) fn theta_h(&self, t: f64) -> (f64, f64) {
        debug_assert!((0.0..=1.0).contains(&t));
        match self.spacing {
            Spacing::Area => {
                // θh = high·√t: rings of equal area about the pole, as far as sin θh = θh.
                let root = t.sqrt();
                (self.high * root, 0.5 * self.high / root)
            }
            Spacing::Root => {
                // √θh = a + (b − a)t, so dθh/dt = 2√θh (b − a).
                let (a, b) = (self.low.sqrt(), self.high.sqrt());
                let s = a + (b - a) * t;
                (s * s, 2.0 * s * (b - a))
            }
            Spacing::Ends => {
                // θh = low + ½(high − low)(1 − cos πt). Its slope is 0 at both ends, which smooths the square roots of φmax there.
                let half = 0.5 * (self.high - self.low);
                let (sin, cos) = (PI * t).sin_cos();
                (self.low + half * (1.0 - cos), half * PI * sin)
            }
        }
    }
}

/// MERL's bins within the domain, cut where the horizon first cuts the azimuths.
fn pieces(domain: &HalfVectorDomain) -> Vec<Piece> {
    let cut = domain.theta_full();
    let end = domain.theta_max();
    let mut edges = vec![cut, end];
    for edge in (0..=THETA_H_BINS).map(theta_h_edge) {
        if edge < end {
            edges.push(edge);
        }
    }
    edges.sort_by(f64::total_cmp);
    edges.dedup();
    debug_assert!(edges.is_sorted_by(|a, b| a < b));
    let mut pieces = Vec::with_capacity(edges.len() - 1);
    for pair in edges.windows(2) {
        pieces.push(piece(pair[0], pair[1], cut, end));
    }
    pieces
}

pub(super) fn piece(low: f64, high: f64, cut: f64, end: f64) -> Piece {
    let spacing = if low == 0.0 {
        Spacing::Area
    } else if low == cut || high == end {
        Spacing::Ends
    } else {
        Spacing::Root
    };
    // Components of wi are rounded by up to 3·10⁻⁸, and the half vector by that over |wo + wi| = 2 wo·h.
    let rounding = 6e-8 / end.mul_add(-2.0, PI).sin().max(1e-9);
    let margin = rounding.min((high - low) / 64.0);
    Piece {
        low,
        high,
        spacing,
        margin,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{half_vector, spherical};
    use std::f64::consts::FRAC_1_PI;

    const ANGLES: [f64; 9] = [0.0, 0.76, 14.5, 29.75, 45.0, 60.25, 75.5, 84.7, 89.0];

    fn wo(theta: f64) -> Vec3 {
        spherical(theta.to_radians(), 0.6).as_vec3()
    }

    #[test]
    fn cosine_density_integrates_to_one() {
        for theta in ANGLES {
            let sum = Quadrature::new(wo(theta), 233).integrate(|wi| f64::from(wi.z) * FRAC_1_PI);
            assert!((sum - 1.0).abs() < 1e-5, "{theta}°: {sum}");
        }
    }

    #[test]
    fn hemisphere_has_two_pi_steradians() {
        for theta in ANGLES {
            let sum = Quadrature::new(wo(theta), POINTS_PER_BIN).integrate(|_| 1.0);
            assert!((sum / (2.0 * PI) - 1.0).abs() < 2e-5, "{theta}°: {sum}");
        }
    }

    /// (n+1)/2π·cosⁿθh/(4 wo·h) is the density of a lobe of half vectors: its mass above the horizon is 1 minus a tail of
    /// cosⁿ⁺¹ at the angle where the horizon begins to cut.
    #[test]
    fn sharp_lobe_of_half_vectors_integrates_to_one() {
        for (theta, exponent) in [
            (0.76, 1e5),
            (29.75, 1e6),
            (60.25, 1e4),
            (75.5, 3e5),
            (84.7, 1e6),
        ] {
            let wo = wo(theta);
            let exact = wo.as_dvec3();
            let sum = Quadrature::new(wo, 233).integrate(|wi| {
                let h = half_vector(exact, wi.as_dvec3()).unwrap();
                let tan2 = (h.x * h.x + h.y * h.y) / (h.z * h.z);
                let lobe = (-0.5 * exponent * tan2.ln_1p()).exp();
                (exponent + 1.0) * 0.5 * FRAC_1_PI * lobe / (4.0 * exact.dot(h))
            });
            assert!((sum - 1.0).abs() < 1e-5, "{theta}°, n = {exponent}: {sum}");
        }
    }

    #[test]
    fn invalid_directions_integrate_to_zero() {
        for wo in [Vec3::NAN, -Vec3::Z, Vec3::X, Vec3::ZERO] {
            let quadrature = Quadrature::new(wo, 34);
            assert_eq!(quadrature.nodes(), 0);
            assert_eq!(quadrature.integrate(|_| 1.0), 0.0);
        }
    }
}
