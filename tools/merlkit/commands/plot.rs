//! `merlkit plot`

use std::ffi::OsStr;
use std::process::ExitCode;

use merlkit::Error;
use merlkit::material::LookupRule;
use merlkit::sampler::SamplerSpec;
use merlkit_evaluate::report::{ChartSubject, SLICE};

use crate::args;
use crate::failure::Outcome;
use crate::output::{Destination, overwrite};
use crate::raster;
use crate::sampler_args;

/// What to draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Kind {
    /// f_r·cosθ in the plane of incidence against the angle of wi; with --sampler, the ideal density and the sampler's
    Lobe,
    /// The same as lobe, in polar coordinates
    LobePolar,
    /// The table at φd = 90° over θh and θd, in false colours
    Slice,
    /// The same as slice, in the material's own colours
    SliceRgb,
    /// The leaves of the adaptive disc, and directions drawn by --sampler, on the unit disc
    Disc,
    /// The CDF over θh of cascade-cdf before and after compression, with its knots
    Cdf,
    /// The CDF over φh of cascade-cdf at the median θh, before and after compression
    CdfAzimuth,
    /// Directional albedo against θ; for a table, with each of the three lookup rules
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
            Self::CdfAzimuth => "cdf-azimuth",
            Self::Albedo => "albedo",
        }
    }

    /// Whether an option named so has an effect.
    fn takes(self, option: &str) -> bool {
        match option {
            "--theta" | "--lookup" | "--sampler" => {
                !matches!(self, Self::Slice | Self::SliceRgb | Self::Albedo)
            }
            _ => self == Self::Disc,
        }
    }
}

/// Plot a material or a sampler: lobes, densities, slices, leaves, CDFs, albedo
///
/// Writes one self-contained SVG file, 640 pixels wide, whose labels are text. A build with the feature png-plots also writes
/// PNG, at twice the size, if FILE ends in .png; otherwise, convert the SVG with a viewer or rsvg-convert.
///
/// Angles are in degrees, f_r and densities in sr⁻¹; f_r is the mean of red, green and blue. In the plane of incidence, wo is
/// on the left and its mirror direction on the right.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  merlkit plot nickel --kind lobe --theta 30 --sampler half-vector"
)]
pub struct Args {
    /// MERL binary, .bsdf file, name of a built-in material, or a formula
    #[arg(value_name = "MATERIAL")]
    material: String,
    /// What to plot
    #[arg(help_heading = "Plot", long, value_name = "KIND")]
    kind: Kind,
    /// Polar angles of wo in degrees, from 0 to below 90, such as 10,30,60; one for disc, up to four otherwise [default: 30]
    #[arg(
        help_heading = "Plot",
        long,
        value_name = "DEG",
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    theta: Vec<f64>,
    /// Sampler to show, with settings (`merlkit samplers` lists them) [default: none for lobes, adaptive-disc for disc,
    /// cascade-cdf for CDFs]
    #[arg(help_heading = "Plot", long, value_name = sampler_args::VALUE)]
    sampler: Option<SamplerSpec>,
    /// How values between the samples of a table are interpolated [default: floor]
    #[arg(help_heading = "Materials", long, value_name = "floor|linear|centred", hide_possible_values = true, value_parser = args::lookup_rule())]
    lookup: Option<LookupRule>,
    #[command(flatten, next_help_heading = "Materials")]
    tables: args::TableOptions,
    /// disc: number of directions to draw, 0 to 100000 [default: 1000]
    #[arg(help_heading = "Plot", long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=100_000))]
    samples: Option<u32>,
    /// disc: seed of the draws [default: 0]
    #[arg(help_heading = "Plot", long, value_name = "K")]
    seed: Option<u64>,
    /// SVG or PNG file to write, or - for SVG on standard output [default: MATERIAL-KIND.svg]
    #[arg(help_heading = "Output", short, long, value_name = "FILE|-")]
    output: Option<Destination>,
    /// Replace an existing FILE [default: refuse]
    #[arg(help_heading = "Output", long)]
    force: bool,
}

pub fn run(args: &Args) -> Outcome {
    let kind = args.kind;
    args.refuse_idle()?;
    let thetas = args.thetas()?;
    let spec = args.spec()?;
    let material = args.tables.resolve(&args.material)?;
    let file = || Destination::File(format!("{}-{}.svg", material.name(), kind.name()).into());
    let destination = args.output.clone().unwrap_or_else(file);
    let format = Format::from_extension(&destination)?;
    destination.check(overwrite(args.force))?;
    let facts = material.facts()?;
    if matches!(kind, Kind::Slice | Kind::SliceRgb) {
        facts.require_table(material.name(), SLICE)?;
    }
    if let Some(spec) = &spec {
        spec.check_supports(&facts)?;
    }
    let loaded = args::load(&material, args.lookup.unwrap_or_default())?;
    let subject = ChartSubject::new(&loaded, thetas, spec)?;
    let svg = match kind {
        Kind::Lobe => subject.lobe(),
        Kind::LobePolar => subject.lobe_polar(),
        Kind::Slice => subject.slice()?,
        Kind::SliceRgb => subject.slice_rgb()?,
        Kind::Disc => subject.disc(
            args.samples.unwrap_or(1000) as usize,
            args.seed.unwrap_or(0),
        ),
        Kind::Cdf => subject.cdf()?,
        Kind::CdfAzimuth => subject.cdf_azimuth()?,
        Kind::Albedo => subject.albedo(),
    };
    let bytes = match format {
        Format::Svg => svg.into_bytes(),
        Format::Png => raster::png(&svg)?,
    };
    destination.write(overwrite(args.force), |out| out.write_all(&bytes))?;
    Ok(ExitCode::SUCCESS)
}

#[derive(Clone, Copy)]
enum Format {
    Svg,
    Png,
}

impl Format {
    /// By the extension.
    fn from_extension(destination: &Destination) -> Result<Self, Error> {
        let Destination::File(path) = destination else {
            return Ok(Self::Svg);
        };
        match path.extension().and_then(OsStr::to_str) {
            Some("svg") => Ok(Self::Svg),
            Some("png") => raster::check().map(|()| Self::Png),
            _ => Err(Error::argument(
                format!("{}: plots are SVG or PNG", path.display()),
                "name a file that ends in .svg",
            )),
        }
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
        let idle = given
            .iter()
            .find(|(option, given)| *given && !self.kind.takes(option));
        match idle {
            Some((option, _)) => Err(Error::argument(
                format!("{option} has no effect on --kind {}", self.kind.name()),
                "omit it",
            )),
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

    /// The sampler that is shown.
    fn spec(&self) -> Result<Option<SamplerSpec>, Error> {
        match (&self.sampler, self.kind) {
            (Some(spec), _) => Ok(Some(spec.clone())),
            (None, Kind::Cdf | Kind::CdfAzimuth) => "cascade-cdf".parse().map(Some),
            (None, Kind::Disc) => "adaptive-disc".parse().map(Some),
            (None, _) => Ok(None),
        }
    }
}
