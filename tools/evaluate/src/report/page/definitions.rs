//! What the words mean, and what the figures leave out.

use super::Section;
use super::html::{definition_list, table};
use crate::measure::compare::{Comparison, TIE};
use crate::measure::cost::ROUNDS;
use crate::measure::difference::LIT_FROM;
use crate::report::Sheet;
use crate::report::digits::rounded;

pub(super) fn section(comparison: &Comparison) -> Option<Section> {
    let mut body = definition_list(&terms(comparison));
    if comparison
        .materials
        .iter()
        .any(|m| !m.references.is_empty())
    {
        body += &table(
            "References at the lit point, and their own errors",
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
            "The rule by which values between the samples of a table are interpolated. This run uses {} lookup, except where \
             the rule itself is the setting under test. Samplers and references use the same rule, so the errors measured \
             are those of the estimates, not those of the table.",
            plan.lookup.name()
        )),
        ("Counted time", format!(
            "A fixed cost model, the same on every machine: nanoseconds per sample and for building each sampler on one \
             thread. The costs are medians over materials, measured on one core of an AMD EPYC. Verdicts, the order of \
             tables and the time to reach an error are based on counted time, because measured times vary between runs. The \
             model is accurate to about 25 %, so counted times within a factor of {TIE} are a tie."
        )),
        ("Measured time", format!(
            "For a sample: the CPU time of one thread, as the lower quartile of {ROUNDS} short batches with its 95 % confidence \
             interval; batches of different samplers alternate. For building: the wall-clock time of one build on all \
             threads. For a picture: the wall-clock time on all threads, without loading and building. Charts of error \
             against seconds use N times the measured time of a sample."
        )),
        ("Build time shared by 10⁶ samples", "A sampler is built once and reused for every later sample. If its build time is shared by 10⁶ samples, an \
                       estimate with N samples is charged N/10⁶ of it, and never more than all of it."
            .into()),
        ("Bytes", "The size of the tables used to draw directions from the sampler or the light; 1 KB is 1000 bytes. The material's \
                   own table is not counted, because every renderer needs it to evaluate the BRDF."
            .into()),
        ("What is not measured", "Loading the material, writing files, and tracing rays (the point is never in shadow). Errors of the BRDF \
                                 measurement and its table are not included either. Other programs running on the machine \
                                 at the same time are not corrected for; they increase the times."
            .into()),
    ]);
    all
}

fn on_errors(angles: usize) -> Vec<(&'static str, String)> {
    vec![
        ("Sample", "One direction: random numbers, draw, density, BRDF and light. A failed draw counts as a sample of value 0. \
                    MIS takes half of its samples from the light."
            .into()),
        ("Relative RMSE", format!(
            "The square root of the mean of ((estimate − reference)/reference)² over {angles} view angles and all seeds. \
             Radiance is the mean of red, green and blue."
        )),
        ("Confidence interval", "The 95 % interval of the RMSE: the square roots of the mean squared error ± 1.96 standard errors, over seeds and \
                      angles. It reflects only these seeds; a rare bright sample that none of them drew is not covered."
            .into()),
        ("Extrapolated", "If the last measured error is above the target, the slope of the last measurements is continued. \
                          Such sample counts are estimates."
            .into()),
        ("Reference, point", "Quadrature over the table's half-vector bins, without any sampler. Its own error is the difference \
                              from a quadrature with fewer points."
            .into()),
        ("Reference, pictures", "The same scene rendered with many samples of the largest half-vector table and the light, using \
                                 random numbers and another seed. Its own error is the mean relative standard error of its \
                                 pixels; smaller errors of other pictures can't be resolved."
            .into()),
        ("Mean relative error", format!(
            "For a picture: the mean of |picture − reference|/reference, in luminance, over lit pixels. A pixel is lit if its \
             reference is above {LIT_FROM} times the reference's mean."
        )),
        ("FLIP", "For a picture: the mean of HDR-FLIP (Andersson et al. 2021), an estimate of the difference that a person sees who \
                  alternates between the picture and the reference, from 0 to 1, at 67 pixels per degree, the largest over \
                  several exposures. merlkit diff measures the same."
            .into()),
    ]
}

fn references(comparison: &Comparison) -> Sheet {
    let mut sheet = Sheet::new(&[
        "material",
        "wo",
        "radiance",
        "relative error of the reference",
    ]);
    for material in &comparison.materials {
        for reference in &material.references {
            sheet.push(vec![
                material.material.clone(),
                format!("{}°", reference.theta_o_deg),
                rounded(reference.radiance, reference.radiance * reference.error),
                format!("{:.1e}", reference.error),
            ]);
        }
    }
    sheet
}
