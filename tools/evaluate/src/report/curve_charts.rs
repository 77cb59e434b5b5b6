//! Charts of curves that materials, angles and samplers share: lobes, densities and albedos.

use std::collections::BTreeSet;

use super::charts::{angles_text, reading};
use crate::measure::views;
use crate::measure::views::{PlottedCurve, PlottedValue};
use crate::plot::{
    Axis, COLOURS, Caption, DASHES, Lines, Marks, Polar, PolarCurve, Scale, Series, style_number,
};
use merlkit::material::{Loaded, LookupRule};
use merlkit::sampler::{Sampler, SamplerSpec};
use merlkit::{Error, Result};

/// Materials, seen from some angles, with samplers that were built for each.
pub struct CurveCharts {
    materials: Vec<Loaded>,
    thetas: Vec<f64>,
    /// Those of each material, in the order of `specs`.
    samplers: Vec<Vec<Sampler>>,
    specs: Vec<SamplerSpec>,
    options: CurveOptions,
}

/// What of a value is drawn, and on which scale.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CurveOptions {
    /// The number drawn; densities are always those of the mean.
    pub value: PlottedValue,
    /// The scale of values; `None` is the chart's own choice.
    pub scale: Option<Scale>,
}

/// A curve with its name and style.
struct Named {
    label: String,
    style: usize,
    curve: PlottedCurve,
}

/// Which material, angle and kind of curve a curve has, and how many of each there are.
struct CurvePlace {
    material: (usize, usize),
    theta: (usize, usize),
    kind: (usize, usize),
}

/// Curves of more samplers or angles would look alike.
const MOST_SAMPLERS: usize = 4;
const MOST_ANGLES_OF_SEVERAL: usize = 5;

/// A lobe whose greatest value is so many times its mean over angles is drawn under a root.
const PEAKED: f64 = 8.0;

impl CurvePlace {
    /// One colour for what has the most to compare; a dash for the other; marks as colours, for print in black and white.
    fn style(&self) -> usize {
        let (m, t, k) = (self.material, self.theta, self.kind);
        let pair = m.0 * t.1 + t.0;
        match (m.1 > 1, t.1 > 1, k.1 > 1) {
            // A material at an angle has a colour, and its samplers have dashes.
            (true, _, true) | (_, true, true) => style_number(pair, k.0, pair),
            (true, true, false) => style_number(m.0, t.0, m.0),
            _ => {
                let only = pair + k.0;
                style_number(only, only, only)
            }
        }
    }

    /// Names of what distinguishes the curve from the others.
    fn label(&self, material: &str, theta: f64, kind: Option<&str>) -> String {
        let several = self.material.1 > 1;
        let mut parts = Vec::new();
        if several {
            parts.push(material.to_owned());
        }
        parts.extend(kind.map(str::to_owned));
        if self.theta.1 > 1 || parts.is_empty() {
            parts.push(format!("θ = {theta}°"));
        }
        parts.join(", ")
    }
}

impl CurveCharts {
    /// `materials` with `wo` at each of `thetas` degrees, 0 to below 90; `samplers` are those of each material, of the same
    /// specs for all. Without samplers the lists may be left out.
    ///
    /// # Errors
    /// [`Error::Argument`] for nothing to draw, for more curves than styles can tell apart, and for materials whose samplers
    /// differ.
    pub fn new(
        materials: &[Loaded],
        thetas: Vec<f64>,
        mut samplers: Vec<Vec<Sampler>>,
        options: CurveOptions,
    ) -> Result<Self> {
        samplers.resize(materials.len(), Vec::new());
        let specs_of = samplers.iter().map(|built| specs(built));
        let mut specs: Vec<Vec<SamplerSpec>> = specs_of.collect();
        specs.dedup();
        if specs.len() > 1 {
            return Err(Error::argument(
                "materials with different samplers in one chart",
                "build the same samplers for each",
            ));
        }
        let specs = specs.pop().unwrap_or_default();
        Self::check_counts(materials.len(), thetas.len(), specs.len())?;
        Ok(Self {
            materials: materials.to_vec(),
            thetas,
            samplers,
            specs,
            options,
        })
    }

