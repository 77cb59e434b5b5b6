//! `merlkit sheet`

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use merlkit::Error;
use merlkit::files::Overwrite;
use merlkit::glam::DVec3;
use merlkit::image::Image;
use merlkit::material::{LookupRule, Material, Origin};
use merlkit::points::PointSet;
use merlkit::render::{Budget, Camera, PlanRequest, RenderSettings, SceneSpec};
use merlkit::sampler::SamplerSpec;
use merlkit_evaluate::report::Sheet;

use crate::args;
use crate::columns::{ColumnsBy, compare_rows};
use crate::failure::{Failure, Outcome};
use crate::grid::{Cell, Grid, line_height};
use crate::output;
use crate::picture::{Files, Picture};
use crate::provenance::Checksums;
use crate::resumable::unfinished;
use crate::sampler_args;
use crate::sampler_choice::SamplerChoice;
use crate::scene_args::SceneOptions;
use crate::table;
use crate::tiles::{Tile, TileFolder, draw_tiles, tile_key};

/// Render a contact sheet to NAME.exr and NAME.png: each material as a sphere of its own, with its name
// Without a second paragraph the help has one line or two for each option, instead of three or more.
#[derive(clap::Args)]
#[command(
    after_help = "Each sphere is alone in its tile, in the middle and far from the eye, so that its outline is a circle and its pixels don't \
                  depend on its neighbours. Ctrl-C keeps the finished spheres in the folder NAME.tiles; the same command with --resume \
                  goes on from there.\n\n\
                  Examples:\n  merlkit sheet --all -o merl100\n  merlkit sheet nickel chrome ward:sx=0.2,sy=0.4 --columns 3 --size 256 --spp 256\n  merlkit sheet nickel teflon --columns-by sampler --sampler cosine --sampler half-vector --difference\n  merlkit sheet nickel.json --columns-by alpha=0.02,0.05,0.1,0.2 -o roughness"
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
    /// BRDF sampler, with settings (`merlkit samplers` lists them); repeatable with --columns-by sampler
    #[arg(help_heading = "Sampling", long = "sampler", value_name = sampler_args::VALUE, default_value = sampler_args::DEFAULT)]
    samplers: Vec<SamplerSpec>,
    /// Paths per pixel
    #[arg(help_heading = "Sampling", long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u64).range(1..))]
    spp: u64,
    /// Seed of all random numbers
    #[arg(help_heading = "Sampling", long, value_name = "K", default_value_t = 0)]
    seed: u64,
    /// A row for each material, a column for each sampler or value of a parameter of a formula or stored fit: sampler, or such as
    /// alpha=0.05,0.1,0.2 (ax and ay). The first column is the reference, and under each other sphere is its error [default: no meaning of columns]
    #[arg(help_heading = "Comparison", long, value_name = "sampler|PARAM=V,V,…", conflicts_with = "columns", value_parser = ColumnsBy::parse)]
    columns_by: Option<ColumnsBy>,
    /// Add to each row a row of differences from the reference, as FLIP sees them: dark for none, yellow for 1
    #[arg(help_heading = "Comparison", long, requires = "columns_by")]
    difference: bool,
    /// Paths per pixel of the reference [default: 16 × --spp]
    #[arg(help_heading = "Comparison", long, value_name = "N", requires = "columns_by", value_parser = clap::value_parser!(u64).range(1..))]
    reference_spp: Option<u64>,
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
    if args.samplers.len() > 1 && args.columns_by != Some(ColumnsBy::Sampler) {
        let what = "several samplers without a column for each";
        return Err(Error::argument(what, "pass --columns-by sampler").into());
    }
    let default: SamplerSpec = sampler_args::DEFAULT.parse()?;
    let spheres = plan_spheres(args, &materials, &default)?;
    for sphere in &spheres {
        let facts = sphere.material.facts()?;
        sphere.sampler.check_supports(&facts)?;
    }
    let grid = lay_out(args, materials.len());
    grid.check()?;
    let mut sums = Checksums::default();
    let files = Files::named(&args.output).with_provenance(&materials, &mut sums)?;
    let scene = describe_scene(args)?;
    let mut tiles = Vec::with_capacity(spheres.len());
    for sphere in &spheres {
        tiles.push(sphere.tile(args, &scene, &mut sums)?);
    }
    let folder = TileFolder::named(&files, args.resume);
    folder.check()?;
    let overwrite = match args.resume {
        true => Overwrite::Replace,
        false => output::overwrite(args.force),
    };
    files.check(overwrite)?;
    let layout = format!("{:?} {:?}", args.columns_by, args.reference_spp);
    let errors = draw_tiles(&folder, &tiles, &layout, |drawn| {
        let is_finished = drawn.finished == tiles.len();
        let state = (!is_finished).then(|| unfinished("some spheres are missing"));
        let finish = args.scene.finish(args.exposure);
        let images = drawn.read(&folder, &tiles)?;
        let (image, errors) = compose(args, &grid, &materials, images)?;
        files.write(image, &finish, state, overwrite)?;
        Ok(errors)
    })?;
    report(args, spheres.len(), errors.flatten(), start)?;
    unreadable.end(materials.len(), ExitCode::SUCCESS)
}

