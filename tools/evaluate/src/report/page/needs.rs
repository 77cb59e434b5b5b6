//! Samples, seconds and bytes to an error: the tables to act on.

use super::Section;
use super::html::{column_head, escape, folded, framed, paragraph};
use crate::measure::compare::{
    Comparison, Contender, Curve, MaterialComparison, Reach, TARGETS, Winner, best, reach,
};
use crate::measure::convergence::Technique;
use crate::report::compare::{HOUR, by_time, duration};
use crate::report::cost::{kilobytes, nanoseconds};
use crate::report::digits::{grouped, significant};

pub(super) fn section(comparison: &Comparison) -> Option<Section> {
    let tables: String = comparison.materials.iter().map(tables).collect();
    if tables.is_empty() {
        return None;
    }
    let note = "All errors are with Sobol points. N is the number of samples of one estimate, followed by the counted time of one \
                estimate on one thread, with the build time shared by 10⁶ samples. The folded tables charge the build time to \
                one estimate alone, or share it by 10⁹ samples. In each column the best sampler is shaded and bold, and those \
                whose time is within 25 % of it are underlined; of these, the one with the fewest samples is the best. Samplers \
                that draw from the BRDF alone and those that know the light are judged apart. Counted times are the same in \
                every run and have two digits, because the model is accurate to about 25 %. Measured nanoseconds per sample \
                have their 95 % confidence interval. A ~ marks sample counts that were extrapolated, “never” means that the \
                error does not fall, and times above 1000 times the least of their column are not spelled out.";
    Section::new("needs", "What an error costs", paragraph(note) + &tables)
}

/// Position in [`SHARED_BY`] of what the first table shows.
const MAIN: usize = 1;

fn tables(material: &MaterialComparison) -> String {
    if material.curves.is_empty() {
        return String::new();
    }
    let name = &material.material;
    let main = table(
        &format!("{name}: samples and counted time to reach an error"),
        material,
        Shown::Main,
    );
    let others = [
        (0, "built for one estimate alone"),
        (2, "build time shared by 10⁹ samples"),
    ];
    let others = others.map(|(share, words)| {
        let caption = format!("{name}: counted time, {words}");
        table(&caption, material, Shown::Other(share))
    });
    main + &folded(
        &format!("{name}: other ways to charge the build time"),
        &others.concat(),
    )
}

/// What a table has in its columns.
#[derive(Clone, Copy)]
enum Shown {
    /// Costs, and for each error the samples and the time.
    Main,
    /// For each error the time, as the build time is shared.
    Other(usize),
}

impl Shown {
    fn share(self) -> usize {
        match self {
            Self::Main => MAIN,
            Self::Other(share) => share,
        }
    }
}

