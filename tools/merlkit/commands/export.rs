//! `merlkit export`

use std::path::PathBuf;
use std::process::ExitCode;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use merlkit::Error;
use merlkit::brdf::Importance;
use merlkit::export::{Export, refuse_same_identifier};
use merlkit::files::check_writable;
use merlkit::material::rgl::{BsdfFile, BsdfSize, RglBrdf, tabulate};
use merlkit::material::{Loaded, LookupRule, Material};
use merlkit::sampler::{HalfVectorSettings, SamplerSpec};
use merlkit_evaluate::measure::{colour_error, draw_quality, size_within, value_errors};
use merlkit_evaluate::report::{Sheet, drawn_row, export_row, export_sheet, table_sheet};

use crate::failure::Outcome;
use crate::progress::Progress;
use crate::{args, output, sampler_args, table};

/// Write materials for other renderers and numpy
///
/// bsdf: files for the `measured` material of Mitsuba 3 and pbrt-v4. NAME.rgb.bsdf is for Mitsuba's rgb variants,
/// NAME.spectral.bsdf for its spectral variants and for pbrt. The errors of each written file are measured and printed:
/// those of f_r over random, cosine-distributed pairs of directions, those of the albedo, and the spread of the sample
/// weights with the file's own density.
///
/// header: NAME.h for C, C++ and GLSL, with sample and pdf (from the half-vector table) and eval (from the values of f_r in
/// NAME.f32).
///
/// runtime: NAME.merlkit, the same table and values as a file that a program loads when it runs, and the code for all such
/// files: merlkit.h for C, C++ and CUDA, and merlkit.glsl, merlkit.hlsl and merlkit.wgsl for shaders.
///
/// npz: NAME.npz, the same table and values as numpy arrays. For header, runtime and npz, the smallest and the largest spread
/// of the sample weights over the angles of wo are printed.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  merlkit export nickel --format bsdf -o exported")]
pub struct Args {
    #[command(flatten, next_help_heading = "Materials")]
    materials: args::Materials,
    /// File format
    #[arg(help_heading = "Format", long, value_name = "FORMAT", value_parser = args::named(FORMATS))]
    format: Format,
    /// bsdf: RGB colours, spectra, or one file of each [default: both]
    #[arg(help_heading = "Format", long, value_name = "VARIANT", value_parser = args::named(VARIANTS))]
    variant: Option<Variant>,
    /// bsdf: size of an RGB file; a spectral file is twice as large [default: 6MB]
    #[arg(help_heading = "Format", long, value_name = "SIZE", conflicts_with = "target_error", value_parser = size())]
    size: Option<BsdfSize>,
    /// bsdf: use the smallest size whose median error is at most E, such as 0.001 or 0.1% [default: none]
    #[arg(help_heading = "Format", long, value_name = "E", value_parser = args::target_error)]
    target_error: Option<f64>,
    /// header, runtime, npz: half-vector table to export, with settings (`merlkit samplers half-vector`) [default: half-vector:64KB]
    #[arg(help_heading = "Format", long, value_name = sampler_args::VALUE)]
    sampler: Option<SamplerSpec>,
    /// How values between the samples of a table are interpolated. A written .bsdf file is always linear [default: linear for
    /// bsdf, floor otherwise]
    #[arg(help_heading = "Materials", long, value_name = "floor|linear|centred", hide_possible_values = true, value_parser = args::lookup_rule())]
    lookup: Option<LookupRule>,
    /// Folder for the files; created if missing
    #[arg(help_heading = "Output", short, long, value_name = "DIR")]
    output: PathBuf,
    /// bsdf: write the file even if an albedo is off by more than 25 % [default: refuse]
    #[arg(help_heading = "Output", long)]
    accept_error: bool,
    /// Replace existing files [default: refuse]
    #[arg(help_heading = "Output", long)]
    force: bool,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Format {
    Bsdf,
    Npz,
    Header,
    Runtime,
}

const FORMATS: &[(&str, Format)] = &[
    ("bsdf", Format::Bsdf),
    ("npz", Format::Npz),
    ("header", Format::Header),
    ("runtime", Format::Runtime),
];

#[derive(Clone, Copy, PartialEq, Eq)]
enum Variant {
    Rgb,
    Spectral,
    Both,
}

const VARIANTS: &[(&str, Variant)] = &[
    ("rgb", Variant::Rgb),
    ("spectral", Variant::Spectral),
    ("both", Variant::Both),
];

fn size() -> impl TypedValueParser<Value = BsdfSize> {
    PossibleValuesParser::new(BsdfSize::ALL.map(|s| s.name)).map(|name| size_called(&name))
}

fn size_called(name: &str) -> BsdfSize {
    BsdfSize::ALL
        .into_iter()
        .find(|s| s.name == name)
        .unwrap_or(BsdfSize::ALL[0])
}

pub fn run(args: &Args) -> Outcome {
    args.refuse_foreign()?;
    let (materials, unreadable) = args.materials.resolve()?;
    args::refuse_repeated(&materials)?;
    match args.format {
        Format::Bsdf => args::require_isotropic(&materials, "an exported .bsdf file")?,
        Format::Npz | Format::Header | Format::Runtime => {
            args.table_settings()?;
            args::require_tables(&materials, "this export")?;
        }
    }
    if args.format == Format::Header {
        refuse_same_identifier(&materials)?;
    }
    std::fs::create_dir_all(&args.output).map_err(|e| Error::io(&args.output, "create", e))?;
    for path in materials.iter().flat_map(|m| args.paths(m)) {
        check_writable(&path, output::overwrite(args.force))?;
    }
    let code = match args.format {
        Format::Runtime => Export::missing_runtime_code(&args.output),
        Format::Bsdf | Format::Npz | Format::Header => Vec::new(),
    };
    for (path, _) in &code {
        check_writable(path, output::overwrite(args.force))?;
    }
    let progress = Progress::new("exporting", materials.len());
    let mut sheet = if args.format == Format::Bsdf {
        export_sheet()
    } else {
        table_sheet()
    };
    let mut all_written = true;
    for material in &materials {
        match args.format {
            Format::Bsdf => all_written &= bsdf(material, args, &mut sheet)?,
            Format::Npz | Format::Header | Format::Runtime => {
                table_and_values(material, args, &mut sheet)?;
            }
        }
        progress.advance();
    }
    drop(progress);
    for (path, text) in &code {
        let file = output::Destination::File(path.clone());
        file.write(output::overwrite(args.force), |out| {
            out.write_all(text.as_bytes())
        })?;
        let bytes = text.len() as u64;
        sheet.push(drawn_row(
            path.display().to_string(),
            bytes,
            "sample, pdf, eval",
            None,
        ));
    }
    output::stdout(|out| write!(out, "{}", table::render(&sheet)))?;
    unreadable.end(materials.len(), ExitCode::from(u8::from(!all_written)))
}

impl Args {
    /// Every option given must belong to the format.
    fn refuse_foreign(&self) -> Result<(), Error> {
        let of_bsdf = [
            (self.variant.is_some(), "--variant"),
            (self.size.is_some(), "--size"),
            (self.target_error.is_some(), "--target-error"),
            (self.accept_error, "--accept-error"),
        ];
        let of_tables = [(self.sampler.is_some(), "--sampler")];
        let (foreign, others) = match self.format {
            Format::Bsdf => (&of_tables[..], "header, runtime or npz"),
            Format::Npz | Format::Header | Format::Runtime => (&of_bsdf[..], "bsdf"),
        };
        match foreign.iter().find(|option| option.0) {
            None => Ok(()),
            Some((_, option)) => Err(Error::argument(
                format!("{option} does not apply to --format {}", self.format_name()),
                format!("omit it, or choose --format {others}"),
            )),
        }
    }