/// Prints what was drawn.
fn report(
    args: &Args,
    spheres: usize,
    errors: Option<Sheet>,
    start: Instant,
) -> Result<(), Failure> {
    output::stdout(|out| {
        if let Some(errors) = errors {
            writeln!(out, "{}", table::render(&errors))?;
        }
        let files = Files::named(&args.output);
        writeln!(out, "{}\n{}", files.exr.display(), files.png.display())?;
        let seconds = start.elapsed().as_secs_f64();
        let (size, spp) = (args.size, args.spp);
        writeln!(
            out,
            "{spheres} spheres of {size} × {size} pixels, {spp} paths per pixel, {seconds:.1} s in total"
        )?;
        match args.scene.finish(args.exposure).warning() {
            Some(words) => writeln!(out, "{words}"),
            None => Ok(()),
        }
    })
}

/// A sphere of the sheet.
struct Sphere<'a> {
    material: Material,
    sampler: &'a SamplerSpec,
    paths: u64,
    points: PointSet,
    seed: u64,
    /// Distinguishes the spheres of a material.
    variant: String,
}

/// Paths of the reference for each path of the others.
const REFERENCE_PATHS: u64 = 16;

/// All spheres in the order in which they are drawn: row after row, without the rows of differences. References are drawn by the
/// `default` sampler where it takes their material.
fn plan_spheres<'a>(
    args: &'a Args,
    materials: &[Material],
    default: &'a SamplerSpec,
) -> Result<Vec<Sphere<'a>>, Error> {
    let Some(first) = args.samplers.first() else {
        return Ok(Vec::new());
    };
    let mut spheres = Vec::new();
    for material in materials {
        let plain = Sphere {
            material: material.clone(),
            sampler: first,
            paths: args.spp,
            points: PointSet::Lattice,
            seed: args.seed,
            variant: String::new(),
        };
        let Some(columns) = &args.columns_by else {
            spheres.push(plain);
            continue;
        };
        // Other points and another seed: the reference shares no noise with the others.
        spheres.push(Sphere {
            sampler: match default.check_supports(&material.facts()?) {
                Ok(()) => default,
                Err(_) => first,
            },
            paths: args
                .reference_spp
                .unwrap_or(args.spp.saturating_mul(REFERENCE_PATHS)),
            points: PointSet::Sobol,
            seed: args.seed.wrapping_add(1),
            variant: "-reference".into(),
            ..plain
        });
        let varied = columns.materials(material, args.samplers.len())?;
        for (number, material) in varied.into_iter().enumerate() {
            spheres.push(Sphere {
                material,
                sampler: args.samplers.get(number).unwrap_or(first),
                paths: args.spp,
                points: PointSet::Lattice,
                seed: args.seed,
                variant: format!("-{number}"),
            });
        }
    }
    Ok(spheres)
}

impl Sphere<'_> {
    fn tile<'a>(
        &'a self,
        args: &Args,
        scene: &SceneSpec,
        sums: &mut Checksums,
    ) -> Result<Tile<'a>, Error> {
        let materials = std::slice::from_ref(&self.material);
        let picture = Picture {
            scene: SceneSpec {
                mirrors: args::find_mirrors(materials)?,
                ..scene.clone()
            },
            effects: PlanRequest::AsNeeded,
            materials,
            lookup: args.lookup,
            samplers: vec![SamplerChoice::Built(self.sampler.clone())],
            settings: RenderSettings {
                width: args.size as usize,
                height: args.size as usize,
                seed: self.seed,
                points: self.points,
                budget: Budget::Even(self.paths),
            },
            finish: args.scene.finish(args.exposure),
            costs: None,
        };
        let key = tile_key(materials, sums)?;
        Ok(Tile::new(&key, &self.variant, picture))
    }
}

/// Where the tiles are.
fn lay_out(args: &Args, materials: usize) -> Grid {
    let tile = [args.size as usize; 2];
    let line = line_height(tile[0]);
    let grid = match &args.columns_by {
        None => Grid::for_tiles(materials, args.columns.map(|n| n as usize), tile),
        Some(columns) => {
            let columns = 1 + columns.headings(&args.samplers).len();
            let rows = materials * (1 + usize::from(args.difference));
            Grid {
                heading: if args.no_labels { 0 } else { line },
                ..Grid::for_tiles(columns * rows, Some(columns), tile)
            }
        }
    };
    Grid {
        gap: GAP,
        label: if args.no_labels { 0 } else { line },
        ink: args.scene.ink(),
        ..grid
    }
}

/// The sheet of the spheres that are drawn, and a table of their errors if they have any.
fn compose(
    args: &Args,
    grid: &Grid,
    materials: &[Material],
    images: Vec<Image>,
) -> Result<(Image, Option<Sheet>), Error> {
    let names: Vec<&str> = materials.iter().map(label_of).collect();
    let Some(columns) = &args.columns_by else {
        let mut cells = Vec::with_capacity(images.len());
        for (image, name) in images.into_iter().zip(&names) {
            cells.push(Cell {
                image: Some(image),
                label: (*name).to_owned(),
            });
        }
        return Ok((grid.compose(&[], &cells)?, None));
    };
    let mut headings = columns.headings(&args.samplers);
    let rows = compare_rows(images, &names, &headings, args.difference, args.exposure)?;
    headings.insert(0, "reference".into());
    Ok((grid.compose(&headings, &rows.cells)?, Some(rows.sheet)))
}

/// The scene of every tile: one sphere under the lights.
fn describe_scene(args: &Args) -> Result<SceneSpec, Error> {
    let mut scene = SceneSpec::row(&["sphere".to_owned()], 1.0);
    args.scene.apply(&mut scene)?;
    scene.camera = camera();
    Ok(scene)
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
