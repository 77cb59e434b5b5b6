//! The proof that a sampler is right, as a list of outcomes: what `merlkit check` runs, and the tests too.
//!
//! Each direction `wo` gets every check of [`Check`]. The statistical ones share one significance (Šidák), and allow for
//! heavy-tailed weights: their bound is Bernstein's for the variance and the largest weight by quadrature, which holds
//! where the normal approximation doesn't and comes to some 4.5 standard errors where it does.

use glam::{DVec4, Vec3};
use rayon::prelude::*;

use super::accuracy::{Moments, SCALAR, mean_weight};
use super::chi_square::{ChiSquare, ChiSquareTest, ChiSquareVerdict, sidak};
use super::probe::{self, Probe};
use merlkit::brdf::{Brdf, Importance};
use merlkit::direction_sampler::{DirectionSampler, draw_stratified};
use merlkit::geometry::{POINTS_PER_BIN, Quadrature, Symmetry, spherical, to_spherical};
use merlkit::points::{PointSet, mix};

/// Polar angles of `wo` that are checked, degrees: on the knots of common tables, between them, and near grazing.
pub const CHECK_ANGLES_DEG: [f64; 13] = [
    0.0, 0.76, 14.5, 29.75, 30.0, 45.0, 60.0, 60.25, 75.0, 75.5, 84.7, 85.0, 89.0,
];

/// Azimuths that [`check_directions`] takes in turn, degrees: none is a multiple of another or of a table's step.
const CHECK_AZIMUTHS_DEG: [f64; 4] = [0.0, 37.3, 161.9, -110.2];

/// Directions at [`CHECK_ANGLES_DEG`], each at another of four azimuths.
pub fn check_directions() -> Vec<Vec3> {
    let azimuths = CHECK_AZIMUTHS_DEG.iter().cycle();
    let direction =
        |(theta, phi): (&f64, &f64)| spherical(theta.to_radians(), phi.to_radians()).as_vec3();
    CHECK_ANGLES_DEG
        .iter()
        .zip(azimuths)
        .map(direction)
        .collect()
}

/// Azimuths that anisotropic materials are checked at, degrees: seams of their symmetries, and others.
const CHECK_AZIMUTHS_ANISOTROPIC_DEG: [f64; 5] = [0.0, 37.3, 90.0, 161.9, -110.2];

/// Directions at [`CHECK_ANGLES_DEG`]: for an isotropic material as [`check_directions`], else each at five azimuths.
pub fn check_directions_of(symmetry: Symmetry) -> Vec<Vec3> {
    if symmetry == Symmetry::Isotropic {
        return check_directions();
    }
    let at = |theta: f64| {
        CHECK_AZIMUTHS_ANISOTROPIC_DEG
            .map(|phi| spherical(theta.to_radians(), phi.to_radians()).as_vec3())
    };
    CHECK_ANGLES_DEG.into_iter().flat_map(at).collect()
}

/// How thoroughly to check.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct CheckSettings {
    /// Draws of each statistical check.
    pub draws: usize,
    /// Chooses the draws.
    pub seed: u64,
    /// Probability that anything fails in a whole run, though every sampler is right.
    pub significance: f64,
    /// How many calls of [`check_sampler`] make up the run and share `significance`, at least 1.
    pub calls: usize,
    /// The scalar whose estimate must be unbiased.
    pub importance: Importance,
}

impl Default for CheckSettings {
    fn default() -> Self {
        Self {
            draws: 100_000,
            seed: 1,
            significance: 0.01,
            calls: 1,
            importance: Importance::Mean,
        }
    }
}

/// What is checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Check {
    /// Draws are unit directions above the horizon with a positive, finite pdf and weight; `pdf` is finite, not negative, and
    /// 0 below the horizon; an invalid `wo` gives nothing. Value: violations.
    Validity,
    /// The pdf returned with a draw is that of `pdf`. Value: largest relative difference.
    Agreement,
    /// pdf > 0 wherever f cosθ > 0, at quadrature nodes and at random directions. Value: violations.
    Positivity,
    /// ∫ pdf is one minus the rate of failed draws. Value: their difference.
    PdfIntegral,
    /// Draws fall where the pdf says. Value: p-value, of which the bound is the least that passes.
    ChiSquare,
    /// The mean weight of independent draws is the albedo by quadrature. Value: relative deviation.
    Bias,
    /// Under a uniform sky of radiance 1, a stratified batch of draws estimates the albedo of each channel. Value: relative deviation of the
    /// worst channel.
    Furnace,
}

