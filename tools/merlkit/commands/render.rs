//! `merlkit render`: a row of spheres, one per material.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use merlkit::brdf::{LookupRule, Measured};
use merlkit::files::Overwrite;
use merlkit::image::{write_exr, write_png};
use merlkit::merl::Material;
use merlkit::points::PointSet;
use merlkit::render::{
    Decision, Effect, EffectPlan, EnvironmentSource, Film, LightSpec, Scene, SceneSpec, Settings, Strategy,
    Surface, render,
};
use merlkit::sampler::{Cosine, DirectionSampler};
use merlkit::{Error, Result};

/// Path-trace a row of spheres, one per material, to NAME.exr (linear) and NAME.png (tone-mapped sRGB).
#[derive(Args, Debug)]
pub struct RenderArgs {
    /// Embedded names or paths to MERL binaries; one sphere each, from left to right.
    #[arg(required = true, value_name = "MATERIAL")]
    materials: Vec<String>,
    /// point, directional, area, environment (the built-in studio) or FILE.exr (equirectangular); may be repeated.
    #[arg(long = "light", value_name = "LIGHT", default_value = "environment")]
    lights: Vec<String>,
    /// How directions are drawn from the BRDF.
    #[arg(long, value_name = "NAME", default_value = DEFAULT_SAMPLER)]
    sampler: String,
    /// Paths per pixel.
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u64).range(1..))]
    spp: u64,
    /// Size in pixels [default: 320 per sphere, at least 480, by 360].
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(usize, usize)>,
    /// Seed of all random numbers.
    #[arg(long, value_name = "K", default_value_t = 0)]
    seed: u64,
    /// What a table says between its samples: floor, linear or centred.
    #[arg(long, value_name = "RULE", default_value = "floor", value_parser = parse_lookup)]
    lookup: LookupRule,
    /// Put the spheres on a grey floor.
    #[arg(long)]
    floor: bool,
    /// Surfaces a path may meet; 1 is direct light only.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..))]
    depth: u32,
    /// How light from lights with an extent is found: mis, light or brdf.
    #[arg(long, value_name = "NAME", default_value = "mis", value_parser = parse_strategy)]
    strategy: Strategy,
    /// Exposure of the PNG, in stops.
    #[arg(long, value_name = "EV", default_value_t = 0.0, allow_negative_numbers = true)]
    exposure: f32,
    /// Threads [default: one per core].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Replace existing pictures.
    #[arg(long)]
    force: bool,
    /// Print each effect, on or off, and why.
    #[arg(long)]
    explain: bool,
    /// Compute every effect, called for or not; the picture is the same within noise.
    #[arg(long)]
    all_effects: bool,
    /// Output without extension; ".exr" and ".png" are appended.
    #[arg(short, long, value_name = "NAME", default_value = "render")]
    output: PathBuf,
}

const DEFAULT_SAMPLER: &str = "cosine";
/// The floor's reflectance: a mid grey.
const FLOOR: f32 = 0.35;

/// Runs the command.
///
/// # Errors
/// Whatever reading materials and lights, rendering and writing return.
pub fn run(args: &RenderArgs) -> Result<ExitCode> {
    let pool = rayon_pool(args.threads)?;
    pool.install(|| run_on_this_pool(args))
}

fn run_on_this_pool(args: &RenderArgs) -> Result<ExitCode> {
    let start = Instant::now();
    let (exr, png) = outputs(&args.output);
    let overwrite = if args.force { Overwrite::Replace } else { Overwrite::Refuse };
    check_outputs(&[&exr, &png], overwrite)?;
    let settings = settings(args);
    let (spec, materials) = describe(args, &settings)?;
    let plan = if args.all_effects { EffectPlan::everything(&spec) } else { EffectPlan::of(&spec) };
    if args.explain {
        println!("{}", explanation(&spec, &plan));
    }
    let scene = Scene::build(&spec, &plan, |i, directions| surface(args, &materials[i], directions))?;
    let film = render_with_progress(&scene, &plan, &settings)?;
    let image = film.to_image()?;
    write_exr(&exr, &image, overwrite)?;
    write_png(&png, &image, args.exposure, overwrite)?;
    println!("{}\n{}", exr.display(), png.display());
    eprintln!(
        "{} × {}, {} paths per pixel, {:.2} s",
        settings.width,
        settings.height,
        args.spp,
        elapsed(start)
    );
    Ok(ExitCode::SUCCESS)
}

/// Builds the sampler called `name` for `brdf`.
fn build_sampler(name: &str, _brdf: Arc<Measured>) -> Result<Arc<dyn DirectionSampler>> {
    match name {
        "cosine" => Ok(Arc::new(Cosine)),
        _ => Err(Error::argument(format!("no sampler is called \"{name}\""), "pass --sampler cosine")),
    }
}

fn surface(args: &RenderArgs, material: &Material, directions: bool) -> Result<Surface> {
    let brdf = Arc::new(Measured::new(Arc::new(material.load()?), args.lookup));
    let sampler = directions.then(|| build_sampler(&args.sampler, brdf.clone())).transpose()?;
    Ok(Surface { brdf, sampler })
}

