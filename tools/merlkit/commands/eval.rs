//! `merlkit eval`

use std::io::{self, BufRead, Read, Write};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use merlkit::Error;
use merlkit::brdf::{Brdf, LookupRule, Measured};
use merlkit::color::Rgb;
use merlkit::merl::Material;

use crate::args;
use crate::failure::{Failure, Outcome};
use crate::output;

/// Evaluate f_r, in sr⁻¹ and without the cosine, for pairs of directions
///
/// Reads lines of wo_x,wo_y,wo_z,wi_x,wi_y,wi_z from standard input, with or without that heading, and writes one line
/// f_r,f_g,f_b for each under a heading. Directions are unit vectors that leave the surface, z along the normal, wo to the
/// viewer and wi to the light. A pair with a direction below the horizon has the value 0. Blank lines are skipped.
#[derive(clap::Args)]
pub struct Args {
    /// Path to a MERL binary or name of an embedded material
    #[arg(value_name = "MATERIAL")]
    material: String,
    /// What the table says between its samples
    #[arg(long, value_name = "RULE", default_value = "floor", value_parser = args::lookup_rule())]
    lookup: LookupRule,
    /// Viewer as polar angle (0 to 180) and azimuth, degrees, instead of standard input [default: none]
    #[arg(long, value_name = "T,P", requires = "wi", value_parser = angles)]
    wo: Option<DVec3>,
    /// Light as polar angle (0 to 180) and azimuth, degrees, instead of standard input [default: none]
    #[arg(long, value_name = "T,P", requires = "wo", value_parser = angles)]
    wi: Option<DVec3>,
}

const HEADING: &str = "wo_x,wo_y,wo_z,wi_x,wi_y,wi_z";
/// Bytes of a line that are read before it is refused; six numbers need some hundred.
const LONGEST_LINE: u64 = 4096;
/// How far a direction's length may be from 1; files with three decimals pass.
const UNIT_SLACK: f64 = 1e-3;

pub fn run(args: &Args) -> Outcome {
    let brdf = Measured::new(Arc::new(Material::resolve(&args.material)?.load()?), args.lookup);
    let mut failure = None;
    output::stdout(|out| {
        writeln!(out, "f_r,f_g,f_b")?;
        if let (Some(wo), Some(wi)) = (args.wo, args.wi) {
            return write_value(out, brdf.eval(wo.as_vec3(), wi.as_vec3()));
        }
        for pair in Pairs::new(io::stdin().lock()) {
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
        Some([_, _]) => Err("expected a polar angle of 0 to 180 degrees and a finite azimuth".into()),
        _ => Err("expected two numbers, polar angle and azimuth in degrees, as in 30,180".into()),
    }
}

/// Pairs of directions from lines of text.
struct Pairs<R> {
    input: R,
    number: usize,
    line: Vec<u8>,
    heading_possible: bool,
}

impl<R: BufRead> Pairs<R> {
    fn new(input: R) -> Self {
        Self { input, number: 0, line: Vec::new(), heading_possible: true }
    }

    /// The next line with anything on it, trimmed.
    fn next_line(&mut self) -> Option<Result<String, Error>> {
        loop {
            self.line.clear();
            match self.input.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut self.line) {
                Ok(0) => return None,
                Ok(_) => self.number += 1,
                Err(e) => return Some(Err(Error::io(Path::new("standard input"), "read", e))),
            }
            if self.line.len() as u64 == LONGEST_LINE {
                return Some(Err(Error::argument(
                    format!("standard input, line {}: {LONGEST_LINE} bytes without an end", self.number),
                    "write one pair of directions a line",
                )));
            }
            let text = String::from_utf8_lossy(&self.line);
            let text = text.trim_start_matches('\u{feff}').trim();
            if !text.is_empty() {
                return Some(Ok(text.to_owned()));
            }
        }
    }

    fn is_heading(&mut self, line: &str) -> bool {
        let bare: String = line.chars().filter(|c| !c.is_whitespace()).collect();
        std::mem::take(&mut self.heading_possible) && bare.eq_ignore_ascii_case(HEADING)
    }
}

impl<R: BufRead> Iterator for Pairs<R> {
    type Item = Result<(Vec3, Vec3), Error>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            match self.next_line()? {
                Ok(line) if self.is_heading(&line) => {}
                Ok(line) => return Some(parse(&line, self.number)),
                Err(error) => return Some(Err(error)),
            }
        }
    }
}

fn parse(line: &str, number: usize) -> Result<(Vec3, Vec3), Error> {
    let found = |expected: &str, found: &str, fix: &str| {
        let found: String = found.chars().take(80).collect();
        Error::argument(
            format!("standard input, line {number}: expected {expected}, found \"{found}\""),
            fix.to_owned(),
        )
    };
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    if fields.len() != 6 {
        let expected = format!("6 numbers {HEADING}");
        return Err(found(&expected, line, "separate them by commas"));
    }
    let mut v = [0.0f64; 6];
    for (x, field) in v.iter_mut().zip(&fields) {
        *x = field.parse().map_err(|_| found("a number", field, &format!("the columns are {HEADING}")))?;
    }
    let unit = |name: &str, w: DVec3| {
        let length = w.length();
        if (length - 1.0).abs() <= UNIT_SLACK {
            return Ok((w / length).as_vec3());
        }
        Err(found(
            &format!("{name} of length 1 within {UNIT_SLACK}"),
            &format!("length {length}"),
            "normalise the directions",
        ))
    };
    Ok((unit("wo", DVec3::new(v[0], v[1], v[2]))?, unit("wi", DVec3::new(v[3], v[4], v[5]))?))
}
