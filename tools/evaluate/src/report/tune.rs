//! A choice of sampler, worded.

use super::Sheet;
use super::compare::duration;
use crate::measure::compare::{MOST_SAMPLES, Tried, Tuning};

/// One line a sampler that was tried, the quickest first.
pub fn tuning_sheet(material: &str, tuning: &Tuning) -> Sheet {
    let to = format!("to {} %", percent(tuning.wish.error));
    let mut sheet = Sheet::new(&[
        material,
        "KB",
        "build s",
        "ns/sample",
        "samples",
        &to,
        "within limits",
        "slope",
    ]);
    for (i, tried) in tuning.tried.iter().enumerate() {
        let curve = &tried.curve;
        let mark = if tuning.chosen == Some(i) { "→ " } else { "" };
        let samples = tried.reach.map_or("never".into(), |r| {
            format!(
                "{}{:.0}",
                if r.extrapolated { "~" } else { "" },
                r.samples.ceil()
            )
        });
        sheet.push(vec![
            format!("{mark}{}", curve.label),
            format!("{:.1}", curve.table_bytes as f64 / 1000.0),
            format!("{:.3}", curve.build_seconds),
            format!("{:.0}", curve.ns_per_sample),
            samples,
            tried.seconds.map_or(String::new(), duration),
            if tried.allowed { "yes" } else { "no" }.into(),
            format!("{:.2}", curve.sobol_slope),
        ]);
    }
    sheet
}

/// The choice with its proof and its neighbours, or how near one gets.
pub fn tuning_summary(material: &str, tuning: &Tuning) -> String {
    let asked = percent(tuning.wish.error);
    let Some(choice) = tuning.chosen.and_then(|i| tuning.tried.get(i)) else {
        return nearest(material, tuning);
    };
    let mut lines = vec![match &tuning.proof {
        Some(proof) => format!(
            "{material}: {} reaches {asked} % with {} samples, {} an estimate: {} % ({} to {} %) over seeds {} to {}",
            choice.curve.label,
            proof.samples,
            duration(choice.curve.ns_per_sample * 1e-9 * proof.samples as f64),
            percent(proof.error.rmse),
            percent(proof.error.low),
            percent(proof.error.high),
            proof.first_seed,
            proof.first_seed + proof.seeds - 1,
        ),
        None => format!(
            "{material}: {} would be the quickest to {asked} %, but needs more samples than were measured",
            choice.curve.label
        ),
    }];
    lines.extend(tuning.cheaper().map(|t| neighbour("with less memory", t)));
    lines.extend(tuning.better().map(|t| neighbour("with fewer samples", t)));
    lines.join("\n")
}

fn neighbour(how: &str, tried: &Tried) -> String {
    let limits = if tried.allowed {
        ""
    } else {
        ", beyond the limits"
    };
    let (samples, seconds) = (
        tried.reach.map_or(0.0, |r| r.samples),
        tried.seconds.unwrap_or_default(),
    );
    format!(
        "{how}: {}, {:.1} KB, {:.0} samples, {}{limits}",
        tried.curve.label,
        tried.curve.table_bytes as f64 / 1000.0,
        samples.ceil(),
        duration(seconds),
    )
}

fn nearest(material: &str, tuning: &Tuning) -> String {
    let asked = percent(tuning.wish.error);
    match tuning.nearest() {
        Some((tried, end)) => format!(
            "{material}: nothing within the limits reaches {asked} % with {MOST_SAMPLES:.0e} samples; {} is nearest, {} % with {}",
            tried.curve.label,
            percent(end.rmse),
            end.samples
        ),
        None => {
            format!("{material}: no sampler keeps the limits; allow more bytes or a longer build")
        }
    }
}

/// Three significant digits of a share, in per cent.
fn percent(share: f64) -> String {
    let value = share * 100.0;
    let digits = if value >= 100.0 || value <= 0.0 {
        0.0
    } else {
        (2.0 - value.log10().floor()).clamp(0.0, 12.0)
    };
    let text = format!("{value:.*}", digits as usize);
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').into()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::percent;

    #[test]
    fn shares_keep_three_digits() {
        for (share, text) in [
            (0.01, "1"),
            (0.0123, "1.23"),
            (0.12345, "12.3"),
            (1.5, "150"),
            (0.0, "0"),
        ] {
            assert_eq!(percent(share), text);
        }
    }
}