fn settings(args: &RenderArgs) -> Settings {
    let (width, height) = args.size.unwrap_or(((320 * args.materials.len()).max(480), 360));
    Settings { width, height, samples: args.spp, seed: args.seed, points: PointSet::Sobol }
}

/// The scene, and its materials in the order of [`SceneSpec::materials`]; nothing is loaded.
fn describe(args: &RenderArgs, settings: &Settings) -> Result<(SceneSpec, Vec<Material>)> {
    let mut spec = SceneSpec::row(&args.materials, settings.width as f64 / settings.height as f64);
    let materials = spec.materials.iter().map(|m| Material::resolve(m)).collect::<Result<_>>()?;
    spec.lights = args.lights.iter().map(|l| light(l, &spec)).collect::<Result<_>>()?;
    spec.floor = args.floor.then_some(FLOOR);
    spec.depth = args.depth;
    spec.strategy = args.strategy;
    Ok((spec, materials))
}

fn light(name: &str, spec: &SceneSpec) -> Result<LightSpec> {
    match name {
        "point" => Ok(spec.row_point()),
        "directional" => Ok(spec.row_directional()),
        "area" => Ok(spec.row_area()),
        "environment" => Ok(LightSpec::Environment(EnvironmentSource::Studio)),
        file if Path::new(file).extension().is_some_and(|e| e.eq_ignore_ascii_case("exr")) => {
            Ok(LightSpec::Environment(EnvironmentSource::File(file.into())))
        }
        _ => Err(Error::argument(
            format!("no light is called \"{name}\""),
            "pass --light point, directional, area, environment or the path of an .exr file",
        )),
    }
}

fn explanation(spec: &SceneSpec, plan: &EffectPlan) -> String {
    let mut table = comfy_table::Table::new();
    table.load_style(comfy_table::presets::NOTHING).set_header(["effect", "", "why"]);
    let mut row = |name: String, decision: Decision| {
        table.add_row([name, if decision.on { "on" } else { "off" }.into(), decision.why.into()]);
    };
    for effect in Effect::ALL {
        row(effect.name().into(), plan.effect(effect));
    }
    for (name, decision) in spec.materials.iter().zip(plan.materials()) {
        row(format!("load material {name}"), *decision);
    }
    for (light, decision) in spec.lights.iter().zip(plan.lights()) {
        row(format!("load light {}", light.kind()), *decision);
    }
    table.trim_fmt()
}

/// A bar on a terminal's stderr, once the work has taken a second.
fn render_with_progress(scene: &Scene, plan: &EffectPlan, settings: &Settings) -> Result<Film> {
    let total = (settings.width as u64).saturating_mul(settings.height as u64);
    let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden());
    if let Ok(style) = ProgressStyle::with_template("render {wide_bar} {percent} %, {eta} left") {
        bar.set_style(style);
    }
    let (start, shown) = (Instant::now(), std::sync::Once::new());
    let film = render(scene, plan, settings, &|pixels| {
        bar.inc(pixels as u64);
        if start.elapsed() > Duration::from_secs(1) {
            shown.call_once(|| bar.set_draw_target(ProgressDrawTarget::stderr()));
        }
    });
    bar.finish_and_clear();
    film
}

fn outputs(name: &Path) -> (PathBuf, PathBuf) {
    let is_picture = name.extension().is_some_and(|e| e == "exr" || e == "png");
    let stem = if is_picture { name.with_extension("") } else { name.to_owned() };
    let with = |extension: &str| {
        let mut path = stem.clone().into_os_string();
        path.push(extension);
        PathBuf::from(path)
    };
    (with(".exr"), with(".png"))
}

/// Tells of outputs that can't be written before the work, not after it.
fn check_outputs(paths: &[&Path], overwrite: Overwrite) -> Result<()> {
    for path in paths {
        if overwrite == Overwrite::Refuse && path.exists() {
            return Err(Error::argument(
                format!("{} exists", path.display()),
                "pass --force to replace it, or name another output",
            ));
        }
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
        if let Some(folder) = folder.filter(|p| !p.is_dir()) {
            return Err(Error::argument(
                format!("{} is not a folder", folder.display()),
                "make it, or name another output",
            ));
        }
    }
    Ok(())
}

fn rayon_pool(threads: Option<u16>) -> Result<rayon::ThreadPool> {
    let threads = threads.map_or(0, usize::from);
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| {
        Error::argument(format!("the threads can't be started ({e})"), "pass a smaller --threads")
    })
}

fn elapsed(start: Instant) -> f64 {
    start.elapsed().as_secs_f64()
}

fn parse_size(text: &str) -> std::result::Result<(usize, usize), String> {
    let sides = text.split_once(['x', 'X', '×']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    sides.filter(|&(w, h)| w > 0 && h > 0).ok_or_else(|| "give width x height in pixels, as 960x360".into())
}

fn parse_lookup(text: &str) -> std::result::Result<LookupRule, String> {
    let rule = LookupRule::ALL.into_iter().find(|r| r.name() == text);
    rule.ok_or_else(|| "give floor, linear or centred".into())
}

fn parse_strategy(text: &str) -> std::result::Result<Strategy, String> {
    match text {
        "mis" => Ok(Strategy::Mis),
        "light" => Ok(Strategy::Light),
        "brdf" => Ok(Strategy::Brdf),
        _ => Err("give mis, light or brdf".into()),
    }
}
