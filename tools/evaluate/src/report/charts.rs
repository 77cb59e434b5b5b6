//! Charts of one material and of the samplers built for it.

use glam::DVec2;

use crate::measure::views;
use crate::plot::{Axis, Caption, Disc, DiscMark, Heat, Lines, Marks, Pixels, Scale, Series};
use merlkit::brdf::Brdf;
use merlkit::geometry::Symmetry;
use merlkit::image::Image;
use merlkit::material::Loaded;
use merlkit::material::merl::{THETA_D_BINS, THETA_H_BINS};
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

impl ChartSubject {
    /// `material` with `wo` at each of `thetas` degrees, 0 to below 90; the sampler, if there is
    /// one, was built for it.
    pub fn new(material: &Loaded, thetas: Vec<f64>, sampler: Option<Sampler>) -> Self {
        Self {
            material: material.clone(),
            thetas,
            sampler,
        }
    }

    fn brdf(&self) -> &dyn Brdf {
        &**self.material.brdf()
    }

    fn name(&self) -> &str {
        self.material.name()
    }

    fn reading(&self) -> String {
        reading(&self.material)
    }

    fn angles(&self) -> String {
        angles_text(&self.thetas)
    }

    /// The table at φd = `phi_d` degrees, 0 to 179, over θh and θd, as colours for the mean of the channels on a scale.
    ///
    /// # Errors
    /// [`Error::Argument`] for a material that is not a MERL table.
    pub fn slice(&self, phi_d: usize, scale: Scale) -> Result<Heat> {
        let table = self.material.require_table(SLICE)?;
        let bar = Axis::new("f [sr⁻¹]", scale);
        let values = views::slice(table.table(), phi_d);
        let how = "colours show the mean of red, green and blue; white bins have no valid value";
        let pixels = Pixels::Values {
            width: THETA_H_BINS,
            values,
            bar,
        };
        Ok(self.slice_of(pixels, phi_d, how))
    }

    /// The same in the material's own colours, made brighter by `exposure` stops.
    ///
    /// # Errors
    /// As [`Self::slice`].
    pub fn slice_rgb(&self, phi_d: usize, exposure: f32) -> Result<Heat> {
        let table = self.material.require_table(SLICE)?;
        let colours = views::slice_rgb(table.table(), phi_d);
        let image = Image::new(THETA_H_BINS, THETA_D_BINS, colours)?;
        let how = format!("in its own colours, gamma 2.2, exposure {exposure:+} stops");
        let pixels = Pixels::Picture { image, exposure };
        Ok(self.slice_of(pixels, phi_d, &how))
    }

    fn slice_of(&self, pixels: Pixels, phi_d: usize, how: &str) -> Heat {
        let caption = Caption::new(
            format!("{}: slice at φd = {phi_d}°", self.name()),
            format!(
                "f of the table over the half angle θh and the difference angle θd, one pixel per bin: {how}."
            ),
        );
        Heat {
            caption,
            x: Axis::new("θh [°]", Scale::Root).with_range(0.0, 90.0),
            y: Axis::new("θd [°]", Scale::Linear).with_range(0.0, 90.0),
            pixels,
        }
    }

    /// The unit disc with `samples` directions of a seed by the sampler, cosine if there is none, for the first angle; of the
    /// adaptive disc, the leaves as well.
    pub fn disc(&self, samples: usize, seed: u64) -> Disc {
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
    }

    /// CDF over θh before and after compression, with its knots.
    ///
    /// # Errors
    /// [`merlkit::Error::Argument`] if the sampler is no cascade CDF; those of building it.
    pub fn cdf(&self) -> Result<Lines> {
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
        })
    }

    /// CDF over φh, of the θh that halves the draws, before and after compression, with its knots.
    ///
    /// # Errors
    /// As [`Self::cdf`].
    pub fn cdf_azimuth(&self) -> Result<Lines> {
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
        })
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
}

/// How values were come by, for captions; of an anisotropic material, also the azimuth that is shown.
pub(super) fn reading(material: &Loaded) -> String {
    let reading = material.reading();
    match material.symmetry() {
        Symmetry::Isotropic => reading,
        _ => format!("{reading}, wo in the plane of the surface's x"),
    }
}

/// "10°, 30°".
pub(super) fn angles_text(thetas: &[f64]) -> String {
    let all: Vec<_> = thetas.iter().map(|t| format!("{t}°")).collect();
    all.join(", ")
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
