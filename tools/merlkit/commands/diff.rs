//! `merlkit diff`

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use merlkit::Error;
use merlkit::files::{Overwrite, check_writable, write_new};
use merlkit::image::{encode_png, read_image};
use merlkit_evaluate::measure::difference::{FlipMap, PictureDifference, Viewing};
use merlkit_evaluate::plot::viridis;
use merlkit_evaluate::report::{Sheet, write_json};
use serde::Serialize;

use crate::args;
use crate::failure::{Failure, Outcome};
use crate::output::{self, Destination};
use crate::progress::Progress;
use crate::provenance::record_command;
use crate::table;

/// Measure how far a picture is from a reference
///
/// Prints the mean relative error and the relative squared error (relMSE) of luminance, and FLIP: the difference that a person
/// sees who alternates between the two pictures, from 0 (none) to 1. Two PNG files are compared as a display shows them.
/// Otherwise the pictures hold radiance, and FLIP is the greatest error over a range of exposures. FLIP assumes a monitor of
/// 3840 pixels over 0.7 m that is seen from 0.7 m.
///
/// With --tolerance, the exit status is 1 if the chosen metric is above it.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  merlkit diff nickel.exr reference.exr\n  merlkit diff nickel.exr reference.exr --tolerance 0.05 -o flip.png"
)]
pub struct Args {
    /// Picture to judge: EXR, HDR, PFM or PNG
    #[arg(value_name = "PICTURE")]
    picture: PathBuf,
    /// Picture that it should look like, of the same size
    #[arg(value_name = "REFERENCE")]
    reference: PathBuf,
    /// Fail if the metric is above E: 0.05 or 5% [default: never fail]
    #[arg(help_heading = "Verdict", long, value_name = "E", value_parser = args::fraction)]
    tolerance: Option<f64>,
    /// Metric that --tolerance is about
    #[arg(help_heading = "Verdict", long, value_name = "flip|relmse|relative", default_value = "flip", hide_possible_values = true, value_parser = args::named(METRICS))]
    metric: Metric,
    /// Write a PNG of FLIP at each pixel to FILE: dark where no difference is seen, yellow at 1 [default: none]
    #[arg(help_heading = "Output", short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Also write every number as JSON to FILE; with -, write JSON to standard output instead of the table [default: none]
    #[arg(help_heading = "Output", long, value_name = "FILE|-")]
    json: Option<Destination>,
    /// Replace existing files [default: refuse]
    #[arg(help_heading = "Output", long)]
    force: bool,
}

/// What a tolerance is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Metric {
    Flip,
    Relmse,
    Relative,
}

const METRICS: &[(&str, Metric)] = &[
    ("flip", Metric::Flip),
    ("relmse", Metric::Relmse),
    ("relative", Metric::Relative),
];

/// What is written as JSON.
#[derive(Serialize)]
struct Judged<'a> {
    picture: &'a Path,
    reference: &'a Path,
    #[serde(flatten)]
    difference: &'a PictureDifference,
    metric: Metric,
    tolerance: Option<f64>,
    pass: bool,
}

pub fn run(args: &Args) -> Outcome {
    // Two pictures are read, and then compared.
    let progress = Progress::new("comparing", 3);
    let picture = read_image(&args.picture)?;
    progress.advance();
    let reference = read_image(&args.reference)?;
    progress.advance();
    let overwrite = output::overwrite(args.force);
    if let Some(path) = &args.output {
        check_writable(path, overwrite)?;
    }
    if let Some(destination) = &args.json {
        destination.check(overwrite)?;
    }
    let viewing = match is_png(&args.picture) && is_png(&args.reference) {
        true => Viewing::Display,
        false => Viewing::Radiance,
    };
    let difference = PictureDifference::measure(&picture, &reference, viewing)?;
    drop(progress);
    let value = match args.metric {
        Metric::Flip => difference.flip,
        Metric::Relmse => difference.rel_mse,
        Metric::Relative => difference.mean_relative,
    };
    // A NaN is above every tolerance.
    let pass = args.tolerance.is_none_or(|tolerance| value <= tolerance);
    if args.json != Some(Destination::Stdout) {
        output::stdout(|out| writeln!(out, "{}", table::render(&sheet(args, &difference, pass))))?;
    }
    if let Some(destination) = &args.json {
        let judged = Judged {
            picture: &args.picture,
            reference: &args.reference,
            difference: &difference,
            metric: args.metric,
            tolerance: args.tolerance,
            pass,
        };
        destination.write(overwrite, |out| {
            write_json(out, "diff", &record_command(), &judged)
        })?;
    }
    if let Some(path) = &args.output {
        write_map(path, &difference.map, overwrite)?;
    }
    Ok(ExitCode::from(u8::from(!pass)))
}

fn is_png(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default();
    extension.eq_ignore_ascii_case("png")
}

fn sheet(args: &Args, difference: &PictureDifference, pass: bool) -> Sheet {
    let name = |path: &Path| path.display().to_string();
    let mut sheet = Sheet::new(&[&name(&args.picture), &name(&args.reference)]);
    let [width, height] = difference.size;
    let seen = match difference.viewing {
        Viewing::Display => "as a display shows them".to_owned(),
        Viewing::Radiance => format!("at {} exposures", difference.exposures),
    };
    for (name, value) in [
        ("pixels", format!("{width} × {height}")),
        (
            "mean relative error",
            format!("{:.3e}", difference.mean_relative),
        ),
        ("relMSE", format!("{:.3e}", difference.rel_mse)),
        ("FLIP, mean", format!("{:.4} ({seen})", difference.flip)),
        ("FLIP, greatest", format!("{:.4}", difference.flip_greatest)),
    ] {
        sheet.push(vec![name.to_owned(), value]);
    }
    if let Some(tolerance) = args.tolerance {
        let metric = METRICS.iter().find(|m| m.1 == args.metric);
        let verdict = if pass { "kept" } else { "EXCEEDED" };
        let name = metric.map_or("", |m| m.0);
        sheet.push(vec![
            format!("tolerance of {name}"),
            format!("{tolerance} {verdict}"),
        ]);
    }
    sheet
}

/// A PNG of the errors, in the colours of plots.
fn write_map(path: &Path, map: &FlipMap, overwrite: Overwrite) -> Result<(), Failure> {
    let mut bytes = Vec::with_capacity(3 * map.errors.len());
    for &error in &map.errors {
        bytes.extend(viridis(error));
    }
    let png = encode_png(map.width, map.errors.len() / map.width.max(1), &bytes)?;
    write_new(path, overwrite, |out| {
        out.write_all(&png).map_err(|e| Error::io(path, "write", e))
    })?;
    Ok(())
}
