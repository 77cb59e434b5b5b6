//! `merlkit render`

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use merlkit::Error;
use merlkit::files::Overwrite;
use merlkit::image::Image;
use merlkit::material::Material;
use merlkit::material::merl::LookupRule;
use merlkit::points::PointSet;
use merlkit::render::{Budget, PlanRequest, Refinement, RenderSettings, SceneSpec};
use merlkit_evaluate::report::write_json;
use merlkit_scene::{OptionFile, read_scene};

use crate::camera_args::CameraOptions;
use crate::explanation::explain_plans;
use crate::failure::{Failure, Outcome};
use crate::frames::{FrameOptions, Movie};
use crate::grid::{Cell, Grid, lay_out_spheres};
use crate::output::Destination;
use crate::path_args::PathOptions;
use crate::picture::{Files, Picture, describe_samplers};
use crate::provenance::{self, Checksums};
use crate::render_costs::{CostSummary, RenderCosts};
use crate::render_summary::{RenderResult, error_reached, paths_a_pixel};
use crate::resumable::{self, Resumable};
use crate::sampler_choice::{self, SamplerChoice, choose_samplers, merge_samplers};
use crate::scene_args::SceneOptions;
use crate::scene_input::{SceneInput, find_scene_file};
use crate::strategy_args::StrategyOptions;
use crate::tiles::{Tile, TileFolder, draw_tiles, tile_key};
use crate::{args, batch, output, table};

/// Path-trace a sphere of each material to NAME.exr (linear RGB) and NAME.png (sRGB)
// Without a second paragraph the help has one line or two for each option, instead of three or more.
#[derive(Clone, clap::Args)]
#[command(
    after_help = "Each sphere is drawn alone, so that its pixels don't depend on the other materials. Only the effects that the scene needs are computed; \
                  --explain prints which, and why. The same command gives the same bytes on any number of threads.\n\n\
                  Example:\n  merlkit render nickel teflon --spp 256 --light studio --light point -o spheres"
)]
pub struct Args {
    /// MERL binaries, .bsdf files, built-in names or formulas, one sphere each; or one scene file (.toml, .grf)
    #[arg(required_unless_present = "options", value_name = "MATERIAL")]
    materials: Vec<String>,
    /// Option file (.op) of the thesis's renderer for a scene file, which it may name; options given here go before
    #[arg(help_heading = "Scene", long, value_name = "FILE")]
    options: Option<PathBuf>,
    /// How values between the samples of a table are interpolated [default: floor]
    #[arg(help_heading = "Materials", long, value_name = "floor|linear|centred", hide_possible_values = true, default_value = "floor", hide_default_value = true, value_parser = args::lookup_rule())]
    lookup: LookupRule,
    #[command(flatten, next_help_heading = "Materials")]
    tables: args::TableOptions,
    #[command(flatten, next_help_heading = "Scene")]
    scene: SceneOptions,
    #[command(flatten, next_help_heading = "Scene")]
    camera: CameraOptions,
    /// Put all spheres into one scene, in which they light one another [default: each is drawn alone]
    #[arg(help_heading = "Scene", long, conflicts_with = "columns")]
    together: bool,
    /// Put the spheres on a grey floor
    #[arg(help_heading = "Scene", long = "ground")]
    ground: bool,
    /// Maximum number of surfaces on a path; 1 gives direct light only [default: 8]
    #[arg(help_heading = "Scene", long = "bounces", value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    bounces: Option<u32>,
    /// Print whether each effect is on or off, and why; and what loading, building, drawing and tracing took
    #[arg(help_heading = "Effects", long)]
    explain: bool,
    /// Compute every effect, needed or not; the picture is the same within noise
    #[arg(help_heading = "Effects", long)]
    all_effects: bool,
    /// BRDF sampler, with settings (`merlkit samplers` lists them), or a sampler file; once for all materials, or once for each
    /// [default: half-vector:64KB]
    #[arg(help_heading = "Sampling", long = "sampler", value_name = sampler_choice::VALUE)]
    samplers: Vec<SamplerChoice>,
    #[command(flatten, next_help_heading = "Sampling")]
    paths: PathOptions,
    #[command(flatten, next_help_heading = "Sampling")]
    strategy: StrategyOptions,
    /// Size of the whole picture [default: 320 × 360 pixels a sphere; 480 × 360 for one]
    #[arg(help_heading = "Picture", long, value_name = "WxH", value_parser = args::size)]
    size: Option<(usize, usize)>,
    /// Number of spheres in a row [default: up to 5]
    #[arg(help_heading = "Picture", long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    columns: Option<u32>,
    #[command(flatten, next_help_heading = "Picture")]
    frames: FrameOptions,
    /// Exposure of the PNG in stops [default: 0]
    #[arg(help_heading = "Picture", long, value_name = "EV", default_value_t = 0.0, hide_default_value = true, allow_negative_numbers = true, value_parser = args::stops)]
    exposure: f32,
    /// Finish a picture that Ctrl-C interrupted; the bytes are those of an uninterrupted run
    #[arg(help_heading = "Picture", long)]
    resume: bool,
    /// Also write what the picture cost as JSON to FILE; with -, to standard output instead of the text [default: none]
    #[arg(help_heading = "Picture", long, value_name = "FILE|-")]
    json: Option<Destination>,
    /// Replace existing files [default: refuse]
    #[arg(help_heading = "Picture", long)]
    force: bool,
    /// Output name without extension; .exr and .png are appended [default: render]
    #[arg(help_heading = "Picture", short, long, value_name = "NAME")]
    output: Option<PathBuf>,
}

