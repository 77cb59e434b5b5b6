//! `merlkit compare`

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use merlkit::Error;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::files::{Overwrite, check_writable, write_new};
use merlkit::light::Environment;
use merlkit::material::{Loaded, LookupRule, Material, MaterialFacts};
use merlkit::sampler::{Sampler, SamplerSpec};
use merlkit_evaluate::measure::compare::{
    Comparison, ComparisonPlan, Competitor, Curve, Knob, MATERIALS, MaterialComparison,
    PictureComparison, PicturePlan, PictureResult, PointPlan, Reference, SCHEMA, SceneKind,
    SettingsComparison, competitors, cost_notes, curve, knobs, measure_costs, picture_competitors,
    picture_reference, pictures, references, setting, verdict,
};
use merlkit_evaluate::measure::cost::{CallCost, time};
use merlkit_evaluate::report::{
    ComparisonDocument, comparison_csv, comparison_page, material_charts, picture_sheet, targets,
    write_json,
};

use crate::failure::{Failure, Outcome};
use crate::journal::Journal;
use crate::output;
use crate::progress::Progress;
use crate::provenance;
use crate::sampler_args;
use crate::sky::{SkyArgs, UnderSky};
use crate::{args, table};

/// Compare the samplers: error against samples, seconds and bytes
///
/// Errors are measured at a lit point, in pictures of spheres in the studio, and for each sampler at different settings.
/// They are relative to a reference that states its own error: quadrature for the point, many samples for the pictures.
///
/// Results go to compare.json (everything), compare.csv (one line per number) and compare.html (a page that needs no
/// network) in DIR. Finished measurements are kept in DIR/compare.partial.jsonl until the run is complete, so that --resume
/// can continue after Ctrl-C.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  merlkit compare nickel teflon --quick -o comparison")]
pub struct Args {
    /// MERL binaries, .bsdf files or folders of either, names of built-in materials, or formulas [default: eight built-in materials; with --quick
    /// nickel, red-plastic and teflon]
    #[arg(value_name = "MATERIAL")]
    materials: Vec<String>,
    /// Sampler to compare, with settings (`merlkit samplers` lists them); repeatable. Named samplers are compared without
    /// light sampling and only with the given settings [default: all useful samplers]
    #[arg(help_heading = "Comparison", long = "sampler", value_name = sampler_args::VALUE)]
    samplers: Vec<SamplerSpec>,
    /// Use fewer samplers, angles, seeds and settings: one minute for three materials on two cores instead of an hour
    #[arg(help_heading = "Comparison", long)]
    quick: bool,
    /// Continue an interrupted run that had the same options
    #[arg(help_heading = "Output", long)]
    resume: bool,
    /// How values between the samples of a table are interpolated
    #[arg(help_heading = "Materials", long, value_name = "floor|linear|centred", hide_possible_values = true, default_value = "floor", value_parser = args::lookup_rule())]
    lookup: LookupRule,
    #[command(flatten, next_help_heading = "Materials")]
    tables: args::TableOptions,
    #[command(flatten, next_help_heading = "Comparison")]
    sky: SkyArgs,
    /// Seed of the draws
    #[arg(
        help_heading = "Comparison",
        long,
        value_name = "K",
        default_value_t = 1
    )]
    seed: u64,
    /// Folder for the results
    #[arg(
        help_heading = "Output",
        short,
        long,
        value_name = "DIR",
        default_value = "out"
    )]
    output: PathBuf,
    /// Replace existing results [default: refuse]
    #[arg(help_heading = "Output", long)]
    force: bool,
}

/// What is finished of a run that is not.
const JOURNAL: &str = "compare.partial.jsonl";
const QUICK: [&str; 3] = ["nickel", "red-plastic", "teflon"];

