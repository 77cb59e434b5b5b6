//! `merlkit check`

use std::process::ExitCode;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use merlkit::Error;
use merlkit::files::Overwrite;
use merlkit::material::Material;
use merlkit::material::merl::HardCase;
use merlkit::material::merl::LookupRule;
use merlkit::sampler::SamplerSpec;
use merlkit_evaluate::measure::check::{CheckSettings, check_directions_of, check_sampler};
use merlkit_evaluate::measure::hard::{HardModel, Thoroughness, check_hard, check_hard_models};
use merlkit_evaluate::report::{CheckResult, HardSheets, Provenance, Sheet, write_json};

use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::output;
use crate::output::Destination;
use crate::progress::Progress;
use crate::provenance;
use crate::sampler_args;
use crate::{args, table};

/// Check that samplers are correct: densities, draws and estimates
///
/// Each check runs at 13 polar angles of wo: tabulated angles, angles between them, and grazing angles. For an anisotropic
/// .bsdf file, each polar angle is checked at five azimuths. The checks:
///
/// - validity, agreement: every draw is a unit vector above the horizon, and its density equals pdf.
///
/// - positivity, pdf integral: pdf is positive wherever the material reflects, and integrates to 1 minus the fraction of lost
///   draws.
///
/// - chi-square: draws are distributed according to pdf.
///
/// - bias, furnace: the albedo estimate is unbiased, also in each channel.
///
/// The exit status is 1 if a check fails. At the default significance, one run in a hundred fails by chance even if all
/// samplers are correct. Ctrl-C writes the JSON of the checks that are finished.
#[derive(clap::Args)]
#[command(
    override_usage = "merlkit check [OPTIONS] <MATERIAL>...\n       merlkit check [OPTIONS] --all\n       merlkit check --hard [--all] [--seed K] [--json FILE]",
    after_help = "Example:\n  merlkit check nickel --sampler half-vector:64KB --sampler lobe:ggx"
)]
pub struct Args {
    #[command(flatten, next_help_heading = "Materials")]
    materials: args::Materials,
    /// Check hard cases instead of materials: difficult tables and formulas, extreme directions and extreme numbers, with every
    /// sampler, lookup rule and light. Takes less than a minute on two cores; with --all, every combination in about ten minutes. Can't be
    /// combined with materials, --sampler, --draws, --significance or --lookup
    #[arg(help_heading = "Checks", long, conflicts_with_all = ["materials", "samplers", "draws", "significance", "lookup"])]
    hard: bool,
    /// Sampler to check, with settings (`merlkit samplers` lists them); repeatable [default: half-vector:2KB,
    /// half-vector:64KB, half-vector:1MB, cosine, adaptive-disc, cascade-cdf:uniform, cascade-cdf and `file`, as far as the
    /// material supports them]
    #[arg(help_heading = "Checks", long = "sampler", value_name = sampler_args::VALUE)]
    samplers: Vec<SamplerSpec>,
    /// How values between the samples of a table are interpolated
    #[arg(help_heading = "Materials", long, value_name = "floor|linear|centred", hide_possible_values = true, default_value = "floor", value_parser = args::lookup_rule())]
    lookup: LookupRule,
    /// Number of draws in each statistical check, 1000 to 10000000
    #[arg(
        help_heading = "Checks",
        long,
        value_name = "N",
        default_value_t = 100_000
    )]
    draws: usize,
    /// Seed of the draws
    #[arg(help_heading = "Checks", long, value_name = "K", default_value_t = 1)]
    seed: u64,
    /// Probability that a run fails by chance although all samplers are correct, between 0 and 1 (exclusive)
    #[arg(
        help_heading = "Checks",
        long,
        value_name = "P",
        default_value_t = 0.01
    )]
    significance: f64,
    /// Also write every outcome as JSON to FILE; with -, write JSON to standard output instead of the table [default: none]
    #[arg(help_heading = "Output", long, value_name = "FILE|-")]
    json: Option<Destination>,
    /// Replace an existing FILE [default: refuse]
    #[arg(help_heading = "Output", long)]
    force: bool,
}

/// With fewer draws nothing would fail; with more, nobody would wait.
const DRAWS: std::ops::RangeInclusive<usize> = 1000..=10_000_000;

