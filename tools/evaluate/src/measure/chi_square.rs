//! Chi-square: do draws fall where the pdf says?
//!
//! As in the tests of pbrt-v4 and Mitsuba 3: a fixed seed, cells under five expected draws pooled, a Šidák correction for
//! the number of tests, failed draws as a cell of their own, and failure on any draw where the pdf is zero beyond rounding.
//! Unlike those, the cells divide half vectors about `wo` and not directions, for a metal's lobe is narrower than a cell
//! of any affordable grid over the hemisphere.
//!
//! The pdf of a tabulated sampler jumps, so its integral over a cell is never exact. Each cell is integrated until the standard
//! error of that is a tenth of the cell's own deviation, and what remains is added to the cell's variance: an error of
//! integration makes the test weaker, not wrong. A cell whose integral is less certain than its count, and that does not
//! contradict the draws even so, is left out and counted as unjudged.

use glam::Vec3;
use statrs::function::gamma::checked_gamma_ur;

use super::expected::{Expected, Grid, Mass, Witness, expected};
use merlkit::direction_sampler::{DirectionSample, DirectionSampler};
use merlkit::geometry::{HalfVectorDomain, is_upper};
use merlkit::points::PointSet;

/// Cells of fewer expected draws are pooled.
const SMALLEST_EXPECTED: f64 = 5.0;
/// A cell whose integral is less certain than its count is judged all the same where both differ by this many deviations of
/// their difference: no error of the integral explains that.
const BEYOND_DOUBT: f64 = 5.0;
/// Draws of each cell whose densities help to integrate it.
const WITNESSES: usize = 64;
/// Worst cells kept for a failed test's message.
const WORST_CELLS: usize = 8;
/// Offset of the directions about a draw that tell rounding from a true zero of the pdf.
const ROUNDING: f32 = 2e-6;

/// A chi-square test, ready to run on any sampler and direction.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct ChiSquareTest {
    /// Number of draws.
    pub draws: usize,
    /// Cells in √θh over [0, (π/2 + θo)/2], at least 1.
    pub theta_cells: usize,
    /// Cells in the azimuth of the half vector over the range above the horizon, at least 1.
    pub phi_cells: usize,
    /// Chooses the draws.
    pub seed: u64,
    /// Probability that any of `tests` right samplers fails.
    pub significance: f64,
    /// How many tests share `significance`, at least 1.
    pub tests: usize,
}

impl Default for ChiSquareTest {
    fn default() -> Self {
        Self {
            draws: 100_000,
            theta_cells: 45,
            phi_cells: 15,
            seed: 1,
            significance: 0.01,
            tests: 1,
        }
    }
}

/// Why a test passed or failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ChiSquareVerdict {
    /// The draws are what the pdf makes likely.
    Pass,
    /// They are less likely than the threshold, or one cell alone is.
    Unlikely,
    /// Draws where the pdf is zero.
    Impossible,
    /// Draws that are no directions above the horizon, or a pdf that is NaN, infinite or negative.
    Unusable,
}

/// A cell that fits badly.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Cell {
    /// Range of θh, degrees; absent for the pool of small cells and for failed draws.
    pub theta_h_deg: Option<[f64; 2]>,
    /// Range of the azimuth of the half vector about `wo`, as a fraction of the largest above the horizon, in [−1, 1].
    pub azimuth_share: Option<[f64; 2]>,
    /// Draws that fell there.
    pub observed: u64,
    /// Draws that the pdf predicts.
    pub expected: f64,
    /// Contribution to the statistic.
    pub term: f64,
    /// Σ 1/pdf over the draws and by the number of draws, over the solid angle of the cell: 1 within noise where draws follow the
    /// pdf and it is positive, whatever its integral is taken for. Absent where `theta_h_deg` is.
    pub solid_angle_ratio: Option<f64>,
}

/// What a test found.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ChiSquare {
    /// Σ (observed − expected)² / variance.
    pub statistic: f64,
    /// Cells after pooling, minus one.
    pub degrees_of_freedom: usize,
    /// Probability of a statistic at least as large; 1 with a single cell, which can't disagree.
    pub p_value: f64,
    /// Smallest p-value that passes: the significance of one test after Šidák's correction.
    pub threshold: f64,
    /// The outcome.
    pub verdict: ChiSquareVerdict,
    /// Draws that failed (`None`).
    pub failed: u64,
    /// Cells whose integral is too uncertain to be judged by.
    pub unjudged: usize,
    /// Draws where the pdf is zero, there and at the neighbouring directions that rounding may reach.
    pub impossible: u64,
    /// Draws that are no unit directions above the horizon, and nodes where the pdf is NaN, infinite or negative.
    pub unusable: u64,
    /// ∫ pdf over the directions above the horizon.
    pub pdf_integral: f64,
    /// Error of `pdf_integral`, from independent errors of the cells.
    pub integral_error: f64,
    /// After a failure, the cells that fit worst, worst first.
    pub worst: Vec<Cell>,
}

