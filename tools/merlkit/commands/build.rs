//! `merlkit build`

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Arc, Mutex, PoisonError};

use merlkit::Error;
use merlkit::files::{Overwrite, check_writable};
use merlkit::material::Material;
use merlkit::material::merl::LookupRule;
use merlkit::sampler::{SamplerSpec, store};
use rayon::prelude::*;

use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::progress::Progress;
use crate::sampler_args;
use crate::{args, output};

/// Build samplers and store them as files
///
/// A sampler file is a safetensors file. It contains the sampler's tables and, as metadata, the format version, settings,
/// lookup rule, and the material's name and SHA-256. `merlkit sample` and the library load it without rebuilding.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  merlkit build nickel --sampler half-vector:64KB -o nickel.safetensors"
)]
pub struct Args {
    #[command(flatten, next_help_heading = "Materials")]
    materials: args::Materials,
    /// Sampler to build, with settings (`merlkit samplers` lists them)
    #[arg(help_heading = "Sampler", long, value_name = sampler_args::VALUE, default_value = sampler_args::DEFAULT)]
    sampler: SamplerSpec,
    /// How values between the samples of a table are interpolated
    #[arg(help_heading = "Materials", long, value_name = "floor|linear|centred", hide_possible_values = true, default_value = "floor", value_parser = args::lookup_rule())]
    lookup: LookupRule,
    /// File to write. For several materials: folder for files named NAME.SAMPLER.safetensors
    #[arg(help_heading = "Output", short, long, value_name = "PATH")]
    output: PathBuf,
    /// Replace existing files [default: refuse]
    #[arg(help_heading = "Output", long)]
    force: bool,
}

pub fn run(args: &Args) -> Outcome {
    let spec = &args.sampler;
    if !spec.is_stored() {
        return Err(Error::argument(
            format!("the sampler {spec} has no tables of its own to store"),
            "choose another sampler",
        )
        .into());
    }
    let (materials, unreadable) = args.materials.resolve()?;
    args::refuse_repeated(&materials)?;
    materials
        .iter()
        .try_for_each(|m| spec.check_supports(&m.facts()?))?;
    let overwrite = output::overwrite(args.force);
    let jobs = destinations(args, materials)?;
    for (_, path) in &jobs {
        check_writable(path, overwrite)?;
    }
    let progress = Progress::new("building", jobs.len());
    let written = Arc::new(Mutex::new(BTreeMap::new()));
    let lines = written.clone();
    // At the end, on failure and on Ctrl-C alike: a file that is listed is complete.
    interrupt::at_end(move || {
        let lines = lines.lock().unwrap_or_else(PoisonError::into_inner);
        output::stdout(|out| {
            lines
                .values()
                .try_for_each(|line: &String| writeln!(out, "{line}"))
        })
    });
    let jobs: Vec<_> = jobs.into_iter().enumerate().collect();
    // One chunk at a time holds at most one table a thread in memory.
    let outcome = jobs
        .chunks(rayon::current_num_threads())
        .try_for_each(|chunk| {
            chunk.par_iter().try_for_each(|(number, (material, path))| {
                let line = build(material, spec, args.lookup, path, overwrite)?;
                written
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner)
                    .insert(*number, line);
                progress.advance();
                Ok::<_, Error>(())
            })
        });
    drop(progress);
    interrupt::finish()?;
    outcome?;
    unreadable.end(jobs.len(), ExitCode::SUCCESS)
}

/// Each material with its file; makes the folder if there are several.
fn destinations(
    args: &Args,
    materials: Vec<Material>,
) -> Result<Vec<(Material, PathBuf)>, Failure> {
    let single = materials.len() == 1 && !args.output.is_dir();
    if !single {
        std::fs::create_dir_all(&args.output).map_err(|e| Error::io(&args.output, "create", e))?;
    }
    let mut destinations = Vec::new();
    for material in materials {
        let file = format!("{}.{}.safetensors", material.name(), args.sampler.name());
        let path = match single {
            true => args.output.clone(),
            false => args.output.join(file),
        };
        destinations.push((material, path));
    }
    Ok(destinations)
}

fn build(
    material: &Material,
    spec: &SamplerSpec,
    lookup: LookupRule,
    path: &Path,
    overwrite: Overwrite,
) -> Result<String, Error> {
    let brdf = args::load(material, lookup)?;
    let sampler = spec.build(&brdf)?;
    let bytes = store::save(&sampler, material, path, overwrite)?;
    let lookup = brdf
        .rule()
        .map_or_else(String::new, |rule| format!(" {} lookup,", rule.name()));
    Ok(format!(
        "{}: {spec} for {},{lookup} {bytes} bytes",
        path.display(),
        material.name()
    ))
}