pub fn run(args: &Args) -> Outcome {
    let overwrite = output::overwrite(args.force);
    let materials = materials(args)?;
    let [json, csv, page] =
        ["json", "csv", "html"].map(|e| args.output.join(format!("compare.{e}")));
    let journal = args.output.join(JOURNAL);
    if args.resume && !journal.exists() {
        return Err(Error::argument(
            format!("nothing to resume: there is no {}", journal.display()),
            "name the folder of the interrupted run, or omit --resume to start a new one",
        )
        .into());
    }
    std::fs::create_dir_all(&args.output).map_err(|e| Error::io(&args.output, "create", e))?;
    for path in [&json, &csv, &page] {
        check_writable(path, overwrite)?;
    }
    let provenance = provenance::record_timed(args.seed, &materials.1)?;
    let mut run = Run::new(args, materials)?;
    let comparison = run.comparison()?;
    write(&json, overwrite, |out| {
        let results = UnderSky {
            results: ComparisonDocument::new(&comparison),
            environment_file: run.sky.notes(),
        };
        write_json(out, "compare", &provenance, &results)
    })?;
    write(&csv, overwrite, |out| {
        comparison_csv(&comparison).write_csv(out)
    })?;
    write(&page, overwrite, |out| {
        out.write_all(comparison_page(&comparison, &provenance).as_bytes())
    })?;
    let Run {
        journal, progress, ..
    } = run;
    drop(progress);
    journal.finish()?;
    print(&comparison, &[json, csv, page])?;
    Ok(ExitCode::SUCCESS)
}

/// Prints tables, verdicts and the files that were written.
fn print(comparison: &Comparison, files: &[PathBuf]) -> Result<(), Failure> {
    for material in &comparison.materials {
        output::print_notes(&material.material, &material.notes);
    }
    output::stdout(|out| {
        for material in &comparison.materials {
            for sheet in targets(material) {
                writeln!(out, "{}", table::render(&sheet))?;
            }
        }
        for picture in &comparison.pictures {
            writeln!(out, "{}", table::render(&picture_sheet(picture)))?;
        }
        for verdict in comparison
            .materials
            .iter()
            .filter_map(|m| m.verdict.as_ref())
        {
            write!(out, "{}", table::wrap(&verdict.sentence))?;
        }
        for file in files {
            writeln!(out, "{}", file.display())?;
        }
        Ok(())
    })
}

/// What is compared, by name.
fn materials(args: &Args) -> Result<(Vec<String>, Vec<Material>), Error> {
    let default = if args.quick {
        &QUICK[..]
    } else {
        &MATERIALS[..]
    };
    let names = match args.materials.is_empty() {
        true => default.iter().map(|&name| name.to_owned()).collect(),
        false => args.materials.clone(),
    };
    let materials = args::resolve(&names, &args.tables)?;
    args::refuse_repeated(&materials)?;
    Ok((names, materials))
}

fn write(
    path: &Path,
    overwrite: Overwrite,
    fill: impl FnOnce(&mut dyn std::io::Write) -> std::io::Result<()>,
) -> Result<(), Error> {
    write_new(path, overwrite, |out| {
        fill(out).map_err(|e| Error::io(path, "write", e))
    })
}

/// A run under way.
struct Run {
    plan: ComparisonPlan,
    materials: Vec<Material>,
    sky: Environment,
    journal: Journal,
    progress: Progress,
}

impl Run {
    fn new(
        args: &Args,
        (mut names, materials): (Vec<String>, Vec<Material>),
    ) -> Result<Self, Error> {
        // What is resumed must have been read alike.
        names.extend(args.tables.words());
        let plan = plan(args);
        let path = args.output.join(JOURNAL);
        if path.exists() && !args.resume && !args.force {
            return Err(Error::argument(
                format!(
                    "{} has the finished measurements of an interrupted run",
                    path.display()
                ),
                "pass --resume to continue it, or --force to start again",
            ));
        }
        let journal = Journal::open(&path, &(&plan, &names), args.resume)?;
        let facts = materials
            .iter()
            .map(Material::facts)
            .collect::<Result<Vec<_>, _>>()?;
        for spec in &plan.samplers {
            facts.iter().try_for_each(|f| spec.check_supports(f))?;
        }
        let parts = parts(&plan, &facts)?;
        let progress = Progress::new("comparing", parts);
        let sky = args.sky.load()?;
        Ok(Self {
            plan,
            materials,
            sky,
            journal,
            progress,
        })
    }

