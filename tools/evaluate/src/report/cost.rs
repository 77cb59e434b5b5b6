//! Measured times, worded.

use crate::measure::cost::CallCost;

/// Nanoseconds with their interval: "268 (262–275)".
pub(super) fn nanoseconds(cost: &CallCost) -> String {
    format!("{:.0} ({:.0}–{:.0})", cost.ns, cost.low, cost.high)
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
    }

    #[test]
    fn a_kilobyte_has_a_thousand_bytes() {
        assert_eq!(kilobytes(64_543), "64.5");
    }
}
