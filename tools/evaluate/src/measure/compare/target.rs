//! What it takes to reach an error: samples, seconds, bytes.

use serde::{Deserialize, Serialize};

use super::{Curve, ErrorPoint};
use crate::measure::convergence::slope_of;

/// Relative errors that people ask for.
pub const TARGETS: [f64; 4] = [0.1, 0.03, 0.01, 0.003];

/// Samples that share the precomputation: none but the estimate's own, a small picture's, a film's.
pub const SHARED_BY: [u64; 3] = [1, 1_000_000, 1_000_000_000];

/// What a competitor needs to reach an error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reach {
    /// The relative error.
    pub error: f64,
    /// Samples of one estimate.
    pub samples: f64,
    /// Whether that is beyond what was measured, by the slope of the last measurements.
    pub extrapolated: bool,
    /// Counted seconds ([`super::CountedCost`]) of one estimate on one thread, with its part of the precomputation when that
    /// is for as many samples as [`SHARED_BY`] says, or for this estimate's alone if that is more.
    pub counted_seconds: [f64; 3],
}

/// What `curve` needs, under Sobol points, to reach `error`; `None` if its error doesn't fall.
pub fn reach(curve: &Curve, error: f64) -> Option<Reach> {
    let (samples, extrapolated) = samples_to_reach(&curve.sobol, error)?;
    Some(reach_with(curve, error, samples, extrapolated))
}

/// What `samples` of `curve` take, which is what it needs to reach `error`.
pub(super) fn reach_with(curve: &Curve, error: f64, samples: f64, extrapolated: bool) -> Reach {
    Reach {
        error,
        samples,
        extrapolated,
        counted_seconds: SHARED_BY.map(|shared| counted_seconds(curve, samples, shared)),
    }
}

/// Counted seconds of one estimate with its part of the precomputation, which `shared` samples share.
pub(super) fn counted_seconds(curve: &Curve, samples: f64, shared: u64) -> f64 {
    let cost = curve.counted;
    samples * cost.sample_ns * 1e-9 + cost.build_seconds * (samples / shared as f64).min(1.0)
}

/// The least number above `samples` that is a power of two or one and a half times one: 1, 2, 3, 4, 6, 8, 12, 16, 24…
///
/// Sobol points are spread best at powers of two; between these numbers their error follows no law, so that what a number of
/// samples reaches is measured at that very number.
pub(super) fn next_count(samples: usize) -> usize {
    let power = samples.max(1).next_power_of_two();
    // ¾ of the power above lies halfway between two powers, and is a whole number from 3 on.
    let between = power / 4 * 3;
    match (between > samples, power > samples) {
        (true, _) => between,
        (false, true) => power,
        (false, false) => next_count_above_power(power),
    }
}

/// Behind a power of two comes one and a half times it; behind 1 comes 2.
fn next_count_above_power(power: usize) -> usize {
    if power == 1 { 2 } else { power / 2 * 3 }
}

/// The first of the measured numbers of samples whose error's interval ends at or below `error`, or one beyond them along
/// the errors' fall, and whether it is that; `None` if they don't fall.
pub(super) fn count_to_reach(errors: &[ErrorPoint], error: f64) -> Option<(usize, bool)> {
    if let Some(found) = errors.iter().find(|e| e.high <= error) {
        return Some((found.samples, false));
    }
    let last = errors.last()?.samples;
    let (samples, _) = samples_to_reach(errors, error)?;
    let mut count = next_count(last);
    while (count as f64) < samples && count < usize::MAX / 4 {
        count = next_count(count);
    }
    Some((count, true))
}

/// The slowest fall that is still called one.
const FLATTEST: f64 = -0.1;
/// Errors at the end of a curve that its continuation is fitted to.
const TAIL: usize = 6;

