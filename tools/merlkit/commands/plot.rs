//! `merlkit plot`

use std::ffi::OsStr;
use std::process::ExitCode;
use std::sync::Arc;

use glam::DVec2;
use merlkit::Error;
use merlkit::brdf::{LookupRule, Measured};
use merlkit::image::Image;
use merlkit::measure::views::{self, Curve};
use merlkit::merl::{Material, THETA_D_BINS, THETA_H_BINS};
use merlkit::plot::{
    Axis, Caption, Disc, DiscMark, Heat, Lines, Marks, Pixels, Polar, PolarCurve, Scale, Series,
};
use merlkit::sampler::{CascadeCdf, CascadeCdfSettings, Marginal, Sampler, SamplerSpec};

use crate::args;
use crate::failure::Outcome;
use crate::output::{Destination, overwrite};
use crate::sampler_args::{SAMPLERS, SamplerArgs};

/// What to draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Kind {
    /// f_r·cosθ of wi over its angle in the plane of incidence; with --sampler, the ideal density and the sampler's
    Lobe,
    /// The same in polar coordinates
    LobePolar,
    /// The table at φd = 90° over θh and θd, as colours for values
    Slice,
    /// The same in the material's own colours
    SliceRgb,
    /// The unit disc with the adaptive disc's leaves and directions drawn by --sampler
    Disc,
    /// cascade-cdf's CDF over θh before and after compression, with its knots
    Cdf,
    /// Directional albedo over θ by each of the three lookup rules
    Albedo,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Lobe => "lobe",
            Self::LobePolar => "lobe-polar",
            Self::Slice => "slice",
            Self::SliceRgb => "slice-rgb",
            Self::Disc => "disc",
            Self::Cdf => "cdf",
            Self::Albedo => "albedo",
        }
    }

    /// Whether an option named so has an effect.
    fn takes(self, option: &str) -> bool {
        match option {
            "--theta" => !matches!(self, Self::Slice | Self::SliceRgb | Self::Albedo),
            "--lookup" => matches!(self, Self::Lobe | Self::LobePolar | Self::Disc | Self::Cdf),
            "--sampler" => matches!(self, Self::Lobe | Self::LobePolar | Self::Disc),
            _ => self == Self::Disc,
        }
    }
}

/// Draw a material or a sampler: lobes, densities, slices, leaves, CDFs, albedo
///
/// Writes one SVG picture, 640 pixels wide; its text stays text and it needs no other file. For PNG, convert it with a
/// viewer or rsvg-convert. Angles are degrees; f_r and densities are sr⁻¹, f_r as the mean of red, green and blue. In the
/// plane of incidence wo stands on the left, its mirror direction on the right.
#[derive(clap::Args)]
pub struct Args {
    /// Path to a MERL binary or name of an embedded material
    #[arg(value_name = "MATERIAL")]
    material: String,
    /// What to draw
    #[arg(long, value_name = "KIND")]
    kind: Kind,
    /// Polar angles of wo, degrees, 0 to below 90, as in 10,30,60; one for disc, up to four otherwise [default: 30]
    #[arg(long, value_name = "DEG", value_delimiter = ',', allow_negative_numbers = true)]
    theta: Vec<f64>,
    /// Sampler whose density or directions are shown [default: lobes none, disc adaptive-disc]
    #[arg(long, value_name = "NAME", value_parser = SAMPLERS)]
    sampler: Option<String>,
    /// What the table says between its samples [default: floor]
    #[arg(long, value_name = "RULE", value_parser = args::lookup_rule())]
    lookup: Option<LookupRule>,
    /// disc: how many directions are drawn, 0 to 100000 [default: 1000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=100_000))]
    samples: Option<u32>,
    /// disc: seed of the draws [default: 0]
    #[arg(long, value_name = "K")]
    seed: Option<u64>,
    /// SVG file, or standard output (-) [default: MATERIAL-KIND.svg]
    #[arg(short, long, value_name = "FILE|-")]
    output: Option<Destination>,
    /// Replace an existing FILE [default: refuse]
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    settings: SamplerArgs,
}

