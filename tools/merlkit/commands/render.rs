//! `merlkit render`

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use merlkit::Error;
use merlkit::distribution::Heuristic;
use merlkit::glam::DVec3;
use merlkit::light::LightSpec;
use merlkit::material::Material;
use merlkit::material::merl::LookupRule;
use merlkit::points::PointSet;
use merlkit::render::{
    Budget, Camera, Decision, Effect, EffectPlan, PlanRequest, Refinement, RenderSettings,
    SceneSpec, Strategy,
};
use merlkit::sampler::SamplerSpec;
use merlkit_evaluate::report::Sheet;

use crate::failure::Outcome;
use crate::picture::{Files, Picture};
use crate::resumable::{self, Resumable};
use crate::sampler_args;
use crate::{args, batch, output, table};

/// Path-trace a row of spheres, one per material, to NAME.exr (linear RGB) and NAME.png (sRGB)
///
/// Only the effects that the scene needs are computed; --explain prints which, and why. The same command gives the same bytes
/// on any number of threads.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  merlkit render nickel teflon --spp 256 --light studio --light point -o spheres"
)]
pub struct Args {
    /// MERL binaries, .bsdf files, built-in names or formulas; one sphere each, left to right
    #[arg(required = true, value_name = "MATERIAL")]
    materials: Vec<String>,
    /// How values between the samples of a table are interpolated [default: floor]
    #[arg(help_heading = "Materials", long, value_name = "floor|linear|centred", hide_possible_values = true, default_value = "floor", hide_default_value = true, value_parser = args::lookup_rule())]
    lookup: LookupRule,
    #[command(flatten, next_help_heading = "Materials")]
    tables: args::TableOptions,
    #[arg(help_heading = "Scene", long = "light", value_name = "LIGHT", default_value = "environment", hide_default_value = true, help = light_help())]
    lights: Vec<String>,
    /// Position of the eye in radii of a sphere; +y is up, +z to the viewer [default: it frames the row]
    #[arg(help_heading = "Scene", long, value_name = "X,Y,Z", allow_hyphen_values = true, conflicts_with_all = ["elevation", "fov"], value_parser = position)]
    eye: Option<DVec3>,
    /// Elevation of the eye above the horizon in degrees, -89 to 89 [default: 12.4]
    #[arg(help_heading = "Scene", long, value_name = "DEG", allow_negative_numbers = true, value_parser = within::<-89, 89>)]
    elevation: Option<f64>,
    /// Vertical field of view in degrees, 1 to 120; the row keeps its size [default: 24]
    #[arg(help_heading = "Scene", long, value_name = "DEG", value_parser = within::<1, 120>)]
    fov: Option<f64>,
    /// Put the spheres on a grey floor
    #[arg(help_heading = "Scene", long = "ground")]
    ground: bool,
    /// Maximum number of surfaces on a path; 1 gives direct light only [default: 8]
    #[arg(help_heading = "Scene", long = "bounces", value_name = "N", default_value_t = 8, hide_default_value = true, value_parser = clap::value_parser!(u32).range(1..))]
    bounces: u32,
    /// Print whether each effect is on or off, and why
    #[arg(help_heading = "Effects", long)]
    explain: bool,
    /// Compute every effect, needed or not; the picture is the same within noise
    #[arg(help_heading = "Effects", long)]
    all_effects: bool,
    /// BRDF sampler, with settings (`merlkit samplers` lists them) [default: half-vector:64KB]
    #[arg(help_heading = "Sampling", long, value_name = sampler_args::VALUE, default_value = sampler_args::DEFAULT, hide_default_value = true)]
    sampler: SamplerSpec,
    /// Paths per pixel [default: 64]
    #[arg(help_heading = "Sampling", long, value_name = "N", default_value_t = 64, hide_default_value = true, value_parser = clap::value_parser!(u64).range(1..))]
    spp: u64,
    /// Spend the paths where the first of them found noise; needs --spp 16 or more
    #[arg(help_heading = "Sampling", long, conflicts_with = "target_error")]
    adaptive: bool,
    /// Points of each pixel [default: lattice; sobol from --spp 512 and with --target-error]
    #[arg(help_heading = "Sampling", long, value_name = "random|sobol|lattice", hide_possible_values = true, value_parser = args::named(&POINTS))]
    points: Option<PointSet>,
    /// Sample each 16 × 16 tile that shows an object until its estimated relative RMS error is about E: 0.05 or 5%. The halves
    /// of a tile stop one another, which keeps means unbiased; a finished tile can exceed E somewhat
    #[arg(help_heading = "Sampling", long, value_name = "E", conflicts_with = "spp", value_parser = args::target_error)]
    target_error: Option<f64>,
    /// Maximum paths per pixel with --target-error, at least 16 [default: 4096]
    #[arg(help_heading = "Sampling", long, value_name = "N", requires = "target_error", value_parser = clap::value_parser!(u64).range(16..))]
    max_spp: Option<u64>,
    /// Seed of all random numbers [default: 0]
    #[arg(
        help_heading = "Sampling",
        long,
        value_name = "K",
        default_value_t = 0,
        hide_default_value = true
    )]
    seed: u64,
    /// Sampling of extended lights: of light and BRDF (mis), of one of them, or of one of --candidates from the BRDF (ris)
    /// [default: mis]
    #[arg(help_heading = "Sampling", long, value_name = "mis|light|brdf|ris", hide_possible_values = true, default_value = "mis", hide_default_value = true, value_parser = STRATEGIES)]
    strategy: String,
    /// MIS heuristic of --strategy mis [default: power]
    #[arg(help_heading = "Sampling", long, value_name = "power|balance", hide_possible_values = true, value_parser = args::named(&HEURISTICS))]
    heuristic: Option<Heuristic>,
    /// Number of BRDF candidates of --strategy ris, of which one is traced [default: 8]
    #[arg(help_heading = "Sampling", long, value_name = "M", value_parser = clap::value_parser!(u32).range(1..=1 << 16))]
    candidates: Option<u32>,
    /// Size in pixels [default: 320 × the number of spheres, but at least 480, wide; 360 high]
    #[arg(help_heading = "Picture", long, value_name = "WxH", value_parser = args::size)]
    size: Option<(usize, usize)>,
    /// Exposure of the PNG in stops [default: 0]
    #[arg(help_heading = "Picture", long, value_name = "EV", default_value_t = 0.0, hide_default_value = true, allow_negative_numbers = true, value_parser = stops)]
    exposure: f32,
    /// Finish a picture that Ctrl-C interrupted; the bytes are those of an uninterrupted run
    #[arg(help_heading = "Picture", long)]
    resume: bool,
    /// Replace existing pictures [default: refuse]
    #[arg(help_heading = "Picture", long)]
    force: bool,
    /// Output name without extension; .exr and .png are appended [default: render]
    #[arg(
        help_heading = "Picture",
        short,
        long,
        value_name = "NAME",
        default_value = "render",
        hide_default_value = true
    )]
    output: PathBuf,
}

