//! `merlkit fit`

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use merlkit::Error;
use merlkit::files::Overwrite;
use merlkit::material::{Loaded, LookupRule, Material};
use merlkit::sampler::store;
use merlkit_evaluate::measure::fit::{
    DEFAULT_FIT_MODELS, FitMetric, FitModel, FitPictures, FitPlan, MaterialFit, ModelFit,
    draw_fits, fit_models,
};
use merlkit_evaluate::report::{
    FitDocument, FitFormat, best_held, fit_matrix, fit_page, fit_ranking, fit_summary, fit_text,
    fits_csv, fits_sheet, fitted_text, parameters_sheet, write_json,
};
use rayon::prelude::*;

use crate::failure::{Failure, Outcome};
use crate::output::{self, Destination};
use crate::progress::Progress;
use crate::provenance;
use crate::{args, table};

/// Fit analytic models to materials, and write the fits for renderers
///
/// A fit is a diffuse part and one to three lobes, each with a colour. Its shapes are found by a simplex search from fixed starts;
/// the best colours are solved for at every step. The error is the root mean square difference of a function of f·cos θi, by
/// default its cube root, over pairs of directions that the fit did not see. The sphere column is the difference of two rendered
/// spheres in 8-bit levels. A model holds a material if its error is at most 10 % of the root mean square of the material's own
/// values.
///
/// For one material the parameters of the best fit are printed, each with the range in which the error grows by at most 5 %
/// when the others are fitted again. The MATERIAL that is printed can be given to every command. For several materials a table
/// of errors and a ranking of the models are printed.
///
/// --format writes the best fit that the format can hold: one or two lobes of ggx for materialx, gltf, mitsuba and pbrt, ggx+sheen
/// for materialx and gltf, one lobe of ggx, ward, blinn or ashikhmin for sampler, which is a file for `merlkit sample` and `render`, and everything for json.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  merlkit fit nickel\n  merlkit fit nickel --model ggx,ggx+ggx --format materialx -o nickel.mtlx\n  \
                  merlkit fit --all --model ward,ggx --page gallery.html --csv fits.csv"
)]
pub struct Args {
    #[command(flatten, next_help_heading = "Materials")]
    materials: args::Materials,
    /// How values between the samples of a table are interpolated
    #[arg(help_heading = "Materials", long, value_name = "RULE", default_value = "linear", value_parser = args::lookup_rule())]
    lookup: LookupRule,
    /// Models to fit: ward, blinn, phong, lafortune, torrance, he, ashikhmin, ggx or sheen, or several lobes as in ggx+ggx and
    /// ggx+sheen [default: all of these names but phong and sheen]
    #[arg(
        help_heading = "Fit",
        long = "model",
        value_name = "M,…",
        value_delimiter = ','
    )]
    models: Vec<String>,
    /// Function of f·cos θi whose differences are squared: its cube root, ln(1 + f·cos θi), or f·cos θi itself
    #[arg(help_heading = "Fit", long, value_name = "METRIC", default_value = "cube-root", value_parser = args::named(FitMetric::ALL))]
    metric: FitMetric,
    /// Number of pairs of directions that a fit sees
    #[arg(help_heading = "Fit", long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(50..=1_000_000))]
    pairs: u32,
    /// Seed of the pairs
    #[arg(help_heading = "Fit", long, value_name = "K", default_value_t = 1)]
    seed: u64,
    /// Format of the file that --output names [default: json]
    #[arg(help_heading = "Output", long, value_name = "FORMAT", requires = "output", value_parser = args::named(FORMATS))]
    format: Option<Format>,
    /// Write the fit to FILE; with several materials or --all, a folder in which each has a file
    #[arg(help_heading = "Output", short, long, value_name = "FILE|DIR")]
    output: Option<PathBuf>,
    /// Write an HTML page with spheres of the materials and their fits [default: none]
    #[arg(help_heading = "Output", long, value_name = "FILE")]
    page: Option<PathBuf>,
    /// Also write every number as JSON to FILE; with -, write JSON to standard output instead of the table [default: none]
    #[arg(help_heading = "Output", long, value_name = "FILE|-")]
    json: Option<Destination>,
    /// Also write CSV, one line per material and model, to FILE; with -, write CSV to standard output instead of the table
    /// [default: none]
    #[arg(help_heading = "Output", long, value_name = "FILE|-")]
    csv: Option<Destination>,
    /// Replace existing files [default: refuse]
    #[arg(help_heading = "Output", long)]
    force: bool,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Format {
    Json,
    Sampler,
    Renderer(FitFormat),
}