/// Significance of one of `tests` tests such that all pass with probability 1 − `significance` (Šidák 1967).
pub fn sidak(significance: f64, tests: usize) -> f64 {
    -((-significance).ln_1p() / tests.max(1) as f64).exp_m1()
}

impl ChiSquareTest {
    /// Tests `sampler` at `wo`.
    ///
    /// For an invalid `wo` every draw must fail.
    pub fn run(&self, sampler: &dyn DirectionSampler, wo: Vec3) -> ChiSquare {
        let grid = HalfVectorDomain::new(wo).map(|domain| Grid {
            domain,
            theta_cells: self.theta_cells.max(1),
            phi_cells: self.phi_cells.max(1),
        });
        let mut observed = self.observe(sampler, wo, grid.as_ref());
        let witnesses = std::mem::take(&mut observed.witnesses);
        let predicted = match &grid {
            Some(grid) => expected(sampler, wo, grid, self.draws, witnesses),
            None => Expected {
                cells: Vec::new(),
                unusable: 0,
            },
        };
        self.judge(grid.as_ref(), &observed, &predicted)
    }

    fn observe(&self, sampler: &dyn DirectionSampler, wo: Vec3, grid: Option<&Grid>) -> Observed {
        let cells = grid.map_or(0, Grid::len);
        let mut observed = Observed {
            cells: vec![0; cells],
            inverse: vec![0.0; cells],
            witnesses: vec![Vec::new(); cells],
            ..Observed::default()
        };
        for i in 0..self.draws as u64 {
            match (
                sampler.sample(wo, PointSet::Random.point(self.seed, i, 0)),
                grid,
            ) {
                (None, _) => observed.failed += 1,
                (Some(sample), Some(grid)) if is_direction(sample.wi) => {
                    observed.add(grid, sample);
                    observed.impossible += u64::from(is_impossible(sampler, wo, sample.wi));
                }
                _ => observed.unusable += 1,
            }
        }
        observed
    }

    fn judge(&self, grid: Option<&Grid>, observed: &Observed, predicted: &Expected) -> ChiSquare {
        let pdf_integral = predicted.cells.iter().map(|m| m.value).sum::<f64>();
        let integral_error = predicted
            .cells
            .iter()
            .map(|m| m.error * m.error)
            .sum::<f64>()
            .sqrt();
        let failures = Mass {
            value: (1.0 - pdf_integral).max(0.0),
            error: integral_error,
        };
        let bins = self.bins(observed, &predicted.cells, failures);
        let (bins, unjudged) = judged(bins);
        let pooled = pool(bins);
        let statistic = pooled.iter().map(Bin::term).sum::<f64>();
        let degrees_of_freedom = pooled.len().saturating_sub(1);
        let (p_value, threshold) = (
            upper_tail(statistic, degrees_of_freedom),
            sidak(self.significance, self.tests),
        );
        // A hundredth of the test's significance, shared by all cells: one that is wrong alone is lost in the sum over hundreds.
        let outlier = threshold / (100.0 * pooled.len().max(1) as f64);
        let unusable = observed.unusable + predicted.unusable as u64;
        let verdict = match () {
            () if unusable > 0 => ChiSquareVerdict::Unusable,
            () if observed.impossible > 0 => ChiSquareVerdict::Impossible,
            () if p_value < threshold => ChiSquareVerdict::Unlikely,
            () if pooled.iter().any(|bin| bin.is_outlier(outlier)) => ChiSquareVerdict::Unlikely,
            () => ChiSquareVerdict::Pass,
        };
        let worst = if verdict == ChiSquareVerdict::Pass {
            Vec::new()
        } else {
            self.worst(grid, observed, pooled)
        };
        ChiSquare {
            statistic,
            degrees_of_freedom,
            p_value,
            threshold,
            verdict,
            failed: observed.failed,
            unjudged,
            impossible: observed.impossible,
            unusable,
            pdf_integral,
            integral_error,
            worst,
        }
    }

    fn worst(&self, grid: Option<&Grid>, observed: &Observed, mut bins: Vec<Bin>) -> Vec<Cell> {
        bins.sort_by(|a, b| b.term().total_cmp(&a.term()));
        bins.truncate(WORST_CELLS);
        let mut worst = Vec::new();
        for bin in &bins {
            let mut cell = Cell {
                theta_h_deg: None,
                azimuth_share: None,
                observed: bin.observed,
                expected: bin.expected,
                term: bin.term(),
                solid_angle_ratio: None,
            };
            if let (Some(grid), Some(index)) = (grid, bin.cell) {
                let (theta, share) = grid.ranges(index);
                let solid_angle = observed.inverse[index] / self.draws as f64;
                cell.theta_h_deg = Some(theta.map(f64::to_degrees));
                cell.azimuth_share = Some(share);
                cell.solid_angle_ratio = Some(solid_angle / grid.solid_angle(index));
            }
            worst.push(cell);
        }
        worst
    }

