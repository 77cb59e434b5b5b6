//! What was measured, and what it comes to.

use super::Section;
use super::html::{escape, marked_table, paragraph};
use crate::measure::compare::{
    Comparison, Curve, MaterialComparison, Verdict, reach, write_factor,
};
use crate::measure::convergence::Technique;
use crate::report::Sheet;
use crate::report::compare::duration;

/// A material's verdict as an item of the list.
fn verdict_item(material: &MaterialComparison) -> String {
    let sentence = match &material.verdict {
        Some(verdict) => verdict.sentence.clone(),
        None => format!(
            "{}: no sampler's error falls to 1 %, and none falls steadily enough to extrapolate",
            material.material
        ),
    };
    let loses = match loses(material) {
        Some(loses) => format!(" <span class=\"loses\">{}</span>", escape(&loses)),
        None => String::new(),
    };
    format!("<li>{}.{loses}</li>\n", escape(&sentence))
}

/// Every material's verdict.
pub(super) fn verdicts(comparison: &Comparison) -> Option<Section> {
    if comparison.materials.is_empty() {
        return Section::new("verdicts", "Verdicts", paragraph("Nothing was measured."));
    }
    let items: String = comparison.materials.iter().map(verdict_item).collect();
    let note = "Verdicts compare the time to reach a relative error of 1 % at the lit point, with the build time spread over 10⁶ \
                samples, among samplers that draw from the BRDF only. Counted times come from a fixed cost per sample of \
                each sampler, so that the same run gives the same verdict; the tables below also have measured times. \
                Counted times within 25 % of the smallest are a tie; the sampler with the fewest samples wins, then the \
                one with the fewest bytes. A ~ in the tables marks extrapolated sample counts.";
    let table = marked_table("Time to reach 1 %", &summary(comparison), FASTEST);
    let body = format!(
        "{table}<ul class=\"verdicts\">\n{items}</ul>\n{}",
        paragraph(note)
    );
    Section::new("verdicts", "Verdicts", body)
}

/// That the half-vector table is not the choice, where it isn't, and whether it ties.
fn loses(material: &MaterialComparison) -> Option<String> {
    let verdict = material
        .verdict
        .as_ref()
        .filter(|v| v.sampler != HALF_VECTOR)?;
    let name = &material.material;
    let half_vector = quickest(&material.curves, |c| {
        c.competitor.technique == Technique::Brdf && c.competitor.spec.name() == HALF_VECTOR
    });
    Some(match half_vector {
        Some((label, _)) if verdict.ties.iter().any(|t| t == label) => format!(
            "On {name}, the choice is {}, not the half-vector table; it ties with {label}.",
            verdict.best
        ),
        Some((label, seconds)) => format!(
            "On {name}, the half-vector table is not the fastest: {} is, and {label} takes {}.",
            verdict.best,
            times(seconds, verdict)
        ),
        None => format!(
            "On {name}, the half-vector table is not the fastest: {} is, and no half-vector table reaches 1 %.",
            verdict.best
        ),
    })
}

/// Its name in [`Verdict::sampler`].
const HALF_VECTOR: &str = "half-vector";

fn times(seconds: f64, verdict: &Verdict) -> String {
    format!("{} the time", write_factor(seconds / seconds_of(verdict)))
}

/// Counted seconds to the verdict's error.
fn seconds_of(verdict: &Verdict) -> f64 {
    verdict.reach.counted_seconds[1]
}

/// Label and counted seconds to 1 % of the quickest of some.
fn quickest(curves: &[Curve], of: impl Fn(&Curve) -> bool) -> Option<(&str, f64)> {
    let times = curves
        .iter()
        .filter(|c| of(c))
        .filter_map(|c| Some((c.label.as_str(), reach(c, 0.01)?.counted_seconds[1])));
    times.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Column of [`summary`] with the winner.
const FASTEST: usize = 1;

/// What a competitor takes beside the winner, which says nothing of itself.
fn compare_with_winner((label, seconds): (&str, f64), verdict: &Verdict) -> String {
    if label == verdict.best {
        "the fastest".into()
    } else {
        format!("{label}: {}", times(seconds, verdict))
    }
}

fn summary(comparison: &Comparison) -> Sheet {
    let mut sheet = Sheet::new(&[
        "material",
        "fastest",
        "KB",
        "counted time to 1 %",
        "cosine",
        "best half-vector table",
        "best with light sampling",
    ]);
    for material in &comparison.materials {
        let Some(verdict) = &material.verdict else {
            continue;
        };
        let table = quickest(&material.curves, |c| {
            draws_from_brdf(c) && c.competitor.spec.name() == HALF_VECTOR
        });
        let light = quickest(&material.curves, |c| !draws_from_brdf(c));
        sheet.push(vec![
            material.material.clone(),
            verdict.best.clone(),
            format!("{:.1}", verdict.table_bytes as f64 / 1000.0),
            duration(seconds_of(verdict)),
            verdict
                .cosine_ratio
                .map_or("never".into(), |r| match r < 1000.0 {
                    true => format!("{} the time", write_factor(r)),
                    false => "over 1000× the time".into(),
                }),
            table.map_or("never".into(), |t| compare_with_winner(t, verdict)),
            light.map_or("not measured".into(), |t| compare_with_winner(t, verdict)),
        ]);
    }
    sheet
}

fn draws_from_brdf(curve: &Curve) -> bool {
    curve.competitor.technique == Technique::Brdf
}
