//! Charts of one material and of the samplers built for it.

use glam::DVec2;

use crate::measure::views;
use crate::measure::views::PlottedCurve;
use crate::plot::{
    Axis, Caption, Disc, DiscMark, Heat, Lines, Marks, Pixels, Polar, PolarCurve, Scale, Series,
};
use merlkit::brdf::Brdf;
use merlkit::geometry::Symmetry;
use merlkit::image::Image;
use merlkit::material::merl::{THETA_D_BINS, THETA_H_BINS};
use merlkit::material::{Loaded, LookupRule};
use merlkit::sampler::{
    AdaptiveDisc, CascadeCdf, CascadeCdfSettings, CdfCurve, CosineSettings, Sampler, SamplerSpec,
};
use merlkit::{Error, Result};

/// What a slice is, to who asks for one of another material than a table.
pub const SLICE: &str = "a slice of bins";

/// A material, seen from some angles, and a sampler that was built for it.
pub struct ChartSubject {
    material: Loaded,
    thetas: Vec<f64>,
    sampler: Option<Sampler>,
}

/// A curve with its name and style.
struct Named {
    label: String,
    style: usize,
    curve: PlottedCurve,
}

impl ChartSubject {
    /// `material` with `wo` at each of `thetas` degrees, 0 to below 90; with `spec`, builds that sampler.
    ///
    /// # Errors
    /// Those of building the sampler.
    pub fn new(material: &Loaded, thetas: Vec<f64>, spec: Option<SamplerSpec>) -> Result<Self> {
        let sampler = spec.map(|s| s.build(material)).transpose()?;
        Ok(Self {
            material: material.clone(),
            thetas,
            sampler,
        })
    }

    fn brdf(&self) -> &dyn Brdf {
        &**self.material.brdf()
    }

    fn name(&self) -> &str {
        self.material.name()
    }

    /// How values were come by, for captions; of an anisotropic material, also the azimuth that is shown.
    fn reading(&self) -> String {
        let reading = self.material.reading();
        match self.material.symmetry() {
            Symmetry::Isotropic => reading,
            _ => format!("{reading}, wo in the plane of the surface's x"),
        }
    }

    fn angles(&self) -> String {
        let all: Vec<_> = self.thetas.iter().map(|t| format!("{t}°")).collect();
        all.join(", ")
    }

    /// The lobe at each angle; with a sampler, both densities.
    fn curves(&self) -> Vec<Named> {
        let Some(sampler) = &self.sampler else {
            return self.lobes();
        };
        let mut curves = Vec::new();
        for (i, &theta) in self.thetas.iter().enumerate() {
            curves.push(Named {
                label: format!("ideal, θ = {theta}°"),
                style: 2 * i,
                curve: views::ideal_density(self.brdf(), theta),
            });
            curves.push(Named {
                label: format!("{}, θ = {theta}°", sampler.spec().name()),
                style: 2 * i + 1,
                curve: views::density(sampler.as_dyn(), theta),
            });
        }
        curves
    }

    /// f·cos θ at each angle of wo.
    fn lobes(&self) -> Vec<Named> {
        let mut curves = Vec::new();
        for (style, &theta) in self.thetas.iter().enumerate() {
            curves.push(Named {
                label: format!("θ = {theta}°"),
                style,
                curve: views::lobe(self.brdf(), theta),
            });
        }
        curves
    }

