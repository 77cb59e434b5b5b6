//! The probability of each cell of a grid over half vectors, integrated from a pdf with an error that can be relied on.
//!
//! Lattices that agree prove nothing about a spike that all of them miss. Here a cell is cut into strata of two random points
//! each. The mean of both is an unbiased estimate, whose variance the difference of both estimates without bias, jump or not
//! (Cochran 1977, 5A.12); the strata that differ most are cut further. A spike between the points is found by where draws fell
//! and by half vectors next to the mirror direction: a stratum in which one of those has a density far above that of both points
//! counts as uncertain by as much, and is cut until it is resolved. The strata so found are then integrated by points of their own.

use glam::Vec3;

use merlkit::direction_sampler::DirectionSampler;
use merlkit::geometry::{HalfVectorDomain, is_upper};
use merlkit::points::{Stream, mix};

/// A grid over the half vectors about `wo`: uniform in √θh and in the fraction of the azimuth, both odd so that no cell edge
/// falls on the plane of symmetry.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    pub domain: HalfVectorDomain,
    pub theta_cells: usize,
    pub phi_cells: usize,
}

/// Mass of a cell, and the standard error of it.
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

/// A direction whose density is known, by its place within a cell, each coordinate in [0, 1].
#[derive(Clone, Copy, Debug)]
pub(super) struct Witness {
    pub at: [f64; 2],
    pub pdf: f64,
}

impl Grid {
    /// Number of cells; cell `theta * phi_cells + phi`.
    pub fn len(&self) -> usize {
        self.theta_cells * self.phi_cells
    }

    /// The cell of a direction above the horizon, and the place within it.
    pub fn locate(&self, wi: Vec3) -> (usize, [f64; 2]) {
        let (theta_h, b) = self.domain.coordinates(wi);
        let s = (theta_h / self.domain.theta_max()).sqrt();
        let index = |x: f64, cells: usize| {
            let x = x * cells as f64;
            let index = (x as usize).min(cells - 1);
            (index, x - index as f64)
        };
        let (i, x) = index(s, self.theta_cells);
        let (j, y) = index(0.5 * (b + 1.0), self.phi_cells);
        (i * self.phi_cells + j, [x, y])
    }

    /// The direction at a place within a cell, and dσ(wi) per unit of the place.
    pub fn direction(&self, cell: usize, at: [f64; 2]) -> (Vec3, f64) {
        let ([theta_low, theta_high], [b_low, b_high]) = self.ranges(cell);
        let low = theta_low.sqrt();
        let step = theta_high.sqrt() - theta_low.sqrt();
        let root = low + step * at[0];
        let (wi, jacobian) = self
            .domain
            .direction(root * root, b_low + (b_high - b_low) * at[1]);
        (wi, jacobian * 2.0 * root * step * (b_high - b_low))
    }