const STRATEGIES: [&str; 4] = ["mis", "light", "brdf", "ris"];
const HEURISTICS: [(&str, Heuristic); 2] =
    [("power", Heuristic::Power), ("balance", Heuristic::Balance)];
const POINTS: [(&str, PointSet); 3] = [
    ("random", PointSet::Random),
    ("sobol", PointSet::Sobol),
    ("lattice", PointSet::Lattice),
];
/// Paths per pixel that a target error may take, where nothing is said.
const MAX_SPP: u64 = 4096;
/// The floor's reflectance: a mid grey.
pub const GREY: f32 = 0.35;

pub fn run(args: &Args) -> Outcome {
    let start = Instant::now();
    let files = Files::named(&args.output);
    let overwrite = output::overwrite(args.force);
    let names = batch::expand_folders(&args.materials)?;
    let settings = settings(args, names.len())?;
    settings.check()?;
    let (scene, materials) = describe(args, &names, &settings)?;
    resumable::check_files(&files, overwrite, args.resume)?;
    let effects = if args.all_effects {
        PlanRequest::Everything
    } else {
        PlanRequest::AsNeeded
    };
    let plan = EffectPlan::for_scene(&scene, effects);
    if plan.is_on(Effect::Directions) {
        for material in &materials {
            args.sampler.check_supports(&material.facts()?)?;
        }
    }
    if args.explain {
        let sheet = explanation(&scene, &plan);
        output::stdout(|out| writeln!(out, "{}", table::render(&sheet)))?;
    }
    let picture = Picture {
        scene: &scene,
        effects,
        materials: &materials,
        lookup: args.lookup,
        sampler: &args.sampler,
        settings,
        exposure: args.exposure,
    };
    let resumable = Resumable {
        picture: &picture,
        files: &files,
        overwrite,
        resume: args.resume,
    };
    let refinement = resumable.render()?;
    output::stdout(|out| {
        writeln!(out, "{}\n{}", files.exr.display(), files.png.display())?;
        let (w, h) = (settings.width, settings.height);
        let paths = paths_a_pixel(&settings, refinement.as_ref());
        let seconds = start.elapsed().as_secs_f64();
        writeln!(
            out,
            "{w} × {h} pixels, {paths} paths per pixel, {seconds:.2} s in total"
        )?;
        match (refinement, settings.budget) {
            (Some(refinement), Budget::ToError { most, .. }) => {
                writeln!(out, "{}", error_reached(&refinement, most))
            }
            _ => Ok(()),
        }
    })?;
    Ok(ExitCode::SUCCESS)
}

