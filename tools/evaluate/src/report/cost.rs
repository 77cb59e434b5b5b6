//! Measured times, worded.

use crate::measure::cost::CallCost;

/// Nanoseconds with their interval, "268 (262–275)", to the first digit of the standard error.
pub(super) fn nanoseconds(cost: &CallCost) -> String {
    // Half of the interval is 1.96 standard errors; nothing is written below a nanosecond.
    let standard_error = 0.5 * (cost.high - cost.low) / 1.96;
    let step = 10f64.powf(standard_error.clamp(1.0, 1e9).log10().floor());
    let [ns, low, high] = [cost.ns, cost.low, cost.high].map(|x| (x / step).round() * step);
    format!("{ns:.0} ({low:.0}–{high:.0})")
}

/// Bytes in units of 1000.
pub(super) fn kilobytes(bytes: usize) -> String {
    format!("{:.1}", bytes as f64 / 1000.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nanoseconds_have_their_interval() {
        let cost = CallCost {
            ns: 268.4,
            low: 262.0,
            high: 275.0,
            spread: 0.05,
        };
        assert_eq!(nanoseconds(&cost), "268 (262–275)");
        let cost = CallCost {
            ns: 1229.4,
            low: 1197.0,
            high: 1251.0,
            spread: 0.05,
        };
        assert_eq!(nanoseconds(&cost), "1230 (1200–1250)");
    }

    #[test]
    fn a_kilobyte_has_a_thousand_bytes() {
        assert_eq!(kilobytes(64_543), "64.5");
    }
}
