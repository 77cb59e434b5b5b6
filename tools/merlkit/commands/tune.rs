//! `merlkit tune`

use std::path::PathBuf;
use std::process::ExitCode;

use merlkit::Error;
use merlkit::material::{Loaded, LookupRule};
use merlkit::sampler::{SamplerSpec, store};
use merlkit_evaluate::measure::compare::{PointPlan, Tuning, Wish, tunable, tune};
use merlkit_evaluate::report::{tuning_sheet, tuning_summary, write_json};

use crate::failure::Outcome;
use crate::output;
use crate::output::Destination;
use crate::progress::Progress;
use crate::sampler_args;
use crate::sky::{SkyArgs, UnderSky};
use crate::{args, table};

/// Choose the sampler and settings that reach an error in the least time
///
/// Tries every size of the half-vector table, the cascade CDF, the adaptive disc, fitted lobes and the cosine at a lit point
/// (relative RMSE over three angles, Owen-scrambled Sobol points), proves the best three and all that is named on fresh
/// seeds, with more samples if it takes more, and takes the one that reaches E soonest within the limits. A proof holds
/// where the upper end of the error's interval is at most E. Times that decide are counted by a fixed model, of one thread,
/// with the estimate's part of the precomputation, so that every run gives the same answer; within 25 % they tie, and fewer
/// samples, then fewer bytes decide. Exit status 1 if nothing reaches E within the limits.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  merlkit tune nickel --target-error 1%")]
pub struct Args {
    /// Path to a MERL binary or a .bsdf file, name of an embedded material, or a formula
    #[arg(value_name = "MATERIAL")]
    material: String,
    /// Sampler to try, with its settings (`merlkit samplers`); may be repeated [default: those named above]
    #[arg(long = "sampler", value_name = sampler_args::VALUE)]
    samplers: Vec<SamplerSpec>,
    /// Relative error of one estimate, root of the mean square: 0.01 or 1%
    #[arg(long, value_name = "E", value_parser = args::target_error)]
    target_error: f64,
    /// Most bytes that the sampler's tables may hold [default: any]
    #[arg(long, value_name = "BYTES")]
    max_bytes: Option<usize>,
    /// Most seconds that building may take on the threads of this run, by the clock [default: any]
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    max_build: Option<f64>,
    /// Samples that share the precomputation: those of all that is rendered with the sampler
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(1..))]
    shared_by: u64,
    /// How values between the samples of a table are interpolated
    #[arg(long, value_name = "RULE", default_value = "floor", value_parser = args::lookup_rule())]
    lookup: LookupRule,
    #[command(flatten)]
    invalid: args::Invalid,
    #[command(flatten)]
    sky: SkyArgs,
    /// Seed of the draws
    #[arg(long, value_name = "K", default_value_t = 1)]
    seed: u64,
    /// Write JSON with every figure to FILE as well, or to standard output (-) instead of the table [default: none]
    #[arg(long, value_name = "FILE|-")]
    json: Option<Destination>,
    /// Write the chosen sampler to FILE; the cosine, which has no tables, is no choice then [default: none]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace existing files [default: refuse]
    #[arg(long)]
    force: bool,
}

fn seconds(argument: &str) -> Result<f64, String> {
    let positive = argument
        .parse()
        .ok()
        .filter(|s: &f64| s.is_finite() && *s > 0.0);
    positive.ok_or_else(|| "expected seconds above 0".into())
}

pub fn run(args: &Args) -> Outcome {
    let overwrite = output::overwrite(args.force);
    for file in args
        .output
        .iter()
        .cloned()
        .map(Destination::File)
        .chain(args.json.clone())
    {
        file.check(overwrite)?;
    }
    let material = args.invalid.resolve(&args.material)?;
    let sky = args.sky.load()?;
    let loaded = args::load(&material, args.lookup)?;
    let specs = candidates(args, &loaded)?;
    let progress = Progress::new("trying", specs.len());
    let plan = PointPlan::tuning(args.seed);
    let tuning = tune(&loaded, &sky, wish(args), &specs, &plan, &|| {
        progress.advance()
    })?;
    drop(progress);
    output::print_notes(material.name(), &tuning.notes);
    if args.json != Some(Destination::Stdout) {
        output::stdout(|out| {
            writeln!(
                out,
                "{}",
                table::render(&tuning_sheet(material.name(), &tuning))
            )?;
            writeln!(out, "{}", tuning_summary(material.name(), &tuning))
        })?;
    }
    if let Some(destination) = &args.json {
        let results = UnderSky {
            results: &tuning,
            environment_file: sky.notes(),
        };
        destination.write(overwrite, |out| write_json(out, "tune", &results))?;
    }
    let Some(spec) = chosen(&tuning) else {
        return Ok(ExitCode::from(1));
    };
    if let Some(path) = &args.output {
        let bytes = store::save(&spec.build(&loaded)?, &material, path, overwrite)?;
        output::message(&format!("{}: {bytes} bytes", path.display()));
    }
    Ok(ExitCode::SUCCESS)
}

/// The samplers given, or all that are worth a try.
fn candidates(args: &Args, material: &Loaded) -> Result<Vec<SamplerSpec>, Error> {
    let facts = material.facts();
    let stored = args.output.is_some();
    if args.samplers.is_empty() {
        return tunable(&facts, stored);
    }
    for spec in &args.samplers {
        spec.check_supports(&facts)?;
        if stored && !spec.is_stored() {
            return Err(Error::argument(
                format!("the sampler {spec} has no tables of its own to store"),
                "leave out --output, or that sampler",
            ));
        }
    }
    Ok(args.samplers.clone())
}

fn wish(args: &Args) -> Wish {
    let Args {
        max_bytes,
        max_build,
        shared_by,
        ..
    } = *args;
    Wish {
        error: args.target_error,
        max_bytes,
        max_build,
        shared_by,
    }
}

/// The choice, if it was proved.
fn chosen(tuning: &Tuning) -> Option<&SamplerSpec> {
    tuning.proof?;
    Some(&tuning.tried.get(tuning.chosen?)?.curve.competitor.spec)
}