pub fn run(args: &Args) -> Outcome {
    let kind = args.kind;
    args.refuse_idle()?;
    let thetas = args.thetas()?;
    let spec = args.spec()?;
    let material = Material::resolve(&args.material)?;
    let file = || Destination::File(format!("{}-{}.svg", material.name(), kind.name()).into());
    let destination = args.output.clone().unwrap_or_else(file);
    refuse_other_formats(&destination)?;
    destination.check(overwrite(args.force))?;
    let table = Arc::new(material.load()?);
    let subject = Subject {
        name: material.name(),
        brdf: Arc::new(Measured::new(table, args.lookup.unwrap_or_default())),
        thetas,
        spec,
    };
    let svg = match kind {
        Kind::Lobe => subject.lobe()?,
        Kind::LobePolar => subject.lobe_polar()?,
        Kind::Slice => subject.slice()?,
        Kind::SliceRgb => subject.slice_rgb()?,
        Kind::Disc => subject.disc(args.samples.unwrap_or(1000) as usize, args.seed.unwrap_or(0))?,
        Kind::Cdf => subject.cdf()?,
        Kind::Albedo => subject.albedo(),
    };
    destination.write(overwrite(args.force), |out| out.write_all(svg.as_bytes()))?;
    Ok(ExitCode::SUCCESS)
}

fn refuse_other_formats(destination: &Destination) -> Result<(), Error> {
    match destination {
        Destination::File(path) if path.extension() != Some(OsStr::new("svg")) => Err(Error::argument(
            format!("{}: pictures are SVG only", path.display()),
            "name a file that ends in .svg, and convert it with a viewer or rsvg-convert",
        )),
        _ => Ok(()),
    }
}

impl Args {
    /// Options without effect are mistakes.
    fn refuse_idle(&self) -> Result<(), Error> {
        let given = [
            ("--theta", !self.theta.is_empty()),
            ("--lookup", self.lookup.is_some()),
            ("--sampler", self.sampler.is_some()),
            ("--samples", self.samples.is_some()),
            ("--seed", self.seed.is_some()),
        ];
        let idle = given.iter().find(|(option, given)| *given && !self.kind.takes(option));
        let setting = self.settings.first_given().filter(|_| self.sampler_name().is_none());
        match idle.map(|i| i.0).or(setting) {
            Some(option) => {
                let what = format!("{option} has no effect on --kind {} as it is", self.kind.name());
                let lobe = matches!(self.kind, Kind::Lobe | Kind::LobePolar);
                Err(Error::argument(
                    what,
                    if lobe { "name a --sampler, or leave it out" } else { "leave it out" },
                ))
            }
            None => Ok(()),
        }
    }

    fn thetas(&self) -> Result<Vec<f64>, Error> {
        let most = if self.kind == Kind::Disc { 1 } else { 4 };
        if let Some(theta) = self.theta.iter().find(|t| !(0.0..90.0).contains(*t)) {
            let what = format!("wo at polar angle {theta}°");
            return Err(Error::argument(what, "choose --theta from 0 to below 90"));
        }
        if self.theta.len() > most {
            let what = format!("{} angles for --kind {}", self.theta.len(), self.kind.name());
            return Err(Error::argument(what, format!("choose at most {most}")));
        }
        Ok(if self.theta.is_empty() { vec![30.0] } else { self.theta.clone() })
    }

    /// The sampler that is shown.
    fn sampler_name(&self) -> Option<&str> {
        match self.kind {
            Kind::Cdf => Some("cascade-cdf"),
            Kind::Disc => Some(self.sampler.as_deref().unwrap_or("adaptive-disc")),
            _ => self.sampler.as_deref(),
        }
    }

    fn spec(&self) -> Result<Option<SamplerSpec>, Error> {
        self.sampler_name().map(|name| self.settings.spec(name)).transpose()
    }
}

/// What is drawn.
struct Subject<'a> {
    name: &'a str,
    brdf: Arc<Measured>,
    thetas: Vec<f64>,
    spec: Option<SamplerSpec>,
}

/// A curve with its name and style.
struct Named {
    label: String,
    style: usize,
    curve: Curve,
}