    fn value_title(&self) -> &'static str {
        if self.sampler.is_some() {
            "density [sr⁻¹]"
        } else {
            "f·cos θi [sr⁻¹]"
        }
    }

    fn lobe_caption(&self) -> Caption {
        let shown = match &self.sampler {
            Some(sampler) => {
                let label = sampler.spec();
                format!("the ideal density, f·cos θi over the albedo, and the density of {label}")
            }
            None => "f·cos θi, the mean of red, green and blue".into(),
        };
        let of = self
            .sampler
            .as_ref()
            .map_or(String::new(), |s| format!(" and {}", s.spec().name()));
        Caption::new(
            format!(
                "{}: lobe{of} at θ = {} ({})",
                self.name(),
                self.angles(),
                self.reading()
            ),
            format!(
                "Against the polar angle of the light direction wi in the plane of incidence, in sr⁻¹: {shown}. \
                 The view direction wo is at −θ, its mirror direction at θ."
            ),
        )
    }

    /// f·cos θ of wi over its angle in the plane of incidence; with a sampler, the ideal density and the sampler's.
    pub fn lobe(&self) -> String {
        let curves = self.curves();
        let greatest = greatest(&curves);
        let y = Axis::new(self.value_title(), Scale::Log);
        // The last decades are floors of samplers and horizons.
        let least = least(&curves).max(greatest * 1e-6);
        let y = if greatest > 0.0 {
            y.with_range(least * 0.8, greatest * 1.5)
        } else {
            y
        };
        let series = curves.into_iter().map(|c| Series {
            label: c.label,
            points: c.curve,
            style: c.style,
            ..Series::default()
        });
        let x = Axis::new("angle of wi in the plane of incidence [°]", Scale::Linear)
            .with_range(-90.0, 90.0);
        Lines {
            caption: self.lobe_caption(),
            x,
            y,
            series: series.collect(),
        }
        .svg()
    }

    /// The same in polar coordinates.
    pub fn lobe_polar(&self) -> String {
        let mut caption = self.lobe_caption();
        let mut curves = self.curves();
        if self.sampler.is_some() {
            cut(&mut curves);
            caption
                .description
                .push_str(" Densities are cut off at twice the greatest ideal density.");
        }
        // A narrow lobe on an even scale is a line, and nothing beside it.
        let mean = curves.iter().map(|c| mean(&c.curve)).sum::<f64>() / curves.len().max(1) as f64;
        let scale = if greatest(&curves) > PEAKED * mean {
            Scale::Root
        } else {
            Scale::Linear
        };
        let radius = Axis::new(self.value_title(), scale);
        let curves = curves.into_iter().map(|c| PolarCurve {
            label: c.label,
            points: c.curve,
            style: c.style,
        });
        let curves = curves.collect();
        Polar {
            caption,
            radius,
            curves,
            wo: self.thetas.clone(),
        }
        .svg()
    }

    /// The table at φd = 90° over θh and θd, as colours for values.
    ///
    /// # Errors
    /// [`Error::Argument`] for a material that is not a MERL table; those of encoding the pixels.
    pub fn slice(&self) -> Result<String> {
        let table = self.material.require_table(SLICE)?;
        let bar = Axis::new("f [sr⁻¹]", Scale::Log);
        let values = views::slice(table.table());
        self.slice_of(
            Pixels::Values { width: THETA_H_BINS, values, bar },
            "colours show the mean of red, green and blue on a logarithmic scale; white bins have no valid value",
        )
    }

    /// The same in the material's own colours.
    ///
    /// # Errors
    /// As [`Self::slice`].
    pub fn slice_rgb(&self) -> Result<String> {
        let table = self.material.require_table(SLICE)?;
        let pixels = views::slice_rgb(table.table());
        let image = Image::new(THETA_H_BINS, THETA_D_BINS, pixels)?;
        self.slice_of(
            Pixels::Picture {
                image,
                exposure: 0.0,
            },
            "in its own colours, tone-mapped",
        )
    }

    fn slice_of(&self, pixels: Pixels, how: &str) -> Result<String> {
        let caption = Caption::new(
            format!("{}: slice at φd = 90°", self.name()),
            format!(
                "f of the table over the half angle θh and the difference angle θd, one pixel per bin: {how}."
            ),
        );
        let x = Axis::new("θh [°]", Scale::Root).with_range(0.0, 90.0);
        let y = Axis::new("θd [°]", Scale::Linear).with_range(0.0, 90.0);
        Heat {
            caption,
            x,
            y,
            pixels,
        }
        .svg()
    }

    /// The unit disc with `samples` directions of a seed by the sampler, cosine if there is none, for the first angle; of the
    /// adaptive disc, the leaves as well.
    pub fn disc(&self, samples: usize, seed: u64) -> String {
        let theta = self.thetas.first().copied().unwrap_or(0.0);
        let sampler = self.sampler.as_ref();
        let (points, failed) = views::sampled_directions(sampler, theta, samples, seed);
        let disc: Option<&AdaptiveDisc> = sampler.and_then(Sampler::downcast);
        let (cells, tree) = match disc {
            Some(disc) => views::leaf_outlines(disc, theta),
            None => (Vec::new(), theta),
        };
        let leaves = match cells.len() {
            0 => String::new(),
            count => {
                format!(
                    "{count} cells of the {tree:.1}° tree (cells smaller than a pixel appear as dots)"
                )
            }
        };
        let lost = if failed == 0 {
            String::new()
        } else {
            format!(", {failed} more failed")
        };
        let drawn = if samples == 0 {
            String::new()
        } else {
            format!("{} directions drawn{lost}", points.len())
        };
        let cosine = SamplerSpec::new(CosineSettings::default());
        let spec = sampler.map_or(&cosine, Sampler::spec);
        let caption = Caption::new(
            format!("{}: {} at θ = {theta}°", self.name(), spec.name()),
            format!(
                "The hemisphere of light directions from above, {spec}, {}, seed {seed}.",
                self.reading()
            ),
        );
        let cells = cells.into_iter().map(coordinate_pairs).collect();
        Disc {
            caption,
            cells,
            points: coordinate_pairs(points),
            marks: disc_marks(theta),
            labels: [leaves, drawn],
        }
        .svg()
    }

    /// CDF over θh before and after compression, with its knots.
    ///
    /// # Errors
    /// [`merlkit::Error::Argument`] if the sampler is no cascade CDF; those of building it.
    pub fn cdf(&self) -> Result<String> {
        let (series, of) = self.compressed(CascadeCdf::marginal, |_| String::new())?;
        let caption = Caption::new(
            format!("{}: CDF over θh before and after compression", self.name()),
            format!("Probability of a half vector below θh, from {of}."),
        );
        let x = Axis::new("θh [°]", Scale::Root).with_range(0.0, 90.0);
        let y = Axis::new("probability below θh", Scale::Linear).with_range(0.0, 1.0);
        Ok(Lines {
            caption,
            x,
            y,
            series,
        }
        .svg())
    }

    /// CDF over φh, of the θh that halves the draws, before and after compression, with its knots.
    ///
    /// # Errors
    /// As [`Self::cdf`].
    pub fn cdf_azimuth(&self) -> Result<String> {
        let (series, of) = self.compressed(CascadeCdf::conditional, theta_h_range)?;
        let caption = Caption::new(
            format!("{}: CDF over φh before and after compression", self.name()),
            format!(
                "Probability that the half vector's azimuth, measured from wo, is below φh, at the median θh, from {of}."
            ),
        );
        let x = Axis::new("φh [°]", Scale::Linear).with_range(0.0, 360.0);
        let y = Axis::new("probability below φh", Scale::Linear).with_range(0.0, 1.0);
        Ok(Lines {
            caption,
            x,
            y,
            series,
        }
        .svg())
    }

    /// A curve at each angle before and after compression, with its knots; and what tables they are of.
    fn compressed(
        &self,
        curve: impl Fn(&CascadeCdf, f64) -> CdfCurve,
        span: impl Fn(&CdfCurve) -> String,
    ) -> Result<(Vec<Series>, String)> {
        let stored: Option<&CascadeCdf> = self.sampler.as_ref().and_then(Sampler::downcast);
        let Some(stored) = stored else {
            return Err(Error::argument(
                "the sampler has no CDF to plot",
                "choose cascade-cdf",
            ));
        };
        let settings = *stored.settings();
        let whole = CascadeCdf::build(
            self.brdf(),
            CascadeCdfSettings {
                tolerance: None,
                ..settings
            },
        )?;
        let mut series = Vec::new();
        for (i, theta) in self.thetas.iter().map(|t| t.to_radians()).enumerate() {
            let (before, after) = (curve(&whole, theta), curve(stored, theta));
            let angle_before = format!("{}{}", theta_o_text(&before), span(&before));
            let angle_after = format!("{}{}", theta_o_text(&after), span(&after));
            series.push(line_in_degrees(
                format!("{angle_before}, {} knots", before.knots.len()),
                &before.curve,
                5 * i,
            ));
            series.push(line_in_degrees(
                format!("{angle_after}, compressed"),
                &after.curve,
                5 * i + 1,
            ));
            let label = format!("{angle_after}, its {} knots", after.knots.len());
            series.push(Series {
                marks: Marks::Only,
                ..line_in_degrees(label, &after.knots, 5 * i + 1)
            });
        }
        let label = SamplerSpec::new(settings);
        Ok((
            series,
            format!(
                "the tables of {label} nearest to θ = {}, {}",
                self.angles(),
                self.reading()
            ),
        ))
    }

    /// Directional albedo over θ, of a table by each of the three lookup rules.
    pub fn albedo(&self) -> String {
        let what = "Fraction of light reflected, the mean of red, green and blue, over the polar angle of wo";
        let (curves, how): (Vec<(String, PlottedCurve)>, String) = match self.material.table() {
            Some(measured) => {
                let curves = views::albedo_by_rule(measured.table());
                let labels = LookupRule::ALL.map(|rule| format!("{} lookup", rule.name()));
                let how = "for the three rules of interpolation between table samples".to_owned();
                (labels.into_iter().zip(curves).collect(), how)
            }
            None => {
                let curve = views::albedo_curve(self.brdf());
                (vec![(self.material.reading(), curve)], self.reading())
            }
        };
        let caption = Caption::new(
            format!("{}: directional albedo", self.name()),
            format!("{what}, {how}."),
        );
        let mut series = Vec::new();
        for (style, (label, points)) in curves.into_iter().enumerate() {
            series.push(Series {
                label,
                points,
                style,
                ..Series::default()
            });
        }
        let greatest = series
            .iter()
            .flat_map(|s| &s.points)
            .map(|p| p.1)
            .fold(0.0, f64::max);
        let x = Axis::new("polar angle of wo [°]", Scale::Linear).with_range(0.0, 90.0);
        let y = Axis::new("directional albedo", Scale::Linear).with_range(0.0, greatest * 1.08);
        Lines {
            caption,
            x,
            y,
            series,
        }
        .svg()
    }
}