    /// The settings of the table that is exported.
    fn table_settings(&self) -> Result<HalfVectorSettings, Error> {
        let Some(spec) = &self.sampler else {
            return Ok(HalfVectorSettings::default());
        };
        spec.settings().copied().ok_or_else(|| {
            let what = format!(
                "--format {} supports the half-vector table only, not {}",
                self.format_name(),
                spec.name()
            );
            Error::argument(what, "choose --sampler half-vector with any settings")
        })
    }

    fn format_name(&self) -> &'static str {
        FORMATS
            .iter()
            .find(|f| f.1 == self.format)
            .map_or("", |f| f.0)
    }

    fn lookup(&self) -> LookupRule {
        let of_format = if self.format == Format::Bsdf {
            LookupRule::Linear
        } else {
            LookupRule::Floor
        };
        self.lookup.unwrap_or(of_format)
    }

    fn variants(&self) -> impl Iterator<Item = &'static str> + use<> {
        let wanted = self.variant.unwrap_or(Variant::Both);
        let both = [("rgb", Variant::Rgb), ("spectral", Variant::Spectral)];
        both.into_iter()
            .filter(move |v| wanted == Variant::Both || wanted == v.1)
            .map(|v| v.0)
    }

    /// The files of a material, in the order in which they are written.
    fn paths(&self, material: &Material) -> Vec<PathBuf> {
        let ends: Vec<String> = match self.format {
            Format::Bsdf => self.variants().map(|v| format!("{v}.bsdf")).collect(),
            Format::Npz => vec!["npz".into()],
            Format::Header => vec!["f32".into(), "h".into()],
            Format::Runtime => vec!["merlkit".into()],
        };
        ends.iter()
            .map(|end| self.output.join(format!("{}.{end}", material.name())))
            .collect()
    }
}

