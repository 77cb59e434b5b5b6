//! Errors of several samplers over several materials, next to a table of the thesis.

use super::exhibit::{ResultCell, ResultTable, mean, rank_correlation, write_order, write_ratio};
use super::published::{PublishedTable, published_number};
use super::stage::StagePiece;

/// Percent of a table's sampler at a number of samples. Tables have samplers as rows, or as columns.
fn printed_error(table: &str, name: &str, samples: u64) -> Option<f64> {
    let column = format!("n{samples}");
    published_number(table, name, &column)
        .or_else(|| published_number(table, &samples.to_string(), name))
}

/// Mean error of a sampler over the materials.
fn mean_error(pieces: &[(&str, StagePiece)], name: &str, samples: u64) -> Option<f64> {
    let mut errors = Vec::new();
    for (_, piece) in pieces {
        errors.push(piece.find(name, samples)?.error);
    }
    (!errors.is_empty()).then(|| mean(&errors))
}

/// The table of mean errors in percent, and what it says of the order of the samplers and of how errors fall.
pub(super) fn compare_errors(
    published: &str,
    caption: &str,
    names: &[&str],
    pieces: &[(&str, StagePiece)],
    samples: &[u64],
) -> (ResultTable, Vec<String>) {
    let mut heading = vec!["sampler".to_owned()];
    for n in samples {
        heading.push(format!("thesis, {n}"));
        heading.push(format!("ours, {n}"));
    }
    let columns: Vec<&str> = heading.iter().map(String::as_str).collect();
    let mut table = ResultTable::new(caption, &columns);
    for name in names {
        let mut row = vec![ResultCell::from(*name)];
        for &n in samples {
            row.push(printed_error(published, name, n).into());
            row.push(mean_error(pieces, name, n).map(|e| 100.0 * e).into());
        }
        table.push(row);
    }
    let mut findings = Vec::new();
    for &n in samples {
        findings.extend(describe_order(published, names, pieces, n));
    }
    findings.extend(describe_fall(names, pieces, samples));
    (table, findings)
}

/// The order of the samplers that both have, at a number of samples.
fn describe_order(
    published: &str,
    names: &[&str],
    pieces: &[(&str, StagePiece)],
    samples: u64,
) -> Option<String> {
    let (mut theirs, mut ours) = (Vec::new(), Vec::new());
    for &name in names {
        if let Some(printed) = printed_error(published, name, samples)
            && let Some(found) = mean_error(pieces, name, samples)
        {
            theirs.push((name, printed));
            ours.push((name, found));
        }
    }
    if ours.len() < 2 {
        return None;
    }
    let [a, b] = [&theirs, &ours].map(|side| side.iter().map(|s| s.1).collect::<Vec<f64>>());
    let correlation = rank_correlation(&a, &b).map_or("none".into(), |c| format!("{c:.2}"));
    Some(format!(
        "Order of the errors at {samples} samples: {} in the thesis, {} here; rank correlation {correlation}.",
        write_order(&theirs),
        write_order(&ours)
    ))
}

/// How our errors fall, against 1/√N.
fn describe_fall(names: &[&str], pieces: &[(&str, StagePiece)], samples: &[u64]) -> Option<String> {
    let (first, last) = (*samples.first()?, *samples.last()?);
    let mut falls = Vec::new();
    for name in names {
        let from = mean_error(pieces, name, first)?;
        let to = mean_error(pieces, name, last)?;
        falls.push(format!("{name} {}", write_ratio(from / to)));
    }
    Some(format!(
        "From {first} to {last} samples our errors fall by these factors, where 1/√N makes {}: {}.",
        write_ratio((last as f64 / first as f64).sqrt()),
        falls.join(", ")
    ))
}

/// Which of a table's errors level off.
pub(super) fn describe_levels(number: &str) -> String {
    let table = PublishedTable::find(number);
    let mut levels = Vec::new();
    for name in table.map_or_else(Vec::new, |t| t.names()) {
        let (Some(few), Some(many)) = (
            printed_error(number, name, 2500),
            printed_error(number, name, 1_000_000),
        ) else {
            continue;
        };
        levels.push(format!("{name} {few} to {many} %"));
    }
    format!(
        "Errors of the thesis's table {number} level off from 2500 to 1,000,000 samples, where 1/√N makes a twentieth: {}. Its reference is the \
         mean over all samplers, so this is the distance between a sampler and that mean, and no noise.",
        levels.join(", ")
    )
}

/// The references' own errors.
pub(super) fn describe_references(pieces: &[(&str, StagePiece)]) -> String {
    let mut errors = Vec::new();
    let mut samples = 0;
    for (_, piece) in pieces {
        errors.push(100.0 * piece.reference_error);
        samples = piece.reference_samples;
    }
    let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
    let most = errors.iter().copied().fold(0.0, f64::max);
    format!(
        "The references have {samples} samples and errors of their own of {least:.2} to {most:.2} %; errors near these are partly theirs."
    )
}