impl Check {
    /// How many of the checks of one direction can fail by chance.
    const STATISTICAL: usize = 4;
}

/// One check at one direction.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Outcome {
    /// What was checked.
    pub check: Check,
    /// Polar angle of `wo`, degrees.
    pub theta_o_deg: f64,
    /// Azimuth of `wo`, degrees in (−180, 180].
    pub phi_o_deg: f64,
    /// What was found; see [`Check`].
    pub value: f64,
    /// What it was held against: a largest value, but for chi-square a smallest.
    pub bound: f64,
    /// Whether the value keeps the bound.
    pub pass: bool,
    /// Of chi-square, the cells left out because no integral of the pdf over them was certain enough; 0 otherwise.
    pub unjudged: usize,
    /// After a failure, one line on where; empty otherwise.
    pub note: String,
}

/// All outcomes, by direction in the order given, then in the order of [`Check`].
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct CheckReport {
    /// The outcomes.
    pub outcomes: Vec<Outcome>,
}

impl CheckReport {
    /// Whether every check passed.
    pub fn pass(&self) -> bool {
        self.outcomes.iter().all(|o| o.pass)
    }

    /// The checks that did not.
    pub fn failures(&self) -> impl Iterator<Item = &Outcome> {
        self.outcomes.iter().filter(|o| !o.pass)
    }
}

/// Runs every check at every direction of `wos`, in parallel; the same report for any number of threads.
pub fn check_sampler(
    sampler: &dyn DirectionSampler,
    brdf: &dyn Brdf,
    wos: &[Vec3],
    settings: &CheckSettings,
) -> CheckReport {
    let tests = settings.calls.max(1) * wos.len() * Check::STATISTICAL;
    let outcomes = wos
        .par_iter()
        .enumerate()
        .map(|(i, &wo)| CheckSubject::new(sampler, brdf, wo, settings, i, tests).outcomes())
        .collect::<Vec<_>>()
        .concat();
    CheckReport { outcomes }
}

/// A sampler and a BRDF at one direction.
struct CheckSubject<'a> {
    sampler: &'a dyn DirectionSampler,
    brdf: &'a dyn Brdf,
    wo: Vec3,
    settings: &'a CheckSettings,
    /// Differs between directions.
    seed: u64,
    tests: usize,
}

impl<'a> CheckSubject<'a> {
    fn new(
        sampler: &'a dyn DirectionSampler,
        brdf: &'a dyn Brdf,
        wo: Vec3,
        settings: &'a CheckSettings,
        index: usize,
        tests: usize,
    ) -> Self {
        Self {
            sampler,
            brdf,
            wo,
            settings,
            seed: mix(settings.seed ^ mix(index as u64)),
            tests,
        }
    }

    fn outcomes(&self) -> Vec<Outcome> {
        let fine = self.moments(POINTS_PER_BIN);
        let coarse = self.moments(POINTS_PER_BIN / 3);
        let probe = probe::run(self.sampler, self.brdf, self.wo, self.seed ^ 1);
        let chi = self.chi_square();
        let mut all = self.exact(&probe, &fine);
        all.push(self.pdf_integral(&chi));
        all.push(self.chi_outcome(&chi));
        all.extend(self.energy(&fine, &coarse));
        all
    }

    /// Bias and furnace. On spikes two quadratures can agree by chance and miss the albedo, so one of four times the points has
    /// the last word before an estimate is called wrong.
    fn energy(&self, fine: &Moments, coarse: &Moments) -> [Outcome; 2] {
        let (single, batch) = (self.mean_of_single_draws(), self.mean_of_batch());
        let judge = |fine: &Moments, coarse: &Moments| {
            [
                self.bias(fine, coarse, single),
                self.furnace(fine, coarse, batch),
            ]
        };
        let outcomes = judge(fine, coarse);
        if outcomes.iter().all(|o| o.pass) {
            return outcomes;
        }
        judge(&self.moments(4 * POINTS_PER_BIN), fine)
    }