    /// Refuses charts without a curve, or with curves that look alike: by how many materials, angles and samplers they have.
    ///
    /// # Errors
    /// [`Error::Argument`] with the greatest number.
    pub fn check_counts(materials: usize, thetas: usize, samplers: usize) -> Result<()> {
        let pairs = materials * thetas;
        let (what, most, given) = if pairs == 0 {
            ("materials and angles", "at least one of each".into(), 0)
        } else if samplers > MOST_SAMPLERS {
            ("samplers", format!("at most {MOST_SAMPLERS}"), samplers)
        } else if materials > COLOURS {
            ("materials", format!("at most {}", COLOURS), materials)
        } else if samplers > 0 && pairs > COLOURS {
            let most = format!("at most {} with samplers", COLOURS);
            ("materials times angles", most, pairs)
        } else if materials > 1 && thetas > MOST_ANGLES_OF_SEVERAL {
            let most = format!("at most {MOST_ANGLES_OF_SEVERAL} with several materials");
            ("angles", most, thetas)
        } else if thetas > COLOURS {
            ("angles", format!("at most {}", COLOURS), thetas)
        } else {
            return Ok(());
        };
        Err(Error::argument(
            format!("{given} {what} in one chart"),
            format!("choose {most}"),
        ))
    }

    /// f·cos θ of wi over its angle in the plane of incidence; with samplers, the ideal density and theirs.
    pub fn lobe(&self) -> Lines {
        let curves = self.curves();
        let scale = self.options.scale.unwrap_or(Scale::Log);
        let y = value_axis(self.value_title(), scale, &curves);
        let x = Axis::new("angle of wi in the plane of incidence [°]", Scale::Linear)
            .with_range(-90.0, 90.0);
        Lines {
            caption: self.lobe_caption(),
            x,
            y,
            series: series(curves),
        }
    }

    /// The same in polar coordinates; on a linear scale, or under a root where the lobe is narrow.
    pub fn lobe_polar(&self) -> Polar {
        let mut caption = self.lobe_caption();
        let mut curves = self.curves();
        if !self.specs.is_empty() {
            cut(&mut curves, 1 + self.specs.len());
            caption
                .description
                .push_str(" Densities are cut off at twice the greatest ideal density.");
        }
        // A narrow lobe on an even scale is a line, and nothing beside it.
        let own = if is_peaked(curves.iter().map(|c| &c.curve)) {
            Scale::Root
        } else {
            Scale::Linear
        };
        let radius = Axis::new(self.value_title(), self.options.scale.unwrap_or(own));
        let curves = curves.into_iter().map(|c| PolarCurve {
            label: c.label,
            points: c.curve,
            style: c.style,
        });
        Polar {
            caption,
            radius,
            curves: curves.collect(),
            wo: self.thetas.clone(),
        }
    }

    /// Directional albedo over θ; of a single table, by each of the three lookup rules.
    pub fn albedo(&self) -> Lines {
        let channel = self.options.value.channel;
        let single = match &self.materials[..] {
            [material] => material.table(),
            _ => None,
        };
        let (labels, points, how): (Vec<String>, Vec<PlottedCurve>, String) = match single {
            Some(measured) => (
                Vec::from(LookupRule::ALL.map(|rule| format!("{} lookup", rule.name()))),
                Vec::from(views::albedo_by_rule(measured.table(), channel)),
                "for the three rules of interpolation between table samples".into(),
            ),
            None => (
                self.albedo_labels(),
                self.albedo_curves(),
                self.reading_of_all(),
            ),
        };
        let mut curves = Vec::new();
        for (i, (label, curve)) in labels.into_iter().zip(points).enumerate() {
            let style = style_number(i, i, i);
            curves.push(Named {
                label,
                style,
                curve,
            });
        }
        let caption = Caption::new(
            format!("{}: directional albedo{}", self.names(), self.of_channel()),
            format!(
                "Fraction of light reflected, {}, over the polar angle of wo, {how}.",
                channel.words()
            ),
        );
        let scale = self.options.scale.unwrap_or(Scale::Linear);
        let y = value_axis("directional albedo", scale, &curves);
        let x = Axis::new("polar angle of wo [°]", Scale::Linear).with_range(0.0, 90.0);
        Lines {
            caption,
            x,
            y,
            series: series(curves),
        }
    }

