//! Charts of the lit point's errors.

use super::Section;
use super::families::{chosen, family, short_label};
use super::html::{charts, paragraph, subheading};
use crate::measure::compare::{Comparison, Curve, ErrorPoint, MaterialComparison};
use crate::plot::{Axis, Caption, Lines, Scale, Series};
use crate::report::compare::by_time;
use crate::report::material_charts::PAGE_CHART;

pub(super) fn section(comparison: &Comparison) -> Option<Section> {
    let all: String = comparison.materials.iter().map(material).collect();
    if all.is_empty() {
        return None;
    }
    let note = "Relative RMSE at the lit point over all angles and seeds, on logarithmic scales. Only the fastest sampler of each \
                kind to 1 % is shown. Samplers that also sample the light have separate charts, together with the fastest \
                one that does not. Bands are 95 % confidence intervals, cut off below one third of the measured error. The \
                fitted slope is in brackets: −0.5 is plain Monte Carlo; −1 halves the error with twice the samples.";
    Section::new(
        "point",
        "Error against samples and seconds",
        paragraph(note) + &all,
    )
}

/// What an error is held against.
#[derive(Clone, Copy)]
enum Across {
    Samples,
    Seconds,
}

impl Across {
    fn title(self) -> &'static str {
        match self {
            Self::Samples => "samples N",
            Self::Seconds => "measured seconds per estimate",
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Samples => "samples",
            Self::Seconds => "seconds",
        }
    }

    fn abscissa(self, curve: &Curve, samples: usize) -> f64 {
        match self {
            Self::Samples => samples as f64,
            Self::Seconds => samples as f64 * curve.ns_per_sample.ns * 1e-9,
        }
    }
}

/// Which errors are shown.
#[derive(Clone, Copy, PartialEq)]
enum Points {
    Sobol,
    Random,
}

impl Points {
    fn name(self) -> &'static str {
        match self {
            Self::Sobol => "Sobol points",
            Self::Random => "random numbers",
        }
    }

    fn errors(self, curve: &Curve) -> (&[ErrorPoint], f64) {
        match self {
            Self::Sobol => (&curve.sobol, curve.sobol_slope),
            Self::Random => (&curve.random, curve.random_slope),
        }
    }
}

fn material(material: &MaterialComparison) -> String {
    if material.curves.is_empty() {
        return String::new();
    }
    let name = &material.material;
    let [brdf, light] = chosen(&by_time(&material.curves), |c| &c.competitor);
    let heading = subheading(name);
    let name = "BRDF alone";
    let mut pictures = vec![
        chart(name, &brdf, Across::Samples, Points::Sobol),
        chart(name, &brdf, Across::Samples, Points::Random),
        chart(name, &brdf, Across::Seconds, Points::Sobol),
    ];
    if !light.is_empty() {
        let name = "light sampling";
        pictures.push(chart(name, &light, Across::Samples, Points::Sobol));
        pictures.push(chart(name, &light, Across::Seconds, Points::Sobol));
    }
    heading + &charts(&pictures)
}

fn chart(name: &str, curves: &[&Curve], across: Across, points: Points) -> String {
    let series = |curve: &&Curve| {
        let (errors, slope) = points.errors(curve);
        let place = |e: &ErrorPoint| across.abscissa(curve, e.samples);
        let band = match across {
            Across::Samples => errors
                .iter()
                .map(|e| (place(e), e.low.max(e.rmse / 3.0), e.high))
                .collect(),
            Across::Seconds => Vec::new(),
        };
        Series {
            label: format!("{} ({})", short_label(&curve.label), signed(slope)),
            points: errors.iter().map(|e| (place(e), e.rmse)).collect(),
            band,
            style: family(&curve.competitor),
            ..Series::default()
        }
    };
    let caption = Caption::new(
        format!("{name}, {}: error by {}", points.name(), across.name()),
        format!(
            "Relative RMSE at the lit point against {}, {}, one curve per sampler.",
            across.title(),
            points.name()
        ),
    );
    let x = Axis::new(across.title(), Scale::Log);
    let y = Axis::new("relative RMSE", Scale::Log);
    Lines {
        caption,
        x,
        y,
        series: curves.iter().map(series).collect(),
    }
    .svg_sized(PAGE_CHART)
}

/// Two decimals with a true minus.
fn signed(value: f64) -> String {
    format!("{value:.2}").replace('-', "−")
}
