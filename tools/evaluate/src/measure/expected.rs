//! The probability of each cell of a grid over half vectors, integrated from a pdf to a known error.

use glam::Vec3;

use merlkit::direction_sampler::DirectionSampler;
use merlkit::geometry::{FibonacciLattice, HalfVectorDomain, is_upper};

/// A grid over the half vectors about `wo`: uniform in √θh and in the share of the azimuth, both odd so that no cell edge
/// falls on the plane of symmetry.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    pub domain: HalfVectorDomain,
    pub theta_cells: usize,
    pub phi_cells: usize,
}

/// Mass of a cell and how far off it may be.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Mass {
    pub value: f64,
    pub error: f64,
}

/// What the integration of a pdf over a grid found.
#[derive(Clone, Debug)]
pub(super) struct Expected {
    pub cells: Vec<Mass>,
    /// Nodes whose pdf is NaN, infinite or negative.
    pub unusable: usize,
}

impl Grid {
    /// Number of cells; cell `theta * phi_cells + phi`.
    pub fn len(&self) -> usize {
        self.theta_cells * self.phi_cells
    }

    /// The cell of a direction above the horizon.
    pub fn cell(&self, wi: Vec3) -> usize {
        let (theta_h, b) = self.domain.coordinates(wi);
        let s = (theta_h / self.domain.theta_max()).sqrt();
        let index = |x: f64, cells: usize| ((x * cells as f64) as usize).min(cells - 1);
        index(s, self.theta_cells) * self.phi_cells + index(0.5 * (b + 1.0), self.phi_cells)
    }

    /// Ranges of θh, radians, and of the azimuth's share in [−1, 1] of a cell.
    pub fn ranges(&self, cell: usize) -> ([f64; 2], [f64; 2]) {
        let (i, j) = (cell / self.phi_cells, cell % self.phi_cells);
        let theta =
            |i: usize| (i as f64 / self.theta_cells as f64).powi(2) * self.domain.theta_max();
        let share = |j: usize| 2.0 * j as f64 / self.phi_cells as f64 - 1.0;
        ([theta(i), theta(i + 1)], [share(j), share(j + 1)])
    }
}

/// Lattice sizes of successive attempts at a cell.
const ATTEMPTS: [usize; 6] = [55, 144, 377, 987, 2584, 6765];

/// Integrates `sampler.pdf` over each cell until the error is small against the noise of `draws` draws.
///
/// The error of a cell is the difference between the last two attempts, so an overestimate. Refinement stops below a fifth of
/// the cell's standard deviation or at the finest lattice; what error remains is for the test to allow for.
pub(super) fn expected(
    sampler: &dyn DirectionSampler,
    wo: Vec3,
    grid: &Grid,
    draws: usize,
) -> Expected {
    let mut unusable = 0;
    let cells = (0..grid.len())
        .map(|cell| refine(sampler, wo, grid, cell, draws, &mut unusable))
        .collect();
    Expected { cells, unusable }
}

fn refine(
    sampler: &dyn DirectionSampler,
    wo: Vec3,
    grid: &Grid,
    cell: usize,
    draws: usize,
    unusable: &mut usize,
) -> Mass {
    let mut coarse = integrate(
        sampler,
        wo,
        grid,
        cell,
        FibonacciLattice::at_least(ATTEMPTS[0]),
        unusable,
    );
    let mut mass = Mass {
        value: coarse,
        error: coarse,
    };
    for points in &ATTEMPTS[1..] {
        let value = integrate(
            sampler,
            wo,
            grid,
            cell,
            FibonacciLattice::at_least(*points),
            unusable,
        );
        mass = Mass {
            value,
            error: (value - coarse).abs(),
        };
        // Cells of less than one expected draw are pooled; they need no more digits than a cell of one.
        let deviation = (value / draws as f64)
            .max(1.0 / (draws as f64).powi(2))
            .sqrt();
        if mass.error <= 0.2 * deviation {
            break;
        }
        coarse = value;
    }
    mass
}

fn integrate(
    sampler: &dyn DirectionSampler,
    wo: Vec3,
    grid: &Grid,
    cell: usize,
    lattice: FibonacciLattice,
    unusable: &mut usize,
) -> f64 {
    let ([theta_low, theta_high], [b_low, b_high]) = grid.ranges(cell);
    let (low, step) = (theta_low.sqrt(), theta_high.sqrt() - theta_low.sqrt());
    let mut sum = 0.0;
    for (s, t) in lattice.points() {
        let root = low + step * s;
        let (wi, jacobian) = grid
            .domain
            .direction(root * root, b_low + (b_high - b_low) * t);
        let pdf = f64::from(sampler.pdf(wo, wi));
        if !(pdf >= 0.0 && pdf.is_finite()) {
            *unusable += 1;
        } else if is_upper(wi) {
            sum += pdf * jacobian * 2.0 * root;
        }
    }
    sum * step * (b_high - b_low) / lattice.size() as f64
}