    /// Solid angle of a cell in sr, by midpoints: to a part in a thousand.
    pub fn solid_angle(&self, cell: usize) -> f64 {
        let mut sum = 0.0;
        for k in 0..SIDE * SIDE {
            let middle = |i: usize| (i as f64 + 0.5) / SIDE as f64;
            sum += self.direction(cell, [middle(k % SIDE), middle(k / SIDE)]).1;
        }
        sum / (SIDE * SIDE) as f64
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

/// Strata along each side of a cell to begin with.
const SIDE: usize = 6;
/// Most evaluations of the pdf in one cell.
const BUDGET: usize = 20_000;
/// The part of a cell's statistical deviation that its integral may be off by.
const GOAL: f64 = 0.1;
/// The part of a cell's statistical deviation that one stratum may hold.
const MOST_MASS: f64 = 0.5;
/// A witness is taken for a part of a spike where its density is this many times that of both points.
const STANDS_OUT: f64 = 4.0;
/// Half vectors next to the mirror direction that are looked at, at angles that halve each time from 1° down.
const NEAR_MIRROR: [usize; 2] = [24, 5];

/// Integrates `sampler.pdf` over each cell until the error is small against the noise of `draws` draws, or the budget is spent;
/// what error remains is for the test to allow for. `witnesses` holds draws of each cell.
pub(super) fn expected(
    sampler: &dyn DirectionSampler,
    wo: Vec3,
    grid: &Grid,
    draws: usize,
    mut witnesses: Vec<Vec<Witness>>,
) -> Expected {
    for (cell, witness) in near_mirror(sampler, wo, grid) {
        witnesses[cell].push(witness);
    }
    let mut unusable = 0;
    let cells = witnesses
        .iter()
        .enumerate()
        .map(|(cell, witnesses)| {
            let heights = witnesses
                .iter()
                .map(|w| (w.at, w.pdf * grid.direction(cell, w.at).1))
                .collect();
            let mut integral = CellIntegral {
                sampler,
                wo,
                grid,
                cell,
                heights,
                stream: Stream::new(mix(cell as u64)),
                unusable: 0,
                evaluations: 0,
            };
            let mass = integral.refine(draws);
            unusable += integral.unusable;
            mass
        })
        .collect();
    Expected { cells, unusable }
}

/// Densities next to the mirror direction, where highlights are and formulas divide by zero.
fn near_mirror(sampler: &dyn DirectionSampler, wo: Vec3, grid: &Grid) -> Vec<(usize, Witness)> {
    let mut found = Vec::new();
    for ring in 0..NEAR_MIRROR[0] {
        for turn in 0..NEAR_MIRROR[1] {
            let theta = 1f64.to_radians() * 0.5f64.powi(ring as i32);
            let azimuth = 2.0 * (turn as f64 + 0.3) / NEAR_MIRROR[1] as f64 - 1.0;
            if theta >= grid.domain.theta_max() {
                continue;
            }
            let (wi, _) = grid.domain.direction(theta, azimuth);
            let pdf = f64::from(sampler.pdf(wo, wi));
            if is_upper(wi) && pdf > 0.0 && pdf.is_finite() {
                let (cell, at) = grid.locate(wi);
                found.push((cell, Witness { at, pdf }));
            }
        }
    }
    found
}

/// A rectangle of a cell with two random points.
#[derive(Clone, Copy)]
struct Stratum {
    low: [f64; 2],
    /// Its sides are 1/`parts` of those of the cell.
    parts: f64,
    value: f64,
    variance: f64,
}

/// The integral over one cell.
struct CellIntegral<'a> {
    sampler: &'a dyn DirectionSampler,
    wo: Vec3,
    grid: &'a Grid,
    cell: usize,
    /// Places of the witnesses, and their densities per unit of the cell.
    heights: Vec<([f64; 2], f64)>,
    stream: Stream,
    unusable: usize,
    evaluations: usize,
}

impl CellIntegral<'_> {
    fn refine(&mut self, draws: usize) -> Mass {
        let mut strata = Vec::with_capacity(SIDE * SIDE);
        self.divide([0.0; 2], SIDE, SIDE as f64, &mut strata);
        loop {
            let value: f64 = strata.iter().map(|s| s.value).sum();
            let variance: f64 = strata.iter().map(|s| s.variance).sum();
            // Cells of less than one expected draw are pooled; they need no more digits than a cell of one.
            let deviation2 = (value / draws as f64).max(1.0 / (draws as f64).powi(2));
            let goal = GOAL * GOAL * deviation2;
            // Two points that agree by chance, both within a spike that covers half of a stratum, hide an error of all its mass.
            let most = MOST_MASS * deviation2.sqrt();
            let is_fine = strata.iter().all(|s| s.value <= most);
            if (variance <= goal && is_fine) || self.evaluations >= BUDGET {
                return self.afresh(&strata);
            }
            // What all strata may keep adds up to less than the goal, so that one of them at least is cut.
            let allowed = 0.5 * goal / strata.len() as f64;
            let mut finer = Vec::with_capacity(2 * strata.len());
            for stratum in strata {
                let is_coarse = stratum.variance > allowed || stratum.value > most;
                if is_coarse && self.evaluations < BUDGET {
                    self.divide(stratum.low, 2, 2.0 * stratum.parts, &mut finer);
                } else {
                    finer.push(stratum);
                }
            }
            strata = finer;
        }
    }

    /// The integral by new points in strata that others led to. What decided where to stop is no longer fair: strata that were left
    /// whole are those whose points agreed, if only by chance. Of both variances the larger counts.
    fn afresh(&mut self, strata: &[Stratum]) -> Mass {
        let (mut value, mut variance) = (0.0, 0.0);
        for old in strata {
            let new = self.stratum(old.low, old.parts);
            value += new.value;
            variance += new.variance.max(old.variance);
        }
        Mass {
            value,
            error: variance.sqrt(),
        }
    }

    /// Adds `side`² strata of sides 1/`parts` from the corner `low` on.
    fn divide(&mut self, low: [f64; 2], side: usize, parts: f64, strata: &mut Vec<Stratum>) {
        for k in 0..side * side {
            let corner = [
                low[0] + (k % side) as f64 / parts,
                low[1] + (k / side) as f64 / parts,
            ];
            let stratum = self.stratum(corner, parts);
            strata.push(stratum);
        }
    }

    fn stratum(&mut self, low: [f64; 2], parts: f64) -> Stratum {
        let area = 1.0 / (parts * parts);
        let points = [
            self.random_density(low, parts),
            self.random_density(low, parts),
        ];
        let half = 0.5 * area * (points[0] - points[1]);
        let mut variance = half * half;
        let highest = self.highest_witness(low, parts);
        if highest > STANDS_OUT * points[0].max(points[1]) {
            variance = variance.max((0.5 * area * highest).powi(2));
        }
        Stratum {
            low,
            parts,
            value: 0.5 * area * (points[0] + points[1]),
            variance,
        }
    }

    /// The highest density of a witness in a stratum, per unit of the cell.
    fn highest_witness(&self, low: [f64; 2], parts: f64) -> f64 {
        let mut highest = 0.0f64;
        for &(at, height) in &self.heights {
            let is_inside = at[0] >= low[0]
                && at[0] < low[0] + 1.0 / parts
                && at[1] >= low[1]
                && at[1] < low[1] + 1.0 / parts;
            if is_inside {
                highest = highest.max(height);
            }
        }
        highest
    }

    /// The density per unit of the cell at a random place of a stratum; 0 below the horizon and where it is unusable.
    fn random_density(&mut self, low: [f64; 2], parts: f64) -> f64 {
        let at = low.map(|low| low + self.stream.next_f64() / parts);
        let (wi, change) = self.grid.direction(self.cell, at);
        self.evaluations += 1;
        let pdf = f64::from(self.sampler.pdf(self.wo, wi));
        if !(pdf >= 0.0 && pdf.is_finite()) {
            self.unusable += 1;
            return 0.0;
        }
        if is_upper(wi) { pdf * change } else { 0.0 }
    }
}
