//! `merlkit info`

use std::process::ExitCode;
use std::sync::Arc;

use merlkit::brdf::{LookupRule, Measured};
use merlkit::measure::facts;
use merlkit::merl::{Material, Source};
use merlkit::report::{Info, write_json};

use crate::failure::{Failure, Outcome};
use crate::output::{self, Destination};
use crate::progress::Progress;
use crate::{args, table};

/// Print what a material's table holds: size, gaps, range, directional albedo, symmetry
#[derive(clap::Args)]
pub struct Args {
    /// Paths to MERL binaries or names of embedded materials
    #[arg(required = true, value_name = "MATERIAL")]
    materials: Vec<String>,
    /// What the table says between its samples
    #[arg(long, value_name = "RULE", default_value = "floor", value_parser = args::lookup_rule())]
    lookup: LookupRule,
    /// Write JSON to FILE as well, or to standard output (-) instead of the table [default: none]
    #[arg(long, value_name = "FILE|-")]
    json: Option<Destination>,
    /// Replace an existing FILE [default: refuse]
    #[arg(long)]
    force: bool,
}

pub fn run(args: &Args) -> Outcome {
    let materials = args::resolve(&args.materials)?;
    let overwrite = output::overwrite(args.force);
    if let Some(destination) = &args.json {
        destination.check(overwrite)?;
    }
    let progress = Progress::new("measuring", materials.len());
    let mut results = Vec::new();
    for material in &materials {
        let info = measure(material, args.lookup)?;
        if args.json != Some(Destination::Stdout) {
            progress.aside(|| output::stdout(|out| writeln!(out, "{}", table::render(&info.sheet()))))?;
        }
        results.push(info);
        progress.advance();
    }
    if let Some(destination) = &args.json {
        destination.write(overwrite, |out| write_json(out, "info", &results))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn measure(material: &Material, lookup: LookupRule) -> Result<Info, Failure> {
    let brdf = Measured::new(Arc::new(material.load()?), lookup);
    let source = match material.source() {
        Source::File(path) => path.display().to_string(),
        Source::Embedded(_) => "embedded".into(),
    };
    Ok(Info { material: material.name().into(), source, facts: facts(&brdf) })
}