/// A lobe whose greatest value is so many times its mean over angles is drawn under a root.
const PEAKED: f64 = 8.0;

/// Ends densities at twice the greatest ideal one: a peak that runs away at the mirror direction would hide the rest. `curves`
/// are ideal densities and samplers' by turns.
fn cut(curves: &mut [Named]) {
    let ideal = curves
        .iter()
        .step_by(2)
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

fn greatest(curves: &[Named]) -> f64 {
    curves
        .iter()
        .flat_map(|c| &c.curve)
        .map(|p| p.1)
        .fold(0.0, f64::max)
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
    let above = curves
        .iter()
        .flat_map(|c| &c.curve)
        .map(|p| p.1)
        .filter(|&v| v > 0.0);
    above.reduce(f64::min).unwrap_or(0.0)
}

fn coordinate_pairs(points: Vec<DVec2>) -> Vec<(f64, f64)> {
    points.into_iter().map(|p| (p.x, p.y)).collect()
}

/// The angle of wo that a CDF was tabulated at.
fn theta_o_text(cdf: &CdfCurve) -> String {
    format!("θ = {:.1}°", cdf.theta_o.to_degrees())
}

/// The θh that a CDF over φh belongs to.
fn theta_h_range(cdf: &CdfCurve) -> String {
    let [from, to] = cdf.theta_h.map(f64::to_degrees);
    format!(", θh {from:.2}–{to:.2}°")
}

/// A line through points whose abscissas are in radians.
fn line_in_degrees(label: String, points: &[(f64, f64)], style: usize) -> Series {
    Series {
        label,
        points: points.iter().map(|p| (p.0.to_degrees(), p.1)).collect(),
        style,
        marks: Marks::None,
        ..Series::default()
    }
}

/// `wo` and its mirror direction on the disc.
fn disc_marks(theta: f64) -> Vec<DiscMark> {
    match theta {
        0.0 => vec![disc_mark(0.0, "wo and mirror")],
        _ => vec![
            disc_mark(-theta.to_radians().sin(), "wo"),
            disc_mark(theta.to_radians().sin(), "mirror"),
        ],
    }
}

fn disc_mark(x: f64, label: &str) -> DiscMark {
    DiscMark {
        at: (x, 0.0),
        label: label.into(),
    }
}