/// Surfaces on a path, where nothing is said.
const BOUNCES: u32 = 8;
/// The floor's reflectance: a mid grey.
pub const GREY: f32 = 0.35;

pub fn run(args: &Args) -> Outcome {
    let mut args = args.clone();
    let options = args.read_options()?;
    let Some(path) = find_scene_file(&args.materials)? else {
        return match options {
            None => draw(&args, None),
            Some(_) => Err(Error::argument("--options without a scene file", "name one").into()),
        };
    };
    let scene = args.read_scene(&path, options.as_ref())?;
    draw(&args, Some(&scene))
}

impl Args {
    /// Where the picture goes, without extension.
    fn output(&self) -> &Path {
        self.output.as_deref().unwrap_or(Path::new("render"))
    }

    /// Reads the option file. What the command line leaves open, it says: here what no scene is needed for.
    fn read_options(&mut self) -> Result<Option<OptionFile>, Error> {
        let Some(path) = &self.options else {
            return Ok(None);
        };
        let options = OptionFile::read(path)?;
        if self.materials.is_empty() {
            let scene = options.scene.as_ref().ok_or_else(|| {
                let what = format!("{} names no scene", path.display());
                Error::argument(what, "add BPT_SCENE, or name the scene file")
            })?;
            self.materials.push(scene.display().to_string());
        }
        if self.output.is_none() {
            self.output = options.output.as_ref().map(PathBuf::from);
        }
        if options.random && self.paths.points.is_none() {
            self.paths.points = Some(PointSet::Random);
        }
        self.strategy.take_directions(options.directions);
        self.explain |= options.measures;
        Ok(Some(options))
    }

    /// Reads a scene file. What the command line leaves open, its options say, and then the file.
    fn read_scene(
        &mut self,
        path: &Path,
        options: Option<&OptionFile>,
    ) -> Result<SceneInput, Error> {
        if self.together || self.columns.is_some() {
            let what = "--together and --columns have no effect on a scene file";
            return Err(Error::argument(what, "omit them"));
        }
        let mut scene = read_scene(path)?;
        if let Some(options) = options {
            options.apply(&mut scene);
        }
        self.scene.override_file(&mut scene);
        self.camera.override_file(&mut scene.camera)?;
        self.size = self.size.or(scene.size.map(|[w, h]| (w, h)));
        // A target error says how many paths there are.
        if self.paths.target_error.is_none() {
            self.paths.spp = self.paths.spp.or(scene.spp);
        }
        self.bounces = self.bounces.or(scene.bounces);
        SceneInput::build(path, &scene)
    }
}

