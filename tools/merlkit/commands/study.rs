//! `merlkit study`

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use merlkit::Error;
use merlkit::files::{Overwrite, RegularFile, check_writable, write_new};
use merlkit::image::{Image, write_exr, write_png};
use merlkit_evaluate::report::write_shared_json;
use merlkit_evaluate::study::{
    PlannedTask, Shard, StudyBench, StudyFolder, StudyPlan, StudySpec, StudyTable, StudyTask,
    TileTask, merge_study,
};

use crate::failure::{Failure, Outcome};
use crate::progress::Progress;
use crate::provenance::write_command;
use crate::{batch, output};

/// Study many materials on many machines: a list of independent tasks, run in parts and put together
///
/// `plan` writes the list of tasks to DIR/plan.json, `run` runs them or a part of them, and `merge` makes one table of all results
/// and whole pictures of their tiles. A task's result is a file in DIR/results that is called by the task's key. It appears whole or
/// not at all, and a task whose file is there is not run again: after an interruption, give the same command again. Results have the same bytes
/// for any number of parts and threads. `python3 -m merlkit.study` runs the same plans to the same bytes.
#[derive(clap::Args)]
#[command(
    after_help = "A study is a TOML file, or a JSON file with the same names; what is left out has the value after #, and without \
                  samplers, thetas, checks, models or [pictures] their tasks are left out:\n\n\
                  \u{20}   materials = [\"nickel\", \"measured\"]   # names, formulas, files or folders\n\
                  \u{20}   lookup = \"floor\"\n\
                  \u{20}   samplers = [\"half-vector:64KB\", \"cosine\"]\n\
                  \u{20}   thetas = [10, 60]      # polar angles of wo in degrees: estimates of the albedo\n\
                  \u{20}   seeds = 1              # seeds 1 to this\n\
                  \u{20}   draws = 10000          # of each estimate and check\n\
                  \u{20}   checks = false         # the checks of `merlkit check`\n\
                  \u{20}   models = [\"ggx\"]       # fits of each material\n\
                  \u{20}   [pictures]             # those of `merlkit render`, for each material and sampler\n\
                  \u{20}   lights = [\"environment\"]\n\
                  \u{20}   size = [480, 360]\n\
                  \u{20}   tile = 120             # pixels of a tile's sides; a tile is a task\n\
                  \u{20}   spp = 64\n\
                  \u{20}   bounces = 8\n\
                  \u{20}   seed = 0\n\n\
                  Examples:\n  merlkit study plan study.toml -o study\n  merlkit study run study --shard 3/8\n  merlkit study merge study -o results"
)]
pub struct Args {
    #[command(subcommand)]
    step: Step,
}

#[derive(clap::Subcommand)]
enum Step {
    Plan(PlanArgs),
    Run(RunArgs),
    Merge(MergeArgs),
}

/// Write the list of tasks
#[derive(clap::Args)]
#[command(after_help = "Example:\n  merlkit study plan study.toml -o study")]
struct PlanArgs {
    /// The study: TOML, or JSON if its name ends in .json (`merlkit help study` shows one)
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Folder of the study; created if missing
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Replace an existing plan; results of tasks that are in both are kept [default: refuse]
    #[arg(long)]
    force: bool,
}

/// Run the tasks whose results are missing, or a part of them
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  merlkit study run study --shard 3/8\n  merlkit study run study --shard $SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT   # with --array=1-8"
)]
struct RunArgs {
    /// Folder of the study
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Part I of N, from 1/N to N/N: neighbours in the plan, which have materials in common [default: 1/1]
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Run the task of this key only; repeatable
    #[arg(long = "task", value_name = "KEY", conflicts_with = "shard")]
    tasks: Vec<String>,
}

/// Put all results together: study.csv, study.json and pictures
#[derive(clap::Args)]
#[command(
    after_help = "If results are missing, the commands that make them are printed, and the exit status is 1.\n\n\
                  Example:\n  merlkit study merge study -o results"
)]
struct MergeArgs {
    /// Folder of the study
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Folder of the table and the pictures; created if missing
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Replace existing files [default: refuse]
    #[arg(long)]
    force: bool,
}