    fn mean_of_single_draws(&self) -> DVec4 {
        let indices = 0..self.settings.draws as u64;
        let points = indices.map(|i| PointSet::Random.point(self.seed ^ 3, i, 0));
        let draws = points.map(|u| self.sampler.sample(self.wo, u));
        mean_weight(self.brdf, self.wo, self.settings.importance, draws)
    }

    fn mean_of_batch(&self) -> DVec4 {
        let draws = draw_stratified(self.sampler, self.wo, self.batch(), self.seed ^ 4);
        mean_weight(
            self.brdf,
            self.wo,
            self.settings.importance,
            draws.into_iter(),
        )
    }

    /// Draws of the stratified batch.
    fn batch(&self) -> usize {
        (self.settings.draws / 4).max(1)
    }

    fn moments(&self, points: usize) -> Moments {
        let quadrature = Quadrature::new(self.wo, points);
        Moments::integrate(
            self.sampler,
            self.brdf,
            &quadrature,
            self.settings.importance,
        )
    }

    fn chi_square(&self) -> ChiSquare {
        let test = ChiSquareTest {
            draws: self.settings.draws,
            seed: self.seed ^ 2,
            significance: self.settings.significance,
            tests: self.tests,
            ..ChiSquareTest::default()
        };
        test.run(self.sampler, self.wo)
    }

    /// The checks that chance has no part in.
    fn exact(&self, probe: &Probe, fine: &Moments) -> Vec<Outcome> {
        let holes = if fine.holes.count > 0 {
            &fine.holes
        } else {
            &probe.holes
        };
        let count = fine.holes.count + probe.holes.count;
        let share = fine.spread(SCALAR).holes;
        vec![
            self.at_most(Check::Validity, probe.invalid.count as f64, 0.0, || {
                probe.invalid.describe()
            }),
            self.at_most(
                Check::Agreement,
                probe.disagreement,
                probe::AGREEMENT,
                || probe.differs.describe(),
            ),
            self.at_most(Check::Positivity, count as f64, 0.0, || {
                format!(
                    "pdf = 0 over {:.3} % of f cosθ; {}",
                    100.0 * share,
                    holes.describe()
                )
            }),
        ]
    }

    fn pdf_integral(&self, chi: &ChiSquare) -> Outcome {
        let draws = self.settings.draws.max(1) as f64;
        let failure_rate = chi.failed as f64 / draws;
        let expected_rate = (1.0 - chi.pdf_integral).clamp(0.0, 1.0);
        let variance = expected_rate * (1.0 - expected_rate);
        // Four deviations of the integration, whose errors within a row of cells may agree in sign.
        let bound = self.bernstein(variance, 1.0, draws, 1) + 4.0 * chi.integral_error + 1e-4;
        let difference = (chi.pdf_integral + failure_rate - 1.0).abs();
        self.at_most(Check::PdfIntegral, difference, bound, || {
            format!(
                "integral {:.6}, failed draws {:.6}",
                chi.pdf_integral, failure_rate
            )
        })
    }

    fn chi_outcome(&self, chi: &ChiSquare) -> Outcome {
        let pass = chi.verdict == ChiSquareVerdict::Pass;
        let note = if pass { String::new() } else { describe(chi) };
        let outcome = self.outcome(Check::ChiSquare, chi.p_value, chi.threshold, pass, note);
        Outcome {
            unjudged: chi.unjudged,
            ..outcome
        }
    }

    fn bias(&self, fine: &Moments, coarse: &Moments, estimate: DVec4) -> Outcome {
        let (deviation, bound) = self.deviation(
            fine,
            coarse,
            SCALAR,
            estimate[SCALAR],
            self.settings.draws,
            1,
        );
        self.at_most(Check::Bias, deviation, bound, || {
            format!(
                "estimate {:.6}, albedo {:.6}",
                estimate[SCALAR], fine.albedo[SCALAR]
            )
        })
    }

