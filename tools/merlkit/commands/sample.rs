//! `merlkit sample`

use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;

use glam::{Vec2, Vec3};
use merlkit::Error;
use merlkit::brdf::Brdf;
use merlkit::color;
use merlkit::direction_sampler::DirectionSample;
use merlkit::material::Loaded;
use merlkit::material::Material;
use merlkit::material::merl::LookupRule;
use merlkit::points::PointSet;
use merlkit::sampler::store::{Record, SamplerFile, looks_like_sampler_file};
use merlkit::sampler::{Sampler, SamplerSpec};
use merlkit_evaluate::measure::cloud::{CloudUnits, viewer_line};

use crate::failure::Outcome;
use crate::progress::Progress;
use crate::sampler_args;
use crate::{args, output};

/// Draw directions and print each with its density and BRDF value
///
/// Writes a heading and, for each draw, one line wi_x,wi_y,wi_z,pdf,f_r,f_g,f_b: the unit vector towards the light, its
/// density in sr⁻¹, and f_r in sr⁻¹ without the cosine. A failed draw is a line of zeros and counts as a sample of weight 0.
/// --fit writes the thesis's point-cloud format instead: the material, the view direction in degrees or as --fit-units says, and one
/// line (x,y,z) f per draw. `merlkit info` and `merlkit plot --kind disc --fit` read it back.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  merlkit sample nickel --theta 30 --count 1000 > draws.csv")]
pub struct Args {
    /// MERL binary, .bsdf file, sampler file, name of a built-in material, or a formula
    #[arg(value_name = "MATERIAL|SAMPLERFILE")]
    source: String,
    /// Sampler to build, with settings (`merlkit samplers` lists them) [default: half-vector:64KB, or the one in the sampler
    /// file]
    #[arg(help_heading = "Draws", long, value_name = sampler_args::VALUE)]
    sampler: Option<SamplerSpec>,
    /// Material of the sampler file [default: the one named in it]
    #[arg(help_heading = "Materials", long, value_name = "MATERIAL")]
    material: Option<String>,
    /// How values between the samples of a table are interpolated [default: floor, or the rule in the sampler file]
    #[arg(help_heading = "Materials", long, value_name = "floor|linear|centred", hide_possible_values = true, value_parser = args::lookup_rule())]
    lookup: Option<LookupRule>,
    #[command(flatten, next_help_heading = "Materials")]
    tables: args::TableOptions,
    /// Polar angle of wo in degrees, from 0 to below 90
    #[arg(
        help_heading = "Draws",
        long,
        value_name = "DEG",
        allow_negative_numbers = true
    )]
    theta: f64,
    /// Azimuth of wo in degrees
    #[arg(
        help_heading = "Draws",
        long,
        value_name = "DEG",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    phi: f64,
    /// Number of draws
    #[arg(help_heading = "Draws", long, value_name = "N")]
    count: u64,
    /// Seed of the points
    #[arg(help_heading = "Draws", long, value_name = "K", default_value_t = 0)]
    seed: u64,
    /// Sample points in the unit square: random or Owen-scrambled Sobol
    #[arg(help_heading = "Draws", long, value_name = "SET", default_value = "random", value_parser = ["random", "sobol"])]
    points: String,
    /// Write a FIT point cloud: successful draws only, with the mean of RGB as the value
    #[arg(help_heading = "Output", long)]
    fit: bool,
    /// Units of the viewer in a FIT point cloud: degrees, or θ in radians and φ in degrees (thesis) [default: degrees]
    #[arg(help_heading = "Output", long, value_name = "degrees|thesis", hide_possible_values = true, requires = "fit", value_parser = args::named(super::plot::UNITS))]
    fit_units: Option<CloudUnits>,
    /// Start each line with its input wo_x,wo_y,wo_z,u_x,u_y, for comparison with another implementation
    #[arg(help_heading = "Output", long, conflicts_with = "fit")]
    with_points: bool,
}

pub fn run(args: &Args) -> Outcome {
    if !(0.0..90.0).contains(&args.theta) || !args.phi.is_finite() {
        let what = format!("wo at polar angle {}°, azimuth {}°", args.theta, args.phi);
        return Err(
            Error::argument(what, "choose --theta from 0 to below 90 and a finite --phi").into(),
        );
    }
    let building = Progress::new("building", 1);
    let (name, sampler, brdf) = load(args)?;
    drop(building);
    // On a terminal the draws themselves show how far they are.
    let is_shown = !io::stdout().is_terminal();
    let draws = Draws {
        progress: is_shown.then(|| Progress::new("drawing", args.count as usize)),
        wo: args::direction(args.theta, args.phi).as_vec3(),
        points: if args.points == "sobol" {
            PointSet::Sobol
        } else {
            PointSet::Random
        },
        seed: args.seed,
        count: args.count,
    };
    output::stdout(|out| match args.fit {
        true => write_fit(
            out,
            &name,
            &viewer_line(args.theta, args.phi, args.fit_units.unwrap_or_default()),
            &draws,
            &sampler,
            &**brdf.brdf(),
        ),
        false => write_csv(out, &draws, &sampler, &**brdf.brdf(), args.with_points),
    })?;
    Ok(ExitCode::SUCCESS)
}

