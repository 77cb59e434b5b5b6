//! `merlkit plot`

mod cloud;
mod format;
mod kind;
mod sky;

use std::path::Path;
use std::process::ExitCode;

use merlkit::Error;
use merlkit::image::write_exr;
use merlkit::material::{Loaded, LookupRule, Material};
use merlkit::sampler::{Sampler, SamplerSpec};
use merlkit_evaluate::measure::views::{PlottedChannel, PlottedValue};
use merlkit_evaluate::plot::{Chart, ChartSize, Pixels, Scale, with_metadata};
use merlkit_evaluate::report::{
    ChartSubject, CurveCharts, CurveOptions, SLICE, SurfaceOptions, check_surfaces, surface_chart,
};

use crate::args;
use crate::failure::{Failure, Outcome};
use crate::output::{self, Destination, overwrite};
use crate::png_comment::with_comment;
use crate::progress::Progress;
use crate::provenance;
use crate::sampler_args;

pub use cloud::UNITS;

use cloud::CloudOptions;
use format::{Format, check_size, png_layout, read_viewpoint};
use kind::Kind;
use sky::{SkyOptions, SkyRequest};

const VALUES: &[(&str, bool)] = &[("f-cos", false), ("f", true)];

const SCALES: &[(&str, Scale)] = &[
    ("linear", Scale::Linear),
    ("log", Scale::Log),
    ("root", Scale::Root),
];

const CHANNELS: &[(&str, PlottedChannel)] = &[
    ("mean", PlottedChannel::Mean),
    ("luminance", PlottedChannel::Luminance),
    ("r", PlottedChannel::Red),
    ("g", PlottedChannel::Green),
    ("b", PlottedChannel::Blue),
];