    fn furnace(&self, fine: &Moments, coarse: &Moments, estimate: DVec4) -> Outcome {
        let count = self.batch();
        let channels =
            [0, 1, 2].map(|c| (c, self.deviation(fine, coarse, c, estimate[c], count, 3)));
        let excess =
            |&(_, (value, bound)): &(usize, (f64, f64))| value / bound.max(f64::MIN_POSITIVE);
        let (channel, (deviation, bound)) = channels
            .into_iter()
            .max_by(|a, b| excess(a).total_cmp(&excess(b)))
            .unwrap_or_default();
        self.at_most(Check::Furnace, deviation, bound, || {
            format!(
                "channel {channel}: estimate {:.6}, albedo {:.6}",
                estimate[channel], fine.albedo[channel]
            )
        })
    }

    /// Relative deviation of an estimate from the albedo, and what chance and quadrature allow. A black channel allows none.
    fn deviation(
        &self,
        fine: &Moments,
        coarse: &Moments,
        lane: usize,
        estimate: f64,
        count: usize,
        channels: usize,
    ) -> (f64, f64) {
        let albedo = fine.albedo[lane];
        if albedo <= 0.0 {
            return (estimate, 0.0);
        }
        let chance = self.bernstein(
            fine.variance(lane),
            fine.reach(lane),
            count as f64,
            channels,
        );
        // f32 rounding of weights and pdf adds up to 10⁻⁵ where nothing else does.
        let quadrature = (albedo - coarse.albedo[lane]).abs();
        (
            (estimate - albedo).abs() / albedo,
            (chance + quadrature) / albedo + 1e-5,
        )
    }

    /// Bernstein's bound on the deviation of a mean of `count` values of the given variance, each within `reach` of the mean,
    /// at the significance of one of `channels` parts of one test.
    fn bernstein(&self, variance: f64, reach: f64, count: f64, channels: usize) -> f64 {
        let significance = sidak(self.settings.significance, self.tests) / channels as f64;
        let log = (2.0 / significance).ln();
        let linear = reach * log / 3.0;
        (linear + (linear * linear + 2.0 * variance * log * count).sqrt()) / count.max(1.0)
    }

    /// An outcome that passes if `value` is not above `bound`; a NaN fails.
    fn at_most(
        &self,
        check: Check,
        value: f64,
        bound: f64,
        note: impl FnOnce() -> String,
    ) -> Outcome {
        let pass = value <= bound;
        self.outcome(
            check,
            value,
            bound,
            pass,
            if pass { String::new() } else { note() },
        )
    }

    fn outcome(&self, check: Check, value: f64, bound: f64, pass: bool, note: String) -> Outcome {
        let (theta, phi) = to_spherical(self.wo.as_dvec3());
        Outcome {
            check,
            theta_o_deg: theta.to_degrees(),
            phi_o_deg: phi.to_degrees(),
            value,
            bound,
            pass,
            unjudged: 0,
            note,
        }
    }
}

/// The counts and the worst cell of a failed test.
fn describe(chi: &ChiSquare) -> String {
    let worst = chi.worst.first().map_or(String::new(), |cell| {
        let place = cell.theta_h_deg.zip(cell.azimuth_share).map_or_else(
            || "small cells and failed draws".to_owned(),
            |(theta, share)| {
                format!(
                    "θh {:.3}..{:.3}°, azimuth {:.2}..{:.2}",
                    theta[0], theta[1], share[0], share[1]
                )
            },
        );
        let ratio = cell.solid_angle_ratio.map_or(String::new(), |ratio| {
            format!(", whose 1/pdf sum to {ratio:.3} of its solid angle")
        });
        format!(
            "; worst cell ({place}): {} draws, {:.1} expected{ratio}",
            cell.observed, cell.expected
        )
    });
    format!(
        "chi-square {:.1} on {} degrees of freedom, {} impossible draws, {} unusable values{worst}",
        chi.statistic, chi.degrees_of_freedom, chi.impossible, chi.unusable
    )
}