impl Subject<'_> {
    fn rule(&self) -> &'static str {
        self.brdf.rule().name()
    }

    fn angles(&self) -> String {
        let all: Vec<_> = self.thetas.iter().map(|t| format!("{t}°")).collect();
        all.join(", ")
    }

    /// The lobe at each angle; with a sampler, both densities.
    fn curves(&self) -> Result<Vec<Named>, Error> {
        let Some(spec) = self.spec else {
            let named = |(style, &theta): (usize, &f64)| Named {
                label: format!("θ = {theta}°"),
                style,
                curve: views::lobe(&*self.brdf, theta),
            };
            return Ok(self.thetas.iter().enumerate().map(named).collect());
        };
        let sampler = spec.build(&self.brdf)?;
        let both = |(i, &theta): (usize, &f64)| {
            [
                Named {
                    label: format!("ideal, θ = {theta}°"),
                    style: 2 * i,
                    curve: views::ideal_density(&*self.brdf, theta),
                },
                Named {
                    label: format!("{}, θ = {theta}°", spec.name()),
                    style: 2 * i + 1,
                    curve: views::density(&sampler, theta),
                },
            ]
        };
        Ok(self.thetas.iter().enumerate().flat_map(both).collect())
    }

    fn value_title(&self) -> &'static str {
        if self.spec.is_some() { "density [sr⁻¹]" } else { "f·cos θi [sr⁻¹]" }
    }

    fn lobe_caption(&self) -> Caption {
        let shown = match self.spec {
            Some(spec) => {
                format!("the ideal density, f·cos θi over the albedo, and the density of {}", spec.label())
            }
            None => "f·cos θi, the mean of red, green and blue".into(),
        };
        Caption::new(
            format!("{}: lobe at θ = {} ({} lookup)", self.name, self.angles(), self.rule()),
            format!(
                "Over the polar angle of the light direction wi in the plane of incidence, in sr⁻¹: {shown}. \
                 The viewer wo stands at −θ, its mirror direction at θ."
            ),
        )
    }

    fn lobe(&self) -> Result<String, Error> {
        let curves = self.curves()?;
        let greatest = greatest(&curves);
        let y = Axis::new(self.value_title(), Scale::Log);
        // The last decades are floors of samplers and horizons.
        let least = least(&curves).max(greatest * 1e-6);
        let y = if greatest > 0.0 { y.with_range(least * 0.8, greatest * 1.5) } else { y };
        let series = curves.into_iter().map(|c| Series {
            label: c.label,
            points: c.curve,
            style: c.style,
            ..Series::default()
        });
        let x = Axis::new("angle of wi in the plane of incidence [°]", Scale::Linear).with_range(-90.0, 90.0);
        Ok(Lines { caption: self.lobe_caption(), x, y, series: series.collect() }.svg())
    }

    fn lobe_polar(&self) -> Result<String, Error> {
        let curves = self.curves()?;
        // A narrow lobe on an even scale is a line, and nothing beside it.
        let mean = curves.iter().map(|c| mean(&c.curve)).sum::<f64>() / curves.len().max(1) as f64;
        let scale = if greatest(&curves) > PEAKED * mean { Scale::Root } else { Scale::Linear };
        let radius = Axis::new(self.value_title(), scale);
        let curves =
            curves.into_iter().map(|c| PolarCurve { label: c.label, points: c.curve, style: c.style });
        let curves = curves.collect();
        Ok(Polar { caption: self.lobe_caption(), radius, curves, wo: self.thetas.clone() }.svg())
    }

    fn slice(&self) -> Result<String, Error> {
        let bar = Axis::new("f [sr⁻¹]", Scale::Log);
        let values = views::slice(self.brdf.table());
        self.slice_of(
            Pixels::Values { width: THETA_H_BINS, values, bar },
            "colours stand for the mean of red, green and blue on a logarithmic scale; white has no valid value",
        )
    }

    fn slice_rgb(&self) -> Result<String, Error> {
        let pixels = views::slice_rgb(self.brdf.table());
        let image = Image::new(THETA_H_BINS, THETA_D_BINS, pixels)?;
        self.slice_of(Pixels::Picture { image, exposure: 0.0 }, "in its own colours, tone-mapped")
    }

    fn slice_of(&self, pixels: Pixels, how: &str) -> Result<String, Error> {
        let caption = Caption::new(
            format!("{}: slice at φd = 90°", self.name),
            format!(
                "f of the table over the half angle θh and the difference angle θd, a bin a pixel: {how}."
            ),
        );
        let x = Axis::new("θh [°]", Scale::Root).with_range(0.0, 90.0);
        let y = Axis::new("θd [°]", Scale::Linear).with_range(0.0, 90.0);
        Heat { caption, x, y, pixels }.svg()
    }

    fn disc(&self, samples: usize, seed: u64) -> Result<String, Error> {
        let spec = self.spec.unwrap_or(SamplerSpec::Cosine);
        let (theta, sampler) = (self.thetas[0], spec.build(&self.brdf)?);
        let (points, failed) = views::sampled_directions(&sampler, theta, samples, seed);
        let (cells, tree) = match &sampler {
            Sampler::AdaptiveDisc(disc) => views::leaf_outlines(disc, theta),
            _ => (Vec::new(), theta),
        };
        let labels = [leaves_label(cells.len(), tree), draws_label(points.len(), failed)];
        let caption = Caption::new(
            format!("{}: {} at θ = {theta}°", self.name, spec.name()),
            format!(
                "The hemisphere of light directions from above, {}, {} lookup, seed {seed}.",
                spec.label(),
                self.rule()
            ),
        );
        let pairs = |points: Vec<DVec2>| points.into_iter().map(|p| (p.x, p.y)).collect();
        let cells = cells.into_iter().map(pairs).collect();
        Ok(Disc { caption, cells, points: pairs(points), marks: ends(theta), labels }.svg())
    }

    fn cdf(&self) -> Result<String, Error> {
        let Some(SamplerSpec::CascadeCdf(settings)) = self.spec else {
            return Err(Error::argument("a CDF of another sampler", "choose cascade-cdf"));
        };
        let stored = CascadeCdf::build(&*self.brdf, settings)?;
        let whole = CascadeCdf::build(&*self.brdf, CascadeCdfSettings { tolerance: None, ..settings })?;
        let mut series = Vec::new();
        for (i, theta) in self.thetas.iter().map(|t| t.to_radians()).enumerate() {
            series.extend(before_and_after(whole.marginal(theta), stored.marginal(theta), 5 * i));
        }
        let caption = Caption::new(
            format!("{}: CDF over θh before and after compression", self.name),
            format!(
                "Probability of a half vector below θh, by the tables of {} nearest to θ = {}, {} lookup.",
                SamplerSpec::CascadeCdf(settings).label(),
                self.angles(),
                self.rule()
            ),
        );
        let x = Axis::new("θh [°]", Scale::Root).with_range(0.0, 90.0);
        let y = Axis::new("probability below θh", Scale::Linear).with_range(0.0, 1.0);
        Ok(Lines { caption, x, y, series }.svg())
    }

    fn albedo(&self) -> String {
        let curves = views::albedo_by_rule(self.brdf.table());
        let series = LookupRule::ALL.into_iter().zip(curves).enumerate().map(|(style, (rule, points))| {
            Series { label: format!("{} lookup", rule.name()), points, style, ..Series::default() }
        });
        let caption = Caption::new(
            format!("{}: directional albedo", self.name),
            "Fraction of light reflected, the mean of red, green and blue, over the polar angle of wo, by what the table says between its samples.",
        );
        let series: Vec<_> = series.collect();
        let greatest = series.iter().flat_map(|s| &s.points).map(|p| p.1).fold(0.0, f64::max);
        let x = Axis::new("polar angle of wo [°]", Scale::Linear).with_range(0.0, 90.0);
        let y = Axis::new("directional albedo", Scale::Linear).with_range(0.0, greatest * 1.08);
        Lines { caption, x, y, series }.svg()
    }
}

