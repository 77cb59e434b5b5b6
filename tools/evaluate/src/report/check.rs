//! Outcomes of checks, worded.

use serde::Serialize;

use super::Sheet;
use crate::measure::check::{Check, CheckReport, Outcome};

/// The checks of one sampler for one material.
#[derive(Clone, Debug, Serialize)]
pub struct CheckResult {
    /// Short name of the material.
    pub material: String,
    /// The sampler, with its settings.
    pub sampler: String,
    /// What was found.
    #[serde(flatten)]
    pub report: CheckReport,
}

impl CheckResult {
    /// Columns of [`Self::line`].
    pub const HEADING: [&str; 9] = [
        "material",
        "sampler",
        "validity",
        "agreement",
        "positivity",
        "pdf integral",
        "chi-square",
        "bias",
        "furnace",
    ];

    /// One line: for each check, how many directions passed it, or how many of all failed.
    pub fn line(&self) -> Vec<String> {
        let checks = [
            Check::Validity,
            Check::Agreement,
            Check::Positivity,
            Check::PdfIntegral,
            Check::ChiSquare,
            Check::Bias,
            Check::Furnace,
        ];
        let mut line = vec![self.material.clone(), self.sampler.clone()];
        line.extend(checks.map(|check| self.count(check)));
        line
    }

    /// How many directions passed a check, or how many of all failed.
    fn count(&self, check: Check) -> String {
        let mut passed = 0;
        let mut all = 0;
        let mut unjudged = 0;
        for outcome in self.report.outcomes.iter().filter(|o| o.check == check) {
            passed += u32::from(outcome.pass);
            all += 1;
            unjudged += outcome.unjudged;
        }
        if passed == all && unjudged > 0 {
            format!("{passed} ok, {unjudged} cells unjudged")
        } else if passed == all {
            format!("{passed} ok")
        } else {
            format!("{} of {all} FAILED", all - passed)
        }
    }

    /// A row for each failed check, with where and what.
    pub fn failures(&self, sheet: &mut Sheet) {
        for o in self.report.failures() {
            let check = serde_json::to_value(o.check)
                .ok()
                .and_then(|v| v.as_str().map(str::to_owned));
            sheet.push(vec![
                self.material.clone(),
                self.sampler.clone(),
                check.unwrap_or_default(),
                format!("{:.2}, {:.1}", o.theta_o_deg, o.phi_o_deg),
                format!("{:.3e}", o.value),
                allowed(o),
                o.note.clone(),
            ]);
        }
    }

    /// An empty sheet for [`Self::failures`].
    pub fn failure_sheet() -> Sheet {
        Sheet::new(&[
            "material",
            "sampler",
            "failed check",
            "wo θ, φ °",
            "value",
            "allowed",
            "found",
        ])
    }
}

/// The bound of a check, with its direction: a p-value must not be below its bound, and nothing else above.
fn allowed(outcome: &Outcome) -> String {
    let direction = match outcome.check {
        Check::ChiSquare => "≥",
        _ => "≤",
    };
    format!("{direction} {:.3e}", outcome.bound)
}
