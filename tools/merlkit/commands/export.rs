//! `merlkit export`

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use merlkit::Error;
use merlkit::brdf::{Brdf, LookupRule, Measured};
use merlkit::bsdf::{BsdfFile, BsdfSize, Rgl, tabulate};
use merlkit::files::check_writable;
use merlkit::measure::{colour_error, draw_quality, size_within, value_errors};
use merlkit::merl::Material;
use merlkit::report::{Sheet, export_row, export_sheet};

use crate::failure::Outcome;
use crate::progress::Progress;
use crate::{args, output, table};

/// Write materials for other renderers: .bsdf files for Mitsuba 3 and pbrt-v4 (`measured`)
///
/// NAME.rgb.bsdf is for Mitsuba's rgb variants, NAME.spectral.bsdf for its spectral ones and for pbrt. What each file
/// makes of the material is measured on the file as it was written, and printed: errors of f_r over random pairs of
/// directions that follow the cosine, of the albedo, and the spread of weights when drawn by the file's own density.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    materials: args::Materials,
    /// Kind of file
    #[arg(long, value_name = "FORMAT", value_parser = ["bsdf"])]
    format: String,
    /// Colours of a .bsdf file
    #[arg(long, value_name = "VARIANT", default_value = "both", value_parser = args::named(VARIANTS))]
    variant: Variant,
    /// Size of an RGB file; one with spectra is twice as large
    #[arg(long, value_name = "SIZE", default_value = "6MB", conflicts_with = "target_error", value_parser = size())]
    size: BsdfSize,
    /// Take the smallest size whose median error is at most this, as in 0.001 or 0.1% [default: none]
    #[arg(long, value_name = "SHARE", value_parser = args::share)]
    target_error: Option<f64>,
    /// What the table says between its samples; a file is linear between its own
    #[arg(long, value_name = "RULE", default_value = "linear", value_parser = args::lookup_rule())]
    lookup: LookupRule,
    /// Folder for the files; made if missing
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Replace existing files [default: refuse]
    #[arg(long)]
    force: bool,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Variant {
    Rgb,
    Spectral,
    Both,
}

const VARIANTS: &[(&str, Variant)] =
    &[("rgb", Variant::Rgb), ("spectral", Variant::Spectral), ("both", Variant::Both)];

fn size() -> impl TypedValueParser<Value = BsdfSize> {
    PossibleValuesParser::new(BsdfSize::ALL.map(|s| s.name))
        .map(|name| BsdfSize::ALL.into_iter().find(|s| s.name == name).unwrap_or(BsdfSize::ALL[0]))
}

pub fn run(args: &Args) -> Outcome {
    let materials = args.materials.resolve()?;
    args::refuse_repeated(&materials)?;
    std::fs::create_dir_all(&args.output).map_err(|e| Error::io(&args.output, "create", e))?;
    for (material, variant) in materials.iter().flat_map(|m| args.variants().map(move |v| (m, v))) {
        check_writable(&args.path(material, variant), output::overwrite(args.force))?;
    }
    let progress = Progress::new("exporting", materials.len());
    let mut sheet = export_sheet();
    for material in &materials {
        export(material, args, &mut sheet)?;
        progress.advance();
    }
    drop(progress);
    output::stdout(|out| write!(out, "{}", table::render(&sheet)))?;
    Ok(ExitCode::SUCCESS)
}

impl Args {
    fn variants(&self) -> impl Iterator<Item = &'static str> + use<> {
        let wanted = self.variant;
        let both = [("rgb", Variant::Rgb), ("spectral", Variant::Spectral)];
        both.into_iter().filter(move |v| wanted == Variant::Both || wanted == v.1).map(|v| v.0)
    }

    fn path(&self, material: &Material, variant: &str) -> PathBuf {
        self.output.join(format!("{}.{variant}.bsdf", material.name()))
    }
}

fn export(material: &Material, args: &Args, sheet: &mut Sheet) -> Result<(), Error> {
    let brdf = Measured::new(Arc::new(material.load()?), args.lookup);
    let size = args.target_error.map_or(Ok(args.size), |limit| size_within(&brdf, limit))?;
    let file = tabulate(|wo, wi| brdf.eval(wo, wi), size, description(material, args.lookup, size));
    for variant in args.variants() {
        let path = args.path(material, variant);
        let written = if variant == "rgb" { file.clone() } else { file.to_spectral() };
        let bytes = written.write(&path, output::overwrite(args.force))?;
        let read = BsdfFile::open(&path)?;
        let colour = colour_error(&read, &file);
        let rgl = Rgl::new(read);
        let name = path.display().to_string();
        sheet.push(export_row(name, bytes, colour, &value_errors(&rgl, &brdf), &draw_quality(&rgl, &brdf)));
    }
    Ok(())
}

/// What the file says of itself.
fn description(material: &Material, lookup: LookupRule, size: BsdfSize) -> String {
    format!(
        "{}, from a MERL table by its {} lookup, which values between the knots follow: {} polar angles, {} x {} half \
         vectors; merlkit {}",
        material.name(),
        lookup.name(),
        size.angles,
        size.side,
        size.side,
        env!("CARGO_PKG_VERSION")
    )
}
