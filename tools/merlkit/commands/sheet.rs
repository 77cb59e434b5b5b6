//! `merlkit sheet`

use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use merlkit::Error;
use merlkit::color::Rgb;
use merlkit::files::{Overwrite, RegularFile, write_new};
use merlkit::glam::DVec3;
use merlkit::image::{Image, MAX_PIXELS, read_exr, write_exr};
use merlkit::material::{LookupRule, Material, Origin};
use merlkit::points::PointSet;
use merlkit::render::{Budget, Camera, PlanRequest, RenderSettings, SceneSpec, render};
use merlkit::sampler::SamplerSpec;

use crate::args;
use crate::failure::{Failure, Outcome};
use crate::interrupt::StoppableWork;
use crate::labels::Label;
use crate::output;
use crate::picture::{Files, Picture};
use crate::progress::Progress;
use crate::resumable::map_file;
use crate::sampler_args;

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
    /// Light, as of `merlkit render` [default: environment]
    #[arg(
        help_heading = "Picture",
        long = "light",
        value_name = "LIGHT",
        default_value = "environment",
        hide_default_value = true
    )]
    lights: Vec<String>,
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
/// Height of a line of text.
const LABEL: usize = 12;
/// Radiance of the letters.
const INK: Rgb = Rgb::ONE;
/// The fraction of the tile's height that the sphere takes.
const FILLED: f64 = 0.92;
/// The angle under which a tile is seen: so small that nearly half of the sphere shows.
const ANGLE: f64 = 4.0;

const STOPPING: &str = "merlkit: stopping after this sphere (press Ctrl-C again to stop now)";

