//! `merlkit import`

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use merlkit::Error;
use merlkit::files::check_writable;
use merlkit::material::measurements::{
    AngleUnit, MeasurementKind, Measurements, fill_gaps, read_array,
};
use merlkit::material::merl::{BinPoint, tabulate_brdf, write};
use merlkit::material::{Loaded, LookupRule, MerlBrdf, MerlTable};
use merlkit_evaluate::measure::resampling_errors;
use merlkit_evaluate::report::resampling_sheet;

use crate::failure::{Failure, Outcome};
use crate::progress::Progress;
use crate::{args, output, table};

/// Convert a .bsdf, .pbsdf or UTIA file, a list of measurements or a numpy array to a MERL binary (35 MB)
///
/// .bsdf, formula: Spectra are converted to linear sRGB under illuminant D65. A MERL table is reciprocal by construction, so
/// each value is the mean over both orders of the directions, weighted by the cosine of the incident one. Two errors are
/// measured over random, cosine-distributed pairs of directions and printed: the table's total error, and the part caused by
/// forced reciprocity.
///
/// List: CSV with named columns, ASTM E1392, or Cornell's spectra. The CSV columns are theta_i, phi_i, theta_o, phi_o or
/// theta_h, theta_d, phi_d, followed by f_r in sr⁻¹ as r, g, b or value or wavelengths
/// such as 550nm. Each cell is the mean of the
/// measurements in its bin; cells without measurements are gaps.
///
/// .pbsdf (Baek et al. 2020): The table has the reflectance of unpolarised light; polarisation is dropped.
///
/// UTIA .bin (1,990,656 bytes): The table has the mean over rotations about the normal. The anisotropy that this removes is
/// measured and printed. Cells beyond 75° are gaps.
///
/// Array: .npy or .npz with f_r in sr⁻¹ by MERL's bins of θh, θd, φd and red, green, blue: of shape [90, 90, 180, 3] or
/// [3, 90, 90, 180]. Negative and NaN values are gaps.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  merlkit import felt.bsdf -o felt.binary\n  merlkit import measured.csv -o measured.binary --fill"
)]
pub struct Args {
    /// A .bsdf, .pbsdf or UTIA file, a list, an array, a formula or, with --fill, a MERL binary
    #[arg(value_name = "FILE")]
    file: String,
    /// Lookup rule that the table will be used with: linear puts values at the bins' lower edges, the others at their centres
    #[arg(help_heading = "Table", long, value_name = "floor|linear|centred", hide_possible_values = true, default_value = "floor", value_parser = args::lookup_rule())]
    lookup: LookupRule,
    #[command(flatten, next_help_heading = "Table")]
    invalid: args::Invalid,
    /// Unit of the angles in a list [default: from the column names, else degrees for CSV, radians for ASTM and Cornell]
    #[arg(help_heading = "Table", long, value_name = "UNIT", value_parser = args::named(UNITS))]
    angles: Option<AngleUnit>,
    /// Fill gaps from mirror images (φd to π − φd) and neighbouring cells. Filled cells are marked in the file, and every
    /// command reports them
    #[arg(help_heading = "Table", long)]
    fill: bool,
    /// File to write
    #[arg(help_heading = "Output", short, long, value_name = "PATH")]
    output: PathBuf,
    /// Write the table even if an albedo is off by more than 25 % from that of the input [default: refuse]
    #[arg(help_heading = "Output", long)]
    accept_error: bool,
    /// Replace an existing file [default: refuse]
    #[arg(help_heading = "Output", long)]
    force: bool,
}

const UNITS: &[(&str, AngleUnit)] = &[
    ("degrees", AngleUnit::Degrees),
    ("radians", AngleUnit::Radians),
];

pub fn run(args: &Args) -> Outcome {
    let overwrite = output::overwrite(args.force);
    check_writable(&args.output, overwrite)?;
    let path = Path::new(&args.file);
    let kind = MeasurementKind::detect(path);
    if kind != Some(MeasurementKind::List) {
        refuse_unit(args)?;
    }
    let progress = Progress::new("importing", 1);
    let made = match kind {
        Some(MeasurementKind::Array) => Arc::new(read_array(path, args.invalid.is_by_channel())?),
        Some(_) => measurements(path, args)?,
        None => match reflectance(args)? {
            Some(table) => table,
            None => return Ok(ExitCode::from(1)),
        },
    };
    let table = if args.fill {
        Arc::new(fill_gaps(&made))
    } else {
        made
    };
    write(&table, &args.output, overwrite)?;
    drop(progress);
    // What every command will say of the table.
    let loaded = Loaded::from_table(Arc::new(MerlBrdf::new(table, args.lookup)));
    output::print_notes(&args.output.display().to_string(), loaded.notes());
    Ok(ExitCode::SUCCESS)
}

fn refuse_unit(args: &Args) -> Result<(), Error> {
    match args.angles {
        None => Ok(()),
        Some(_) => Err(Error::argument(
            format!(
                "{} is not a list of measurements, so --angles does not apply",
                args.file
            ),
            "omit --angles",
        )),
    }
}

/// The table of a list or a grid of measurements.
fn measurements(path: &Path, args: &Args) -> Result<Arc<MerlTable>, Failure> {
    let measurements = Measurements::read(path, args.angles)?;
    let (table, notes) = measurements.tabulate(bin_point(args.lookup));
    let table = Arc::new(table);
    output::print_notes(&args.file, measurements.notes());
    let brdf = MerlBrdf::new(table.clone(), args.lookup);
    let error = 100.0 * measurements.median_error(&brdf);
    output::stdout(|out| {
        for note in notes {
            writeln!(out, "{note}")?;
        }
        writeln!(
            out,
            "median difference between the measurements and the table under {} lookup: {error:.3} %",
            args.lookup.name()
        )
    })?;
    Ok(table)
}

/// The table of a material, and its errors, printed; `None` if they are too large to write it.
fn reflectance(args: &Args) -> Result<Option<Arc<MerlTable>>, Failure> {
    let material = args.invalid.resolve(&args.file)?;
    let facts = material.facts()?;
    facts.require_isotropic(material.name(), "a MERL table")?;
    let loaded = args::load(&material, args.lookup)?;
    if let Some(measured) = loaded.table() {
        if args.fill {
            return Ok(Some(measured.table().clone()));
        }
        let what = format!("{} is already a MERL table", material.name());
        let fix = "`merlkit decode` writes it as a MERL binary; --fill fills its gaps";
        return Err(Error::argument(what, fix).into());
    }
    let brdf = &**loaded.brdf();
    let table = tabulate_brdf(brdf, bin_point(args.lookup))?;
    let table = MerlBrdf::new(Arc::new(table), args.lookup);
    let errors = resampling_errors(&table, brdf);
    output::stdout(|out| write!(out, "{}", table::render(&resampling_sheet(&errors))))?;
    let is_written = args.accept_error || output::is_acceptable(errors.whole.albedo, "the table");
    Ok(is_written.then(|| table.table().clone()))
}

/// Where in its bin a value stands for a lookup rule.
fn bin_point(rule: LookupRule) -> BinPoint {
    match rule {
        LookupRule::Linear => BinPoint::Edge,
        LookupRule::Floor | LookupRule::Centred => BinPoint::Centre,
    }
}