/// Plot materials and samplers: lobes, densities, slices, leaves, CDFs, albedo
// Without a second paragraph the help has one line or two for each option, instead of three or more.
#[derive(clap::Args)]
#[command(
    after_help = "Writes one self-contained SVG file, 640 pixels wide, whose labels are text. -o FILE.pdf and -o FILE.png write the same \
                  picture as PDF and PNG, -o FILE.csv the numbers of the picture. A PNG of a slice is its pixels alone, and slice-rgb is \
                  also written as linear values, FILE.exr.\n\n\
                  Angles are in degrees, f_r and densities in sr⁻¹. In the plane of incidence, wo is on the left and its mirror direction \
                  on the right. Lobes and albedos of up to seven materials share a picture, with up to four samplers; of lobe-3d up to six \
                  solids.\n\n\
                  Kinds:\n  \
                  lobe         f_r·cosθ in the plane of incidence against the angle of wi; with --sampler, the ideal density and the sampler's\n  \
                  lobe-polar   the same in polar coordinates\n  \
                  lobe-3d      f_r·cosθ over the whole hemisphere, as a shaded solid\n  \
                  slice        the table at one φd over θh and θd, in false colours\n  \
                  slice-rgb    the same in the material's own colours: gamma 2.2, one pixel per bin\n  \
                  disc         the leaves of the adaptive disc, and directions drawn by --sampler, on the unit disc\n  \
                  cdf          the CDF over θh of cascade-cdf before and after compression, with its knots\n  \
                  cdf-azimuth  the CDF over φh of cascade-cdf at the median θh, before and after compression\n  \
                  albedo       directional albedo against θ; for one table alone, with each of the three lookup rules\n  \
                  environment  a map and the directions that --strategy draws, and the map's luminance\n\n\
                  Examples:\n  merlkit plot nickel chrome --kind lobe --theta 30\n  merlkit plot nickel --kind lobe --sampler half-vector --sampler cosine --csv nickel.csv\n  merlkit plot nickel red-plastic --kind lobe-3d --elevation 40 -o lobes.pdf\n  merlkit plot nickel --kind slice-rgb --exposure=-2 -o nickel.png\n  merlkit plot nickel --kind environment --light studio --strategy ris --samples 200 --theta 45"
)]
pub struct Args {
    /// MERL binaries and .bsdf files or folders of them, stored fits, names of built-in materials, or formulas; several for lobes and
    /// albedo
    #[arg(required_unless_present_any = ["fit", "light"], value_name = "MATERIAL")]
    materials: Vec<String>,
    /// What to plot
    #[arg(help_heading = "Plot", long, value_name = "KIND")]
    kind: Kind,
    /// Polar angles of wo in degrees, from 0 to below 90, such as 10,30,60; one for disc and environment, up to seven otherwise [default: 30]
    #[arg(
        help_heading = "Plot",
        long,
        value_name = "DEG",
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    theta: Vec<f64>,
    /// Sampler to show, with settings (`merlkit samplers` lists them); lobes take up to four, each with its own --sampler
    /// [default: none for lobes, adaptive-disc for disc, cascade-cdf for CDFs]
    #[arg(help_heading = "Plot", long = "sampler", value_name = sampler_args::VALUE)]
    samplers: Vec<SamplerSpec>,
    /// Lobes without samplers: f_r·cosθi or f_r alone [default: f-cos]
    #[arg(help_heading = "Plot", long, value_name = "f-cos|f", hide_possible_values = true, value_parser = args::named(VALUES))]
    value: Option<bool>,
    /// Lobes without samplers, and albedo: the number that represents red, green and blue [default: mean]
    #[arg(help_heading = "Plot", long, value_name = "mean|luminance|r|g|b", hide_possible_values = true, value_parser = args::named(CHANNELS))]
    channel: Option<PlottedChannel>,
    /// Scale of values in lobes, albedo and slice [default: log for lobe and slice, linear for albedo, linear or root for
    /// lobe-polar, linear or log for lobe-3d]
    #[arg(help_heading = "Plot", long, value_name = "linear|log|root", hide_possible_values = true, value_parser = args::named(SCALES))]
    scale: Option<Scale>,
    /// lobe-3d: angle above the surface from which it is seen, in degrees, 0 to 90 [default: 25]
    #[arg(
        help_heading = "Plot",
        long,
        value_name = "DEG",
        allow_negative_numbers = true
    )]
    elevation: Option<f64>,
    /// lobe-3d: turn of the viewpoint about the normal, in degrees; at 0 the plane of incidence is seen face on, at 90 wo points
    /// to the viewer [default: 20]
    #[arg(
        help_heading = "Plot",
        long,
        value_name = "DEG",
        allow_negative_numbers = true
    )]
    azimuth: Option<f64>,
    /// lobe-3d: two or three materials in one hemisphere, translucent [default: one each]
    #[arg(help_heading = "Plot", long)]
    together: bool,
    /// Slices: azimuth of the difference angle in degrees, 0 to 179 [default: 90]
    #[arg(help_heading = "Plot", long, value_name = "DEG", value_parser = clap::value_parser!(u16).range(0..180))]
    phi_d: Option<u16>,
    /// slice-rgb, environment: stops by which values are made brighter; an f_r of 2^-STOPS sr⁻¹ is full brightness [default: 0]
    #[arg(
        help_heading = "Plot",
        long,
        value_name = "STOPS",
        allow_negative_numbers = true
    )]
    exposure: Option<f32>,
    #[command(flatten, next_help_heading = "Plot")]
    sky: SkyOptions,
    #[command(flatten, next_help_heading = "Plot")]
    cloud: CloudOptions,
    /// How values between the samples of a table are interpolated [default: floor]
    #[arg(help_heading = "Materials", long, value_name = "floor|linear|centred", hide_possible_values = true, value_parser = args::lookup_rule())]
    lookup: Option<LookupRule>,
    #[command(flatten, next_help_heading = "Materials")]
    tables: args::TableOptions,
    /// disc, environment: number of directions to draw, 0 to 100000 [default: 1000]
    #[arg(help_heading = "Plot", long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=100_000))]
    samples: Option<u32>,
    /// disc, environment: seed of the draws [default: 0]
    #[arg(help_heading = "Plot", long, value_name = "K")]
    seed: Option<u64>,
    /// File to write, by its extension: .svg, .pdf, .png, .csv, .exr; or - for SVG on standard output [default: MATERIAL-KIND.svg]
    #[arg(help_heading = "Output", short, long, value_name = "FILE|-")]
    output: Option<Destination>,
    /// Also write the numbers of the picture as CSV; with -, to standard output [default: none]
    #[arg(help_heading = "Output", long, value_name = "FILE|-")]
    csv: Option<Destination>,
    /// Pixels across, 320 to 10000; text keeps its size [default: 640, for a PNG 1280, for a PNG of a slice 360]
    #[arg(help_heading = "Output", long, value_name = "N", value_parser = clap::value_parser!(u16).range(320..=10_000))]
    width: Option<u16>,
    /// Pixels down, 240 to 10000 [default: what suits the width, for a PNG of a slice 360]
    #[arg(help_heading = "Output", long, value_name = "N", value_parser = clap::value_parser!(u16).range(240..=10_000))]
    height: Option<u16>,
    /// Replace existing files [default: refuse]
    #[arg(help_heading = "Output", long)]
    force: bool,
}

