//! Charts of the samplers' own settings, and which of them nothing beats.

use super::Section;
use super::html::{charts, paragraph, subheading};
use crate::measure::compare::{Comparison, RMSE_SAMPLES, Setting, SettingsComparison};
use crate::plot::{Axis, Caption, Group, Scale, Scatter, ScatterPoint};

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
        "Each sampler's own settings: bytes of its tables, seconds to build them, nanoseconds of a draw with its density, \
         against the relative RMSE from {RMSE_SAMPLES} Sobol samples of the point seen at 45°, or the relative standard \
         deviation of a draw's weight. Towards the lower left is better; the dashed steps join the settings that no other \
         beats in both."
    );
    Section::new("settings", "Settings", paragraph(&note) + &all)
}

/// What a setting costs or gives: a title, and its value.
type Measure = (&'static str, fn(&Setting) -> f64);

const BYTES: Measure = ("bytes of tables", |s| s.table_bytes as f64);
const BUILD: Measure = ("seconds to build", |s| s.build_seconds);
const DRAW: Measure = ("ns of a draw with its density", |s| s.sample_ns.ns);
const RMSE: Measure = ("relative RMSE", |s| s.rmse);
const SPREAD: Measure = ("relative standard deviation of a weight", |s| s.relstd);

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
        format!("{}: {}", of.material, x.0),
        format!(
            "{} against {}, one mark a setting, by what is set.",
            y.0, x.0
        ),
    );
    let axis = |m: Measure| Axis::new(m.0, Scale::Log);
    Scatter {
        caption,
        x: axis(x),
        y: axis(y),
        groups,
        front: true,
    }
    .svg()
}