    fn albedo_labels(&self) -> Vec<String> {
        match &self.materials[..] {
            [material] => vec![material.reading()],
            several => several.iter().map(|m| m.name().to_owned()).collect(),
        }
    }

    fn albedo_curves(&self) -> Vec<PlottedCurve> {
        let channel = self.options.value.channel;
        let mut curves = Vec::new();
        for material in &self.materials {
            curves.push(views::albedo_curve(&**material.brdf(), channel));
        }
        curves
    }

    /// The curves of each material at each angle: its lobe, or with samplers the ideal density and theirs.
    fn curves(&self) -> Vec<Named> {
        let mut curves = Vec::new();
        for (m, material) in self.materials.iter().enumerate() {
            for (t, &theta) in self.thetas.iter().enumerate() {
                let shown = self.curves_at(material, &self.samplers[m], theta);
                let kinds = shown.len();
                for (k, (kind, curve)) in shown.into_iter().enumerate() {
                    let place = CurvePlace {
                        material: (m, self.materials.len()),
                        theta: (t, self.thetas.len()),
                        kind: (k, kinds),
                    };
                    curves.push(Named {
                        label: place.label(material.name(), theta, kind.as_deref()),
                        style: place.style(),
                        curve,
                    });
                }
            }
        }
        curves
    }

    /// The curves of one material at one angle, with the names of kinds where there are several.
    fn curves_at(
        &self,
        material: &Loaded,
        samplers: &[Sampler],
        theta: f64,
    ) -> Vec<(Option<String>, PlottedCurve)> {
        let brdf = &**material.brdf();
        if samplers.is_empty() {
            return vec![(None, views::lobe(brdf, theta, self.options.value))];
        }
        let mut shown = vec![(Some("ideal".to_owned()), views::ideal_density(brdf, theta))];
        for sampler in samplers {
            let label = self.sampler_label(sampler.spec());
            shown.push((Some(label), views::density(sampler.as_dyn(), theta)));
        }
        shown
    }

    /// A sampler's name, with its settings where two have the same name.
    fn sampler_label(&self, spec: &SamplerSpec) -> String {
        let namesakes = self.specs.iter().filter(|s| s.name() == spec.name());
        if namesakes.count() > 1 {
            spec.to_string()
        } else {
            spec.name().to_owned()
        }
    }

    fn names(&self) -> String {
        let names: Vec<_> = self.materials.iter().map(Loaded::name).collect();
        names.join(", ")
    }

    /// How the values of all materials were come by, each way once.
    fn reading_of_all(&self) -> String {
        let mut readings: Vec<String> = self.materials.iter().map(reading).collect();
        readings.dedup();
        readings.join("; ")
    }

    /// The channel for titles, where it is not the mean.
    fn of_channel(&self) -> String {
        match self.options.value.channel {
            views::PlottedChannel::Mean => String::new(),
            channel => format!(", {}", channel.name()),
        }
    }

    fn value_title(&self) -> String {
        if self.specs.is_empty() {
            format!(
                "{}{} [sr⁻¹]",
                self.options.value.symbol(),
                self.of_channel()
            )
        } else {
            "density [sr⁻¹]".into()
        }
    }