pub fn run(args: &Args) -> Outcome {
    let thetas = args.thetas()?;
    let specs = args.specs()?;
    let materials = args::resolve(&args.materials, &args.tables)?;
    args::refuse_repeated(&materials)?;
    args.check_options(&materials)?;
    if args.kind == Kind::Lobe3d {
        check_surfaces(materials.len(), thetas.len(), args.together)?;
    } else if args.kind.takes_several() {
        CurveCharts::check_counts(materials.len(), thetas.len(), specs.len())?;
    }
    let destination = args.destination(&materials);
    let format = Format::from_extension(&destination, args.kind)?;
    check_size(format, args.width, args.height)?;
    destination.check(overwrite(args.force))?;
    if let Some(numbers) = &args.csv {
        if (&destination, numbers) == (&Destination::Stdout, &Destination::Stdout) {
            let what = "the picture and its numbers on standard output";
            return Err(Error::argument(what, "name a file for one of them").into());
        }
        numbers.check(overwrite(args.force))?;
    }
    args.check_facts(&materials, &specs)?;
    // Loading, building each sampler and computing the chart.
    let progress = Progress::new("plotting", materials.len() * (1 + specs.len()) + 1);
    let mut loaded = Vec::new();
    for material in &materials {
        loaded.push(args::load(material, args.lookup.unwrap_or_default())?);
        progress.advance();
    }
    let chart = args.chart(&loaded, thetas, &specs, &progress)?;
    drop(progress);
    let origin = match format {
        // These say nothing of where they come from.
        Format::Csv | Format::Pdf => Vec::new(),
        _ => provenance::record(args.seed, &materials)?.lines(),
    };
    args.write(&chart, format, &destination, &origin)?;
    if let Some(numbers) = &args.csv {
        args.write_bytes(chart.csv().as_bytes(), numbers)?;
    }
    args.print_written(&destination)
}

/// Pixels of a PNG for each bin of a slice, across and down.
const PIXELS_PER_BIN: usize = 4;
/// Bins of a slice, across and down.
const BINS: usize = 90;

impl Args {
    /// MATERIAL-KIND.svg unless a file is named; more than three materials are counted instead of named.
    fn destination(&self, materials: &[Material]) -> Destination {
        if let Some(destination) = &self.output {
            return destination.clone();
        }
        let fit = self.cloud.fit.as_deref().and_then(Path::file_stem);
        let mut names: Vec<String> = materials.iter().map(|m| m.name().to_owned()).collect();
        names.extend(fit.map(|stem| stem.to_string_lossy().into_owned()));
        if names.len() > 3 {
            names.truncate(1);
            names.push(format!("and-{}-more", materials.len() - 1));
        }
        names.push(self.kind.name().to_owned());
        let file = names.join("-") + ".svg";
        Destination::File(file.into())
    }

    /// Refuses what the kind has no room for, and options without effect, which are mistakes.
    fn check_options(&self, materials: &[Material]) -> Result<(), Error> {
        let kind = self.kind;
        self.check_extras(materials.len())?;
        if materials.len() > 1 && !kind.takes_several() {
            return Err(Error::argument(
                format!("{} materials for --kind {}", materials.len(), kind.name()),
                "choose one, or --kind lobe, lobe-polar, lobe-3d or albedo",
            ));
        }
        if self.exposure.is_some_and(|stops| !stops.is_finite()) {
            return Err(Error::argument(
                "an exposure without an end",
                "choose a number of stops, such as -2",
            ));
        }
        if kind == Kind::LobePolar && self.scale == Some(Scale::Log) {
            return Err(Error::argument(
                "a logarithmic scale has no 0 for the centre of --kind lobe-polar",
                "choose --scale linear or root",
            ));
        }
        read_viewpoint(self.elevation, self.azimuth)?;
        let given = [
            ("--theta", !self.theta.is_empty()),
            ("--lookup", self.lookup.is_some()),
            ("--sampler", !self.samplers.is_empty()),
            ("--value", self.value.is_some()),
            ("--channel", self.channel.is_some()),
            ("--scale", self.scale.is_some()),
            ("--phi-d", self.phi_d.is_some()),
            ("--exposure", self.exposure.is_some()),
            ("--elevation", self.elevation.is_some()),
            ("--azimuth", self.azimuth.is_some()),
            ("--together", self.together),
            ("--samples", self.samples.is_some()),
            ("--seed", self.seed.is_some()),
        ];
        for (option, given) in given {
            let samplers = !self.samplers.is_empty();
            if given && !kind.takes(option, materials.len(), samplers) {
                let with = if kind.takes(option, materials.len(), false) {
                    " with --sampler"
                } else {
                    ""
                };
                let what = format!("{option} has no effect on --kind {}{with}", kind.name());
                return Err(Error::argument(what, "omit it"));
            }
        }
        Ok(())
    }

