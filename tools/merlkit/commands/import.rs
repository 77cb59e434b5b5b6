//! `merlkit import`

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use merlkit::Error;
use merlkit::files::check_writable;
use merlkit::material::merl::{BinPoint, tabulate_brdf, write};
use merlkit::material::{LookupRule, Material, MerlBrdf};
use merlkit_evaluate::measure::resampling_errors;
use merlkit_evaluate::report::resampling_sheet;

use crate::failure::Outcome;
use crate::{args, output, table};

/// Resample an isotropic .bsdf file, as of the RGL database, as a MERL binary of 35 MB
///
/// Spectra become linear sRGB in light of D65. A table cannot tell the two orders of a pair of directions apart, so its values
/// are the mean of both, weighted by the cosine of the incident one. The error of the table against the file, and the part that
/// forced reciprocity has in it, are measured and printed, over random pairs of directions that follow the cosine.
#[derive(clap::Args)]
pub struct Args {
    /// Path to a .bsdf file, or a formula
    #[arg(value_name = "FILE")]
    file: String,
    /// How the table will be looked up: values at the lower edges of bins for linear, at their centres otherwise
    #[arg(long, value_name = "RULE", default_value = "floor", value_parser = args::lookup_rule())]
    lookup: LookupRule,
    /// File to write
    #[arg(short, long, value_name = "PATH")]
    output: PathBuf,
    /// Write the table however large its measured error [default: not if an albedo is off by more than 25 %]
    #[arg(long)]
    accept_error: bool,
    /// Replace an existing file [default: refuse]
    #[arg(long)]
    force: bool,
}

pub fn run(args: &Args) -> Outcome {
    let overwrite = output::overwrite(args.force);
    check_writable(&args.output, overwrite)?;
    let material = Material::resolve(&args.file)?;
    let facts = material.facts()?;
    facts.require_isotropic(material.name(), "a MERL table")?;
    if facts.has_table {
        let what = format!("{} is a MERL table already", material.name());
        return Err(Error::argument(what, "`merlkit decode` writes it as a MERL binary").into());
    }
    let point = if args.lookup == LookupRule::Linear {
        BinPoint::Edge
    } else {
        BinPoint::Centre
    };
    let loaded = args::load(&material, args.lookup)?;
    let brdf = &**loaded.brdf();
    let table = MerlBrdf::new(Arc::new(tabulate_brdf(brdf, point)?), args.lookup);
    let errors = resampling_errors(&table, brdf);
    output::stdout(|out| write!(out, "{}", table::render(&resampling_sheet(&errors))))?;
    if !args.accept_error && !output::is_acceptable(errors.whole.albedo, "the table") {
        return Ok(ExitCode::from(1));
    }
    write(table.table(), &args.output, overwrite)?;
    Ok(ExitCode::SUCCESS)
}
