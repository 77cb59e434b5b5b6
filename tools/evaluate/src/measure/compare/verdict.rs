//! What it comes to, in a sentence.

use serde::{Deserialize, Serialize};

use super::target::{SHARED_BY, reach};
use super::tie::{Contender, best};
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

/// Who reaches an error in the least counted time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// The relative error.
    pub error: f64,
    /// Samples that share the precomputation.
    pub shared_by: u64,
    /// The quickest competitor; of equals in time the one with the fewest samples, then with the fewest bytes.
    pub best: String,
    /// Its sampler.
    pub sampler: String,
    /// Bytes of its tables.
    pub table_bytes: usize,
    /// What it needs.
    pub reach: Reach,
    /// Competitors whose counted time is within [`super::TIE`] of the least: they tie with the best.
    pub ties: Vec<String>,
    /// The quickest with another sampler that does not tie, and its counted time over the best's.
    pub next: Option<(String, f64)>,
    /// Cosine sampling's counted time over the best's; `None` if it never gets there.
    pub cosine_ratio: Option<f64>,
    /// Whether that is beyond what was measured of the cosine.
    pub cosine_extrapolated: bool,
    /// All of that in words.
    pub sentence: String,
}

/// Who of `curves`, drawing from the BRDF alone, reaches 1 % of `material`'s lit point first by counted time, precomputation
/// shared by 10⁶ samples. `None` if nobody does.
pub fn verdict(material: &str, curves: &[Curve]) -> Option<Verdict> {
    let mut order: Vec<(&Curve, Reach)> = Vec::new();
    for curve in curves {
        if curve.competitor.technique == Technique::Brdf {
            order.extend(reach(curve, ERROR).map(|r| (curve, r)));
        }
    }
    // By label first, so that the order of the curves decides nothing.
    order.sort_by(|a, b| a.0.label.cmp(&b.0.label));
    order.sort_by(|a, b| seconds(&a.1).total_cmp(&seconds(&b.1)));
    let contenders: Vec<Option<Contender>> =
        order.iter().map(|(c, r)| Some(contender(c, r))).collect();
    let winner = best(&contenders)?;
    let (best, best_reach) = order[winner.index];
    let family = best.competitor.spec.name();
    let ratio = |r: &Reach| seconds(r) / seconds(&best_reach);
    let behind = |i: usize| i != winner.index && !winner.ties.contains(&i);
    let next = (0..order.len())
        .find(|&i| behind(i) && order[i].0.competitor.spec.name() != family)
        .map(|i| (order[i].0.label.clone(), ratio(&order[i].1)));
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
        ties: winner
            .ties
            .iter()
            .map(|&i| order[i].0.label.clone())
            .collect(),
        next,
        cosine_ratio: cosine.map(|(_, r)| ratio(r)),
        cosine_extrapolated: cosine.is_some_and(|(_, r)| r.extrapolated),
        sentence: String::new(),
    };
    verdict.sentence = sentence(material, &verdict);
    Some(verdict)
}

fn contender(curve: &Curve, reach: &Reach) -> Contender {
    Contender {
        seconds: seconds(reach),
        samples: reach.samples,
        bytes: curve.table_bytes,
    }
}

fn seconds(reach: &Reach) -> f64 {
    reach.counted_seconds[SHARE]
}

/// A ratio of times with as many digits as counted times deserve: "1.4×", "26×".
pub(crate) fn write_factor(ratio: f64) -> String {
    if ratio < 10.0 {
        format!("{ratio:.1}×")
    } else {
        format!("{ratio:.0}×")
    }
}

fn sentence(material: &str, v: &Verdict) -> String {
    let percent = v.error * 100.0;
    let tie = match &v.ties[..] {
        [] => String::new(),
        [one] => format!("; a tie with {one}, in which fewer samples decide, then fewer bytes"),
        all => format!(
            "; a tie with {} others ({}), in which fewer samples decide, then fewer bytes",
            all.len(),
            all.join(", ")
        ),
    };
    let enough = v.cosine_ratio.filter(|r| *r <= ENOUGH);
    if let Some(ratio) = enough {
        let margin = if v.sampler == "cosine" {
            "nothing is faster".to_owned()
        } else {
            format!("{} the counted time of {}", write_factor(ratio), v.best)
        };
        return format!(
            "{material}: of the samplers that draw from the BRDF alone, cosine is enough to reach {percent} % ({margin}{tie})"
        );
    }
    let about = if v.cosine_extrapolated { "about " } else { "" };
    let against = match v.cosine_ratio {
        Some(ratio) if ratio >= MANY => format!("more than {MANY}× faster than cosine"),
        Some(ratio) => format!("{about}{} faster than cosine", write_factor(ratio)),
        None => "which cosine never does".into(),
    };
    let kilobytes = v.table_bytes as f64 / 1000.0;
    let next = v.next.as_ref().map_or(String::new(), |(who, ratio)| {
        format!(
            "; {who} comes next and takes {} as long",
            write_factor(*ratio)
        )
    });
    format!(
        "{material}: of the samplers that draw from the BRDF alone, {} ({kilobytes:.1} KB) reaches {percent} % in the least \
         counted time, {against}{tie}{next}",
        v.best
    )
}