    /// Every cell of the grid, then the failed draws.
    fn bins(&self, observed: &Observed, masses: &[Mass], failures: Mass) -> Vec<Bin> {
        let draws = self.draws as f64;
        let bin = |cell, observed, mass: Mass| Bin {
            cell,
            observed,
            expected: mass.value * draws,
            error2: (mass.error * draws).powi(2),
        };
        let cells = observed.cells.iter().zip(masses).enumerate();
        cells
            .map(|(cell, (&count, &mass))| bin(Some(cell), count, mass))
            .chain([bin(None, observed.failed, failures)])
            .collect()
    }
}

#[derive(Clone, Debug, Default)]
struct Observed {
    cells: Vec<u64>,
    /// Σ 1/pdf over the draws of each cell.
    inverse: Vec<f64>,
    /// The first draws of each cell.
    witnesses: Vec<Vec<Witness>>,
    failed: u64,
    impossible: u64,
    unusable: u64,
}

impl Observed {
    fn add(&mut self, grid: &Grid, sample: DirectionSample) {
        let (cell, at) = grid.locate(sample.wi);
        let pdf = f64::from(sample.pdf);
        self.cells[cell] += 1;
        if pdf > 0.0 && pdf.is_finite() {
            self.inverse[cell] += 1.0 / pdf;
            if self.witnesses[cell].len() < WITNESSES {
                self.witnesses[cell].push(Witness { at, pdf });
            }
        }
    }
}

/// One term of the sum.
#[derive(Clone, Copy, Debug)]
struct Bin {
    /// Cell of the grid; `None` for failed draws and for the pool.
    cell: Option<usize>,
    observed: u64,
    expected: f64,
    /// Squared error of `expected`.
    error2: f64,
}

impl Bin {
    fn term(&self) -> f64 {
        let difference = self.observed as f64 - self.expected;
        // A bin that expects nothing stands alone only if no other bin expects anything either.
        difference * difference / (self.expected + self.error2).max(f64::MIN_POSITIVE)
    }

    /// Whether its count alone is less likely than `significance`, by Bernstein's bound for a sum of independent draws, and beyond
    /// four standard errors of its integral.
    fn is_outlier(&self, significance: f64) -> bool {
        let log = (2.0 / significance).ln();
        let linear = log / 3.0;
        let chance = linear + (linear * linear + 2.0 * self.expected * log).sqrt();
        let difference = (self.observed as f64 - self.expected).abs();
        difference > chance + 4.0 * self.error2.sqrt()
    }

    /// Whether it is a cell and the error of its integral, rather than chance, decides how far the count may be off, and explains that it is.
    fn is_unjudged(&self) -> bool {
        self.cell.is_some()
            && self.error2 > self.expected.max(SMALLEST_EXPECTED)
            && self.term() <= BEYOND_DOUBT * BEYOND_DOUBT
    }

    fn is_empty(&self) -> bool {
        self.observed == 0 && self.expected == 0.0
    }

    fn join(&mut self, other: &Self) {
        self.cell = None;
        self.observed += other.observed;
        self.expected += other.expected;
        self.error2 += other.error2;
    }
}

/// The bins that can be judged, and how many can't.
fn judged(mut bins: Vec<Bin>) -> (Vec<Bin>, usize) {
    let all = bins.len();
    bins.retain(|bin| !bin.is_unjudged());
    let unjudged = all - bins.len();
    (bins, unjudged)
}

/// Joins the smallest bins until each that remains expects [`SMALLEST_EXPECTED`] or is the only one.
fn pool(mut bins: Vec<Bin>) -> Vec<Bin> {
    bins.sort_by(|a, b| a.expected.total_cmp(&b.expected).then(a.cell.cmp(&b.cell)));
    let mut pool = Bin {
        cell: None,
        observed: 0,
        expected: 0.0,
        error2: 0.0,
    };
    let mut joined = 0;
    for bin in &bins {
        let settled = pool.expected >= SMALLEST_EXPECTED || pool.is_empty();
        if bin.expected >= SMALLEST_EXPECTED && settled {
            break;
        }
        pool.join(bin);
        joined += 1;
    }
    let mut kept = bins.split_off(joined);
    if !pool.is_empty() {
        kept.push(pool);
    }
    kept
}

