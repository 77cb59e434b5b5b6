//! `merlkit eval`

use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;

use glam::DVec3;
use merlkit::color::Rgb;
use merlkit::geometry::DirectionPairs;
use merlkit::material::merl::LookupRule;

use crate::args;
use crate::failure::{Failure, Outcome};
use crate::output;

/// Evaluate f_r, in sr⁻¹ and without the cosine, for pairs of directions
///
/// Reads lines wo_x,wo_y,wo_z,wi_x,wi_y,wi_z from standard input; that heading is optional. Writes a heading and, for each
/// pair, one line f_r,f_g,f_b: the red, green and blue value. Directions are unit vectors that point away from the surface: wo to the viewer, wi to the
/// light, with z along the normal. The value is 0 if either direction is below the horizon. Blank lines are skipped.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  merlkit eval nickel --wo 30,0 --wi 30,180\n  merlkit eval nickel --lookup linear < pairs.txt"
)]
pub struct Args {
    /// MERL binary, .bsdf file, name of a built-in material, or a formula such as lambert:reflectance=0.5
    #[arg(value_name = "MATERIAL")]
    material: String,
    /// How values between the samples of a table are interpolated
    #[arg(help_heading = "Materials", long, value_name = "floor|linear|centred", hide_possible_values = true, default_value = "floor", value_parser = args::lookup_rule())]
    lookup: LookupRule,
    #[command(flatten, next_help_heading = "Materials")]
    tables: args::TableOptions,
    /// View direction as polar angle (0 to 180) and azimuth in degrees, instead of standard input [default: none]
    #[arg(help_heading = "Directions", long, value_name = "T,P", allow_hyphen_values = true, requires = "wi", value_parser = angles)]
    wo: Option<DVec3>,
    /// Light direction as polar angle (0 to 180) and azimuth in degrees, instead of standard input [default: none]
    #[arg(help_heading = "Directions", long, value_name = "T,P", allow_hyphen_values = true, requires = "wo", value_parser = angles)]
    wi: Option<DVec3>,
}

pub fn run(args: &Args) -> Outcome {
    let loaded = args::load(&args.tables.resolve(&args.material)?, args.lookup)?;
    let brdf = &**loaded.brdf();
    if args.wo.is_none() && io::stdin().is_terminal() {
        output::message("reading wo_x,wo_y,wo_z,wi_x,wi_y,wi_z lines from standard input…");
    }
    let mut failure = None;
    output::stdout(|out| {
        writeln!(out, "f_r,f_g,f_b")?;
        if let (Some(wo), Some(wi)) = (args.wo, args.wi) {
            return write_value(out, brdf.eval(wo.as_vec3(), wi.as_vec3()));
        }
        for pair in DirectionPairs::new(io::stdin().lock(), Path::new("standard input")) {
            match pair {
                Ok((wo, wi)) => write_value(out, brdf.eval(wo, wi))?,
                Err(error) => {
                    failure = Some(error);
                    break;
                }
            }
        }
        Ok(())
    })?;
    match failure {
        Some(error) => Err(Failure::Error(error)),
        None => Ok(ExitCode::SUCCESS),
    }
}

/// The shortest digits that read back as the same `f32`.
fn write_value(out: &mut dyn Write, f: Rgb) -> io::Result<()> {
    writeln!(out, "{:?},{:?},{:?}", f.x, f.y, f.z)
}

/// "T,P" in degrees as a direction.
fn angles(argument: &str) -> Result<DVec3, String> {
    let numbers: Option<Vec<f64>> = argument.split(',').map(|x| x.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[theta, phi]) if (0.0..=180.0).contains(&theta) && phi.is_finite() => {
            Ok(args::direction(theta, phi))
        }
        Some([_, _]) => {
            Err("expected a polar angle from 0 to 180 degrees and a finite azimuth".into())
        }
        _ => Err("expected two numbers, polar angle and azimuth in degrees, such as 30,180".into()),
    }
}
