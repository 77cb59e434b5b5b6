//! The shape of the thesis's rankings, tables 6.14 and 6.22, beside those of our pictures.

use super::Sheet;
use super::beside_thesis::{ThesisTable, is_plain_disc};
use super::thesis::errors_by_samples;
use crate::measure::compare::{Comparison, Competitor, PictureComparison, SceneKind};
use crate::measure::convergence::Technique;
use crate::thesis::published::{TABLE_6_14 as SCENE_2, TABLE_6_22 as SCENE_6};
use merlkit::sampler::{HalfVectorSettings, LobeKind, LobeSettings, SamplerSpec};

/// The thesis's name for a sampler, empty for one that is new; what stands beside it here, and how that is told.
struct Pair {
    thesis: &'static str,
    ours: &'static str,
    matches: fn(&Competitor) -> bool,
}

const fn pair(thesis: &'static str, ours: &'static str, matches: fn(&Competitor) -> bool) -> Pair {
    Pair {
        thesis,
        ours,
        matches,
    }
}

fn brdf(c: &Competitor, of: impl Fn(&SamplerSpec) -> bool) -> bool {
    c.technique == Technique::Brdf && of(&c.spec)
}

fn lobe(c: &Competitor, kind: LobeKind) -> bool {
    brdf(c, |s| {
        s.settings::<LobeSettings>().is_some_and(|l| l.kind == kind)
    })
}

fn is_half_vector(spec: &SamplerSpec) -> bool {
    spec.settings() == Some(&HalfVectorSettings::default())
}

const FACTORED: Pair = pair("factored", "factored", |c| {
    brdf(c, |s| s.name() == "factored")
});
const DISC: Pair = pair("adaptive_disc", "adaptive disc", |c| brdf(c, is_plain_disc));
const HALF_VECTOR: Pair = pair("", "half-vector", |c| brdf(c, is_half_vector));

const OF_SCENE_2: [Pair; 6] = [
    pair("uniform", "cosine", |c| brdf(c, |s| s.name() == "cosine")),
    pair("lobe_sphere", "lobe on the sphere", |c| {
        lobe(c, LobeKind::CosineLobeSphere)
    }),
    pair("lobe_hemisphere", "lobe on the hemisphere", |c| {
        lobe(c, LobeKind::CosineLobe)
    }),
    FACTORED,
    DISC,
    HALF_VECTOR,
];

const OF_SCENE_6: [Pair; 7] = [
    pair("uniform_ris", "cosine with RIS", |c| {
        matches!(c.technique, Technique::Ris(_)) && c.spec.name() == "cosine"
    }),
    FACTORED,
    pair("factored_ris", "factored with RIS", |c| {
        matches!(c.technique, Technique::Ris(_)) && c.spec.name() == "factored"
    }),
    DISC,
    pair("adaptive_disc_ris", "adaptive disc with RIS", |c| {
        matches!(c.technique, Technique::Ris(_)) && is_plain_disc(&c.spec)
    }),
    HALF_VECTOR,
    pair("", "half-vector with RIS", |c| {
        matches!(c.technique, Technique::Ris(_)) && is_half_vector(&c.spec)
    }),
];

/// Both rankings, where the scene was rendered at one of the thesis's numbers of samples.
pub(super) fn rankings(comparison: &Comparison) -> [Option<ThesisTable>; 2] {
    let of = |scene, table, pairs: &[Pair]| ranking(comparison, scene, table, pairs);
    let note = "Each cell is the ratio of the error to the smallest in its row, followed by the mean relative error itself. \
                The scenes differ, so absolute errors can't be compared; the order of the samplers and the ratios can.";
    let scene_2 = "The thesis renders its scene 2, a sphere, and averages over 16 analytic models; ours is a sphere of the named material on the ground \
                   under a square light. Our cosine sampler is compared with the thesis's uniform directions.";
    let scene_6 = "The thesis renders its scene 6, a jar under an environment, and averages over 16 analytic models; ours is a sphere of \
                   the named material in the studio. Our cosine with resampling is compared with the thesis's uniform directions with \
                   resampling; the numbers of candidates differ.";
    [
        ThesisTable::new(
            "Table 6.14: ranking by error, glossy sphere",
            &format!("{scene_2} {note}"),
            of(SceneKind::Glossy, SCENE_2, &OF_SCENE_2),
        ),
        ThesisTable::new(
            "Table 6.22: ranking by error, environment",
            &format!("{scene_6} {note}"),
            of(SceneKind::Environment, SCENE_6, &OF_SCENE_6),
        ),
    ]
}

fn ranking(
    comparison: &Comparison,
    scene: SceneKind,
    table: &'static str,
    pairs: &[Pair],
) -> Sheet {
    let mut sheet = Sheet::new(&["whose", "samples"]);
    sheet
        .heading
        .extend(pairs.iter().map(|p| p.ours.to_owned()));
    sheet.heading.push("order, best first".into());
    for (samples, thesis) in errors_by_samples(table) {
        let ours: Vec<_> = comparison
            .pictures
            .iter()
            .filter(|p| p.scene == scene)
            .filter_map(|p| Some((p.material.clone(), errors(p, samples, pairs)?)))
            .collect();
        if ours.is_empty() {
            continue;
        }
        let mut percent = Vec::new();
        for pair in pairs {
            let found = thesis.iter().find(|t| t.0 == pair.thesis);
            percent.push(found.map(|t| t.1 / 100.0));
        }
        sheet.push(row("thesis", samples, pairs, &percent));
        for (material, errors) in ours {
            sheet.push(row(&material, samples, pairs, &errors));
        }
    }
    sheet
}

/// Errors of a picture's counterparts at a number of samples; `None` without any.
fn errors(picture: &PictureComparison, samples: u64, pairs: &[Pair]) -> Option<Vec<Option<f64>>> {
    let mut all = Vec::with_capacity(pairs.len());
    for pair in pairs {
        let result = picture
            .results
            .iter()
            .find(|r| r.samples == samples && (pair.matches)(&r.competitor));
        all.push(result.map(|r| r.errors.mean_relative));
    }
    all.iter().any(Option::is_some).then_some(all)
}

fn row(whose: &str, samples: u64, pairs: &[Pair], errors: &[Option<f64>]) -> Vec<String> {
    let least = errors
        .iter()
        .flatten()
        .copied()
        .fold(f64::INFINITY, f64::min);
    let mut order: Vec<(&str, f64)> = pairs
        .iter()
        .zip(errors)
        .filter_map(|(p, e)| Some((p.ours, (*e)?)))
        .collect();
    order.sort_by(|a, b| a.1.total_cmp(&b.1));
    let names: Vec<&str> = order.iter().map(|o| o.0).collect();
    let mut row = vec![whose.to_owned(), samples.to_string()];
    for error in errors {
        row.push(match error {
            Some(e) if least > 0.0 => format!("{:.2} ({:.1} %)", e / least, e * 100.0),
            Some(e) => format!("{:.1} %", e * 100.0),
            None => "–".into(),
        });
    }
    row.push(names.join(" < "));
    row
}
