//! `merlkit render`

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use merlkit::Error;
use merlkit::brdf::LookupRule;
use merlkit::merl::Material;
use merlkit::points::PointSet;
use merlkit::render::{
    Decision, Effect, EffectPlan, EnvironmentSource, LightSpec, SceneSpec, Settings, Strategy,
};
use merlkit::report::Sheet;

use crate::failure::Outcome;
use crate::picture::{Files, Picture};
use crate::sampler_args::{self, DEFAULT, SamplerArgs};
use crate::{args, output, table};

/// Path-trace a row of spheres, one a material, to NAME.exr (linear RGB) and NAME.png (tone-mapped sRGB)
///
/// Before anything is loaded, a plan is made of the effects that the scene calls for, and only those are computed; --explain
/// prints it. The same command gives the same bytes on any number of threads.
#[derive(clap::Args)]
pub struct Args {
    /// Paths to MERL binaries or names of embedded materials; one sphere each, from left to right
    #[arg(required = true, value_name = "MATERIAL")]
    materials: Vec<String>,
    /// point, directional, area, environment (the built-in studio) or FILE.exr (equirectangular); may be repeated
    #[arg(long = "light", value_name = "LIGHT", default_value = "environment")]
    lights: Vec<String>,
    /// How directions are drawn from the BRDF
    #[arg(long, value_name = "NAME", default_value = DEFAULT, value_parser = sampler_args::any_name())]
    sampler: String,
    /// Paths a pixel
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u64).range(1..))]
    spp: u64,
    /// Size in pixels [default: 320 a sphere, at least 480, by 360]
    #[arg(long, value_name = "WxH", value_parser = args::size)]
    size: Option<(usize, usize)>,
    /// Seed of all random numbers
    #[arg(long, value_name = "K", default_value_t = 0)]
    seed: u64,
    /// What a table says between its samples
    #[arg(long, value_name = "RULE", default_value = "floor", value_parser = args::lookup_rule())]
    lookup: LookupRule,
    /// Put the spheres on a grey floor
    #[arg(long = "ground")]
    ground: bool,
    /// Surfaces a path may meet; 1 is direct light only
    #[arg(long = "bounces", value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..))]
    bounces: u32,
    /// How light from lights with an extent is found: by multiple importance sampling, by light, or by BRDF alone
    #[arg(long, value_name = "HOW", default_value = "mis", value_parser = args::named(&STRATEGIES))]
    strategy: Strategy,
    /// Exposure of the PNG, stops
    #[arg(long, value_name = "EV", default_value_t = 0.0, allow_negative_numbers = true, value_parser = stops)]
    exposure: f32,
    /// Print each effect, on or off, and why
    #[arg(long)]
    explain: bool,
    /// Compute every effect, called for or not; the picture is the same within noise
    #[arg(long)]
    all_effects: bool,
    /// Replace existing pictures [default: refuse]
    #[arg(long)]
    force: bool,
    /// Output without extension; .exr and .png are appended
    #[arg(short, long, value_name = "NAME", default_value = "render")]
    output: PathBuf,
    #[command(flatten)]
    settings: SamplerArgs,
}

const STRATEGIES: [(&str, Strategy); 3] =
    [("mis", Strategy::Mis), ("light", Strategy::Light), ("brdf", Strategy::Brdf)];
/// The floor's reflectance: a mid grey.
pub const GREY: f32 = 0.35;

pub fn run(args: &Args) -> Outcome {
    let start = Instant::now();
    let files = Files::named(&args.output);
    let overwrite = output::overwrite(args.force);
    files.check(overwrite)?;
    let sampler = args.settings.spec(&args.sampler)?;
    let settings = settings(args);
    let (scene, materials) = describe(args, &settings)?;
    let plan = if args.all_effects { EffectPlan::everything(&scene) } else { EffectPlan::of(&scene) };
    if args.explain {
        let sheet = explanation(&scene, &plan);
        output::stdout(|out| writeln!(out, "{}", table::render(&sheet)))?;
    }
    let picture = Picture {
        scene: &scene,
        plan: &plan,
        materials: &materials,
        lookup: args.lookup,
        sampler,
        settings,
        exposure: args.exposure,
    };
    picture.render(&files, overwrite)?;
    output::stdout(|out| {
        writeln!(out, "{}\n{}", files.exr.display(), files.png.display())?;
        let (w, h, seconds) = (settings.width, settings.height, start.elapsed().as_secs_f64());
        writeln!(out, "{w} × {h} pixels, {} paths a pixel, {seconds:.2} s in all", args.spp)
    })?;
    Ok(ExitCode::SUCCESS)
}

fn stops(argument: &str) -> Result<f32, String> {
    argument
        .parse()
        .ok()
        .filter(|ev: &f32| ev.is_finite())
        .ok_or_else(|| "expected a finite number of stops".into())
}

fn settings(args: &Args) -> Settings {
    let (width, height) = args.size.unwrap_or(((320 * args.materials.len()).max(480), 360));
    Settings { width, height, samples: args.spp, seed: args.seed, points: PointSet::Sobol }
}

/// The scene, and its materials in the order of [`SceneSpec::materials`]; nothing is loaded.
fn describe(args: &Args, settings: &Settings) -> Result<(SceneSpec, Vec<Material>), Error> {
    let mut spec = SceneSpec::row(&args.materials, settings.width as f64 / settings.height as f64);
    let materials = args::resolve(&spec.materials)?;
    spec.lights = args.lights.iter().map(|l| light(l, &spec)).collect::<Result<_, _>>()?;
    spec.floor = args.ground.then_some(GREY);
    spec.depth = args.bounces;
    spec.strategy = args.strategy;
    Ok((spec, materials))
}

fn light(name: &str, spec: &SceneSpec) -> Result<LightSpec, Error> {
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

/// One line an effect, then one a material and a light.
fn explanation(spec: &SceneSpec, plan: &EffectPlan) -> Sheet {
    let mut sheet = Sheet::new(&["effect", "", "why"]);
    let mut row = |name: String, decision: Decision| {
        sheet.push(vec![name, if decision.on { "on" } else { "off" }.into(), decision.why.into()]);
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
    sheet
}