/// Bytes of a study's file, at most.
const MOST_BYTES: u64 = 1 << 28;
/// Missing tasks that are named, at most.
const MOST_NAMED: usize = 20;

pub fn run(args: &Args) -> Outcome {
    match &args.step {
        Step::Plan(args) => write_plan(args),
        Step::Run(args) => run_tasks(args),
        Step::Merge(args) => merge(args),
    }
}

fn plan_file(folder: &Path) -> PathBuf {
    folder.join("plan.json")
}

fn results_of(folder: &Path) -> StudyFolder {
    StudyFolder::new(&folder.join("results"))
}

fn write_plan(args: &PlanArgs) -> Outcome {
    let path = plan_file(&args.output);
    let overwrite = output::overwrite(args.force);
    if path.exists() {
        check_writable(&path, overwrite)?;
    }
    let mut spec = read_spec(&args.file)?;
    spec.materials = batch::expand_folders(&spec.materials)?;
    let plan = spec.plan()?;
    let folder = &args.output;
    std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, "create", e))?;
    write_new(&path, overwrite, |out| {
        plan.write(out).map_err(|e| Error::io(&path, "write", e))
    })?;
    let count = plan.tasks().len();
    output::stdout(|out| writeln!(out, "{}: {count} tasks", path.display()))?;
    Ok(ExitCode::SUCCESS)
}

fn read_spec(path: &Path) -> Result<StudySpec, Error> {
    let bytes = RegularFile::open(path)?.read_all(MOST_BYTES)?;
    let parsed = match path
        .extension()
        .is_some_and(|extension| extension == "json")
    {
        true => serde_json::from_slice(&bytes).map_err(|e| e.to_string()),
        false => match std::str::from_utf8(&bytes) {
            Ok(text) => toml::from_str(text).map_err(|e| e.to_string()),
            Err(error) => Err(error.to_string()),
        },
    };
    parsed.map_err(|reason| {
        Error::argument(
            format!("{} is no study: {}", path.display(), reason.trim_end()),
            "`merlkit help study` shows one",
        )
    })
}

fn run_tasks(args: &RunArgs) -> Outcome {
    let plan = StudyPlan::read(&plan_file(&args.folder))?;
    let results = results_of(&args.folder);
    results.create()?;
    let chosen = choose_tasks(args, &plan)?;
    let mut missing = Vec::new();
    for planned in &chosen {
        if !results.holds(planned) {
            missing.push(*planned);
        }
    }
    let progress = Progress::new("running", missing.len());
    let mut bench = StudyBench::default();
    let mut failed = 0;
    for planned in &missing {
        // A damaged file keeps no other material from being done.
        let outcome = bench.run(&planned.task);
        if let Err(error) = outcome.and_then(|result| results.keep(planned, &result)) {
            output::message(&format!("merlkit: {}: {error}", planned.key));
            failed += 1;
        }
        progress.advance();
    }
    drop(progress);
    let (ran, there) = (missing.len() - failed, chosen.len() - missing.len());
    output::stdout(|out| {
        let folder = args.folder.display();
        write!(out, "{folder}: {ran} tasks run, {there} were done before")?;
        match failed {
            0 => writeln!(out),
            _ => writeln!(out, ", {failed} failed"),
        }
    })?;
    Ok(ExitCode::from(if failed == 0 { 0 } else { 2 }))
}

/// The tasks of the part, or those of the keys.
fn choose_tasks<'a>(args: &RunArgs, plan: &'a StudyPlan) -> Result<Vec<&'a PlannedTask>, Error> {
    if args.tasks.is_empty() {
        let shard = args.shard.unwrap_or(Shard::ALL);
        return Ok(plan.shard(shard).iter().collect());
    }
    let mut chosen = Vec::new();
    for key in &args.tasks {
        let planned = plan.tasks().iter().find(|planned| planned.key == *key);
        chosen.push(planned.ok_or_else(|| {
            Error::argument(
                format!("the plan has no task {key}"),
                "`merlkit study merge` names those that are missing",
            )
        })?);
    }
    Ok(chosen)
}