/// A CDF with all knots, compressed, and the knots that are left.
fn before_and_after(before: Marginal, after: Marginal, style: usize) -> [Series; 3] {
    let at = format!("θ = {:.1}°", before.theta_o.to_degrees());
    let series = |label, points: Vec<(f64, f64)>, style, marks| {
        let points = points.into_iter().map(|p| (p.0.to_degrees(), p.1)).collect();
        Series { label, points, style, marks, ..Series::default() }
    };
    let (all, left) = (before.knots.len(), after.knots.len());
    [
        series(format!("{at}, {all} knots"), before.curve, style, Marks::None),
        series(format!("{at}, compressed"), after.curve, style + 1, Marks::None),
        series(format!("{at}, its {left} knots"), after.knots, style + 1, Marks::Only),
    ]
}

fn leaves_label(count: usize, tree: f64) -> String {
    match count {
        0 => String::new(),
        _ => format!("{count} squares of the tree at {tree:.1}°; a dot is one below a pixel"),
    }
}

fn draws_label(drawn: usize, failed: usize) -> String {
    match (drawn, failed) {
        (0, 0) => String::new(),
        (_, 0) => format!("{drawn} directions drawn"),
        _ => format!("{drawn} directions drawn, {failed} more failed"),
    }
}

/// `wo` and its mirror direction on the disc.
fn ends(theta: f64) -> Vec<DiscMark> {
    let reach = theta.to_radians().sin();
    let mark = |x: f64, label: &str| DiscMark { at: (x, 0.0), label: label.into() };
    if theta == 0.0 {
        return vec![mark(0.0, "wo and mirror")];
    }
    vec![mark(-reach, "wo"), mark(reach, "mirror")]
}

/// A lobe whose greatest value is so many times its mean over angles is drawn under a root.
const PEAKED: f64 = 8.0;

fn greatest(curves: &[Named]) -> f64 {
    curves.iter().flat_map(|c| &c.curve).map(|p| p.1).fold(0.0, f64::max)
}

/// Mean over the angle: points are closer where the curve is high.
fn mean(curve: &Curve) -> f64 {
    curve.windows(2).map(|w| (w[1].0 - w[0].0) * 0.5 * (w[0].1 + w[1].1)).sum::<f64>() / 180.0
}

/// The least value above 0; 0 if there is none.
fn least(curves: &[Named]) -> f64 {
    let above = curves.iter().flat_map(|c| &c.curve).map(|p| p.1).filter(|&v| v > 0.0);
    above.reduce(f64::min).unwrap_or(0.0)
}
