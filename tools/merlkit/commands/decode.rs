//! `merlkit decode`

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use merlkit::Error;
use merlkit::files::{Overwrite, check_writable};
use merlkit::material::merl::{HardCase, write};
use merlkit::material::{LookupRule, Material};
use rayon::prelude::*;

use clap::builder::PossibleValuesParser;

use crate::failure::Outcome;
use crate::progress::Progress;
use crate::{args, output};

/// Write materials as MERL binaries, 35 MB each
#[derive(clap::Args)]
#[command(after_help = "Example:\n  merlkit decode nickel chrome -o brdfs")]
pub struct Args {
    #[command(flatten, next_help_heading = "Materials")]
    materials: args::Materials,
    /// Write a table that is difficult for lookups and samplers instead of a material; repeatable
    #[arg(help_heading = "Materials", long, value_name = "NAME", conflicts_with_all = ["materials", "all"],
          value_parser = PossibleValuesParser::new(HardCase::ALL.map(|case| case.name)))]
    hard_case: Vec<String>,
    /// Folder for the files, which are named NAME.binary; created if missing
    #[arg(help_heading = "Output", short, long, value_name = "DIR")]
    output: PathBuf,
    /// Replace existing files [default: refuse]
    #[arg(help_heading = "Output", long)]
    force: bool,
}

/// What needs a table here.
const DECODING: &str = "a MERL binary";

pub fn run(args: &Args) -> Outcome {
    if !args.hard_case.is_empty() {
        return hard_cases(args);
    }
    let (materials, unreadable) = args.materials.resolve()?;
    args::refuse_repeated(&materials)?;
    args::require_tables(&materials, DECODING)?;
    std::fs::create_dir_all(&args.output).map_err(|e| Error::io(&args.output, "create", e))?;
    let overwrite = output::overwrite(args.force);
    for material in &materials {
        check_writable(&file_of(material, &args.output), overwrite)?;
    }
    let progress = Progress::new("decoding", materials.len());
    // One chunk at a time holds at most one table a thread in memory.
    for chunk in materials.chunks(rayon::current_num_threads()) {
        chunk.par_iter().try_for_each(|material| {
            decode(material, &args.output, overwrite)?;
            progress.advance();
            Ok::<_, Error>(())
        })?;
    }
    drop(progress);
    unreadable.end(materials.len(), ExitCode::SUCCESS)
}

fn hard_cases(args: &Args) -> Outcome {
    std::fs::create_dir_all(&args.output).map_err(|e| Error::io(&args.output, "create", e))?;
    let progress = Progress::new("writing", args.hard_case.len());
    for case in args
        .hard_case
        .iter()
        .filter_map(|name| HardCase::named(name))
    {
        let path = args.output.join(format!("{}.binary", case.name));
        case.write(&path, output::overwrite(args.force))?;
        progress.advance();
    }
    Ok(ExitCode::SUCCESS)
}

fn decode(material: &Material, folder: &Path, overwrite: Overwrite) -> Result<(), Error> {
    let loaded = material.load(LookupRule::default())?;
    let table = loaded.require_table(DECODING)?.table();
    write(table, &file_of(material, folder), overwrite)
}

fn file_of(material: &Material, folder: &Path) -> PathBuf {
    folder.join(format!("{}.binary", material.name()))
}
