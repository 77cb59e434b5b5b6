//! `merlkit sheet`

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use merlkit::Error;
use merlkit::files::Overwrite;
use merlkit::glam::DVec3;
use merlkit::material::{LookupRule, Material, Origin};
use merlkit::points::PointSet;
use merlkit::render::{Budget, Camera, PlanRequest, RenderSettings, SceneSpec};
use merlkit::sampler::SamplerSpec;

use crate::args;
use crate::failure::Outcome;
use crate::grid::{Cell, Grid, LINE};
use crate::output;
use crate::picture::{Files, Picture};
use crate::resumable::unfinished;
use crate::sampler_args;
use crate::scene_args::SceneOptions;
use crate::tiles::{Tile, TileFolder, draw_tiles};

/// Render a contact sheet: each material as a sphere of its own, with its name
///
/// Each sphere is alone in its tile, in the middle and far from the eye, so that its outline is a circle and its pixels don't depend
/// on its neighbours. Writes NAME.exr (linear RGB) and NAME.png. Ctrl-C keeps the finished spheres in the folder NAME.tiles; the
/// same command with --resume goes on from there.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  merlkit sheet --all -o merl100\n  merlkit sheet nickel chrome ward:sx=0.2,sy=0.4 --columns 3 --size 256 --spp 256"
)]
pub struct Args {
    #[command(flatten, next_help_heading = "Materials")]
    materials: args::Materials,
    /// How values between the samples of a table are interpolated
    #[arg(help_heading = "Materials", long, value_name = "RULE", default_value = "floor", value_parser = args::lookup_rule())]
    lookup: LookupRule,
    #[command(flatten, next_help_heading = "Scene")]
    scene: SceneOptions,
    /// Number of spheres in a row [default: as near to a square as may be]
    #[arg(help_heading = "Picture", long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    columns: Option<u32>,
    /// Width and height of each sphere's tile in pixels, 16 to 4096
    #[arg(help_heading = "Picture", long, value_name = "PIXELS", default_value_t = 96, value_parser = clap::value_parser!(u32).range(16..=4096))]
    size: u32,
    /// Omit the names
    #[arg(help_heading = "Picture", long)]
    no_labels: bool,
    /// Exposure of the PNG in stops
    #[arg(
        help_heading = "Picture",
        long,
        value_name = "EV",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    exposure: f32,
    /// BRDF sampler, with settings (`merlkit samplers` lists them)
    #[arg(help_heading = "Sampling", long, value_name = sampler_args::VALUE, default_value = sampler_args::DEFAULT)]
    sampler: SamplerSpec,
    /// Paths per pixel
    #[arg(help_heading = "Sampling", long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u64).range(1..))]
    spp: u64,
    /// Seed of all random numbers
    #[arg(help_heading = "Sampling", long, value_name = "K", default_value_t = 0)]
    seed: u64,
    /// Finish a sheet that Ctrl-C interrupted; the bytes are those of an uninterrupted run
    #[arg(help_heading = "Output", long)]
    resume: bool,
    /// Replace existing pictures [default: refuse]
    #[arg(help_heading = "Output", long)]
    force: bool,
    /// Output name without extension; .exr and .png are appended
    #[arg(
        help_heading = "Output",
        short,
        long,
        value_name = "NAME",
        default_value = "sheet"
    )]
    output: PathBuf,
}

/// Pixels between tiles.
const GAP: usize = 4;
/// The fraction of the tile's height that the sphere takes.
const FILLED: f64 = 0.92;
/// The angle under which a tile is seen: so small that nearly half of the sphere shows.
const ANGLE: f64 = 4.0;