/// P(χ² ≥ `statistic`): the regularised upper incomplete gamma function of half of both.
fn upper_tail(statistic: f64, degrees_of_freedom: usize) -> f64 {
    if degrees_of_freedom == 0 || statistic <= 0.0 {
        return 1.0;
    }
    checked_gamma_ur(0.5 * degrees_of_freedom as f64, 0.5 * statistic).unwrap_or(0.0)
}

/// Finite, of unit length within rounding, and above the horizon.
pub(super) fn is_direction(wi: Vec3) -> bool {
    is_upper(wi) && (wi.length_squared() - 1.0).abs() < 1e-5
}

/// Whether the pdf is zero at a draw and all about it.
fn is_impossible(sampler: &dyn DirectionSampler, wo: Vec3, wi: Vec3) -> bool {
    let positive = |w: Vec3| sampler.pdf(wo, w) > 0.0;
    if positive(wi) {
        return false;
    }
    let offsets = [
        Vec3::X,
        Vec3::NEG_X,
        Vec3::Y,
        Vec3::NEG_Y,
        Vec3::Z,
        Vec3::NEG_Z,
    ];
    !offsets
        .iter()
        .any(|&offset| positive((wi + ROUNDING * offset).normalize()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn upper_tail_has_its_known_values() {
        // Two degrees of freedom: exp(−x/2). One: erfc(√(x/2)), the five per cent point. Many: Wilson and Hilferty.
        assert!((upper_tail(3.0, 2) - (-1.5_f64).exp()).abs() < 1e-12);
        assert!((upper_tail(3.841_458_820_694_124, 1) - 0.05).abs() < 1e-12);
        assert!((upper_tail(1280.0, 1280) - 0.494_74).abs() < 1e-3);
        assert!(upper_tail(2000.0, 1280) < 1e-30);
        assert_eq!(upper_tail(0.0, 0), 1.0);
        assert_eq!(upper_tail(1e9, 1000), 0.0);
    }

    #[test]
    fn sidak_multiplies_back() {
        for tests in [1, 13, 2496] {
            let passes = (1.0 - sidak(0.01, tests)).powi(tests as i32);
            assert!((passes - 0.99).abs() < 1e-12);
        }
    }

    fn bin(cell: usize, observed: u64, expected: f64) -> Bin {
        Bin {
            cell: Some(cell),
            observed,
            expected,
            error2: 0.0,
        }
    }

    #[test]
    fn cells_of_uncertain_integrals_are_left_out_unless_they_contradict_the_draws() {
        let uncertain = |observed| Bin {
            error2: 400.0,
            ..bin(0, observed, 100.0)
        };
        // Deviations of 500 draws², the count's own 100 and the integral's 400: 110 draws are five.
        for (observed, is_judged) in [(100, false), (205, false), (215, true), (0, false)] {
            let (kept, unjudged) = judged(vec![uncertain(observed), bin(1, 90, 100.0)]);
            assert_eq!(
                (kept.len(), unjudged),
                if is_judged { (2, 0) } else { (1, 1) }
            );
        }
    }

    #[test]
    fn one_cell_that_is_wrong_is_an_outlier() {
        // ln(2/10⁻⁸) = 19.1: 6.4 + √(6.4² + 2·100·19.1) = 68.5 draws may be missing or too many of 100.
        for (observed, expected) in [
            (100, false),
            (168, false),
            (169, true),
            (32, false),
            (31, true),
        ] {
            assert_eq!(
                bin(0, observed, 100.0).is_outlier(1e-8),
                expected,
                "{observed}"
            );
        }
        let uncertain = Bin {
            error2: 100.0,
            ..bin(0, 200, 100.0)
        };
        assert!(!uncertain.is_outlier(1e-8));
    }

    #[test]
    fn pooling_keeps_totals_and_leaves_no_small_cell() {
        let bins: Vec<Bin> = (0..40).map(|i| bin(i, i as u64, i as f64 * 0.3)).collect();
        let pooled = pool(bins);
        assert!(pooled.iter().all(|b| b.expected >= SMALLEST_EXPECTED));
        assert_eq!(pooled.iter().map(|b| b.observed).sum::<u64>(), 780);
        assert!((pooled.iter().map(|b| b.expected).sum::<f64>() - 234.0).abs() < 1e-9);
    }

    #[test]
    fn a_small_pool_joins_the_smallest_large_cell_and_empty_cells_vanish() {
        let pooled = pool(vec![
            bin(0, 3, 0.5),
            bin(1, 90, 100.0),
            bin(2, 10, 10.0),
            bin(3, 0, 0.0),
        ]);
        assert_eq!(pooled.len(), 2);
        assert_eq!((pooled[1].observed, pooled[1].expected), (13, 10.5));
        assert_eq!(pool(vec![bin(0, 0, 0.0), bin(1, 90, 100.0)]).len(), 1);
    }
}
