//! What accuracy costs, as tables.

use serde::Serialize;

use super::cost::{kilobytes, nanoseconds};
use super::digits::significant;
use super::{Sheet, ThesisTable, beside_thesis};
use crate::measure::compare::{
    Comparison, Curve, ErrorPoint, MaterialComparison, PICTURE_SAMPLES, PictureComparison,
    PictureResult, Reach, SHARED_BY, TARGETS, reach,
};

/// What compare.json holds: the comparison's own fields, and the thesis's tables beside it.
#[derive(Clone, Debug, Serialize)]
pub struct ComparisonDocument<'a> {
    #[serde(flatten)]
    comparison: &'a Comparison,
    thesis: Vec<ThesisTable>,
}

impl<'a> ComparisonDocument<'a> {
    /// With everything that a comparison has beside the thesis.
    pub fn new(comparison: &'a Comparison) -> Self {
        Self {
            comparison,
            thesis: beside_thesis(comparison),
        }
    }
}

/// What each competitor costs, and what it needs to reach each of [`TARGETS`] at the lit point: counted seconds of one estimate,
/// precomputation shared by 10⁶ samples, and samples in brackets. The quickest first, by the time to 1 %.
pub fn targets(material: &MaterialComparison) -> [Sheet; 2] {
    let name = &material.material;
    let mut costs = Sheet::new(&[name, "KB", "build s", "ns counted", "ns measured", "slope"]);
    let mut needs = Sheet::new(&[name]);
    let errors = TARGETS.map(|t| format!("to {} %", t * 100.0));
    needs.heading.extend(errors);
    for curve in by_time(&material.curves) {
        costs.push(vec![
            curve.label.clone(),
            kilobytes(curve.table_bytes),
            format!("{:.3}", curve.build_seconds),
            format!("{:.0}", curve.counted.sample_ns),
            nanoseconds(&curve.ns_per_sample),
            format!("{:.2}", curve.sobol_slope),
        ]);
        let mut row = vec![curve.label.clone()];
        row.extend(TARGETS.map(|target| reach(curve, target).map_or("never".into(), |r| cost(&r))));
        needs.push(row);
    }
    [costs, needs]
}

/// The curves, the quickest to 1 % by counted time first.
pub(super) fn by_time(curves: &[Curve]) -> Vec<&Curve> {
    let mut order: Vec<&Curve> = curves.iter().collect();
    order.sort_by(|a, b| seconds_to_one_percent(a).total_cmp(&seconds_to_one_percent(b)));
    order
}

/// Counted time to an error of 1 %; infinite for a curve that does not reach it.
fn seconds_to_one_percent(curve: &Curve) -> f64 {
    reach(curve, 0.01).map_or(f64::INFINITY, |r| r.counted_seconds[1])
}

/// "12 µs (340)", with "~" where the samples are extrapolated.
fn cost(reach: &Reach) -> String {
    let seconds = reach.counted_seconds[1];
    let is_rough = reach.extrapolated && seconds <= HOUR;
    let about = if is_rough { "~" } else { "" };
    format!("{about}{} ({})", duration(seconds), count(reach.samples))
}

/// Samples, as a whole number while it can be read.
pub(super) fn count(samples: f64) -> String {
    if samples < 1e6 {
        format!("{:.0}", samples.ceil())
    } else {
        format!("{samples:.1e}")
    }
}

/// Estimates that take longer than an hour are not worth a figure.
pub(super) const HOUR: f64 = 3600.0;

/// Two digits of seconds in the unit that suits them; beyond an hour "> 1 h".
pub(super) fn duration(seconds: f64) -> String {
    if seconds > HOUR {
        return "> 1 h".into();
    }
    for (unit, name) in [
        (1e-9, "ns"),
        (1e-6, "µs"),
        (1e-3, "ms"),
        (1.0, "s"),
        (60.0, "min"),
    ] {
        if seconds < 1000.0 * unit || name == "min" {
            return format!("{} {name}", significant(seconds / unit, 2));
        }
    }
    String::new()
}

/// A percentage with two digits, or whole ones from 100 % on.
pub(super) fn percent(fraction: f64) -> String {
    format!("{} %", significant(100.0 * fraction, 2))
}

/// The pictures of a scene with the most samples of which the page shows some, the least error first: each one's mean relative
/// error, mean FLIP and render time, after the reference's own error.
pub fn picture_sheet(picture: &PictureComparison) -> Sheet {
    let title = format!("{}: {}", picture.scene.name(), picture.material);
    let mut sheet = Sheet::new(&[&title, "error", "FLIP", "render"]);
    sheet.push(vec![
        format!("reference, {} samples", picture.reference.samples),
        percent(picture.reference.relative_error),
        String::new(),
        String::new(),
    ]);
    for result in by_error(picture) {
        sheet.push(vec![
            result.label.clone(),
            percent(result.errors.mean_relative),
            flip(result),
            duration(result.seconds.wall),
        ]);
    }
    sheet
}

/// The pictures that are shown, the least error first.
pub(super) fn by_error(picture: &PictureComparison) -> Vec<&PictureResult> {
    let results = picture.results.iter();
    let mut shown: Vec<_> = results.filter(|r| r.samples == PICTURE_SAMPLES).collect();
    shown.sort_by(|a, b| a.errors.mean_relative.total_cmp(&b.errors.mean_relative));
    shown
}