/// A column of times: its unit, and beyond what they are not spelled out.
#[derive(Clone, Copy)]
struct TimeColumn {
    target: f64,
    unit: (f64, &'static str),
    least: f64,
}

/// From which size on a time is given in a unit.
const UNITS: [(f64, &str); 4] = [(1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns")];
/// Times above so many times the least say more of the extrapolation than of the sampler.
const MANY: f64 = 1000.0;

impl TimeColumn {
    fn new(curves: &[&Curve], target: f64, share: usize) -> Self {
        let mut least = f64::INFINITY;
        for curve in curves {
            if let Some(reach) = reach(curve, target) {
                least = least.min(reach.counted_seconds[share]);
            }
        }
        let unit = UNITS.into_iter().find(|unit| least >= unit.0);
        Self {
            target,
            unit: unit.unwrap_or(UNITS[3]),
            least,
        }
    }

    fn text(&self, seconds: f64) -> String {
        if seconds > HOUR {
            "> 1 h".into()
        } else if seconds > MANY * self.least {
            format!("> {MANY}×")
        } else {
            grouped(&significant(seconds / self.unit.0, 2))
        }
    }
}

fn table(caption: &str, material: &MaterialComparison, shown: Shown) -> String {
    let curves = by_time(&material.curves);
    let columns = TARGETS.map(|target| TimeColumn::new(&curves, target, shown.share()));
    let mut bodies = Vec::new();
    for (title, is_brdf) in [
        ("draw from the BRDF alone", true),
        ("know the light", false),
    ] {
        let mut group = curves.clone();
        group.retain(|c| (c.competitor.technique == Technique::Brdf) == is_brdf);
        if !group.is_empty() {
            bodies.push(rows(title, &group, &columns, shown));
        }
    }
    framed(
        caption,
        &head(&columns, shown),
        &bodies.join("</tbody>\n<tbody>\n"),
    )
}

/// A group of competitors under its title.
fn rows(title: &str, curves: &[&Curve], columns: &[TimeColumn], shown: Shown) -> String {
    let winners: Vec<Option<Winner>> = columns
        .iter()
        .map(|column| winner(curves, column, shown.share()))
        .collect();
    let mut body = format!(
        "<tr class=\"group\"><th scope=\"rowgroup\">{}</th><td colspan=\"{}\"></td></tr>\n",
        escape(title),
        width(shown) - 1
    );
    for (index, curve) in curves.iter().enumerate() {
        body += &format!("<tr>{}", start(curve, shown));
        for (column, winner) in columns.iter().zip(&winners) {
            let class = match winner {
                Some(w) if w.index == index => "best",
                Some(w) if w.ties.contains(&index) => "tie",
                _ => "",
            };
            body += &cells(reach(curve, column.target).as_ref(), column, class, shown);
        }
        body += "</tr>\n";
    }
    body
}

/// The best of a column, and who ties with it.
fn winner(curves: &[&Curve], column: &TimeColumn, share: usize) -> Option<Winner> {
    let mut contenders = Vec::new();
    for curve in curves {
        contenders.push(reach(curve, column.target).map(|r| Contender {
            seconds: r.counted_seconds[share],
            samples: r.samples,
            bytes: curve.table_bytes,
        }));
    }
    best(&contenders)
}

/// Headings of the columns before those of errors.
const COSTS: [&str; 5] = [
    "sampler",
    "KB",
    "build",
    "ns per sample, counted",
    "measured",
];

fn width(shown: Shown) -> usize {
    match shown {
        Shown::Main => COSTS.len() + 2 * TARGETS.len(),
        Shown::Other(_) => 1 + TARGETS.len(),
    }
}

fn head(columns: &[TimeColumn], shown: Shown) -> String {
    let percent = |column: &TimeColumn| format!("to {} %", significant(100.0 * column.target, 1));
    let mut first = String::new();
    let mut second = String::new();
    match shown {
        Shown::Main => {
            for heading in COSTS {
                first += &column_head(heading, " rowspan=\"2\"");
            }
            for column in columns {
                first += &format!(
                    "<th scope=\"colgroup\" class=\"first\" colspan=\"2\">{}</th>",
                    percent(column)
                );
                second += &column_head("N", " class=\"first\"");
                second += &column_head(column.unit.1, "");
            }
            format!("<tr>{first}</tr>\n<tr>{second}</tr>\n")
        }
        Shown::Other(_) => {
            first += &column_head(COSTS[0], "");
            for column in columns {
                let text = format!("{}, {}", percent(column), column.unit.1);
                first += &column_head(&text, " class=\"first\"");
            }
            format!("<tr>{first}</tr>\n")
        }
    }
}

fn start(curve: &Curve, shown: Shown) -> String {
    let name = format!("<th scope=\"row\">{}</th>", escape(&curve.label));
    match shown {
        Shown::Other(_) => name,
        Shown::Main => format!(
            "{name}<td>{}</td><td>{}</td><td>{:.0}</td><td>{}</td>",
            kilobytes(curve.table_bytes),
            duration(curve.build_seconds),
            curve.counted.sample_ns,
            nanoseconds(&curve.ns_per_sample)
        ),
    }
}

fn cells(reach: Option<&Reach>, column: &TimeColumn, class: &str, shown: Shown) -> String {
    let (samples, time) = match reach {
        Some(r) => {
            let about = if r.extrapolated { "~" } else { "" };
            let time = column.text(r.counted_seconds[shown.share()]);
            (format!("{about}{}", count(r.samples)), time)
        }
        None => ("never".into(), String::new()),
    };
    match shown {
        Shown::Main => {
            format!("<td class=\"first\">{samples}</td><td class=\"{class}\">{time}</td>")
        }
        Shown::Other(_) => {
            let text = if reach.is_none() { &samples } else { &time };
            format!("<td class=\"first {class}\">{text}</td>")
        }
    }
}

/// A number of samples to two or three digits: "7", "5300", "1.2e6".
fn count(samples: f64) -> String {
    match samples {
        n if n < 1000.0 => format!("{:.0}", n.ceil()),
        n if n < 1e5 => grouped(&format!("{:.0}", (n / 100.0).ceil() * 100.0)),
        n => format!("{n:.1e}"),
    }
}