const FORMATS: &[(&str, Format)] = &[
    ("json", Format::Json),
    ("materialx", Format::Renderer(FitFormat::MaterialX)),
    ("gltf", Format::Renderer(FitFormat::Gltf)),
    ("mitsuba", Format::Renderer(FitFormat::Mitsuba)),
    ("pbrt", Format::Renderer(FitFormat::Pbrt)),
    ("sampler", Format::Sampler),
];

/// Pixels of a side of a sphere on the page.
const PICTURE_SIDE: usize = 96;

/// A material's fits, and its pictures if there is a page to show them.
struct Fitted {
    fit: MaterialFit,
    pictures: Option<FitPictures>,
}

pub fn run(args: &Args) -> Outcome {
    let models = args.models()?;
    let (materials, unreadable) = args.materials.resolve()?;
    args::refuse_repeated(&materials)?;
    args.check_format(&models)?;
    let overwrite = output::overwrite(args.force);
    args.check_files(&materials, overwrite)?;
    let plan = FitPlan {
        metric: args.metric,
        pairs: args.pairs as usize,
        seed: args.seed,
        ..FitPlan::default()
    };
    let progress = Progress::new("fitting", materials.len());
    let fitted: Result<Vec<Fitted>, Error> = materials
        .par_iter()
        .map(|material| args.fit(material, &models, &plan, &progress))
        .collect();
    drop(progress);
    let (fits, pictures) = split(fitted?);
    if ![&args.json, &args.csv].contains(&&Some(Destination::Stdout)) {
        print_tables(&fits, &plan)?;
    }
    if let Some(destination) = &args.csv {
        destination.write(overwrite, |out| fits_csv(&fits).write_csv(out))?;
    }
    if let Some(destination) = &args.json {
        args.write_document(destination, &materials, &fits, &plan)?;
    }
    if let Some(path) = &args.page {
        let provenance = provenance::record(Some(args.seed), &materials)?;
        let page = fit_page(&fits, &pictures, &plan, &provenance);
        let destination = Destination::File(path.clone());
        destination.write(overwrite, |out| out.write_all(page.as_bytes()))?;
    }
    for (material, fit) in materials.iter().zip(&fits) {
        if let Some(path) = args.path(material, materials.len()) {
            args.write_fit(material, fit, &plan, &path)?;
        }
    }
    unreadable.end(materials.len(), ExitCode::SUCCESS)
}

/// The fits, and those pictures that were drawn.
fn split(fitted: Vec<Fitted>) -> (Vec<MaterialFit>, Vec<FitPictures>) {
    let (mut fits, mut pictures) = (Vec::new(), Vec::new());
    for one in fitted {
        fits.push(one.fit);
        pictures.extend(one.pictures);
    }
    (fits, pictures)
}

/// Of one material all models and the best one's parameters, of several a table and a ranking.
fn print_tables(fits: &[MaterialFit], plan: &FitPlan) -> Result<(), Failure> {
    output::stdout(|out| {
        writeln!(out, "{}", table::wrap(&fit_text(plan)))?;
        match fits {
            [fit] => {
                writeln!(out, "{}", table::render(&fits_sheet(fit)))?;
                if let Some(best) = fit.best() {
                    writeln!(out, "{}", table::render(&parameters_sheet(best)))?;
                }
                write!(out, "{}", table::wrap(&fit_summary(fit)))
            }
            _ => {
                writeln!(out, "{}", table::render(&fit_matrix(fits)))?;
                write!(out, "{}", table::render(&fit_ranking(fits)))
            }
        }
    })
}

impl Args {
    fn models(&self) -> Result<Vec<FitModel>, Error> {
        let mut models = Vec::new();
        let mut seen = BTreeSet::new();
        let given = self.models.iter().map(String::as_str);
        let names: Vec<&str> = if self.models.is_empty() {
            DEFAULT_FIT_MODELS.to_vec()
        } else {
            given.collect()
        };
        for name in names {
            let model = FitModel::parse(name)?;
            if !seen.insert(model.name().to_owned()) {
                return Err(Error::argument(
                    format!("model {name} is given twice"),
                    "give each model once",
                ));
            }
            models.push(model);
        }
        Ok(models)
    }

    /// Refuses a format before the work that can hold none of the models.
    fn check_format(&self, models: &[FitModel]) -> Result<(), Error> {
        let held: &[&str] = match self.format() {
            Format::Json => return Ok(()),
            Format::Sampler => &["ggx", "ward", "blinn", "ashikhmin"],
            Format::Renderer(format) if format.has_sheen() => {
                &["ggx", "ggx+ggx", "ggx+sheen", "sheen+ggx", "ggx+ggx+sheen"]
            }
            Format::Renderer(_) => &["ggx", "ggx+ggx"],
        };
        let is_held = models.iter().any(|model| held.contains(&model.name()));
        if is_held {
            Ok(())
        } else {
            Err(no_model_is_held())
        }
    }