/// Draws a sphere of each material, or a scene.
fn draw(args: &Args, scene: Option<&SceneInput>) -> Outcome {
    let start = Instant::now();
    let files = Files::named(args.output());
    let names = match scene {
        Some(scene) => scene.spec.materials.clone(),
        None => batch::expand_folders(&args.materials)?,
    };
    let grid = lay_out(args, scene.is_some(), names.len())?;
    let settings = args.paths.settings(grid.tile)?;
    settings.check()?;
    let materials = match args.together && scene.is_none() {
        // Equal names are one material of the scene.
        true => args::resolve(&SceneSpec::row(&names, 1.0).materials, &args.tables)?,
        false => args::resolve(&names, &args.tables)?,
    };
    let mut sums = Checksums::default();
    let files = files.with_provenance(&materials, &mut sums)?;
    let files = match scene {
        Some(scene) => scene.sign(files),
        None => files,
    };
    let said = scene.map(|scene| &scene.samplers[..]).unwrap_or_default();
    let samplers = choose_samplers(&args.samplers, said, &names)?;
    let costs = (args.explain || args.json.is_some()).then(RenderCosts::default);
    let mut pictures = describe(args, scene, &names, &materials, samplers, settings)?;
    for picture in &mut pictures {
        picture.costs = costs.as_ref();
    }
    let is_single = pictures.len() == 1 && args.frames.count().is_none();
    if is_single {
        resumable::check_files(&files, output::overwrite(args.force), args.resume)?;
    }
    check_before(args, &pictures)?;
    let refinement = match is_single {
        true => draw_alone(args, &pictures[0], &files)?,
        false => match args.frames.count() {
            Some(count) => draw_frames(args, &pictures, &grid, &files, &mut sums, count)?,
            None => draw_apart(args, pictures, &grid, &files, &mut sums)?,
        },
    };
    if args.json != Some(Destination::Stdout) {
        report(args, &grid, &settings, refinement.as_ref(), start)?;
    }
    if let Some(costs) = &costs {
        let summary = costs.summarise(start, rayon::current_num_threads());
        tell_costs(args, &grid, &materials, &summary)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Prints what the picture cost, or writes it as JSON.
fn tell_costs(
    args: &Args,
    grid: &Grid,
    materials: &[Material],
    summary: &CostSummary,
) -> Result<(), Failure> {
    if args.explain && args.json != Some(Destination::Stdout) {
        let sheets = [Some(summary.stage_sheet()), summary.sampler_sheet()];
        for sheet in sheets.into_iter().flatten() {
            output::stdout(|out| writeln!(out, "\n{}", table::render(&sheet)))?;
        }
    }
    let Some(destination) = &args.json else {
        return Ok(());
    };
    let [width, height] = grid.size();
    let result = RenderResult {
        files: written_files(args),
        width,
        height,
        frames: args.frames.count().unwrap_or(1),
        costs: summary,
    };
    let provenance = provenance::record_timed(args.paths.seed, materials)?;
    destination.write(output::overwrite(args.force), |out| {
        write_json(out, "render", &provenance, &result)
    })
}

/// The pictures that were written, as the output names them.
fn written_files(args: &Args) -> Vec<String> {
    match args.frames.count() {
        Some(count) => vec![Movie::named(args.output(), count).describe()],
        None => {
            let files = Files::named(args.output());
            vec![
                files.exr.display().to_string(),
                files.png.display().to_string(),
            ]
        }
    }
}

/// Where the spheres are in the picture. A scene is one tile.
fn lay_out(args: &Args, is_scene: bool, spheres: usize) -> Result<Grid, Error> {
    let spheres = if is_scene { 1 } else { spheres };
    if args.together || spheres == 1 {
        let (width, height) = args.size.unwrap_or(((320 * spheres).max(480), 360));
        return Ok(Grid::for_tiles(1, None, [width, height]));
    }
    lay_out_spheres(spheres, args.columns, args.size)
}

/// Refuses, before the work, JSON that can't be written, and samplers that don't suit their materials. Then prints the plans.
fn check_before(args: &Args, pictures: &[Picture<'_>]) -> Result<(), Failure> {
    if let Some(destination) = &args.json {
        destination.check(output::overwrite(args.force))?;
    }
    for picture in pictures {
        picture.check_samplers()?;
    }
    if args.explain && args.json != Some(Destination::Stdout) {
        for sheet in explain_plans(pictures) {
            output::stdout(|out| writeln!(out, "{}", table::render(&sheet)))?;
        }
    }
    Ok(())
}

/// Draws one picture, which can be interrupted at any time.
fn draw_alone(
    args: &Args,
    picture: &Picture<'_>,
    files: &Files,
) -> Result<Option<Refinement>, Failure> {
    let work = Resumable {
        picture,
        files,
        overwrite: output::overwrite(args.force),
        resume: args.resume,
    };
    work.render()
}

/// Prints what was written, and how far the picture came.
fn report(
    args: &Args,
    grid: &Grid,
    settings: &RenderSettings,
    refinement: Option<&Refinement>,
    start: Instant,
) -> Result<(), Failure> {
    output::stdout(|out| {
        for file in written_files(args) {
            writeln!(out, "{file}")?;
        }
        let [w, h] = grid.size();
        let pixels = w * h * args.frames.count().unwrap_or(1);
        let paths = paths_a_pixel(settings, pixels, refinement);
        let seconds = start.elapsed().as_secs_f64();
        writeln!(
            out,
            "{w} × {h} pixels, {paths} paths per pixel, {seconds:.2} s in total"
        )?;
        if let Some(words) = args.scene.finish(args.exposure).warning() {
            writeln!(out, "{words}")?;
        }
        match (refinement, settings.budget) {
            (Some(refinement), Budget::ToError { most, .. }) => {
                writeln!(out, "{}", error_reached(refinement, most))
            }
            _ => Ok(()),
        }
    })
}

/// Draws each sphere by itself and puts them together.
fn draw_apart(
    args: &Args,
    pictures: Vec<Picture<'_>>,
    grid: &Grid,
    files: &Files,
    sums: &mut Checksums,
) -> Result<Option<Refinement>, Failure> {
    let overwrite = match args.resume {
        true => Overwrite::Replace,
        false => output::overwrite(args.force),
    };
    let folder = TileFolder::named(files, args.resume);
    folder.check()?;
    files.check(overwrite)?;
    let mut tiles = Vec::with_capacity(pictures.len());
    let layout = describe_samplers(&pictures);
    for (number, picture) in pictures.into_iter().enumerate() {
        let key = tile_key(picture.materials, sums)?;
        // One material may be there with several samplers.
        let variant = match args.samplers.len() {
            0 | 1 => String::new(),
            _ => format!("-{number}"),
        };
        tiles.push(Tile::new(&key, &variant, picture));
    }
    let drawn = draw_tiles(&folder, &tiles, &layout, |drawn| {
        let is_finished = drawn.finished == tiles.len();
        let images = drawn.read(&folder, &tiles)?;
        let cells: Vec<Cell> = images.into_iter().map(Cell::from).collect();
        let state = resumable::unfinished("some spheres are missing");
        let state = (!is_finished).then_some(state);
        let finish = args.scene.finish(args.exposure);
        files.write(grid.compose(&[], &cells)?, &finish, state, overwrite)?;
        Ok(folder.read_refinement(&tiles)?)
    })?;
    Ok(drawn.flatten())
}

/// A frame of so many, from the tiles of all.
fn compose_frame(
    grid: &Grid,
    folder: &TileFolder,
    tiles: &[Tile<'_>],
    [frame, count]: [usize; 2],
) -> Result<Image, Error> {
    let mut cells = Vec::new();
    for tile in tiles.iter().skip(frame).step_by(count) {
        cells.push(Cell::from(folder.read(tile)?));
    }
    grid.compose(&[], &cells)
}

/// A tile for each sphere and frame, all frames of a sphere before the next one.
fn list_frames<'a>(
    args: &Args,
    pictures: &[Picture<'a>],
    sums: &mut Checksums,
    count: usize,
) -> Result<Vec<Tile<'a>>, Failure> {
    let mut tiles = Vec::with_capacity(pictures.len() * count);
    for (number, picture) in pictures.iter().enumerate() {
        let key = tile_key(picture.materials, sums)?;
        for frame in 0..count {
            let picture = Picture {
                scene: args.frames.turn(&picture.scene, frame),
                ..picture.clone()
            };
            let variant = match args.samplers.len() {
                0 | 1 => format!("_{frame:04}"),
                _ => format!("-{number}_{frame:04}"),
            };
            tiles.push(Tile::new(&key, &variant, picture));
        }
    }
    Ok(tiles)
}

/// Draws the spheres of each frame, all frames of a sphere before the next one, which is then not in memory.
fn draw_frames(
    args: &Args,
    pictures: &[Picture<'_>],
    grid: &Grid,
    files: &Files,
    sums: &mut Checksums,
    count: usize,
) -> Result<Option<Refinement>, Failure> {
    let movie = Movie::named(args.output(), count).with_provenance(&files.provenance);
    let folder = TileFolder::named(files, args.resume);
    folder.check()?;
    let overwrite = match args.resume {
        true => Overwrite::Replace,
        false => output::overwrite(args.force),
    };
    movie.check(overwrite)?;
    let tiles = list_frames(args, pictures, sums, count)?;
    let layout = format!(
        "{}\n{}",
        args.frames.describe(),
        describe_samplers(pictures)
    );
    let finish = args.scene.finish(args.exposure);
    let drawn = draw_tiles(&folder, &tiles, &layout, |drawn| {
        if drawn.finished < tiles.len() {
            return Ok(None);
        }
        movie.write(
            count,
            |frame| compose_frame(grid, &folder, &tiles, [frame, count]),
            &finish,
            overwrite,
        )?;
        Ok(folder.read_refinement(&tiles)?)
    })?;
    Ok(drawn.flatten())
}

/// The pictures to draw, one for each sphere or one of all together; nothing is loaded. `materials` are those of `names`, each once
/// if they are together.
fn describe<'a>(
    args: &'a Args,
    scene: Option<&SceneInput>,
    names: &[String],
    materials: &'a [Material],
    samplers: Vec<SamplerChoice>,
    settings: RenderSettings,
) -> Result<Vec<Picture<'a>>, Error> {
    let mut tiles: Vec<(&[String], &[Material], Vec<SamplerChoice>)> = Vec::new();
    if scene.is_some() {
        tiles.push((names, materials, samplers));
    } else if args.together {
        tiles.push((names, materials, merge_samplers(names, samplers)?));
    } else {
        for (i, sampler) in samplers.into_iter().enumerate() {
            tiles.push((&names[i..=i], &materials[i..=i], vec![sampler]));
        }
    }
    let mut pictures = Vec::with_capacity(tiles.len());
    for (names, materials, samplers) in tiles {
        pictures.push(Picture {
            scene: match scene {
                Some(scene) => finish_scene(args, scene.spec.clone(), materials)?,
                None => describe_row(args, names, materials, &settings)?,
            },
            effects: match args.all_effects {
                true => PlanRequest::Everything,
                false => PlanRequest::AsNeeded,
            },
            materials,
            lookup: args.lookup,
            samplers,
            settings,
            finish: args.scene.finish(args.exposure),
            costs: None,
        });
    }
    Ok(pictures)
}

/// A scene of the spheres of some materials.
fn describe_row(
    args: &Args,
    names: &[String],
    materials: &[Material],
    settings: &RenderSettings,
) -> Result<SceneSpec, Error> {
    let mut spec = SceneSpec::row(names, settings.width as f64 / settings.height as f64);
    args.scene.apply(&mut spec)?;
    spec.camera = args.camera.aim(spec.camera);
    finish_scene(args, spec, materials)
}

/// Puts into a scene what rows of spheres and scene files have in common.
fn finish_scene(
    args: &Args,
    mut spec: SceneSpec,
    materials: &[Material],
) -> Result<SceneSpec, Error> {
    args.scene.apply_settings(&mut spec);
    spec.mirrors = args::find_mirrors(materials)?;
    spec.floor = args.ground.then_some(GREY);
    spec.depth = args.bounces.unwrap_or(BOUNCES);
    spec.strategy = args.strategy.resolve()?;
    spec.directions = args.strategy.directions.unwrap_or(1);
    Ok(spec)
}
