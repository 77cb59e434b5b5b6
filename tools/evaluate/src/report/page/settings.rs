//! Charts of the samplers' own settings, and which of them nothing beats.

use super::Section;
use super::html::{charts, paragraph, subheading};
use crate::measure::compare::{Comparison, RMSE_SAMPLES, Setting, SettingsComparison};
use crate::plot::{Axis, Caption, Group, Scale, Scatter, ScatterPoint};
use crate::report::material_charts::PAGE_CHART;

pub(super) fn section(comparison: &Comparison) -> Option<Section> {
    let filled = comparison
        .settings
        .iter()
        .filter(|s| !s.settings.is_empty());
    let all: String = filled
        .map(|of| subheading(&of.material) + &charts(&pictures(of)))
        .collect();
    if all.is_empty() {
        return None;
    }
    let note = format!(
        "Charts for different settings of each sampler. Table size and build time are plotted against the relative RMSE of \
         {RMSE_SAMPLES} Sobol samples at the lit point, viewed at 45°. Nanoseconds per draw with its density are plotted \
         against the relative standard deviation (relstd) of the sample weight. Lower left is better; dashed steps join the \
         Pareto-optimal settings, which no other setting beats in both."
    );
    Section::new("settings", "Settings", paragraph(&note) + &all)
}

/// What a setting costs or gives: a title, and its value.
type Measure = (&'static str, fn(&Setting) -> f64);

const BYTES: Measure = ("table size in bytes", |s| s.table_bytes as f64);
const BUILD: Measure = ("seconds to build", |s| s.build_seconds);
const DRAW: Measure = ("ns per draw with its density", |s| s.sample_ns.ns);
const RMSE: Measure = ("relative RMSE", |s| s.rmse);
const SPREAD: Measure = ("relstd of the weight", |s| s.relstd);

fn pictures(of: &SettingsComparison) -> Vec<String> {
    [(BYTES, RMSE), (BUILD, RMSE), (DRAW, SPREAD)]
        .map(|(x, y)| chart(of, x, y))
        .to_vec()
}

fn chart(of: &SettingsComparison, x: Measure, y: Measure) -> String {
    let mut groups: Vec<Group> = Vec::new();
    for setting in &of.settings {
        let knob = &setting.knob;
        let point = ScatterPoint {
            x: x.1(setting),
            y: y.1(setting),
            label: knob.value.clone(),
        };
        match groups.iter_mut().find(|g| g.label == knob.name) {
            Some(group) => group.points.push(point),
            None => {
                let style = groups.len();
                groups.push(Group {
                    label: knob.name.clone(),
                    points: vec![point],
                    style,
                });
            }
        }
    }
    let caption = Caption::new(
        format!("by {}", x.0),
        format!(
            "{} against {}, one mark per setting; each style is one parameter.",
            y.0, x.0
        ),
    );
    Scatter {
        caption,
        x: Axis::new(x.0, Scale::Log),
        y: Axis::new(y.0, Scale::Log),
        groups,
        front: true,
    }
    .svg_sized(PAGE_CHART)
}