/// How many paths per pixel has; of a target error the mean, and with those that only served decisions.
fn paths_a_pixel(settings: &RenderSettings, refinement: Option<&Refinement>) -> String {
    match (settings.budget, refinement) {
        (Budget::Even(paths), _) => paths.to_string(),
        (Budget::Adaptive(paths), _) => format!("about {paths}"),
        (Budget::ToError { most, .. }, None) => format!("at most {most}"),
        (Budget::ToError { .. }, Some(refinement)) => {
            let pixels = (settings.width * settings.height) as f64;
            let kept = refinement.paths as f64 / pixels;
            let traced = refinement.traced as f64 / pixels;
            format!("{kept:.1} (traced: {traced:.1})")
        }
    }
}

/// The error that was estimated, and whether all tiles came down to the target.
fn error_reached(refinement: &Refinement, most: u64) -> String {
    let worst = refinement.tiles.iter().map(|t| t.error).fold(0.0, f64::max);
    let tiles = refinement.tiles.len();
    let short = refinement.tiles.iter().filter(|t| !t.reached).count();
    let errors = format!(
        "estimated relative error {:.2} %, worst tile {:.2} %",
        100.0 * refinement.error(),
        100.0 * worst
    );
    match short {
        0 => format!("{errors}; all {tiles} tiles with objects have stopped"),
        _ => format!(
            "{errors}; {short} of {tiles} tiles did not reach the target: raise --max-spp {most}"
        ),
    }
}

fn stops(argument: &str) -> Result<f32, String> {
    argument
        .parse()
        .ok()
        .filter(|ev: &f32| ev.is_finite())
        .ok_or_else(|| "expected a finite number of stops".into())
}

/// Paths per pixel from which Sobol points leave less error than lattices (docs/light-and-brdf.md has what was measured).
const SOBOL_FROM: u64 = 512;

/// Settings of a picture of so many spheres.
fn settings(args: &Args, spheres: usize) -> Result<RenderSettings, Error> {
    let default_size = ((320 * spheres).max(480), 360);
    let (width, height) = args.size.unwrap_or(default_size);
    let budget = match args.target_error {
        Some(error) => Budget::ToError {
            error,
            most: args.max_spp.unwrap_or(MAX_SPP),
        },
        None if args.adaptive => Budget::Adaptive(args.spp),
        None => Budget::Even(args.spp),
    };
    let points = match (args.points, args.target_error) {
        (Some(PointSet::Lattice), Some(_)) => {
            let what = "a lattice needs a path count that is known in advance";
            return Err(Error::argument(
                what,
                "omit --points lattice or --target-error",
            ));
        }
        (None, Some(_)) => PointSet::Sobol,
        (None, None) if args.spp >= SOBOL_FROM => PointSet::Sobol,
        (points, _) => points.unwrap_or(PointSet::Lattice),
    };
    Ok(RenderSettings {
        width,
        height,
        seed: args.seed,
        points,
        budget,
    })
}