/// Writes a material's `.bsdf` files; false if the error of one is too large to write it.
fn bsdf(material: &Material, args: &Args, sheet: &mut Sheet) -> Result<bool, Error> {
    let loaded = args::load(material, args.lookup())?;
    let brdf = &**loaded.brdf();
    let (size, mut file) = match args.target_error {
        Some(limit) => size_within(brdf, limit)?,
        None => {
            let size = args.size.unwrap_or_else(|| size_called("6MB"));
            (
                size,
                tabulate(|wo, wi| brdf.eval(wo, wi), size, String::new()),
            )
        }
    };
    file.description = description(&loaded, size);
    for (variant, path) in args.variants().zip(args.paths(material)) {
        let written = if variant == "rgb" {
            file.clone()
        } else {
            file.to_spectral()
        };
        let errors = value_errors(&RglBrdf::new(written.clone()), brdf);
        let name = path.display().to_string();
        if !args.accept_error && !output::is_acceptable(errors.albedo, &name) {
            return Ok(false);
        }
        let bytes = written.write(&path, output::overwrite(args.force))?;
        let read = BsdfFile::open(&path)?;
        let colour = colour_error(&read, &file);
        let rgl = RglBrdf::new(read);
        let draws = draw_quality(&rgl, brdf, Importance::Luminance);
        sheet.push(export_row(name, bytes, colour, &errors, &draws));
    }
    Ok(true)
}

fn table_and_values(material: &Material, args: &Args, sheet: &mut Sheet) -> Result<(), Error> {
    let loaded = args::load(material, args.lookup())?;
    let export = Export::new(material, &loaded, args.table_settings()?)?;
    let draws = draw_quality(export.table(), export.brdf(), Importance::Mean);
    let overwrite = output::overwrite(args.force);
    for path in args.paths(material) {
        let (bytes, holds, draws) = match path.extension().and_then(|e| e.to_str()) {
            Some("npz") => (
                export.write_npz(&path, overwrite)?,
                "half-vector table, f_r",
                Some(&draws),
            ),
            Some("h") => (
                export.write_header(&path, overwrite)?,
                "sample, pdf, eval",
                Some(&draws),
            ),
            Some("merlkit") => (
                export.write_runtime(&path, overwrite)?,
                "half-vector table, f_r",
                Some(&draws),
            ),
            _ => (export.write_values(&path, overwrite)?, "f_r for eval", None),
        };
        sheet.push(drawn_row(path.display().to_string(), bytes, holds, draws));
    }
    Ok(())
}

/// What the file says of itself.
fn description(material: &Loaded, size: BsdfSize) -> String {
    let source = match material.rule() {
        Some(rule) => format!("a MERL table by its {} lookup", rule.name()),
        None => format!("the {}", material.reading()),
    };
    format!(
        "{}, from {source}, which values between the knots follow: {} polar angles, {} x {} half vectors; merlkit {}",
        material.name(),
        size.angles,
        size.side,
        size.side,
        env!("CARGO_PKG_VERSION")
    )
}