    /// Says before the work which files can't be written, or would be replaced.
    fn check_files(&self, materials: &[Material], overwrite: Overwrite) -> Result<(), Error> {
        output::refuse_same(self.json.as_ref(), self.csv.as_ref())?;
        let mut files: Vec<Destination> = self.json.iter().chain(&self.csv).cloned().collect();
        files.extend(self.page.iter().cloned().map(Destination::File));
        if let Some(folder) = &self.output
            && materials.len() > 1
        {
            std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, "create", e))?;
        }
        let paths = materials.iter().map(|m| self.path(m, materials.len()));
        files.extend(paths.flatten().map(Destination::File));
        for file in files {
            file.check(overwrite)?;
        }
        Ok(())
    }

    /// The file of a material's fit, of which there are `count`.
    fn path(&self, material: &Material, count: usize) -> Option<PathBuf> {
        let output = self.output.as_ref()?;
        if count == 1 {
            return Some(output.clone());
        }
        let extension = match self.format() {
            Format::Json => "json",
            Format::Sampler => "sampler",
            Format::Renderer(FitFormat::MaterialX) => "mtlx",
            Format::Renderer(FitFormat::Gltf) => "gltf",
            Format::Renderer(FitFormat::Mitsuba) => "xml",
            Format::Renderer(FitFormat::Pbrt) => "pbrt",
        };
        Some(output.join(format!("{}.{extension}", material.name())))
    }

    fn format(&self) -> Format {
        self.format.unwrap_or(Format::Json)
    }

    /// Loads a material and fits all models to it.
    fn fit(
        &self,
        material: &Material,
        models: &[FitModel],
        plan: &FitPlan,
        progress: &Progress,
    ) -> Result<Fitted, Error> {
        let loaded: Loaded = args::load(material, self.lookup)?;
        let brdf = &**loaded.brdf();
        let fit = fit_models(material.name(), brdf, models, plan)?;
        let pictures = match self.page {
            Some(_) => Some(draw_fits(brdf, &fit, PICTURE_SIDE)?),
            None => None,
        };
        progress.advance();
        Ok(Fitted { fit, pictures })
    }

    fn write_document(
        &self,
        destination: &Destination,
        materials: &[Material],
        fits: &[MaterialFit],
        plan: &FitPlan,
    ) -> Result<(), Failure> {
        let document = FitDocument {
            plan,
            materials: fits,
        };
        let overwrite = output::overwrite(self.force);
        let provenance = provenance::record(Some(self.seed), materials)?;
        destination.write(overwrite, |out| {
            write_json(out, "fit", &provenance, &document)
        })
    }

    /// Writes the best fit that the format can hold.
    fn write_fit(
        &self,
        material: &Material,
        fit: &MaterialFit,
        plan: &FitPlan,
        path: &Path,
    ) -> Result<(), Failure> {
        let overwrite = output::overwrite(self.force);
        let destination = Destination::File(path.to_owned());
        match self.format() {
            Format::Json => {
                self.write_document(
                    &destination,
                    std::slice::from_ref(material),
                    std::slice::from_ref(fit),
                    plan,
                )?;
            }
            Format::Sampler => self.write_sampler(material, fit, path)?,
            Format::Renderer(format) => {
                let chosen = best_held(format, fit).ok_or_else(no_model_is_held)?;
                let text = fitted_text(format, material.name(), chosen)?;
                destination.write(overwrite, |out| out.write_all(text.as_bytes()))?;
            }
        }
        output::message(&format!("{}: written", path.display()));
        Ok(())
    }

    /// Writes the sampler file of the best fit that is a lobe sampler.
    fn write_sampler(
        &self,
        material: &Material,
        fit: &MaterialFit,
        path: &Path,
    ) -> Result<(), Error> {
        let chosen = best_drawn(fit)?;
        let Some(spec) = chosen.sampler()? else {
            return Ok(());
        };
        let loaded = args::load(material, self.lookup)?;
        let overwrite = output::overwrite(self.force);
        store::save(&spec.build(&loaded)?, material, path, overwrite)?;
        Ok(())
    }
}

/// The fit of the least error, the first of equals, of those that there is a sampler of.
fn best_drawn(fit: &MaterialFit) -> Result<&ModelFit, Error> {
    let mut best: Option<&ModelFit> = None;
    for model in &fit.fits {
        if matches!(model.sampler(), Ok(Some(_))) && best.is_none_or(|b| model.error < b.error) {
            best = Some(model);
        }
    }
    best.ok_or_else(no_model_is_held)
}

fn no_model_is_held() -> Error {
    Error::argument(
        "the format can hold none of these models",
        "choose --model ggx or --format json, or for a sheen --format materialx or gltf",
    )
}
