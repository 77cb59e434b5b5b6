//! The 2008 thesis's tables beside ours, as ratios.

use serde::Serialize;

use super::Sheet;
use super::thesis::{THESIS_KB, cost_rows, thesis_uniform_memory};
use crate::measure::compare::{Comparison, Curve, MaterialComparison, Setting};
use crate::measure::convergence::Technique;
use merlkit::sampler::{
    AdaptiveDiscSettings, CascadeCdfSettings, HalfVectorSettings, LeafChoice, SamplerSpec,
};

/// One table of the thesis, with our counterparts.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ThesisTable {
    /// Its number and what it shows.
    pub title: String,
    /// What is held against what, and how they differ.
    pub note: String,
    /// The figures; ratios are the thesis's over ours.
    pub sheet: Sheet,
}

impl ThesisTable {
    pub(super) fn new(title: &str, note: &str, sheet: Sheet) -> Option<Self> {
        (!sheet.rows.is_empty()).then(|| Self {
            title: title.into(),
            note: note.into(),
            sheet,
        })
    }
}

/// The tables for which something was measured: 5.9, 5.10, 6.23, 6.24 and the rankings of 6.14 and 6.22. Materials
/// and numbers of samples that the thesis doesn't have are left out.
pub fn beside_thesis(comparison: &Comparison) -> Vec<ThesisTable> {
    let costs = [
        uniform_memory(comparison),
        compressed(comparison),
        precomputation(comparison),
        drawing(comparison),
    ];
    costs
        .into_iter()
        .chain(super::thesis_ranking::rankings(comparison))
        .flatten()
        .collect()
}

/// Ours of a sampler that the thesis has too.
struct Ours {
    label: String,
    table_bytes: usize,
    build_seconds: f64,
    ns_per_sample: Option<f64>,
}

impl From<&Curve> for Ours {
    fn from(c: &Curve) -> Self {
        let Curve {
            label,
            table_bytes,
            build_seconds,
            ns_per_sample,
            ..
        } = c;
        let (table_bytes, build_seconds) = (*table_bytes, *build_seconds);
        Self {
            label: label.clone(),
            table_bytes,
            build_seconds,
            ns_per_sample: Some(ns_per_sample.ns),
        }
    }
}

impl From<&Setting> for Ours {
    fn from(s: &Setting) -> Self {
        let label = s.knob.spec.to_string();
        Self {
            label,
            table_bytes: s.table_bytes,
            build_seconds: s.build_seconds,
            ns_per_sample: None,
        }
    }
}

impl Ours {
    fn kb(&self) -> f64 {
        self.table_bytes as f64 / THESIS_KB
    }
}

/// Cascade CDFs without compression, by size.
fn whole_cdfs<'a>(comparison: &'a Comparison, material: Option<&str>) -> Vec<&'a Setting> {
    let of = comparison
        .settings
        .iter()
        .find(|s| material.is_none_or(|m| s.material == m));
    let mut all: Vec<&Setting> = of.iter().flat_map(|s| &s.settings).collect();
    all.retain(|s| is_cascade(&s.knob.spec, |c| c.tolerance.is_none()));
    all.sort_by_key(|s| s.table_bytes);
    all
}

/// What of ours does what the thesis's method does.
fn counterpart(
    comparison: &Comparison,
    material: &MaterialComparison,
    method: &str,
) -> Option<Ours> {
    let curve = |of: &dyn Fn(&SamplerSpec) -> bool| {
        let brdf = material
            .curves
            .iter()
            .filter(|c| c.competitor.technique == Technique::Brdf);
        brdf.into_iter()
            .find(|c| of(&c.competitor.spec))
            .map(Ours::from)
    };
    match method {
        "uniform" => curve(&|s| s.name() == "cosine"),
        "uniform CDF" => whole_cdfs(comparison, Some(&material.material))
            .last()
            .map(|s| Ours::from(*s)),
        "compressed CDF" => curve(&|s| is_cascade(s, |c| c.tolerance.is_some())),
        "adaptive disc" => curve(&is_plain_disc),
        _ => curve(&|s| s.settings() == Some(&HalfVectorSettings::default())),
    }
}

/// Whether it is the thesis's own kind of adaptive disc.
pub(super) fn is_plain_disc(spec: &SamplerSpec) -> bool {
    spec.settings::<AdaptiveDiscSettings>()
        .is_some_and(|s| s.depth > 0 && s.leaves != LeafChoice::Warp)
}

/// Whether it is a cascade CDF of such settings.
fn is_cascade(spec: &SamplerSpec, matches: impl Fn(&CascadeCdfSettings) -> bool) -> bool {
    spec.settings().is_some_and(matches)
}

