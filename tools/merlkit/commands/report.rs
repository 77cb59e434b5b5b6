//! `merlkit report`

use std::process::ExitCode;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use merlkit::Error;
use merlkit::files::Overwrite;
use merlkit::material::merl::LookupRule;
use merlkit::sampler::SamplerSpec;
use merlkit_evaluate::measure::profile::{ProfileSettings, profile};
use merlkit_evaluate::report::{
    Machine, Provenance, SamplerReport, summary, thesis_legend, write_json,
};

use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::output;
use crate::output::Destination;
use crate::progress::Progress;
use crate::provenance;
use crate::sampler_args;
use crate::{args, table};

/// Measure the memory, time and accuracy of samplers, and list the results of R. Montes's thesis (2008) for comparison
///
/// For each material and sampler, prints the size of its tables and file, the build time, and the time per draw and per
/// density. At seven angles that lie between the tabulated ones, prints the spread of the sample weights (by quadrature) and
/// the bias of the albedo (from draws), at the angle where it is largest in standard errors: below about three it is chance. An
/// anisotropic .bsdf file is measured at four azimuths per angle.
///
/// All numbers except the thesis's are measured in this run. Ctrl-C writes the files with the materials that are finished.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  merlkit report nickel teflon --sampler cosine --sampler half-vector:2KB"
)]
pub struct Args {
    #[command(flatten, next_help_heading = "Materials")]
    materials: args::Materials,
    /// Sampler to measure, with settings (`merlkit samplers` lists them); repeatable [default: those the material supports of
    /// half-vector at 2KB, 64KB and 1MB, cosine, adaptive-disc, cascade-cdf:uniform, cascade-cdf and file]
    #[arg(help_heading = "Measurement", long = "sampler", value_name = sampler_args::VALUE)]
    samplers: Vec<SamplerSpec>,
    /// How values between the samples of a table are interpolated
    #[arg(help_heading = "Materials", long, value_name = "floor|linear|centred", hide_possible_values = true, default_value = "floor", value_parser = args::lookup_rule())]
    lookup: LookupRule,
    /// Number of draws per angle for estimating the bias
    #[arg(
        help_heading = "Measurement",
        long,
        value_name = "N",
        default_value_t = 100_000
    )]
    draws: usize,
    /// Seed of the draws
    #[arg(
        help_heading = "Measurement",
        long,
        value_name = "K",
        default_value_t = 1
    )]
    seed: u64,
    /// Also write JSON to FILE; with -, write JSON to standard output instead of the tables [default: none]
    #[arg(help_heading = "Output", long, value_name = "FILE|-")]
    json: Option<Destination>,
    /// Also write CSV, one line per material, sampler and angle, to FILE; with -, write CSV to standard output instead of the
    /// tables [default: none]
    #[arg(help_heading = "Output", long, value_name = "FILE|-")]
    csv: Option<Destination>,
    /// Replace existing files [default: refuse]
    #[arg(help_heading = "Output", long)]
    force: bool,
}

/// No bias can be told from no draws, and JSON and CSV in one file are neither.
fn refuse_meaningless(args: &Args) -> Result<(), Error> {
    if args.draws == 0 {
        return Err(Error::argument(
            "0 draws are too few to estimate a bias",
            "choose --draws of at least 1",
        ));
    }
    output::refuse_same(args.json.as_ref(), args.csv.as_ref())
}

/// What the table of adaptive discs shows.
const DISC_LEGEND: &str = "Adaptive discs, trials: mean number of trials of a draw, over the trees. above bounds: the part of \
    f_r·cosθ that exceeds the bounds of leaves, at the worst tree; it is drawn as often as the bound says, with that density.";

/// What the table over several materials shows.
const SUMMARY_LEGEND: &str = "Over several materials: the range of table sizes, the geometric mean of relstd with the material \
    where it is largest, and of every other figure the worst. bias/±: bias in standard errors. ∫pdf − 1: how far a density's \
    integral is from 1.";

