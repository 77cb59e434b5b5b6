//! What it comes to, in a sentence.

use serde::{Deserialize, Serialize};

use super::target::{SHARED_BY, reach};
use super::{Curve, Reach};
use crate::measure::convergence::Technique;

/// The error that verdicts are about.
const ERROR: f64 = 0.01;
/// Position in [`SHARED_BY`] of the samples that share the precomputation.
const SHARE: usize = 1;
/// Cosine sampling is enough where it takes no longer than this times the quickest.
const ENOUGH: f64 = 1.5;

/// Beyond this, a ratio says more of the extrapolation than of the samplers.
const MANY: f64 = 1000.0;

/// Who reaches an error in the least time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// The relative error.
    pub error: f64,
    /// Samples that share the precomputation.
    pub shared_by: u64,
    /// The quickest competitor.
    pub best: String,
    /// Its sampler.
    pub sampler: String,
    /// Bytes of its tables.
    pub table_bytes: usize,
    /// What it needs.
    pub reach: Reach,
    /// The quickest with another sampler, and its time over the best's.
    pub next: Option<(String, f64)>,
    /// Cosine sampling's time over the best's; `None` if it never gets there.
    pub cosine_ratio: Option<f64>,
    /// Whether that is beyond what was measured of the cosine.
    pub cosine_extrapolated: bool,
    /// All of that in words.
    pub sentence: String,
}

/// Who of `curves`, drawing from the BRDF alone, reaches 1 % of `material`'s lit point first, precomputation shared by 10⁶
/// samples. `None` if nobody does.
pub fn verdict(material: &str, curves: &[Curve]) -> Option<Verdict> {
    let brdf = curves
        .iter()
        .filter(|c| c.competitor.technique == Technique::Brdf);
    let mut order: Vec<(&Curve, Reach)> =
        brdf.filter_map(|c| Some((c, reach(c, ERROR)?))).collect();
    order.sort_by(|a, b| seconds(&a.1).total_cmp(&seconds(&b.1)));
    let &(best, best_reach) = order.first()?;
    let family = best.competitor.spec.name();
    let ratio = |r: &Reach| seconds(r) / seconds(&best_reach);
    let next = order
        .iter()
        .find(|(c, _)| c.competitor.spec.name() != family);
    let cosine = order
        .iter()
        .find(|(c, _)| c.competitor.spec.name() == "cosine");
    let mut verdict = Verdict {
        error: ERROR,
        shared_by: SHARED_BY[SHARE],
        best: best.label.clone(),
        sampler: family.into(),
        table_bytes: best.table_bytes,
        reach: best_reach,
        next: next.map(|(c, r)| (c.label.clone(), ratio(r))),
        cosine_ratio: cosine.map(|(_, r)| ratio(r)),
        cosine_extrapolated: cosine.is_some_and(|(_, r)| r.extrapolated),
        sentence: String::new(),
    };
    verdict.sentence = sentence(material, &verdict);
    Some(verdict)
}

fn seconds(reach: &Reach) -> f64 {
    reach.seconds[SHARE]
}

fn sentence(material: &str, v: &Verdict) -> String {
    let percent = v.error * 100.0;
    let enough = v.cosine_ratio.filter(|r| *r <= ENOUGH);
    if let Some(ratio) = enough {
        let beside = if v.sampler == "cosine" {
            "nothing is quicker".to_owned()
        } else {
            format!("{ratio:.1}× the time of {}, the quickest", v.best)
        };
        return format!("{material}: cosine is enough to reach {percent} % ({beside})");
    }
    let about = if v.cosine_extrapolated { "about " } else { "" };
    let against = match v.cosine_ratio {
        Some(ratio) if ratio >= MANY => format!("more than {MANY}× less time than cosine"),
        Some(ratio) if ratio >= 10.0 => format!("{about}{ratio:.0}× less time than cosine"),
        Some(ratio) => format!("{about}{ratio:.1}× less time than cosine"),
        None => "a time that cosine never would".into(),
    };
    let kilobytes = v.table_bytes as f64 / 1000.0;
    let next = v.next.as_ref().map_or(String::new(), |(who, ratio)| {
        format!("; next is {who} at {ratio:.1}×")
    });
    format!(
        "{material}: {} ({kilobytes:.1} KB) reaches {percent} % in {against}{next}",
        v.best
    )
}
