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
use crate::provenance;
use crate::sampler_args;
use crate::sky::{SkyArgs, UnderSky};
use crate::{args, table};

/// Choose the sampler and settings that reach a target error in the least time
///
/// Measures, where the material supports them, all sizes of the half-vector table, two settings each of the cascade CDF and
/// the adaptive disc, three fitted lobes (cosine, ward, ggx) and the cosine at a lit point: the relative RMSE over three angles
/// with Owen-scrambled Sobol points. Sample counts are tried in steps, so the one found usually does better than E. The three
/// fastest, and all other samplers named in the result, are then re-measured with new seeds, adding samples if needed. A sampler passes if the upper end of the error's
/// confidence interval is at most E. The fastest that passes and meets the limits is chosen.
///
/// The choice is based on counted times, from a fixed cost model for one thread that includes part of the build time. Every
/// run therefore gives the same answer, unless --max-build is given, which measured build times are compared with. Times within 25 % of each other are a tie; the sampler with fewer samples wins, then
/// the one with fewer bytes. The exit status is 1 if no sampler reaches E within the limits.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  merlkit tune nickel --target-error 1%")]
pub struct Args {
    /// MERL binary, .bsdf file, name of a built-in material, or a formula
    #[arg(value_name = "MATERIAL")]
    material: String,
    /// Sampler to try, with settings (`merlkit samplers` lists them); repeatable [default: those named above]
    #[arg(help_heading = "Search", long = "sampler", value_name = sampler_args::VALUE)]
    samplers: Vec<SamplerSpec>,
    /// Target relative RMSE of one estimate: 0.01 or 1%
    #[arg(help_heading = "Search", long, value_name = "E", value_parser = args::target_error)]
    target_error: f64,
    /// Maximum size of the sampler's tables: a number of bytes, or 64KB or 1MB [default: unlimited]
    #[arg(help_heading = "Search", long, value_name = "BYTES", value_parser = args::byte_count)]
    max_bytes: Option<usize>,
    /// Maximum build time in seconds, measured with this run's threads [default: unlimited]
    #[arg(help_heading = "Search", long, value_name = "SECONDS", value_parser = seconds)]
    max_build: Option<f64>,
    /// Total number of samples that the sampler will draw, over which its build time is spread
    #[arg(help_heading = "Search", long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(1..))]
    shared_by: u64,
    /// How values between the samples of a table are interpolated
    #[arg(help_heading = "Materials", long, value_name = "floor|linear|centred", hide_possible_values = true, default_value = "floor", value_parser = args::lookup_rule())]
    lookup: LookupRule,
    #[command(flatten, next_help_heading = "Materials")]
    tables: args::TableOptions,
    #[command(flatten, next_help_heading = "Search")]
    sky: SkyArgs,
    /// Seed of the draws
    #[arg(help_heading = "Search", long, value_name = "K", default_value_t = 1)]
    seed: u64,
    /// Also write every number as JSON to FILE; with -, write JSON to standard output instead of the table [default: none]
    #[arg(help_heading = "Output", long, value_name = "FILE|-")]
    json: Option<Destination>,
    /// Write the chosen sampler to FILE. Excludes the cosine, which has no tables to store [default: none]
    #[arg(help_heading = "Output", short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace existing files [default: refuse]
    #[arg(help_heading = "Output", long)]
    force: bool,
}

fn seconds(argument: &str) -> Result<f64, String> {
    let positive = argument
        .parse()
        .ok()
        .filter(|s: &f64| s.is_finite() && *s > 0.0);
    positive.ok_or_else(|| "expected a number of seconds above 0".into())
}

pub fn run(args: &Args) -> Outcome {
    let overwrite = output::overwrite(args.force);
    let material = args.tables.resolve(&args.material)?;
    if let Some(path) = &args.output {
        Destination::File(path.clone()).check(overwrite)?;
    }
    if let Some(destination) = &args.json {
        destination.check(overwrite)?;
    }
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
            write!(
                out,
                "{}",
                table::wrap(&tuning_summary(material.name(), &tuning))
            )
        })?;
    }
    if let Some(destination) = &args.json {
        let provenance = provenance::record_timed(args.seed, std::slice::from_ref(&material))?;
        let results = UnderSky {
            results: &tuning,
            environment_file: sky.notes(),
        };
        destination.write(overwrite, |out| {
            write_json(out, "tune", &provenance, &results)
        })?;
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
                "omit --output, or that sampler",
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
