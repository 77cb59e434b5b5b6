//! The command line: parses, calls the library and prints.

mod args;
mod batch;
mod camera_args;
mod columns;
mod commands;
mod explanation;
mod failure;
mod frames;
mod grid;
mod interrupt;
mod journal;
mod labels;
mod machine;
mod output;
mod path_args;
mod picture;
mod png_comment;
mod progress;
mod provenance;
mod render_costs;
mod render_summary;
mod resumable;
mod sampler_args;
mod sampler_choice;
mod scene_args;
mod scene_input;
mod sky;
mod strategy_args;
mod table;
mod tiles;
mod version;

use clap::{CommandFactory, Parser};
use std::process::ExitCode;

use commands::Command;
use failure::{Failure, Outcome};

/// Measured-BRDF toolkit: read MERL tables, build and check importance samplers, and render spheres
#[derive(Parser)]
#[command(
    name = "merlkit",
    version,
    long_version = version::long(),
    max_term_width = 100,
    after_help = "A MATERIAL is a path to a MERL binary or .bsdf file, the name of a built-in material (`merlkit list`), or an \
                  analytic model such as lambert:reflectance=0.5 or ward:sx=0.2,sy=0.4 (`merlkit models`), or several models with + between them.\n\
                  Exit status: 0 success, 1 a check failed, tune found no sampler or results of a study are missing, 2 invalid usage or input, 130 or 143 interrupted."
)]
struct Cli {
    /// Number of worker threads, at most 1024. Results don't depend on it [default: all cores]
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    interrupt::install();
    let outcome = run(cli);
    interrupt::wait_if_stopping();
    match outcome {
        Ok(status) => status,
        // Whoever read our output has seen enough.
        Err(Failure::ReaderGone) => ExitCode::SUCCESS,
        Err(Failure::Error(error)) => {
            output::message(&format!("merlkit: {error}"));
            ExitCode::from(2)
        }
    }
}

fn run(cli: Cli) -> Outcome {
    if let Some(threads) = cli.threads {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads.into())
            .build_global()
            .map_err(|e| {
                merlkit::Error::argument(
                    format!("cannot start {threads} threads: {e}"),
                    "ask for fewer",
                )
            })?;
    }
    cli.command.run(Cli::command())
}
