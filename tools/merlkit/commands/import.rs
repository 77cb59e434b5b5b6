//! `merlkit import`

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use merlkit::Error;
use merlkit::files::check_writable;
use merlkit::material::merl::{BinPoint, tabulate_brdf, write};
use merlkit::material::{LookupRule, Material, MerlBrdf};
use merlkit_evaluate::measure::value_errors;

use crate::failure::Outcome;
use crate::{args, output};

/// Resample an isotropic .bsdf file, as of the RGL database, as a MERL binary of 35 MB
///
/// Spectra become linear sRGB in light of D65. The error of the table against the file is measured and printed, over
/// random pairs of directions that follow the cosine.
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
    let loaded = material.load(args.lookup)?;
    let brdf = &**loaded.brdf();
    let table = tabulate_brdf(brdf, point)?;
    write(&table, &args.output, overwrite)?;
    let errors = value_errors(&MerlBrdf::new(Arc::new(table), args.lookup), brdf);
    output::stdout(|out| {
        writeln!(
            out,
            "{}: against {} under the {} lookup, f_r differs by {:.3} % (median), {:.2} % (95th percentile), the albedo by \
             up to {:.2} %",
            args.output.display(),
            args.file,
            args.lookup.name(),
            100.0 * errors.median,
            100.0 * errors.percentile_95,
            100.0 * errors.albedo
        )
    })?;
    Ok(ExitCode::SUCCESS)
}