fn uniform_memory(comparison: &Comparison) -> Option<ThesisTable> {
    let whole = whole_cdfs(comparison, None);
    let mut sheet = Sheet::new(&[
        "thesis cells, θ × φ",
        "thesis KB",
        "ours",
        "ours KB",
        "ratio",
    ]);
    for (theta, phi, kb) in thesis_uniform_memory() {
        let fine_enough = whole.iter().find(|s| {
            is_cascade(&s.knob.spec, |c| {
                c.theta_h >= theta as usize && c.phi_h >= phi as usize
            })
        });
        let Some(ours) = fine_enough.map(|s| Ours::from(*s)) else {
            continue;
        };
        let figures = [
            format!("{kb:.0}"),
            ours.label.clone(),
            figure(ours.kb()),
            ratio(kb, ours.kb()),
        ];
        sheet.push(
            std::iter::once(format!("{theta} × {phi}"))
                .chain(figures)
                .collect(),
        );
    }
    let note = "Each resolution in the thesis is compared with our smallest uncompressed CDF that is at least as fine in both \
                angles. 1 KB is 1024 bytes, as in the thesis.";
    ThesisTable::new("Table 5.9: memory of CDFs without compression", note, sheet)
}

fn compressed(comparison: &Comparison) -> Option<ThesisTable> {
    let mut sheet = Sheet::new(&COSTS);
    for material in &comparison.materials {
        let Some(thesis) = cost_rows(&material.material).compressed else {
            continue;
        };
        push_costs(&mut sheet, comparison, material, "compressed CDF", thesis);
    }
    let note = "The thesis compresses CDFs of 33792 KB with the Douglas–Peucker algorithm; ours are built compressed. 1 KB is \
                1024 bytes.";
    ThesisTable::new("Table 5.10: compressed CDFs", note, sheet)
}

const COSTS: [&str; 9] = [
    "material",
    "method",
    "ours",
    "thesis KB",
    "ours KB",
    "ratio",
    "thesis s",
    "ours s",
    "ratio",
];

fn precomputation(comparison: &Comparison) -> Option<ThesisTable> {
    let mut sheet = Sheet::new(&COSTS);
    for material in &comparison.materials {
        for (method, thesis) in cost_rows(&material.material).precompute {
            push_costs(&mut sheet, comparison, material, method, thesis);
            if method == "adaptive disc" {
                push_costs(&mut sheet, comparison, material, NEW, thesis);
            }
        }
    }
    let note = "Build time in seconds, ours on all threads, and table memory; 1 KB is 1024 bytes. The thesis has no half-vector \
                table; ours is compared with the thesis's adaptive disc.";
    ThesisTable::new("Table 6.23: precomputation and memory", note, sheet)
}

/// What the thesis has nothing like: held against its adaptive disc.
const NEW: &str = "half-vector, compared with adaptive disc";

/// A row of memory and seconds, if ours was measured.
fn push_costs(
    sheet: &mut Sheet,
    comparison: &Comparison,
    material: &MaterialComparison,
    method: &str,
    (kb, seconds): (f64, f64),
) {
    let Some(ours) = counterpart(comparison, material, method) else {
        return;
    };
    let memory = [format!("{kb:.0}"), figure(ours.kb()), ratio(kb, ours.kb())];
    let time = [
        figure(seconds),
        figure(ours.build_seconds),
        ratio(seconds, ours.build_seconds),
    ];
    let start = [material.material.clone(), method.into(), ours.label];
    sheet.push(start.into_iter().chain(memory).chain(time).collect());
}

/// Samples of the picture of table 6.24: 450 × 200 pixels at 25.
const DRAWN: f64 = 450.0 * 200.0 * 25.0;

fn drawing(comparison: &Comparison) -> Option<ThesisTable> {
    let mut sheet = Sheet::new(&["material", "method", "ours", "thesis s", "ours s", "ratio"]);
    for material in &comparison.materials {
        let mut methods = cost_rows(&material.material).sampling;
        let disc = methods
            .iter()
            .find(|m| m.0 == "adaptive disc")
            .map(|m| (NEW, m.1));
        methods.extend(disc);
        for (method, thesis) in methods {
            let Some(ours) = counterpart(comparison, material, method) else {
                continue;
            };
            let Some(seconds) = ours.ns_per_sample.map(|ns| ns * 1e-9 * DRAWN) else {
                continue;
            };
            let start = [material.material.clone(), method.into(), ours.label];
            let figures = [
                format!("{thesis:.2}"),
                figure(seconds),
                ratio(thesis, seconds),
            ];
            sheet.push(start.into_iter().chain(figures).collect());
        }
    }
    let note = "The thesis gives the seconds for drawing the directions of a picture of 450 × 200 pixels at 25 samples per pixel. \
                Ours are for the same number of samples at the lit point on one thread, and include random numbers, \
                density, BRDF and light. Our cosine sampler is compared with the thesis's uniform directions.";
    ThesisTable::new("Table 6.24: sampling time", note, sheet)
}

/// A figure to three digits.
pub(super) fn figure(value: f64) -> String {
    match value {
        v if v >= 100.0 => format!("{v:.0}"),
        v if v >= 1.0 => format!("{v:.2}"),
        v if v >= 0.001 => format!("{v:.4}"),
        v => format!("{v:.1e}"),
    }
}

/// The thesis's over ours; nothing where ours is 0.
fn ratio(thesis: f64, ours: f64) -> String {
    if ours > 0.0 {
        figure(thesis / ours)
    } else {
        String::new()
    }
}