    fn comparison(&mut self) -> Result<Comparison, Error> {
        let mut all: Vec<Loaded> = Vec::new();
        let mut materials = Vec::new();
        for material in std::mem::take(&mut self.materials) {
            let loaded = args::load(&material, self.plan.lookup)?;
            materials.push(self.material(&loaded)?);
            all.push(loaded);
        }
        let mut pictures = Vec::new();
        for scene in scenes(self.plan.quick) {
            for group in groups(scene, &all) {
                pictures.push(self.pictures(scene, group)?);
            }
        }
        let mut settings = Vec::new();
        for material in &all[..settings_of(&self.plan, all.len())] {
            settings.push(self.settings(material)?);
        }
        let mut charts = Vec::new();
        for material in &all {
            let key = format!("charts/{}", material.name());
            charts.push(self.journal.recall_or(&key, || material_charts(material))?);
            self.progress.advance();
        }
        let threads = rayon::current_num_threads();
        Ok(Comparison {
            plan: self.plan.clone(),
            threads,
            materials,
            pictures,
            settings,
            charts,
        })
    }

    /// The lit point.
    fn material(&mut self, material: &Loaded) -> Result<MaterialComparison, Error> {
        let name = material.name();
        let brdf = &**material.brdf();
        let Self {
            plan,
            sky,
            journal,
            progress,
            ..
        } = self;
        let key = format!("references/{name}");
        let references = journal.recall_or(&key, || Ok(references(brdf, sky, &plan.point)))?;
        let measured = (&plan.point, &references[..]);
        let mut curves = Vec::new();
        let mut samplers: Vec<Option<Sampler>> = Vec::new();
        for (number, competitor) in point_competitors(plan, &[material.facts()])?
            .into_iter()
            .enumerate()
        {
            let mut built = None;
            curves.push(journal.recall_or(&format!("point/{name}/{number}"), || {
                let (sampler, seconds) = time(|| competitor.spec.build(material));
                let sampler = built.insert(sampler?);
                Ok(curve(
                    competitor,
                    &**sampler,
                    seconds.wall,
                    material,
                    sky,
                    measured,
                ))
            })?);
            samplers.push(built);
            progress.advance();
        }
        let costs = journal.recall_or(&format!("costs/{name}"), || {
            costs(&curves, samplers, material, sky, measured)
        })?;
        for (curve, cost) in curves.iter_mut().zip(costs) {
            curve.ns_per_sample = cost;
        }
        let verdict = verdict(name, &curves);
        let notes = cost_notes(&curves.iter().collect::<Vec<_>>());
        Ok(MaterialComparison {
            material: name.into(),
            references,
            curves,
            verdict,
            notes,
        })
    }

    fn pictures(&mut self, scene: SceneKind, group: &[Loaded]) -> Result<PictureComparison, Error> {
        let names: Vec<&str> = group.iter().map(Loaded::name).collect();
        let facts: Vec<MaterialFacts> = group.iter().map(Loaded::facts).collect();
        let material = names.join(", ");
        let Self {
            plan,
            journal,
            progress,
            ..
        } = self;
        let key = format!("picture/{}/{material}", scene.name());
        let mut film = None;
        let reference = journal.recall_or(&format!("{key}/reference"), || {
            let (reference, rendered) = picture_reference(scene, group, &plan.picture)?;
            film = Some(rendered);
            Ok(reference)
        })?;
        let mut results: Vec<PictureResult> = Vec::new();
        for (number, competitor) in drawn_competitors(plan, &facts)?.into_iter().enumerate() {
            let one = journal.recall_or(&format!("{key}/{number}"), || {
                // A run that goes on renders the reference again if it is still needed; it is the same.
                let rendered = match film.take() {
                    Some(rendered) => rendered,
                    None => picture_reference(scene, group, &plan.picture)?.1,
                };
                pictures(
                    scene,
                    group,
                    competitor,
                    &plan.picture,
                    film.insert(rendered),
                )
            });
            results.extend(one?);
            progress.advance();
        }
        Ok(PictureComparison {
            scene,
            material,
            reference,
            results,
        })
    }

