//! `merlkit demo`

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use merlkit::Error;
use merlkit::files::{Overwrite, check_writable};
use merlkit::light::{EnvironmentSource, LightSpec};
use merlkit::material::Material;
use merlkit::material::merl::LookupRule;
use merlkit::material::merl::write;
use merlkit::points::PointSet;
use merlkit::render::{Budget, PlanRequest, RenderSettings, SceneSpec, render};
use merlkit::sampler::SamplerSpec;
use merlkit_evaluate::measure::profile::{ProfileSettings, profile};
use merlkit_evaluate::report::SamplerReport;

use super::render::GREY;
use super::report::{describe, legend};
use crate::failure::{Failure, Outcome};
use crate::grid::{Cell, Grid};
use crate::machine;
use crate::output;
use crate::picture::{Files, LoadedParts, Picture};
use crate::progress::Progress;
use crate::sampler_choice::SamplerChoice;
use crate::scene_args::Finish;

/// Demonstrate files, samplers, report and rendering on three built-in materials, in about a minute on two idle cores
///
/// Writes nickel, red-plastic and blue-metallic-paint as MERL binaries and loads them back. Builds each sampler and prints
/// its memory, time and accuracy. Renders three spheres with each sampler, at equal sample counts, as EXR and PNG.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  merlkit demo -o out")]
pub struct Args {
    /// Folder for the files; created if missing
    #[arg(
        help_heading = "Output",
        short,
        long,
        value_name = "DIR",
        default_value = "out"
    )]
    output: PathBuf,
    /// Paths per pixel
    #[arg(help_heading = "Picture", long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u64).range(1..))]
    spp: u64,
    /// Seed of all random numbers
    #[arg(help_heading = "Picture", long, value_name = "K", default_value_t = 1)]
    seed: u64,
    /// Replace existing files [default: refuse]
    #[arg(help_heading = "Output", long)]
    force: bool,
}

const NAMES: [&str; 3] = ["nickel", "red-plastic", "blue-metallic-paint"];
const LOOKUP: LookupRule = LookupRule::Floor;

pub fn run(args: &Args) -> Outcome {
    let start = Instant::now();
    std::fs::create_dir_all(&args.output).map_err(|e| Error::io(&args.output, "create", e))?;
    let overwrite = output::overwrite(args.force);
    let samplers = samplers(&args.output)?;
    let binaries = NAMES.map(|name| args.output.join(format!("{name}.binary")));
    for path in &binaries {
        check_writable(path, overwrite)?;
    }
    for (_, files) in &samplers {
        files.check(overwrite)?;
    }
    let materials = materials(&binaries, overwrite)?;
    report(&materials, &samplers, args.seed)?;
    pictures(args, &materials, &samplers, overwrite)?;
    let seconds = start.elapsed().as_secs_f64();
    output::stdout(|out| {
        writeln!(
            out,
            "Done in {seconds:.1} s; everything is in {}.",
            args.output.display()
        )
    })?;
    Ok(ExitCode::SUCCESS)
}

/// Samplers that are shown.
const SHOWN: [&str; 5] = [
    "half-vector:64KB",
    "cosine",
    "adaptive-disc",
    "cascade-cdf:uniform",
    "cascade-cdf",
];

/// Each sampler and the files of its picture.
fn samplers(folder: &Path) -> Result<Vec<(SamplerSpec, Files)>, Error> {
    let mut all = Vec::new();
    for spec in SamplerSpec::parse_all(&SHOWN)? {
        let name = spec.to_string().replace(':', "-");
        let files = Files::named(&folder.join(format!("spheres-{name}")));
        all.push((spec, files));
    }
    Ok(all)
}

/// Writes the binaries and resolves them as a user's files would be.
fn materials(binaries: &[PathBuf; 3], overwrite: Overwrite) -> Result<Vec<Material>, Failure> {
    let mut materials = Vec::new();
    let progress = Progress::new("decoding", binaries.len());
    for (name, path) in NAMES.iter().zip(binaries) {
        let loaded = Material::resolve(name)?.load(LOOKUP)?;
        write(loaded.require_table("the demo")?.table(), path, overwrite)?;
        progress.advance();
        output::stdout(|out| writeln!(out, "wrote {}", path.display()))?;
        materials.push(Material::resolve(&path.to_string_lossy())?);
    }
    Ok(materials)
}

fn report(
    materials: &[Material],
    samplers: &[(SamplerSpec, Files)],
    seed: u64,
) -> Result<(), Failure> {
    let specs: Vec<SamplerSpec> = samplers.iter().map(|s| s.0.clone()).collect();
    let settings = ProfileSettings {
        draws: 50_000,
        timed_calls: 50_000,
        seed,
        ..ProfileSettings::default()
    };
    let progress = Progress::new("measuring", materials.len() * specs.len());
    let mut reports = Vec::new();
    for material in materials {
        let figures = profile(material, LOOKUP, &specs, &settings, &|| progress.advance())?;
        let report = SamplerReport::new(figures);
        let shown = describe(&report);
        output::stdout(|out| write!(out, "\n{shown}"))?;
        reports.push(report);
    }
    drop(progress);
    let legend = legend(&reports, Some(&machine::detect()));
    output::stdout(|out| writeln!(out, "{legend}"))
}

fn pictures(
    args: &Args,
    materials: &[Material],
    samplers: &[(SamplerSpec, Files)],
    overwrite: Overwrite,
) -> Result<(), Failure> {
    let grid = Grid::for_tiles(materials.len(), Some(materials.len()), [200, 240]);
    let settings = RenderSettings {
        width: grid.tile[0],
        height: grid.tile[1],
        seed: args.seed,
        points: PointSet::Lattice,
        budget: Budget::Even(args.spp),
    };
    let finish = Finish::default();
    for (sampler, files) in samplers {
        let started = Instant::now();
        let mut cells = Vec::with_capacity(materials.len());
        let mut parts = LoadedParts::default();
        let progress = Progress::new("rendering", grid.size().iter().product());
        for material in materials {
            let picture = Picture {
                scene: describe_scene(material, &settings),
                effects: PlanRequest::AsNeeded,
                materials: std::slice::from_ref(material),
                lookup: LOOKUP,
                samplers: vec![SamplerChoice::Built(sampler.clone())],
                settings,
                finish,
                costs: None,
            };
            let scene = parts.load(&picture)?;
            let rendered = render(scene, &settings, &|pixels| progress.advance_by(pixels))?;
            cells.push(Cell::from(rendered.film.to_image()?));
        }
        drop(progress);
        files.write(grid.compose(&[], &cells)?, &finish, None, overwrite)?;
        let seconds = started.elapsed().as_secs_f64();
        output::stdout(|out| {
            writeln!(
                out,
                "{}: {sampler}, {} paths per pixel, {seconds:.1} s",
                files.png.display(),
                args.spp
            )
        })?;
    }
    Ok(())
}

/// A sphere on a grey floor in the studio.
fn describe_scene(material: &Material, settings: &RenderSettings) -> SceneSpec {
    let aspect = settings.width as f64 / settings.height as f64;
    SceneSpec {
        lights: vec![LightSpec::Environment(EnvironmentSource::Studio)],
        floor: Some(GREY),
        ..SceneSpec::row(&[material.name().to_owned()], aspect)
    }
}