    /// Refuses options of environments and clouds where they have no effect.
    fn check_extras(&self, materials: usize) -> Result<(), Error> {
        match self.kind {
            Kind::Environment => self.sky.check(materials)?,
            kind => self.sky.refuse_elsewhere(kind.name())?,
        }
        if self.cloud.fit.is_some() && self.kind != Kind::Disc {
            return Err(Error::argument(
                format!("a cloud for --kind {}", self.kind.name()),
                "choose --kind disc",
            ));
        }
        Ok(())
    }

    fn thetas(&self) -> Result<Vec<f64>, Error> {
        if let Some(theta) = self.theta.iter().find(|t| !(0.0..90.0).contains(*t)) {
            let what = format!("wo at polar angle {theta}°");
            return Err(Error::argument(what, "choose --theta from 0 to below 90"));
        }
        let most = match self.kind {
            Kind::Disc | Kind::Environment => 1,
            _ => 7,
        };
        if self.theta.len() > most {
            let what = format!(
                "{} angles for --kind {}",
                self.theta.len(),
                self.kind.name()
            );
            return Err(Error::argument(what, format!("choose at most {most}")));
        }
        Ok(if self.theta.is_empty() {
            vec![30.0]
        } else {
            self.theta.clone()
        })
    }

    /// The samplers that are shown.
    fn specs(&self) -> Result<Vec<SamplerSpec>, Error> {
        if self.samplers.len() > 1 && !self.kind.is_lobe() {
            return Err(Error::argument(
                format!(
                    "{} samplers for --kind {}",
                    self.samplers.len(),
                    self.kind.name()
                ),
                "choose one, or --kind lobe or lobe-polar",
            ));
        }
        match self.kind {
            _ if !self.samplers.is_empty() => Ok(self.samplers.clone()),
            Kind::Cdf | Kind::CdfAzimuth => SamplerSpec::parse_all(&["cascade-cdf"]),
            Kind::Disc if self.cloud.fit.is_none() => SamplerSpec::parse_all(&["adaptive-disc"]),
            Kind::Environment if self.sky.needs_material() => {
                SamplerSpec::parse_all(&[sampler_args::DEFAULT])
            }
            _ => Ok(Vec::new()),
        }
    }

    /// Refuses materials that have no such picture, before any is loaded.
    fn check_facts(&self, materials: &[Material], specs: &[SamplerSpec]) -> Result<(), Error> {
        for material in materials {
            let facts = material.facts()?;
            if self.kind.is_slice() {
                facts.require_table(material.name(), SLICE)?;
            }
            specs.iter().try_for_each(|s| s.check_supports(&facts))?;
        }
        Ok(())
    }

    /// Builds the samplers, and draws.
    fn chart(
        &self,
        materials: &[Loaded],
        thetas: Vec<f64>,
        specs: &[SamplerSpec],
        progress: &Progress,
    ) -> Result<Chart, Error> {
        let mut samplers = Vec::new();
        for material in materials {
            let mut built: Vec<Sampler> = Vec::new();
            for spec in specs {
                built.push(spec.build(material)?);
                progress.advance();
            }
            samplers.push(built);
        }
        if let Some(path) = &self.cloud.fit {
            return self.cloud.chart(path);
        }
        if self.kind == Kind::Environment {
            let sampler = samplers.first().and_then(|built| built.first());
            let subject = materials.first().zip(sampler);
            return self.sky.chart(subject, &self.sky_request(thetas[0]));
        }
        let (value, scale) = (
            PlottedValue {
                channel: self.channel.unwrap_or_default(),
                without_cosine: self.value.unwrap_or_default(),
            },
            self.scale,
        );
        if self.kind == Kind::Lobe3d {
            let options = SurfaceOptions {
                value,
                scale,
                together: self.together,
                viewpoint: read_viewpoint(self.elevation, self.azimuth)?,
            };
            return surface_chart(materials, &thetas, options).map(Chart::Surfaces);
        }
        if self.kind.takes_several() {
            let options = CurveOptions { value, scale };
            let charts = CurveCharts::new(materials, thetas, samplers, options)?;
            return Ok(match self.kind {
                Kind::Lobe => Chart::Lines(charts.lobe()),
                Kind::LobePolar => Chart::Polar(charts.lobe_polar()),
                _ => Chart::Lines(charts.albedo()),
            });
        }
        let sampler = samplers.into_iter().flatten().next();
        self.single_chart(&ChartSubject::new(&materials[0], thetas, sampler))
    }

