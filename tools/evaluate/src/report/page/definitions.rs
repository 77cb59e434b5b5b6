//! What the words mean, and what the figures leave out.

use super::Section;
use super::html::{escape, table};
use crate::measure::compare::{Comparison, LIT_FROM, MaterialComparison, Reference, TIE};
use crate::measure::cost::ROUNDS;
use crate::report::Sheet;

pub(super) fn section(comparison: &Comparison) -> Option<Section> {
    let entry = |(term, text): &(&str, String)| {
        format!("<dt>{}</dt><dd>{}</dd>\n", escape(term), escape(text))
    };
    let all: String = terms(comparison).iter().map(entry).collect();
    let mut body = format!("<dl>\n{all}</dl>\n");
    if comparison
        .materials
        .iter()
        .any(|m| !m.references.is_empty())
    {
        body += &table(
            "References of the lit point and their own errors",
            &references(comparison),
        );
    }
    Section::new("definitions", "Definitions", body)
}

fn terms(comparison: &Comparison) -> Vec<(&'static str, String)> {
    let plan = &comparison.plan;
    let mut all = on_errors(plan.point.theta_o_deg.len());
    all.extend([
        ("Lookup rule", format!(
            "A table holds samples; the rule says what lies between them. Here all is of {} lookup, except where a setting \
             is the rule itself. Samplers and references use the same rule, so that an error is the estimate's, not the \
             table's.",
            plan.lookup.name()
        )),
        ("Counted time", format!(
            "A fixed number of nanoseconds for a sample of each sampler and for building it, on one thread, and the same on \
             every machine: medians over materials on one core of an AMD EPYC. Verdicts, the order of tables and seconds to \
             an error go by it, because a clock never says the same twice. It is right to some 25 %, so counted times within \
             a factor of {TIE} are a tie."
        )),
        ("Measured time", format!(
            "A sample: CPU time of one thread, the lower quartile of {ROUNDS} short batches, all samplers in turn, with the \
             interval that holds that quartile with 95 %. Building: once, by the clock, on all threads. A picture: the same, \
             without loading and building. Seconds against which errors are drawn are N times the measured time of a sample."
        )),
        ("Shared by", "Building is done once and serves every later sample. Shared by 10⁶ samples, an estimate of N bears \
                       N/10⁶ of it, at most all."
            .into()),
        ("Bytes", "Those of the tables that directions are drawn by, the sampler's or the light's; 1 KB is 1000 bytes. The material's own table, which every renderer needs \
                   to evaluate, is not counted."
            .into()),
        ("What does not count", "Loading the material; writing files; rays (the point sees all of its light); errors of the \
                                 measurement and of its table; other programs that ran on the machine at the same time, \
                                 which make times longer."
            .into()),
    ]);
    all
}

fn on_errors(angles: usize) -> Vec<(&'static str, String)> {
    vec![
        ("Sample", "One direction: its random numbers, draw, density, BRDF and light. A draw that fails counts as a sample \
                    of value 0. MIS takes half of its samples from the light."
            .into()),
        ("Relative RMSE", format!(
            "Root of the mean, over {angles} viewing angles and all seeds, of ((estimate − reference)/reference)². Radiance \
             is the mean of red, green and blue."
        )),
        ("Interval", "95 %: the mean of squared errors ± 1.96 of its standard errors over seeds and angles, then the root. \
                      It knows only what these seeds show: a rare bright sample that none of them met is not in it."
            .into()),
        ("Extrapolated", "Where the last error measured is above what is asked for, the last measurements' slope is \
                          continued. Such figures are estimates."
            .into()),
        ("Reference, point", "Quadrature over the half-vector bins of the table, in which no sampler takes part. Its own \
                              error is its difference from a quadrature of fewer points."
            .into()),
        ("Reference, pictures", "The same scene with many samples of the largest half-vector table and of the light, random \
                                 numbers and another seed. Its own error is the mean of its pixels' standard errors over \
                                 their values; a picture can't be seen to be better than that."
            .into()),
        ("Mean relative error", format!(
            "Of a picture: mean of |picture − reference|/reference, by luminance, over lit pixels: those above {LIT_FROM} of \
             the reference's mean."
        )),
    ]
}

fn references(comparison: &Comparison) -> Sheet {
    let mut sheet = Sheet::new(&[
        "material",
        "wo",
        "radiance",
        "relative error of the reference",
    ]);
    let rows = |m: &MaterialComparison| {
        let row = |r: &Reference| {
            let figures = [
                format!("{}°", r.theta_o_deg),
                format!("{:.5}", r.radiance),
                format!("{:.1e}", r.error),
            ];
            std::iter::once(m.material.clone())
                .chain(figures)
                .collect::<Vec<_>>()
        };
        m.references.iter().map(row).collect::<Vec<_>>()
    };
    comparison
        .materials
        .iter()
        .flat_map(rows)
        .for_each(|row| sheet.push(row));
    sheet
}