/// The material's name, the sampler, and the BRDF it was built for.
fn load(args: &Args) -> Result<(String, Sampler, Loaded), Error> {
    let path = Path::new(&args.source);
    if path.is_file() && looks_like_sampler_file(path) {
        let file = SamplerFile::open(path)?;
        refuse_other_sampler(args, file.record())?;
        let name = file.record().material.clone();
        let material = args
            .material
            .as_deref()
            .map(Material::resolve)
            .transpose()?;
        let (sampler, brdf) = file.load(material)?;
        output::print_notes(brdf.name(), brdf.notes());
        return Ok((name, sampler, brdf));
    }
    if args.material.is_some() {
        return Err(Error::argument(
            "--material applies to sampler files only",
            "omit it",
        ));
    }
    let material = args.tables.resolve(&args.source)?;
    let spec = match &args.sampler {
        Some(spec) => spec.clone(),
        None => sampler_args::DEFAULT.parse()?,
    };
    spec.check_supports(&material.facts()?)?;
    let brdf = args::load(&material, args.lookup.unwrap_or_default())?;
    Ok((material.name().into(), spec.build(&brdf)?, brdf))
}

/// What a sampler file holds is built already.
fn refuse_other_sampler(args: &Args, record: &Record) -> Result<(), Error> {
    if args.sampler.as_ref().is_some_and(|s| *s != record.spec) {
        return Err(Error::argument(
            format!("{} contains the sampler {}", args.source, record.spec),
            "omit --sampler",
        ));
    }
    if let Some(option) = args.tables.contradiction(record) {
        return Err(Error::argument(
            format!("{} was built with another {option}", args.source),
            format!("omit {option}, or rebuild the sampler"),
        ));
    }
    match (record.lookup, args.lookup) {
        (Some(recorded), Some(given)) if recorded != given => Err(Error::argument(
            format!(
                "{} was built for the {} lookup",
                args.source,
                recorded.name()
            ),
            "omit --lookup, or rebuild the sampler",
        )),
        _ => Ok(()),
    }
}

struct Draws {
    wo: Vec3,
    points: PointSet,
    seed: u64,
    count: u64,
    progress: Option<Progress>,
}

impl Draws {
    /// Points and what they are mapped to.
    fn iter(&self, sampler: &Sampler) -> impl Iterator<Item = (Vec2, Option<DirectionSample>)> {
        (0..self.count).map(move |i| {
            if let Some(progress) = &self.progress {
                progress.advance();
            }
            let u: Vec2 = self.points.point(self.seed, i, 0);
            (u, sampler.sample(self.wo, u))
        })
    }
}

fn write_csv(
    out: &mut dyn Write,
    draws: &Draws,
    sampler: &Sampler,
    brdf: &dyn Brdf,
    with_points: bool,
) -> io::Result<()> {
    let points = if with_points {
        "wo_x,wo_y,wo_z,u_x,u_y,"
    } else {
        ""
    };
    writeln!(out, "{points}wi_x,wi_y,wi_z,pdf,f_r,f_g,f_b")?;
    for (u, draw) in draws.iter(sampler) {
        if with_points {
            let wo = draws.wo;
            write!(out, "{:?},{:?},{:?},{:?},{:?},", wo.x, wo.y, wo.z, u.x, u.y)?;
        }
        let Some(DirectionSample { wi, pdf }) = draw else {
            writeln!(out, "0,0,0,0,0,0,0")?;
            continue;
        };
        let f = brdf.eval(draws.wo, wi);
        writeln!(
            out,
            "{:?},{:?},{:?},{pdf:?},{:?},{:?},{:?}",
            wi.x, wi.y, wi.z, f.x, f.y, f.z
        )?;
    }
    Ok(())
}

/// The thesis's format (7.10): a line for the BRDF, the viewer's angles, and a point a line between `begin` and `end`.
fn write_fit(
    out: &mut dyn Write,
    name: &str,
    viewer: &str,
    draws: &Draws,
    sampler: &Sampler,
    brdf: &dyn Brdf,
) -> io::Result<()> {
    writeln!(out, "measured \"{name}\"\n{viewer}\nbegin")?;
    for DirectionSample { wi, .. } in draws.iter(sampler).filter_map(|(_, draw)| draw) {
        writeln!(
            out,
            "  ({},{},{}) {}",
            wi.x,
            wi.y,
            wi.z,
            color::mean(brdf.eval(draws.wo, wi))
        )?;
    }
    writeln!(out, "end")
}
