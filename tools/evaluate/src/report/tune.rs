//! A choice of sampler, worded.

use super::Sheet;
use super::compare::duration;
use super::cost::{kilobytes, nanoseconds};
use crate::measure::compare::{MOST_SAMPLES, Tried, Tuning};

/// One line a sampler that was tried, the quickest by counted time first.
pub fn tuning_sheet(material: &str, tuning: &Tuning) -> Sheet {
    let to = format!("to {} %, counted", percent(tuning.wish.error));
    let mut sheet = Sheet::new(&[
        material,
        "KB",
        "build s",
        "ns counted",
        "ns measured",
        "samples",
        &to,
        "with new seeds",
        "within limits",
        "slope",
    ]);
    for (i, tried) in tuning.tried.iter().enumerate() {
        let curve = &tried.curve;
        let mark = match tuning.chosen {
            Some(chosen) if chosen == i => "→ ",
            _ if tuning.ties.contains(&i) => "= ",
            _ => "",
        };
        let samples = tried.reach.map_or("never".into(), |r| {
            format!("{}{:.0}", if r.extrapolated { "~" } else { "" }, r.samples)
        });
        sheet.push(vec![
            format!("{mark}{}", curve.label),
            kilobytes(curve.table_bytes),
            format!("{:.3}", curve.build_seconds),
            format!("{:.0}", curve.counted.sample_ns),
            nanoseconds(&curve.ns_per_sample),
            samples,
            tried.counted_seconds.map_or(String::new(), duration),
            proved(tried),
            if tried.allowed { "yes" } else { "no" }.into(),
            format!("{:.2}", curve.sobol_slope),
        ]);
    }
    sheet
}

/// The error that a proof found, what came of one that failed, or nothing where none was made.
fn proved(tried: &Tried) -> String {
    match &tried.proof {
        Some(proof) => format!(
            "{} % ({}–{} %)",
            percent(proof.error.rmse),
            percent(proof.error.low),
            percent(proof.error.high)
        ),
        None if tried.unproved => "not confirmed".into(),
        None => String::new(),
    }
}

/// The choice with its proof and its neighbours, or how near one gets.
pub fn tuning_summary(material: &str, tuning: &Tuning) -> String {
    let asked = percent(tuning.wish.error);
    let Some(choice) = tuning.chosen.and_then(|i| tuning.tried.get(i)) else {
        return nearest(material, tuning);
    };
    let mut lines = vec![match &tuning.proof {
        Some(proof) => format!(
            "{material}: {} reaches {asked} % with {} samples, {} per estimate (counted), {} measured: {} % ({} to {} %) over \
             seeds {} to {}",
            choice.curve.label,
            proof.samples,
            duration(choice.counted_seconds.unwrap_or_default()),
            measured(choice, proof.samples as f64),
            percent(proof.error.rmse),
            percent(proof.error.low),
            percent(proof.error.high),
            proof.first_seed,
            proof.first_seed + proof.seeds - 1,
        ),
        None => format!(
            "{material}: {} would be the fastest to reach {asked} %, but needs more samples than were measured",
            choice.curve.label
        ),
    }];
    lines.extend(tie(tuning));
    for (how, index) in [
        ("with less memory", tuning.cheaper),
        ("with fewer samples", tuning.better),
    ] {
        let tried = index.and_then(|i| tuning.tried.get(i));
        lines.extend(tried.map(|t| neighbour(how, t)));
    }
    lines.join("\n")
}

/// Who ties with the choice and what decided.
fn tie(tuning: &Tuning) -> Option<String> {
    let mut names: Vec<&str> = Vec::new();
    for &i in &tuning.ties {
        names.extend(tuning.tried.get(i).map(|t| t.curve.label.as_str()));
    }
    (!names.is_empty()).then(|| {
        format!(
            "a tie within 25 % of counted time with {}: fewer samples decide, then fewer bytes",
            names.join(", ")
        )
    })
}

/// Measured seconds of an estimate without its part of the precomputation, with their interval.
fn measured(tried: &Tried, samples: f64) -> String {
    let cost = &tried.curve.ns_per_sample;
    let [mean, low, high] = [cost.ns, cost.low, cost.high].map(|ns| duration(ns * 1e-9 * samples));
    format!("{mean} ({low} to {high})")
}

fn neighbour(how: &str, tried: &Tried) -> String {
    let limits = if tried.allowed {
        ""
    } else {
        ", outside the limits"
    };
    let samples = tried.reach.map_or(0.0, |r| r.samples);
    format!(
        "{how}: {}, {} KB, {samples:.0} samples, {} counted, {} measured: {}{limits}",
        tried.curve.label,
        kilobytes(tried.curve.table_bytes),
        duration(tried.counted_seconds.unwrap_or_default()),
        measured(tried, samples),
        proved(tried),
    )
}

fn nearest(material: &str, tuning: &Tuning) -> String {
    let asked = percent(tuning.wish.error);
    match tuning.nearest() {
        Some((tried, end)) => format!(
            "{material}: no sampler within the limits reaches {asked} % with {MOST_SAMPLES:.0e} samples; {} is closest, with {} % at {} samples",
            tried.curve.label,
            percent(end.rmse),
            end.samples
        ),
        None => {
            format!(
                "{material}: no sampler is within the limits; allow more bytes or a longer build"
            )
        }
    }
}

/// Three significant digits of a fraction, in per cent.
fn percent(fraction: f64) -> String {
    let value = fraction * 100.0;
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
    fn fractions_keep_three_digits() {
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