pub fn run(args: &Args) -> Outcome {
    if args.hard {
        return hard(args);
    }
    let probability = args.significance > 0.0 && args.significance < 1.0;
    if !probability || !DRAWS.contains(&args.draws) {
        let what = format!("significance {}, {} draws", args.significance, args.draws);
        let fix = "choose a significance between 0 and 1, and 1000 to 10000000 draws";
        return Err(Error::argument(what, fix).into());
    }
    let (materials, unreadable) = args.materials.resolve()?;
    let specs = of_each(&materials, args)?;
    let overwrite = output::overwrite(args.force);
    if let Some(destination) = &args.json {
        destination.check(overwrite)?;
    }
    let settings = CheckSettings {
        draws: args.draws,
        seed: args.seed,
        significance: args.significance,
        calls: specs.iter().map(Vec::len).sum(),
        ..CheckSettings::default()
    };
    let progress = Progress::new("checking", settings.calls);
    let results = Arc::new(Mutex::new(Vec::new()));
    let finished = results.clone();
    let destination = args.json.clone();
    let provenance = match destination {
        Some(_) => provenance::record(Some(args.seed), &materials)?,
        None => provenance::record_command(),
    };
    interrupt::at_end(move || {
        let destination = destination.as_ref();
        write_finished(&lock(&finished), &provenance, destination, overwrite)
    });
    for (material, specs) in materials.iter().zip(&specs) {
        let brdf = args::load(material, args.lookup)?;
        let directions = check_directions_of(brdf.brdf().symmetry());
        for spec in specs {
            let sampler = spec.build(&brdf)?;
            let report = check_sampler(&*sampler, &**brdf.brdf(), &directions, &settings);
            let result = CheckResult {
                material: material.name().into(),
                sampler: spec.to_string(),
                report,
            };
            lock(&results).push(result);
            progress.advance();
        }
    }
    drop(progress);
    if args.json != Some(Destination::Stdout) {
        print(&lock(&results))?;
    }
    interrupt::finish()?;
    let pass = lock(&results).iter().all(|r| r.report.pass());
    unreadable.end(materials.len(), ExitCode::from(u8::from(!pass)))
}

/// The samplers of each material.
fn of_each(materials: &[Material], args: &Args) -> Result<Vec<Vec<SamplerSpec>>, Error> {
    materials
        .iter()
        .map(|m| sampler_args::samplers_for(m, &args.samplers))
        .collect()
}

fn lock(results: &Mutex<Vec<CheckResult>>) -> MutexGuard<'_, Vec<CheckResult>> {
    results.lock().unwrap_or_else(PoisonError::into_inner)
}

/// JSON of the checks that are finished; none if none is.
fn write_finished(
    results: &[CheckResult],
    provenance: &Provenance,
    destination: Option<&Destination>,
    overwrite: Overwrite,
) -> Result<(), Failure> {
    match destination {
        Some(destination) if !results.is_empty() => destination.write(overwrite, |out| {
            write_json(out, "check", provenance, &results)
        }),
        _ => Ok(()),
    }
}

fn hard(args: &Args) -> Outcome {
    let overwrite = output::overwrite(args.force);
    if let Some(destination) = &args.json {
        destination.check(overwrite)?;
    }
    let thoroughness = if args.materials.are_all() {
        Thoroughness::Full
    } else {
        Thoroughness::Quick
    };
    let progress = Progress::new("checking", HardCase::ALL.len() + HardModel::ALL.len());
    let mut outcomes = check_hard(&HardCase::ALL, thoroughness, args.seed, &|| {
        progress.advance()
    })?;
    outcomes.extend(check_hard_models(
        &HardModel::ALL,
        thoroughness,
        args.seed,
        &|| progress.advance(),
    )?);
    drop(progress);
    if args.json != Some(Destination::Stdout) {
        let sheets = HardSheets::from_outcomes(&outcomes);
        output::stdout(|out| {
            writeln!(
                out,
                "{}\n{}",
                table::render(&sheets.cases),
                table::render(&sheets.samplers)
            )?;
            let failures = &sheets.failures;
            if failures.rows.is_empty() {
                Ok(())
            } else {
                writeln!(out, "{}", table::render(failures))
            }
        })?;
    }
    if let Some(destination) = &args.json {
        let provenance = provenance::record(Some(args.seed), &[])?;
        destination.write(overwrite, |out| {
            write_json(out, "check-hard", &provenance, &outcomes)
        })?;
    }
    Ok(if outcomes.iter().all(|o| o.pass) {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(1)
    })
}

fn print(results: &[CheckResult]) -> Result<(), Failure> {
    let mut overview = Sheet::new(&CheckResult::HEADING);
    let mut failures = CheckResult::failure_sheet();
    for result in results {
        overview.push(result.line());
        result.failures(&mut failures);
    }
    output::stdout(|out| {
        writeln!(out, "{}", table::render(&overview))?;
        if failures.rows.is_empty() {
            Ok(())
        } else {
            writeln!(out, "{}", table::render(&failures))
        }
    })
}