/// Mean FLIP with two digits, or "–".
pub(super) fn flip(result: &PictureResult) -> String {
    result.flip.map_or("–".into(), |flip| significant(flip, 2))
}

/// One line a figure: experiment, material, scene, who, points, samples, what, value, unit.
pub fn comparison_csv(comparison: &Comparison) -> Sheet {
    let mut sheet = Sheet::new(&[
        "experiment",
        "material",
        "scene",
        "who",
        "points",
        "samples",
        "figure",
        "value",
        "unit",
    ]);
    for material in &comparison.materials {
        for curve in &material.curves {
            push_curve(&mut sheet, &material.material, curve);
        }
    }
    push_pictures(&mut sheet, comparison);
    push_settings(&mut sheet, comparison);
    sheet
}

fn push_curve(sheet: &mut Sheet, material: &str, curve: &Curve) {
    let mut line = |points: &str, samples: String, figure: &str, value: f64, unit: &str| {
        let start = ["point", material, "", &curve.label, points].map(String::from);
        let end = [samples, figure.into(), format!("{value:e}"), unit.into()];
        sheet.push(start.into_iter().chain(end).collect());
    };
    for (figure, value, unit) in cost_figures(curve) {
        line("", String::new(), figure, value, unit);
    }
    for (points, errors, slope) in [
        ("random", &curve.random, curve.random_slope),
        ("sobol", &curve.sobol, curve.sobol_slope),
    ] {
        line(points, String::new(), "slope", slope, "");
        for ErrorPoint {
            samples,
            rmse,
            low,
            high,
        } in errors
        {
            line(points, samples.to_string(), "relative rmse", *rmse, "");
            line(points, samples.to_string(), "relative rmse, low", *low, "");
            line(
                points,
                samples.to_string(),
                "relative rmse, high",
                *high,
                "",
            );
        }
    }
    for r in TARGETS.iter().filter_map(|&target| reach(curve, target)) {
        let note = if r.extrapolated { ", extrapolated" } else { "" };
        let target = format!("to {}{note}", r.error);
        line(
            "sobol",
            format!("{:e}", r.samples),
            &format!("{target}: samples"),
            r.samples,
            "",
        );
        for (shared, seconds) in SHARED_BY.iter().zip(r.counted_seconds) {
            let figure = format!("{target}: counted, precomputation shared by {shared}");
            line("sobol", format!("{:e}", r.samples), &figure, seconds, "s");
        }
    }
}

/// What a curve's sample and sampler cost: figure, value, unit.
fn cost_figures(curve: &Curve) -> [(&'static str, f64, &'static str); 8] {
    let counted = curve.counted;
    let measured = curve.ns_per_sample;
    [
        ("table", curve.table_bytes as f64, "bytes"),
        ("build", curve.build_seconds, "s"),
        ("build, counted", counted.build_seconds, "s"),
        ("sample, counted", counted.sample_ns, "ns"),
        ("sample", measured.ns, "ns"),
        ("sample, low", measured.low, "ns"),
        ("sample, high", measured.high, "ns"),
        ("sample, spread", measured.spread, ""),
    ]
}

fn push_pictures(sheet: &mut Sheet, comparison: &Comparison) {
    for picture in &comparison.pictures {
        for result in &picture.results {
            let figures = [
                ("mean relative error", result.errors.mean_relative, ""),
                ("relMSE", result.errors.rel_mse, ""),
                ("FLIP", result.flip.unwrap_or(f64::NAN), ""),
                ("render", result.seconds.wall, "s"),
                ("render, CPU", result.seconds.cpu, "s"),
                ("build", result.build_seconds, "s"),
            ];
            for (figure, value, unit) in figures {
                let start = [
                    "picture",
                    &picture.material,
                    picture.scene.name(),
                    &result.label,
                    "sobol",
                ];
                let end = [
                    result.samples.to_string(),
                    figure.into(),
                    format!("{value:e}"),
                    unit.into(),
                ];
                sheet.push(start.map(String::from).into_iter().chain(end).collect());
            }
        }
    }
}

fn push_settings(sheet: &mut Sheet, comparison: &Comparison) {
    for of in &comparison.settings {
        for s in &of.settings {
            let who = format!("{} {}", s.knob.name, s.knob.value);
            let figures = [
                ("table", s.table_bytes as f64, "bytes"),
                ("build", s.build_seconds, "s"),
                ("sample", s.sample_ns.ns, "ns"),
                ("sample, low", s.sample_ns.low, "ns"),
                ("sample, high", s.sample_ns.high, "ns"),
                ("sample, spread", s.sample_ns.spread, ""),
                ("relstd", s.relstd, ""),
                ("relative rmse", s.rmse, ""),
            ];
            for (figure, value, unit) in figures {
                let start = ["setting", &of.material, "", &who, ""];
                let end = [
                    String::new(),
                    figure.into(),
                    format!("{value:e}"),
                    unit.into(),
                ];
                sheet.push(start.map(String::from).into_iter().chain(end).collect());
            }
        }
    }
}