pub fn run(args: &Args) -> Outcome {
    let start = Instant::now();
    let (materials, unreadable) = args.materials.resolve()?;
    args::refuse_repeated(&materials)?;
    for material in &materials {
        args.sampler.check_supports(&material.facts()?)?;
    }
    let grid = Grid::new(args, materials.len())?;
    let files = Files::named(&args.output);
    let scene = describe_scene(args)?;
    let tiles = TileFolder::open(args, &files, &scene)?;
    let work = StoppableWork::begin(STOPPING);
    let outcome = match draw_tiles(args, &scene, &materials, &tiles, &work) {
        Ok(Some(drawn)) => finish(args, &grid, &materials, &drawn, &files, &tiles),
        Ok(None) => Ok(()),
        Err(error) => {
            tiles.remove_without_spheres();
            Err(error.into())
        }
    };
    work.end(outcome)?;
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

/// Draws each sphere, or reads it back; `None` if a signal came first.
fn draw_tiles(
    args: &Args,
    scene: &SceneSpec,
    materials: &[Material],
    tiles: &TileFolder,
    work: &StoppableWork,
) -> Result<Option<Vec<Image>>, Error> {
    let progress = Progress::new("drawing", materials.len());
    let mut drawn = Vec::with_capacity(materials.len());
    for material in materials {
        if work.should_stop() {
            output::message(&format!(
                "merlkit: {} of {} spheres are kept in {}; the same command with --resume goes on",
                drawn.len(),
                materials.len(),
                tiles.folder.display()
            ));
            return Ok(None);
        }
        let path = tiles.path_of(material)?;
        let tile = if path.exists() {
            read_exr(&path)?
        } else {
            let tile = draw_sphere(args, scene, material)?;
            write_exr(&path, &tile, Overwrite::Replace)?;
            tile
        };
        drawn.push(tile);
        progress.advance();
    }
    Ok(Some(drawn))
}

/// The scene of every tile: one sphere under the lights.
fn describe_scene(args: &Args) -> Result<SceneSpec, Error> {
    let mut scene = SceneSpec::row(&["sphere".to_owned()], 1.0);
    let lights = args.lights.iter().map(|name| scene.light(name));
    scene.lights = lights.collect::<Result<_, _>>()?;
    scene.camera = camera();
    Ok(scene)
}

/// The sphere of one material.
fn draw_sphere(args: &Args, scene: &SceneSpec, material: &Material) -> Result<Image, Error> {
    let materials = std::slice::from_ref(material);
    let scene = SceneSpec {
        mirrors: args::find_mirrors(materials)?,
        ..scene.clone()
    };
    let picture = Picture {
        scene: &scene,
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
        exposure: args.exposure,
    };
    let rendered = render(&picture.load()?, &picture.settings, &|_| {})?;
    rendered.film.to_image()
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

/// Where tiles are on the sheet.
struct Grid {
    columns: usize,
    tile: usize,
    label: usize,
    width: usize,
    height: usize,
}

impl Grid {
    fn new(args: &Args, count: usize) -> Result<Self, Error> {
        let square = (count as f64).sqrt().ceil() as usize;
        let columns = args
            .columns
            .map_or(square, |n| n as usize)
            .min(count)
            .max(1);
        let tile = args.size as usize;
        let label = if args.no_labels { 0 } else { LABEL };
        let rows = count.div_ceil(columns);
        let width = columns * (tile + GAP) + GAP;
        let height = rows * (tile + label + GAP) + GAP;
        if width.saturating_mul(height) > MAX_PIXELS {
            return Err(Error::argument(
                format!("a sheet of {width} × {height} pixels"),
                format!("choose a smaller --size; a picture has at most {MAX_PIXELS} pixels"),
            ));
        }
        Ok(Self {
            columns,
            tile,
            label,
            width,
            height,
        })
    }

    /// Upper left corner of a tile.
    fn corner(&self, number: usize) -> (usize, usize) {
        let (column, row) = (number % self.columns, number / self.columns);
        (
            GAP + column * (self.tile + GAP),
            GAP + row * (self.tile + self.label + GAP),
        )
    }

    /// All tiles on black, each with its name below.
    fn compose(&self, tiles: &[Image], names: &[&str]) -> Result<Image, Error> {
        let mut pixels = vec![Rgb::ZERO; self.width * self.height];
        for (number, (tile, name)) in tiles.iter().zip(names).enumerate() {
            let (left, top) = self.corner(number);
            for y in 0..self.tile {
                for x in 0..self.tile {
                    pixels[(top + y) * self.width + left + x] = tile.pixel(x, y);
                }
            }
            let label = Label::new(name, self.tile, self.label);
            for y in 0..self.label {
                for x in 0..self.tile {
                    if label.is_inked(x, y) {
                        pixels[(top + self.tile + y) * self.width + left + x] = INK;
                    }
                }
            }
        }
        Image::new(self.width, self.height, pixels)
    }
}

/// What is written under a sphere: the name of a material, or the text of a formula.
fn label_of(material: &Material) -> &str {
    match material.origin() {
        Origin::Formula(text) => text,
        _ => material.name(),
    }
}

/// Writes the sheet; what it needed to go on is needed no more.
fn finish(
    args: &Args,
    grid: &Grid,
    materials: &[Material],
    tiles: &[Image],
    files: &Files,
    folder: &TileFolder,
) -> Result<(), Failure> {
    for (tile, material) in tiles.iter().zip(materials) {
        if (tile.width(), tile.height()) != (grid.tile, grid.tile) {
            return Err(Error::argument(
                format!("{} has another size", folder.path_of(material)?.display()),
                "remove it",
            )
            .into());
        }
    }
    let names: Vec<&str> = materials.iter().map(label_of).collect();
    let image = grid.compose(tiles, &names)?;
    files.write(&image, args.exposure, output::overwrite(args.force))?;
    folder.remove()?;
    Ok(())
}

/// Finished spheres of a sheet that is not.
struct TileFolder {
    folder: PathBuf,
}

/// The settings that all tiles of a folder were drawn with.
const SETTINGS: &str = "settings.txt";

impl TileFolder {
    /// Makes the folder, or with --resume goes on with it if it was made with the same settings.
    fn open(args: &Args, files: &Files, scene: &SceneSpec) -> Result<Self, Error> {
        let folder = files.exr.with_extension("tiles");
        let shown = folder.display();
        match (args.resume, folder.exists()) {
            (true, false) => {
                return Err(Error::argument(
                    format!("nothing to resume: there is no {shown}"),
                    "omit --resume to start a new sheet, or name the output of the interrupted one",
                ));
            }
            (false, true) => {
                return Err(Error::argument(
                    format!("{shown} holds the spheres of an interrupted sheet"),
                    "continue with --resume, or remove the folder to start again",
                ));
            }
            _ => {}
        }
        files.check(output::overwrite(args.force))?;
        let settings = describe_settings(args, scene)?;
        let record = folder.join(SETTINGS);
        if args.resume {
            let found = fs::read_to_string(&record).map_err(|e| Error::io(&record, "read", e))?;
            if found != settings {
                return Err(Error::argument(
                    format!("{shown} was drawn with other settings:\n{found}"),
                    "repeat the command that was interrupted, or remove the folder to start again",
                ));
            }
        } else {
            fs::create_dir_all(&folder).map_err(|e| Error::io(&folder, "create", e))?;
            write_new(&record, Overwrite::Refuse, |out| {
                let written = out.write_all(settings.as_bytes());
                written.map_err(|e| Error::io(&record, "write", e))
            })?;
        }
        Ok(Self { folder })
    }

    /// The file of a material's sphere: its name and its checksum, so that a changed material is drawn again.
    fn path_of(&self, material: &Material) -> Result<PathBuf, Error> {
        let sum = material.sha256()?;
        let name = format!("{}-{}.exr", material.name(), &sum[..16.min(sum.len())]);
        Ok(self.folder.join(name))
    }

    /// After a failure: a folder without a finished sphere has nothing to go on with. If it can't be removed, the next run says
    /// that it is there.
    fn remove_without_spheres(&self) {
        let entries = fs::read_dir(&self.folder).map_or(0, Iterator::count);
        if entries <= 1 {
            let _ = self.remove();
        }
    }

    fn remove(&self) -> Result<(), Error> {
        fs::remove_dir_all(&self.folder).map_err(|e| Error::io(&self.folder, "remove", e))
    }
}

/// All that the pixels of a tile follow from, apart from the material.
fn describe_settings(args: &Args, scene: &SceneSpec) -> Result<String, Error> {
    let Args {
        lookup,
        lights,
        size,
        sampler,
        spp,
        seed,
        ..
    } = args;
    let mut text = format!(
        "merlkit {}\nsampler {sampler}\nlookup {}\ntables {}\nlights {}\nsize {size}\npaths {spp}\nseed {seed}\n",
        env!("CARGO_PKG_VERSION"),
        lookup.name(),
        args.materials.tables().words().join(" "),
        lights.join(" "),
    );
    for path in scene.lights.iter().filter_map(map_file) {
        text += &format!("map {}\n", RegularFile::open(path)?.sha256()?);
    }
    Ok(text)
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