    fn settings(&mut self, material: &Loaded) -> Result<SettingsComparison, Error> {
        let Self {
            plan,
            sky,
            journal,
            progress,
            ..
        } = self;
        let name = material.name();
        let facts = material.facts();
        let mut settings = Vec::new();
        for (number, knob) in tried_settings(plan, &facts).into_iter().enumerate() {
            settings.push(journal.recall_or(&format!("setting/{name}/{number}"), || {
                setting(material, sky, knob, &plan.point)
            })?);
            progress.advance();
        }
        Ok(SettingsComparison {
            material: name.into(),
            settings,
        })
    }
}

/// Times a sample of each curve, all in turn, which takes all of their samplers: those that an earlier run measured are built
/// again.
fn costs(
    curves: &[Curve],
    samplers: Vec<Option<Sampler>>,
    material: &Loaded,
    sky: &Environment,
    measured: (&PointPlan, &[Reference]),
) -> Result<Vec<CallCost>, Error> {
    let mut all = Vec::new();
    for (curve, sampler) in curves.iter().zip(samplers) {
        all.push(match sampler {
            Some(sampler) => sampler,
            None => curve.competitor.spec.build(material)?,
        });
    }
    let drawing: Vec<&dyn DirectionSampler> = all.iter().map(Sampler::as_dyn).collect();
    let mut timed = curves.to_vec();
    measure_costs(&mut timed, &drawing, &**material.brdf(), sky, measured);
    Ok(timed.iter().map(|c| c.ns_per_sample).collect())
}

fn plan(args: &Args) -> ComparisonPlan {
    let (point, picture) = match args.quick {
        true => (PointPlan::quick(args.seed), PicturePlan::quick(args.seed)),
        false => (PointPlan::full(args.seed), PicturePlan::full(args.seed)),
    };
    ComparisonPlan {
        schema: SCHEMA,
        quick: args.quick,
        samplers: args.samplers.clone(),
        lookup: args.lookup,
        sky: args.sky.environment.clone(),
        point,
        picture,
    }
}

/// Who competes at the lit point.
fn point_competitors(
    plan: &ComparisonPlan,
    facts: &[MaterialFacts],
) -> Result<Vec<Competitor>, Error> {
    if plan.samplers.is_empty() {
        return competitors(plan.quick, facts);
    }
    Ok(plan
        .samplers
        .iter()
        .cloned()
        .map(Competitor::brdf)
        .collect())
}

/// Who competes in pictures.
fn drawn_competitors(
    plan: &ComparisonPlan,
    facts: &[MaterialFacts],
) -> Result<Vec<Competitor>, Error> {
    if plan.samplers.is_empty() {
        return picture_competitors(plan.quick, facts);
    }
    point_competitors(plan, facts)
}

/// Settings that are tried, unless samplers are named, whose settings are given.
fn tried_settings(plan: &ComparisonPlan, facts: &MaterialFacts) -> Vec<Knob> {
    if plan.samplers.is_empty() {
        knobs(plan.quick, plan.lookup, facts)
    } else {
        Vec::new()
    }
}

fn scenes(quick: bool) -> Vec<SceneKind> {
    if quick {
        vec![SceneKind::Environment]
    } else {
        vec![SceneKind::Environment, SceneKind::Glossy, SceneKind::Three]
    }
}

/// Who shares a picture: three at a time where the scene holds three, or else each its own.
fn groups<T>(scene: SceneKind, materials: &[T]) -> Vec<&[T]> {
    match scene {
        SceneKind::Three => materials.chunks_exact(3).take(1).collect(),
        SceneKind::Environment | SceneKind::Glossy => materials.chunks(1).collect(),
    }
}

/// Materials whose settings are tried.
fn settings_of(plan: &ComparisonPlan, materials: usize) -> usize {
    if plan.quick {
        materials.min(1)
    } else {
        materials
    }
}

/// Measurements in all, for the progress bar.
fn parts(plan: &ComparisonPlan, materials: &[MaterialFacts]) -> Result<usize, Error> {
    let mut parts = 0;
    for scene in scenes(plan.quick) {
        for group in groups(scene, materials) {
            parts += drawn_competitors(plan, group)?.len();
        }
    }
    for facts in &materials[..settings_of(plan, materials.len())] {
        parts += tried_settings(plan, facts).len();
    }
    for facts in materials {
        // The lit point, and one for the charts.
        parts += point_competitors(plan, &[*facts])?.len() + 1;
    }
    Ok(parts)
}