pub fn run(args: &Args) -> Outcome {
    let (materials, unreadable) = args.materials.resolve()?;
    let specs = materials
        .iter()
        .map(|m| sampler_args::samplers_for(m, &args.samplers))
        .collect::<Result<Vec<_>, _>>()?;
    let overwrite = output::overwrite(args.force);
    let destinations = [&args.json, &args.csv];
    refuse_meaningless(args)?;
    for destination in destinations.into_iter().flatten() {
        destination.check(overwrite)?;
    }
    let tables = !destinations
        .into_iter()
        .flatten()
        .any(|d| *d == Destination::Stdout);
    let settings = ProfileSettings {
        draws: args.draws,
        seed: args.seed,
        ..ProfileSettings::default()
    };
    let progress = Progress::new("measuring", specs.iter().map(Vec::len).sum());
    let reports = Arc::new(Mutex::new(Vec::new()));
    let files = (args.json.clone(), args.csv.clone());
    let finished = reports.clone();
    // Checksums need all of every material, so they are taken for JSON alone, which has them.
    let checked = if args.json.is_some() {
        &materials[..]
    } else {
        &[]
    };
    let provenance = provenance::record_timed(args.seed, checked)?;
    let machine = provenance.machine.clone();
    interrupt::at_end(move || write_files(&finished, &provenance, &files, overwrite));
    for (material, specs) in materials.iter().zip(&specs) {
        let figures = profile(material, args.lookup, specs, &settings, &|| {
            progress.advance()
        })?;
        output::print_notes(material.name(), &figures.notes);
        let report = SamplerReport::new(figures);
        let shown = describe(&report);
        // Kept before it is shown: who sees it and presses Ctrl-C finds it in the files.
        lock(&reports).push(report);
        if tables {
            output::stdout(|out| write!(out, "{shown}"))?;
        }
    }
    drop(progress);
    if tables && lock(&reports).len() > 1 {
        let sheet = summary(&lock(&reports));
        output::stdout(|out| writeln!(out, "{}", table::render(&sheet)))?;
    }
    if tables {
        let legend = legend(&lock(&reports), machine.as_ref());
        output::stdout(|out| write!(out, "{legend}"))?;
    }
    interrupt::finish()?;
    unreadable.end(materials.len(), ExitCode::SUCCESS)
}

/// The tables of a material.
pub fn describe(report: &SamplerReport) -> String {
    let [cost, accuracy] = report.sheets();
    let mut text = table::wrap(&report.reading());
    for sheet in [Some(cost), Some(accuracy), report.disc_sheet()]
        .into_iter()
        .flatten()
    {
        text.push_str(&table::render(&sheet));
        text.push('\n');
    }
    text
}

/// What the words in the tables mean, once for all materials.
pub fn legend(reports: &[SamplerReport], machine: Option<&Machine>) -> String {
    let mut paragraphs = Vec::from_iter(SamplerReport::legend(reports));
    if reports.len() > 1 {
        paragraphs.push(SUMMARY_LEGEND.into());
    }
    if reports.iter().any(|r| r.disc_sheet().is_some()) {
        paragraphs.push(DISC_LEGEND.into());
    }
    if reports.iter().any(|r| !r.thesis.is_empty()) {
        paragraphs.push(thesis_legend());
    }
    paragraphs.extend(machine.map(|m| format!("Measured on {}.", m.sentence())));
    table::wrap(&paragraphs.join("\n"))
}

fn lock(reports: &Mutex<Vec<SamplerReport>>) -> MutexGuard<'_, Vec<SamplerReport>> {
    reports.lock().unwrap_or_else(PoisonError::into_inner)
}

/// JSON and CSV of the materials that are finished; none if none is.
fn write_files(
    reports: &Mutex<Vec<SamplerReport>>,
    provenance: &Provenance,
    (json, csv): &(Option<Destination>, Option<Destination>),
    overwrite: Overwrite,
) -> Result<(), Failure> {
    let reports = &*lock(reports);
    if reports.is_empty() {
        return Ok(());
    }
    if let Some(destination) = json {
        destination.write(overwrite, |out| {
            write_json(out, "report", provenance, reports)
        })?;
    }
    if let Some(destination) = csv {
        destination.write(overwrite, |out| SamplerReport::csv(reports).write_csv(out))?;
    }
    Ok(())
}