    /// What a picture of an environment shows.
    fn sky_request(&self, theta: f64) -> SkyRequest {
        SkyRequest {
            theta,
            samples: self.samples.unwrap_or(1000) as usize,
            seed: self.seed.unwrap_or(0),
            exposure: self.exposure.unwrap_or(0.0),
        }
    }

    /// A picture of one material.
    fn single_chart(&self, subject: &ChartSubject) -> Result<Chart, Error> {
        let phi_d = usize::from(self.phi_d.unwrap_or(90));
        match self.kind {
            Kind::Slice => {
                let scale = self.scale.unwrap_or(Scale::Log);
                subject.slice(phi_d, scale).map(Chart::Heat)
            }
            Kind::SliceRgb => {
                let exposure = self.exposure.unwrap_or(0.0);
                subject.slice_rgb(phi_d, exposure).map(Chart::Heat)
            }
            Kind::Disc => {
                let samples = self.samples.unwrap_or(1000) as usize;
                let disc = subject.disc(samples, self.seed.unwrap_or(0));
                Ok(Chart::Disc(disc))
            }
            Kind::Cdf => subject.cdf().map(Chart::Lines),
            _ => subject.cdf_azimuth().map(Chart::Lines),
        }
    }

    fn write(
        &self,
        chart: &Chart,
        format: Format,
        destination: &Destination,
        origin: &[String],
    ) -> Result<(), Failure> {
        match (format, chart, destination) {
            (Format::Csv, ..) => self.write_bytes(chart.csv().as_bytes(), destination),
            (Format::PixelsPng, Chart::Heat(heat), _) => {
                let usual = BINS * PIXELS_PER_BIN;
                let width = self.width.map_or(usual, usize::from);
                let height = self.height.map_or(usual, usize::from);
                let png = heat.pixels_png(width, height)?;
                self.write_bytes(&with_comment(&png, origin)?, destination)
            }
            (Format::PixelsExr, Chart::Heat(heat), Destination::File(path)) => {
                if let Pixels::Picture { image, .. } = &heat.pixels {
                    let image = image.clone().with_comment(origin.join("\n"));
                    write_exr(path, &image, overwrite(self.force))?;
                }
                Ok(())
            }
            (Format::Png, ..) => {
                let (size, density) = png_layout(self.width, self.height);
                let png = chart.drawing(size)?.png(density)?;
                self.write_bytes(&with_comment(&png, origin)?, destination)
            }
            (Format::Pdf, ..) => self.write_bytes(&chart.drawing(self.size())?.pdf(), destination),
            _ => {
                let svg = with_metadata(&chart.svg(self.size())?, origin);
                self.write_bytes(svg.as_bytes(), destination)
            }
        }
    }

    fn size(&self) -> ChartSize {
        ChartSize {
            width: self.width.map_or(ChartSize::default().width, f64::from),
            height: self.height.map(f64::from),
        }
    }

    fn write_bytes(&self, bytes: &[u8], destination: &Destination) -> Result<(), Failure> {
        destination.write(overwrite(self.force), |out| out.write_all(bytes))
    }

    /// Says which files were written, unless standard output holds the picture or its numbers.
    fn print_written(&self, destination: &Destination) -> Outcome {
        let mut files = Vec::new();
        for written in std::iter::once(destination).chain(&self.csv) {
            let Destination::File(path) = written else {
                return Ok(ExitCode::SUCCESS);
            };
            files.push(path);
        }
        output::stdout(|out| {
            for file in files {
                writeln!(out, "wrote {}", file.display())?;
            }
            Ok(())
        })?;
        Ok(ExitCode::SUCCESS)
    }
}
