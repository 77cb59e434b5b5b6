//! Outcomes of hard cases, worded.

use super::Sheet;
use crate::measure::hard::{HardCheck, HardOutcome};
use merlkit::material::LookupRule;

/// Tables of hard cases.
#[derive(Clone, Debug)]
pub struct HardSheets {
    /// A row for each hard case.
    pub cases: Sheet,
    /// A row for each sampler; the first for lookups alone.
    pub samplers: Sheet,
    /// A row for each broken promise.
    pub failures: Sheet,
}

/// The row of samplers that stands for the BRDF alone.
const LOOKUPS: &str = "(lookups)";

impl HardSheets {
    /// Columns after the name of the row, in the order of [`HardCheck::ALL`].
    pub const CHECKS: [&str; 8] = [
        "values",
        "reciprocity",
        "draws",
        "pdf agreement",
        "pdf integral",
        "energy",
        "memory",
        "pictures",
    ];

    /// Sheets of outcomes, rows in the order in which their names first appear.
    pub fn from_outcomes(outcomes: &[HardOutcome]) -> Self {
        let mut failures = Sheet::new(&[
            "case", "lookup", "sampler", "check", "value", "allowed", "found",
        ]);
        for o in outcomes.iter().filter(|o| !o.pass) {
            failures.push(vec![
                o.case.into(),
                o.lookup.map_or("", LookupRule::name).into(),
                name_of(o).into(),
                format!("{:?}", o.check),
                format!("{:.3e}", o.value),
                o.bound.map_or_else(String::new, |b| format!("≤ {b:.3e}")),
                o.note.clone(),
            ]);
        }
        Self {
            cases: sheet("case", outcomes, |o| o.case),
            samplers: sheet("sampler", outcomes, name_of),
            failures,
        }
    }
}

fn name_of(outcome: &HardOutcome) -> &'static str {
    if outcome.sampler.is_empty() {
        LOOKUPS
    } else {
        outcome.sampler
    }
}

fn sheet(
    heading: &str,
    outcomes: &[HardOutcome],
    row_of: fn(&HardOutcome) -> &'static str,
) -> Sheet {
    let mut sheet = Sheet::new(&[&[heading], &HardSheets::CHECKS[..]].concat());
    let mut names: Vec<&str> = Vec::new();
    for o in outcomes {
        if !names.contains(&row_of(o)) {
            names.push(row_of(o));
        }
    }
    for name in names {
        let cells = HardCheck::ALL.map(|check| {
            let of: Vec<&HardOutcome> = outcomes
                .iter()
                .filter(|o| row_of(o) == name && o.check == check)
                .collect();
            cell(check, &of)
        });
        sheet.push([name.to_owned()].into_iter().chain(cells).collect());
    }
    sheet
}

/// What all outcomes of a row and column come to: what failed, or how much was looked at, or the worst value.
fn cell(check: HardCheck, outcomes: &[&HardOutcome]) -> String {
    let failed = outcomes.iter().filter(|o| !o.pass).count();
    let count: u64 = outcomes.iter().map(|o| o.count).sum();
    let worst = outcomes.iter().map(|o| o.value).fold(0.0, f64::max);
    // What nothing is promised of stands in brackets.
    let free = outcomes.iter().all(|o| o.bound.is_none());
    match check {
        _ if outcomes.is_empty() => String::new(),
        _ if failed > 0 => format!("{failed} of {} FAILED", outcomes.len()),
        HardCheck::Values | HardCheck::Draws | HardCheck::Picture => format!("{count} ok"),
        HardCheck::Memory => format!("{:.0} KB", worst / 1000.0),
        _ if free => format!("({worst:.1e})"),
        _ if worst == 0.0 => "0".into(),
        _ => format!("{worst:.1e}"),
    }
}
