//! `merlkit import`

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use merlkit::files::check_writable;
use merlkit::material::merl::{BinPoint, import_bsdf, write};
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit_evaluate::measure::value_errors;

use crate::failure::Outcome;
use crate::{args, output};

/// Resample an isotropic .bsdf file, as of the RGL database, as a MERL binary of 35 MB
///
/// Spectra become linear sRGB in light of D65. The error of the table against the file is measured and printed, over
/// random pairs of directions that follow the cosine.
#[derive(clap::Args)]
pub struct Args {
    /// Path to a .bsdf file
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// How the table will be looked up: values stand at the lower edges of bins for linear, at their centres otherwise
    #[arg(long, value_name = "RULE", default_value = "floor", value_parser = args::lookup_rule())]
    lookup: LookupRule,
    /// File to write
    #[arg(short, long, value_name = "PATH")]
    output: PathBuf,
    /// Replace an existing file [default: refuse]
    #[arg(long)]
    force: bool,
}

pub fn run(args: &Args) -> Outcome {
    let overwrite = output::overwrite(args.force);
    check_writable(&args.output, overwrite)?;
    let point = if args.lookup == LookupRule::Linear {
        BinPoint::Edge
    } else {
        BinPoint::Centre
    };
    let (table, rgl) = import_bsdf(&args.file, point)?;
    write(&table, &args.output, overwrite)?;
    let errors = value_errors(&MerlBrdf::new(Arc::new(table), args.lookup), &rgl);
    output::stdout(|out| {
        writeln!(
            out,
            "{}: against {} under the {} lookup, f_r differs by {:.3} % (median), {:.2} % (95th percentile), the albedo by \
             up to {:.2} %",
            args.output.display(),
            args.file.display(),
            args.lookup.name(),
            100.0 * errors.median,
            100.0 * errors.percentile_95,
            100.0 * errors.albedo
        )
    })?;
    Ok(ExitCode::SUCCESS)
}