fn merge(args: &MergeArgs) -> Outcome {
    let plan = StudyPlan::read(&plan_file(&args.folder))?;
    let results = results_of(&args.folder);
    let missing = results.missing(&plan);
    if !missing.is_empty() {
        name_missing(&args.folder, &missing, plan.tasks().len());
        return Ok(ExitCode::from(1));
    }
    let folder = &args.output;
    let overwrite = output::overwrite(args.force);
    std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, "create", e))?;
    let [csv, json] = ["study.csv", "study.json"].map(|name| folder.join(name));
    check_writable(&csv, overwrite)?;
    check_writable(&json, overwrite)?;
    let progress = Progress::new("putting pictures together", count_pictures(&plan));
    let mut pictures = 0;
    let table = merge_study(&plan, &results, &mut |task, name, image| {
        pictures += 1;
        progress.advance();
        write_picture(folder, task, name, image, overwrite)
    })?;
    drop(progress);
    write_table(&table, &csv, &json, overwrite)?;
    output::stdout(|out| {
        writeln!(out, "{}\n{}", csv.display(), json.display())?;
        match pictures {
            0 => Ok(()),
            _ => writeln!(out, "{pictures} pictures in {}", folder.display()),
        }
    })?;
    Ok(ExitCode::SUCCESS)
}

/// How many pictures there are: each has a tile that begins at its corner.
fn count_pictures(plan: &StudyPlan) -> usize {
    let tasks = plan.tasks().iter();
    tasks
        .filter(|planned| matches!(&planned.task, StudyTask::Tile(tile) if tile.corner == [0, 0]))
        .count()
}

/// Prints the commands that make what is missing.
fn name_missing(folder: &Path, missing: &[&PlannedTask], all: usize) {
    let folder = folder.to_string_lossy().into_owned();
    let command = ["study".into(), "run".into(), folder];
    output::message(&format!(
        "merlkit: {} of {all} results are missing. This command makes all of them: {}\nThese make one each:",
        missing.len(),
        write_command(&command)
    ));
    for planned in missing.iter().take(MOST_NAMED) {
        let mut words = command.to_vec();
        words.extend(["--task".into(), planned.key.clone()]);
        output::message(&write_command(&words));
    }
    if missing.len() > MOST_NAMED {
        output::message(&format!("and {} more", missing.len() - MOST_NAMED));
    }
}

/// Writes NAME.exr and NAME.png, and returns the name of the first.
fn write_picture(
    folder: &Path,
    task: &TileTask,
    name: &str,
    image: Image,
    overwrite: Overwrite,
) -> Result<String, Error> {
    let version = env!("CARGO_PKG_VERSION");
    let command = write_command(&rendering_words(task));
    let image = image.with_comment(format!("merlkit {version}\ncommand: {command}"));
    let exr = format!("{name}.exr");
    write_exr(&folder.join(&exr), &image, overwrite)?;
    write_png(&folder.join(format!("{name}.png")), &image, 0.0, overwrite)?;
    Ok(exr)
}

/// The arguments of the command that draws the same pixels.
fn rendering_words(task: &TileTask) -> Vec<String> {
    let [width, height] = task.picture;
    let mut words = vec!["render".into(), task.material.clone()];
    for (option, value) in [
        ("--lookup", task.lookup.name().to_owned()),
        ("--sampler", task.sampler.clone()),
        ("--spp", task.spp.to_string()),
        ("--bounces", task.bounces.to_string()),
        ("--seed", task.seed.to_string()),
        ("--size", format!("{width}x{height}")),
    ] {
        words.extend([option.into(), value]);
    }
    for light in &task.lights {
        words.extend(["--light".into(), light.clone()]);
    }
    words
}

fn write_table(
    table: &StudyTable,
    csv: &Path,
    json: &Path,
    overwrite: Overwrite,
) -> Result<(), Failure> {
    let sheet = table.sheet();
    write_new(csv, overwrite, |out| {
        sheet.write_csv(out).map_err(|e| Error::io(csv, "write", e))
    })?;
    write_new(json, overwrite, |out| {
        write_shared_json(out, "study", table).map_err(|e| Error::io(json, "write", e))
    })?;
    Ok(())
}