    fn lobe_caption(&self) -> Caption {
        let value = self.options.value;
        let shown = if self.specs.is_empty() {
            format!("{}, {}", value.symbol(), value.channel.words())
        } else {
            let labels: Vec<_> = self.specs.iter().map(ToString::to_string).collect();
            let labels = labels.join(", ");
            format!("the ideal density, f·cos θi over the albedo, and the density of {labels}")
        };
        // The legend names several.
        let shown_kind = match &self.specs[..] {
            [] => "lobe".into(),
            [spec] => format!("lobe and {}", spec.name()),
            several => format!("densities of {} samplers", several.len()),
        };
        let title = format!(
            "{}: {shown_kind} at θ = {}",
            self.names(),
            angles_text(&self.thetas)
        );
        let reading = self.reading_of_all();
        let description = format!(
            "Against the polar angle of the light direction wi in the plane of incidence, in sr⁻¹: {shown}. \
             The view direction wo is at −θ, its mirror direction at θ."
        );
        // One material's title has room for how its values were come by.
        match self.materials.len() {
            1 => Caption::new(format!("{title} ({reading})"), description),
            _ => Caption::new(title, format!("{description} Values: {reading}.")),
        }
    }
}

fn specs(samplers: &[Sampler]) -> Vec<SamplerSpec> {
    samplers.iter().map(|s| s.spec().clone()).collect()
}

/// Curves with marks where two have the same dash.
fn series(curves: Vec<Named>) -> Vec<Series> {
    let dashes: BTreeSet<usize> = curves.iter().map(|c| c.style % DASHES).collect();
    let marks = if dashes.len() < curves.len() {
        Marks::Few
    } else {
        Marks::None
    };
    let mut all = Vec::new();
    for c in curves {
        all.push(Series {
            label: c.label,
            points: c.curve,
            style: c.style,
            marks,
            ..Series::default()
        });
    }
    all
}

/// The axis of values: six decades at most on a logarithmic scale, from 0 on the others.
fn value_axis(title: impl Into<String>, scale: Scale, curves: &[Named]) -> Axis {
    let axis = Axis::new(title, scale);
    let greatest = greatest(curves);
    if greatest <= 0.0 {
        return axis;
    }
    if scale != Scale::Log {
        return axis.with_range(0.0, greatest * 1.08);
    }
    // The last decades are floors of samplers and horizons.
    let least = least(curves).max(greatest * 1e-6);
    axis.with_range(least * 0.8, greatest * 1.5)
}

/// Ends densities at twice the greatest ideal one: a peak that runs away at the mirror direction would hide the rest. The first
/// of every `kinds` curves is an ideal density.
fn cut(curves: &mut [Named], kinds: usize) {
    let ideal = curves
        .iter()
        .step_by(kinds)
        .flat_map(|c| &c.curve)
        .map(|p| p.1)
        .fold(0.0, f64::max);
    if ideal > 0.0 {
        curves
            .iter_mut()
            .flat_map(|c| &mut c.curve)
            .for_each(|p| p.1 = p.1.min(2.0 * ideal));
    }
}

/// Whether curves have a peak that is many times their mean over angles.
pub(super) fn is_peaked<'a>(curves: impl ExactSizeIterator<Item = &'a PlottedCurve>) -> bool {
    let count = curves.len().max(1) as f64;
    let (mut sum, mut greatest) = (0.0, 0f64);
    for curve in curves {
        sum += mean(curve);
        greatest = curve.iter().map(|p| p.1).fold(greatest, f64::max);
    }
    greatest > PEAKED * (sum / count)
}

fn greatest(curves: &[Named]) -> f64 {
    let values = curves.iter().flat_map(|c| &c.curve).map(|p| p.1);
    values.fold(0.0, f64::max)
}

/// Mean over the angle: points are closer where the curve is high.
fn mean(curve: &PlottedCurve) -> f64 {
    curve
        .windows(2)
        .map(|w| (w[1].0 - w[0].0) * 0.5 * (w[0].1 + w[1].1))
        .sum::<f64>()
        / 180.0
}

/// The least value above 0; 0 if there is none.
fn least(curves: &[Named]) -> f64 {
    let values = curves.iter().flat_map(|c| &c.curve).map(|p| p.1);
    let above = values.filter(|&v| v > 0.0);
    above.reduce(f64::min).unwrap_or(0.0)
}
