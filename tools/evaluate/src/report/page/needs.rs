//! Samples, seconds and bytes to an error: the tables to act on.

use super::Section;
use super::html::{column_head, escape, framed, paragraph};
use crate::measure::compare::{
    Comparison, Curve, MaterialComparison, Reach, SHARED_BY, TARGETS, TIE, reach,
};
use crate::report::compare::{by_time, duration};
use crate::report::cost::{kilobytes, nanoseconds};

pub(super) fn section(comparison: &Comparison) -> Option<Section> {
    let tables: String = comparison.materials.iter().map(table).collect();
    if tables.is_empty() {
        return None;
    }
    let note = "All errors are with Sobol points. N is the number of samples of one estimate, followed by the counted time of one \
                estimate on one thread, with the build time charged to it alone, or spread over 10⁶ or 10⁹ samples. Choose \
                the column for your target error and for how often the sampler will be reused. Counted times are the same \
                in every run; measured nanoseconds per sample are given with their 95 % confidence interval. The fastest \
                sampler to 1 % comes first. In each column, the smallest time and all within 25 % of it are underlined. A \
                ~ marks sample counts that were extrapolated; “never” means that the error does not fall.";
    Section::new("needs", "What an error costs", paragraph(note) + &tables)
}

fn table(material: &MaterialComparison) -> String {
    let curves = by_time(&material.curves);
    let needs: Vec<[Option<Reach>; TARGETS.len()]> = curves
        .iter()
        .map(|c| TARGETS.map(|target| reach(c, target)))
        .collect();
    let least = |target: usize, share: usize| {
        let seconds = needs
            .iter()
            .filter_map(|n| n[target])
            .map(|r| r.counted_seconds[share]);
        seconds.fold(f64::INFINITY, f64::min)
    };
    let least: [[f64; SHARED_BY.len()]; TARGETS.len()] =
        std::array::from_fn(|t| std::array::from_fn(|s| least(t, s)));
    let mut body = String::new();
    for (curve, needs) in curves.iter().zip(&needs) {
        body += &format!("<tr>{}", start(curve));
        for (reach, least) in needs.iter().zip(&least) {
            body += &cells(reach.as_ref(), least);
        }
        body += "</tr>\n";
    }
    framed(
        &format!(
            "{}: samples and counted time to reach an error",
            material.material
        ),
        &head(),
        &body,
    )
}

fn head() -> String {
    let first: String = [
        "sampler",
        "KB",
        "build",
        "ns per sample, counted",
        "measured",
    ]
    .map(|h| column_head(h, " rowspan=\"2\""))
    .concat();
    let columns = [
        column_head("N", " class=\"first\""),
        column_head("alone", ""),
        column_head("over 10⁶", ""),
        column_head("over 10⁹", ""),
    ];
    let groups = TARGETS.map(group_head).concat();
    format!(
        "<tr>{first}{groups}</tr>\n<tr>{}</tr>\n",
        columns.concat().repeat(TARGETS.len())
    )
}

/// The heading over the columns of a target error.
fn group_head(target: f64) -> String {
    format!(
        "<th scope=\"colgroup\" class=\"first\" colspan=\"4\">to {} %</th>",
        target * 100.0
    )
}

fn start(curve: &Curve) -> String {
    format!(
        "<th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{:.0}</td><td>{}</td>",
        escape(&curve.label),
        kilobytes(curve.table_bytes),
        duration(curve.build_seconds),
        curve.counted.sample_ns,
        nanoseconds(&curve.ns_per_sample)
    )
}

fn cells(reach: Option<&Reach>, least: &[f64; SHARED_BY.len()]) -> String {
    let Some(reach) = reach else {
        return "<td class=\"first\">never</td><td></td><td></td><td></td>".into();
    };
    let about = if reach.extrapolated { "~" } else { "" };
    let mut times = String::new();
    for (&seconds, &least) in reach.counted_seconds.iter().zip(least) {
        let text = duration(seconds);
        times += &match seconds <= TIE * least {
            true => format!("<td><b>{text}</b></td>"),
            false => format!("<td>{text}</td>"),
        };
    }
    format!(
        "<td class=\"first\">{about}{}</td>{times}",
        count(reach.samples)
    )
}

/// A number of samples to two or three digits: "7", "5300", "1.2e6".
fn count(samples: f64) -> String {
    match samples {
        n if n < 1000.0 => format!("{:.0}", n.ceil()),
        n if n < 1e5 => format!("{:.0}", (n / 100.0).ceil() * 100.0),
        n => format!("{n:.1e}"),
    }
}