pub fn run(args: &Args) -> Outcome {
    let start = Instant::now();
    let (materials, unreadable) = args.materials.resolve()?;
    args::refuse_repeated(&materials)?;
    for material in &materials {
        args.sampler.check_supports(&material.facts()?)?;
    }
    let grid = lay_out(args, materials.len());
    grid.check()?;
    let files = Files::named(&args.output);
    let scene = describe_scene(args)?;
    let mut tiles = Vec::with_capacity(materials.len());
    for material in &materials {
        tiles.push(Tile {
            variant: String::new(),
            picture: picture(args, &scene, material)?,
        });
    }
    let folder = TileFolder::beside(&files, args.resume);
    folder.check()?;
    let overwrite = match args.resume {
        true => Overwrite::Replace,
        false => output::overwrite(args.force),
    };
    files.check(overwrite)?;
    draw_tiles(&folder, &tiles, "", |drawn| {
        let is_finished = drawn.finished == tiles.len();
        let mut cells = Vec::with_capacity(tiles.len());
        for (image, material) in drawn.read(&folder, &tiles)?.into_iter().zip(&materials) {
            cells.push(Cell {
                image: Some(image),
                label: label_of(material).to_owned(),
            });
        }
        let state = (!is_finished).then(|| unfinished("some spheres are missing"));
        let finish = args.scene.finish(args.exposure);
        Ok(files.write(grid.compose(&[], &cells)?, &finish, state, overwrite)?)
    })?;
    output::stdout(|out| {
        writeln!(out, "{}\n{}", files.exr.display(), files.png.display())?;
        let seconds = start.elapsed().as_secs_f64();
        let (n, size, spp) = (materials.len(), args.size, args.spp);
        writeln!(
            out,
            "{n} spheres of {size} × {size} pixels, {spp} paths per pixel, {seconds:.1} s in total"
        )
    })?;
    unreadable.end(materials.len(), ExitCode::SUCCESS)
}

/// Where the tiles are.
fn lay_out(args: &Args, count: usize) -> Grid {
    let columns = args.columns.map(|n| n as usize);
    let label = if args.no_labels { 0 } else { LINE };
    Grid {
        gap: GAP,
        label,
        ink: args.scene.ink(),
        ..Grid::for_tiles(count, columns, [args.size as usize; 2])
    }
}

/// The scene of every tile: one sphere under the lights.
fn describe_scene(args: &Args) -> Result<SceneSpec, Error> {
    let mut scene = SceneSpec::row(&["sphere".to_owned()], 1.0);
    args.scene.apply(&mut scene)?;
    scene.camera = camera();
    Ok(scene)
}

/// The picture of one material's sphere.
fn picture<'a>(
    args: &'a Args,
    scene: &SceneSpec,
    material: &'a Material,
) -> Result<Picture<'a>, Error> {
    let materials = std::slice::from_ref(material);
    Ok(Picture {
        scene: SceneSpec {
            mirrors: args::find_mirrors(materials)?,
            ..scene.clone()
        },
        effects: PlanRequest::AsNeeded,
        materials,
        lookup: args.lookup,
        sampler: &args.sampler,
        settings: RenderSettings {
            width: args.size as usize,
            height: args.size as usize,
            seed: args.seed,
            points: PointSet::Lattice,
            budget: Budget::Even(args.spp),
        },
        finish: args.scene.finish(args.exposure),
    })
}

/// A camera whose axis goes through the centre of the sphere at (0, 1, 0): its outline is a circle.
fn camera() -> Camera {
    let vertical_angle = ANGLE.to_radians();
    let target = DVec3::new(0.0, 1.0, 0.0);
    // The outline is seen at the angle asin(1/distance) from the axis.
    let distance = 1.0 / (FILLED * (0.5 * vertical_angle).tan()).atan().sin();
    Camera {
        eye: target + DVec3::new(0.0, 0.22, 1.0).normalize() * distance,
        target,
        vertical_angle,
    }
}

/// What is written under a sphere: the name of a material, or the text of a formula.
fn label_of(material: &Material) -> &str {
    match material.origin() {
        Origin::Formula(text) => text,
        _ => material.name(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The outline takes the promised part of the tile's height in every direction: a circle.
    #[test]
    fn the_outline_is_a_circle() {
        let camera = camera();
        let radius = |x: f64, y: f64| {
            // Walks outwards from the middle of the tile until the ray misses the unit sphere.
            let mut r = 0.0f64;
            loop {
                let p = merlkit::glam::DVec2::new(0.5 + r * x, 0.5 + r * y);
                let ray = camera.ray(p, 1.0);
                let to_centre = camera.target - ray.origin;
                let along = to_centre.dot(ray.direction);
                if (to_centre - along * ray.direction).length() > 1.0 {
                    return r;
                }
                r += 1e-4;
            }
        };
        for (x, y) in [(1.0, 0.0), (0.0, 1.0), (-0.6, 0.8), (0.0, -1.0)] {
            assert!((radius(x, y) - 0.5 * FILLED).abs() < 1e-3, "{x} {y}");
        }
    }
}
