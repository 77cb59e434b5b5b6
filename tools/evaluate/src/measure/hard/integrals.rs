//! What needs all directions at once: the mass of the pdf and the energy of the estimate.

use super::{HardCheck, HardOutcome, HardSampler, HardSubject, Thoroughness};
use crate::measure::accuracy::{Moments, SCALAR, mean_weight};
use merlkit::brdf::{Brdf, Importance};
use merlkit::direction_sampler::{DirectionSample, DirectionSampler};
use merlkit::geometry::{POINTS_PER_BIN, Quadrature, spherical};
use merlkit::points::PointSet;

/// Draws of each direction.
const DRAWS: u64 = 20_000;
/// Points a bin of the quadrature that tells the error of the fine one.
const COARSE: usize = POINTS_PER_BIN / 3;
/// The same where neighbouring cells differ by 10¹², at the angles and under the rules of the full crossing alone: normalisers are
/// off by up to 1.5 % at some of them.
const PDF_INTEGRAL_TORN: f64 = 2e-2;
/// Points a bin where the fine one is off.
const FINEST: usize = 4 * POINTS_PER_BIN;
/// ∫ pdf may differ from its mass by this, and by what is not known of either.
const PDF_INTEGRAL: f64 = 1e-3;
/// Beyond this angle of `wo`, degrees, rounding of directions to f32 moves half vectors by a tenth of the radius of MERL's first
/// bin of θh, 0.011°: a lobe that ends at its edge can't be integrated there, and isn't judged.
const RESOLVED_DEG: f64 = 89.0;
/// −ln of the probability that a right estimate fails: 2·10⁻⁸, some thousand times over in a run.
const LOG_CHANCE: f64 = 18.4;

/// [`HardCheck::PdfIntegral`] and [`HardCheck::Energy`], each at its worst direction.
pub(super) fn integrals(
    subject: &HardSubject,
    hard: &HardSampler,
    sampler: &dyn DirectionSampler,
) -> Vec<HardOutcome> {
    let mut out: Vec<HardOutcome> = Vec::new();
    for &degrees in subject.angles {
        let [mass, energy] = integrals_at_angle(subject, hard, sampler, degrees);
        if out.is_empty() {
            out = vec![mass, energy];
            continue;
        }
        for (worst, new) in out.iter_mut().zip([mass, energy]) {
            let count = worst.count + new.count;
            // A failure before anything else, then the larger share of the bound.
            if (!new.pass, excess(&new)) > (!worst.pass, excess(worst)) {
                *worst = new;
            }
            worst.count = count;
        }
    }
    out
}

fn excess(outcome: &HardOutcome) -> f64 {
    outcome.value / outcome.bound.unwrap_or(1.0).max(f64::MIN_POSITIVE)
}

fn integrals_at_angle(
    subject: &HardSubject,
    hard: &HardSampler,
    sampler: &dyn DirectionSampler,
    degrees: f64,
) -> [HardOutcome; 2] {
    let wo = spherical(degrees.to_radians(), 2.5).as_vec3();
    let judged = hard.exact && !(subject.is_narrow && degrees > RESOLVED_DEG);
    let brdf: &dyn Brdf = &**subject.brdf();
    let moments = |points| {
        Moments::integrate(
            sampler,
            brdf,
            &Quadrature::new(wo, points),
            Importance::Mean,
        )
    };
    let (mut fine, mut coarse) = (moments(POINTS_PER_BIN), moments(COARSE));
    let draws: Vec<Option<DirectionSample>> = (0..DRAWS)
        .map(|i| sampler.sample(wo, PointSet::Random.point(subject.seed, i, 0)))
        .collect();
    let failed = draws.iter().filter(|d| d.is_none()).count() as f64 / DRAWS as f64;
    let torn = subject.is_torn && subject.thoroughness == Thoroughness::Full;
    let settled = if torn {
        PDF_INTEGRAL_TORN
    } else {
        PDF_INTEGRAL
    };
    let judge = |fine: &Moments, coarse: &Moments| {
        let (mass, rough) = (
            fine.spread(SCALAR).pdf_integral,
            coarse.spread(SCALAR).pdf_integral,
        );
        let lost = (1.0 - mass).clamp(failed, 1.0);
        let chance = if failed > 0.0 {
            bernstein(lost * (1.0 - lost), 1.0)
        } else {
            0.0
        };
        (mass, rough, settled + (mass - rough).abs() + chance)
    };
    let (mut mass, mut rough, mut bound) = judge(&fine, &coarse);
    if (mass + failed - 1.0).abs() > bound {
        // On noise two quadratures can agree by chance: a finer one tells whether they did.
        (coarse, fine) = (fine, moments(FINEST));
        (mass, rough, bound) = judge(&fine, &coarse);
    }
    let mass = subject.outcome(
        hard.name,
        HardCheck::PdfIntegral,
        (mass + failed - 1.0).abs(),
        judged.then_some(bound),
        DRAWS,
        format!("at {degrees}°: integral {mass:.6} ({rough:.6} with fewer points), failed draws {failed:.6}"),
    );
    let estimate = mean_weight(brdf, wo, Importance::Mean, draws.into_iter())[SCALAR];
    [
        mass,
        energy(subject, (hard, judged), degrees, &fine, &coarse, estimate),
    ]
}

fn energy(
    subject: &HardSubject,
    (hard, judged): (&HardSampler, bool),
    degrees: f64,
    fine: &Moments,
    coarse: &Moments,
    estimate: f64,
) -> HardOutcome {
    let (expected, rough) = (fine.spread(SCALAR).mean, coarse.spread(SCALAR).mean);
    let variance = fine.variance(SCALAR).max(coarse.variance(SCALAR));
    let reach = fine.reach(SCALAR).max(coarse.reach(SCALAR));
    // f32 rounding of weights and pdf adds up to 10⁻⁵ where nothing else does.
    let bound = bernstein(variance, reach) + 2.0 * (expected - rough).abs() + 1e-5 * expected;
    let deviation = (estimate - expected).abs();
    let value = if deviation == 0.0 {
        0.0
    } else {
        deviation / bound
    };
    subject.outcome(
        hard.name,
        HardCheck::Energy,
        value,
        judged.then_some(1.0),
        DRAWS,
        format!("at {degrees}°: estimate {estimate:e}, by quadrature {expected:e}, ± {bound:.1e}"),
    )
}

/// Bernstein's bound on the deviation of a mean of [`DRAWS`] values of a variance, each within `reach` of the mean.
fn bernstein(variance: f64, reach: f64) -> f64 {
    let linear = reach * LOG_CHANCE / 3.0;
    let count = DRAWS as f64;
    (linear + (linear * linear + 2.0 * variance * LOG_CHANCE * count).sqrt()) / count
}