/// The scene, and its materials in the order of [`SceneSpec::materials`]; nothing is loaded.
fn describe(
    args: &Args,
    names: &[String],
    settings: &RenderSettings,
) -> Result<(SceneSpec, Vec<Material>), Error> {
    let mut spec = SceneSpec::row(names, settings.width as f64 / settings.height as f64);
    let materials = args::resolve(&spec.materials, &args.tables)?;
    spec.mirrors = args::find_mirrors(&materials)?;
    spec.lights = args
        .lights
        .iter()
        .map(|name| spec.light(name))
        .collect::<Result<_, _>>()?;
    spec.camera = camera(args, spec.camera);
    spec.floor = args.ground.then_some(GREY);
    spec.depth = args.bounces;
    spec.strategy = strategy(args)?;
    Ok((spec, materials))
}

/// The camera that was asked for, where the scene has `framed`.
fn camera(args: &Args, framed: Camera) -> Camera {
    if let Some(eye) = args.eye {
        return Camera { eye, ..framed };
    }
    let Camera {
        eye,
        target,
        vertical_angle: framed_angle,
    } = framed;
    let vertical_angle = args.fov.map_or(framed_angle, f64::to_radians);
    // The nearest points of the spheres, one radius before their centres, keep their size in the picture.
    let zoom = (0.5 * framed_angle).tan() / (0.5 * vertical_angle).tan();
    let distance = ((eye - target).length() - 1.0) * zoom + 1.0;
    let towards = match args.elevation.map(f64::to_radians) {
        Some(elevation) => DVec3::new(0.0, elevation.sin(), elevation.cos()),
        None => (eye - target).normalize(),
    };
    Camera {
        eye: target + towards * distance,
        target,
        vertical_angle,
    }
}

/// "X,Y,Z" as a point.
fn position(argument: &str) -> Result<DVec3, String> {
    let numbers: Option<Vec<f64>> = argument.split(',').map(|n| n.trim().parse().ok()).collect();
    let point = match numbers.as_deref() {
        Some(&[x, y, z]) => Some(DVec3::new(x, y, z)),
        _ => None,
    };
    point
        .filter(|p| p.is_finite())
        .ok_or_else(|| "expected three numbers, such as 0,2,8".into())
}

/// A number from `LEAST` to `MOST`.
fn within<const LEAST: i32, const MOST: i32>(argument: &str) -> Result<f64, String> {
    let domain = f64::from(LEAST)..=f64::from(MOST);
    let number = argument.parse().ok();
    number
        .filter(|x| domain.contains(x))
        .ok_or_else(|| format!("expected a number from {LEAST} to {MOST}"))
}

fn strategy(args: &Args) -> Result<Strategy, Error> {
    match (args.strategy.as_str(), args.heuristic, args.candidates) {
        (name, Some(_), _) if name != "mis" => Err(no_effect(name, "--heuristic", "mis")),
        (name, _, Some(_)) if name != "ris" => Err(no_effect(name, "--candidates", "ris")),
        ("light", ..) => Ok(Strategy::Light),
        ("brdf", ..) => Ok(Strategy::Brdf),
        ("ris", _, candidates) => Ok(Strategy::Ris {
            candidates: candidates.unwrap_or(Strategy::CANDIDATES),
        }),
        (_, heuristic, _) => Ok(Strategy::Mis(heuristic.unwrap_or_default())),
    }
}

/// The error for an option that belongs to the strategy `wanted` only.
fn no_effect(strategy: &str, option: &str, wanted: &str) -> Error {
    Error::argument(
        format!("{option} has no effect with --strategy {strategy}"),
        format!("omit it, or pass --strategy {wanted}"),
    )
}

fn light_help() -> String {
    format!(
        "{}: a map (EXR, HDR, PFM, PNG; its top is +y, its centre −z, its right half +x); repeatable [default: studio]",
        LightSpec::words()
    )
}

/// One line an effect, then one a material and a light.
fn explanation(spec: &SceneSpec, plan: &EffectPlan) -> Sheet {
    let mut sheet = Sheet::new(&["effect", "", "why"]);
    let mut row = |name: String, decision: Decision| {
        sheet.push(vec![
            name,
            if decision.on { "on" } else { "off" }.into(),
            decision.why.into(),
        ]);
    };
    for effect in Effect::ALL {
        row(effect.name().into(), plan.effect(effect));
    }
    for (name, decision) in spec.materials.iter().zip(plan.materials()) {
        row(format!("load material {name}"), *decision);
    }
    for (light, decision) in spec.lights.iter().zip(plan.lights()) {
        row(format!("load light {}", light.describe()), *decision);
    }
    sheet
}