/// Number of samples from which on the error stays at or below `error`, interpolated in logarithms, and whether it lies
/// beyond the last measurement.
pub fn samples_to_reach(errors: &[ErrorPoint], error: f64) -> Option<(f64, bool)> {
    let last = errors.last()?;
    if last.rmse > error {
        let tail = &errors[errors.len().saturating_sub(TAIL)..];
        let slope = slope_of(tail.iter().map(|e| (e.samples, e.rmse)));
        return (slope < FLATTEST).then(|| {
            (
                last.samples as f64 * (error / last.rmse).powf(1.0 / slope),
                true,
            )
        });
    }
    let after = errors
        .iter()
        .rposition(|e| e.rmse > error)
        .map_or(0, |i| i + 1);
    let reached = &errors[after];
    let Some(before) = after.checked_sub(1).map(|i| &errors[i]) else {
        return Some((reached.samples as f64, false));
    };
    if reached.rmse <= 0.0 {
        return Some((reached.samples as f64, false));
    }
    let share = (before.rmse / error).ln() / (before.rmse / reached.rmse).ln();
    let (from, to) = ((before.samples as f64).ln(), (reached.samples as f64).ln());
    Some(((from + share * (to - from)).exp(), false))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn falling(scale: f64) -> Vec<ErrorPoint> {
        let at = |samples: usize| {
            let rmse = scale / (samples as f64).sqrt();
            ErrorPoint {
                samples,
                rmse,
                low: rmse,
                high: rmse,
            }
        };
        [1, 4, 16, 64, 256].map(at).to_vec()
    }

    #[test]
    fn samples_follow_the_power_law_within_and_beyond() {
        let close = |found: Option<(f64, bool)>, samples: f64, beyond: bool| {
            let (n, extrapolated) = found.unwrap();
            assert!(
                (n / samples - 1.0).abs() < 1e-9 && extrapolated == beyond,
                "{n} {extrapolated}"
            );
        };
        close(samples_to_reach(&falling(1.0), 0.1), 100.0, false);
        close(samples_to_reach(&falling(1.0), 0.01), 10_000.0, true);
        close(samples_to_reach(&falling(0.05), 0.1), 1.0, false);
    }

    #[test]
    fn counts_are_powers_of_two_and_half_as_much_again() {
        let mut counts = vec![1];
        while counts.len() < 11 {
            counts.push(next_count(*counts.last().unwrap()));
        }
        assert_eq!(counts, [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48]);
        assert_eq!([0, 5, 100, 256, 300].map(next_count), [1, 6, 128, 384, 384]);
    }

    /// The upper end decides: 0.01 is the mean at 64 and is not reached there.
    #[test]
    fn a_count_is_one_whose_interval_ends_below_the_target() {
        let point = |(samples, rmse): (usize, f64)| ErrorPoint {
            samples,
            rmse,
            low: 0.9 * rmse,
            high: 1.1 * rmse,
        };
        let errors = [(16, 0.05), (64, 0.01), (128, 0.005)].map(point);
        assert_eq!(count_to_reach(&errors, 0.01), Some((128, false)));
        assert_eq!(count_to_reach(&errors, 0.012), Some((64, false)));
        let (beyond, extrapolated) = count_to_reach(&errors, 0.004).unwrap();
        assert!(beyond > 128 && extrapolated, "{beyond}");
        assert_eq!(count_to_reach(&[], 0.1), None);
    }

    #[test]
    fn an_error_that_stays_is_never_below_what_it_is() {
        let flat = [1, 10, 100].map(|samples| ErrorPoint {
            samples,
            rmse: 0.5,
            low: 0.5,
            high: 0.5,
        });
        assert_eq!(samples_to_reach(&flat, 0.1), None);
        assert_eq!(samples_to_reach(&[], 0.1), None);
        assert_eq!(samples_to_reach(&flat, 0.5), Some((1.0, false)));
    }

    #[test]
    fn a_bump_counts_until_it_is_over() {
        let bump = [(1, 0.2), (4, 0.05), (16, 0.2), (64, 0.05)].map(|(samples, rmse)| ErrorPoint {
            samples,
            rmse,
            low: rmse,
            high: rmse,
        });
        let (n, _) = samples_to_reach(&bump, 0.1).unwrap();
        assert!((16.0..64.0).contains(&n), "{n}");
    }
}
