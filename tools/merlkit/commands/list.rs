//! `merlkit list`

use std::process::ExitCode;

use merlkit::material::merl::embedded_names;
use merlkit_evaluate::report::write_json;

use crate::failure::Outcome;
use crate::output;
use crate::output::Destination;
use crate::provenance::record_command;

/// Print the names of the built-in materials, one per line
#[derive(clap::Args)]
#[command(after_help = "Example:\n  merlkit list")]
pub struct Args {
    /// Write JSON instead of text, to FILE or, without FILE, to standard output
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    json: Option<Destination>,
    /// Replace an existing FILE [default: refuse]
    #[arg(long)]
    force: bool,
}

pub fn run(args: &Args) -> Outcome {
    let names = embedded_names();
    match &args.json {
        Some(destination) => {
            destination.write(output::overwrite(args.force), |out| {
                write_json(out, "list", &record_command(), names)
            })?;
        }
        None => output::stdout(|out| names.iter().try_for_each(|n| writeln!(out, "{n}")))?,
    }
    Ok(ExitCode::SUCCESS)
}
