//! `merlkit thesis`

use std::path::PathBuf;
use std::process::ExitCode;

use merlkit::Error;
use merlkit::files::{Overwrite, check_writable, write_new};
use merlkit_evaluate::report::{Provenance, ThesisDocument, thesis_page, write_json};
use merlkit_evaluate::thesis::{
    Exhibit, Experiment, PieceFolder, PlanMesh, ThesisBench, ThesisPlan,
};

use crate::failure::{Failure, Outcome};
use crate::output::{self, Destination};
use crate::progress::Progress;
use crate::{provenance, table};

/// Repeat the experiments of the thesis (R. Montes, 2008), with its figures next to ours
///
/// An EXPERIMENT is a table, a section or a scene of the thesis; --list names them. All are repeated unless some are named. The
/// page DIR/thesis.html has the thesis's figures as printed next to those of this run, says how ours were measured and what differs,
/// and what agrees.
///
/// Finished pieces are kept in DIR/pieces. After an interruption, or to add experiments, give the same command again: pieces that
/// are there are not measured again. Pieces of other options, of another version or of another machine are refused.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  merlkit thesis 6.23 6.24 --quick -o thesis")]
pub struct Args {
    /// Tables, sections or scenes, such as 6.23 or scene-2 [default: all]
    #[arg(value_name = "EXPERIMENT")]
    experiments: Vec<String>,
    /// List the experiments and do nothing else
    #[arg(long)]
    list: bool,
    /// Use fewer trees, cells, pixels and samples: a few minutes for everything on two idle cores instead of hours
    #[arg(help_heading = "Measurement", long)]
    quick: bool,
    /// Pixels per side of a picture of one object, 4 to 1024 [default: 128; with --quick 40]
    #[arg(help_heading = "Measurement", long, value_name = "N", value_parser = clap::value_parser!(u16).range(4..=1024))]
    side: Option<u16>,
    /// Mesh of scene 3, in place of a displaced sphere: OBJ, PLY or glTF with +y up, scaled to fit [default: none]
    #[arg(help_heading = "Measurement", long, value_name = "FILE")]
    mesh: Option<PathBuf>,
    /// Seed of the draws
    #[arg(
        help_heading = "Measurement",
        long,
        value_name = "K",
        default_value_t = 1
    )]
    seed: u64,
    /// Folder for the page and the finished pieces
    #[arg(
        help_heading = "Output",
        short,
        long,
        value_name = "DIR",
        default_value = "thesis"
    )]
    output: PathBuf,
    /// Also write JSON to FILE; with -, write JSON to standard output instead of the findings [default: none]
    #[arg(help_heading = "Output", long, value_name = "FILE|-")]
    json: Option<Destination>,
    /// Start again: discard finished pieces and replace existing files [default: continue]
    #[arg(help_heading = "Output", long)]
    force: bool,
}

pub fn run(args: &Args) -> Outcome {
    if args.list {
        list()?;
        return Ok(ExitCode::SUCCESS);
    }
    let experiments = chosen(&args.experiments)?;
    let overwrite = output::overwrite(args.force);
    if let Some(json) = &args.json {
        json.check(overwrite)?;
    }
    let provenance = provenance::record_timed(args.seed, &[])?;
    let plan = plan(args, &provenance)?;
    let page = args.output.join("thesis.html");
    let folder = args.output.join("pieces");
    // A page next to pieces is one of theirs, which a run that goes on replaces.
    let page_overwrite = match folder.join("plan.json").exists() {
        true => Overwrite::Replace,
        false => overwrite,
    };
    std::fs::create_dir_all(&args.output).map_err(|e| Error::io(&args.output, "create", e))?;
    check_writable(&page, page_overwrite)?;
    let today = provenance.date.clone().unwrap_or_default();
    let pieces = PieceFolder::open(&folder, &plan, &today, args.force)?;
    let mut bench = ThesisBench { plan, pieces };
    let mut exhibits = Vec::new();
    let progress = Progress::new("repeating", experiments.len());
    for experiment in &experiments {
        exhibits.push(experiment.run(&mut bench)?);
        progress.advance();
    }
    drop(progress);
    let begun = bench.pieces.begun().to_owned();
    let text = thesis_page(&exhibits, &bench.plan, &begun, &provenance);
    write_new(&page, page_overwrite, |out| {
        let written = out.write_all(text.as_bytes());
        written.map_err(|e| Error::io(&page, "write", e))
    })?;
    if let Some(json) = &args.json {
        write_results(json, overwrite, &bench, &exhibits, &provenance)?;
    }
    if args.json != Some(Destination::Stdout) {
        print(&exhibits, &bench, &page)?;
    }
    Ok(ExitCode::SUCCESS)
}

fn write_results(
    json: &Destination,
    overwrite: Overwrite,
    bench: &ThesisBench,
    exhibits: &[Exhibit],
    provenance: &Provenance,
) -> Result<(), Failure> {
    let results = ThesisDocument {
        plan: &bench.plan,
        begun: bench.pieces.begun(),
        experiments: exhibits,
    };
    json.write(overwrite, |out| {
        write_json(out, "thesis", provenance, &results)
    })
}

/// The experiments of these names, each once; all without names.
fn chosen(names: &[String]) -> Result<Vec<Experiment>, Error> {
    if names.is_empty() {
        return Ok(Experiment::all().to_vec());
    }
    let mut chosen: Vec<Experiment> = Vec::new();
    for name in names {
        let found = Experiment::find(name)?;
        if chosen.iter().all(|known| known.name != found.name) {
            chosen.push(found);
        }
    }
    Ok(chosen)
}

/// How much is run, and of which mesh.
fn plan(args: &Args, provenance: &Provenance) -> Result<ThesisPlan, Error> {
    let machine = provenance.machine.as_ref();
    let processor = machine.map_or_else(String::new, |machine| machine.sentence());
    let mut plan = match args.quick {
        true => ThesisPlan::quick(args.seed, &processor),
        false => ThesisPlan::full(args.seed, &processor),
    };
    if let Some(side) = args.side {
        plan.side = side.into();
    }
    if let Some(path) = &args.mesh {
        plan.mesh = Some(PlanMesh::read(path)?);
    }
    Ok(plan)
}

fn list() -> Result<(), Failure> {
    output::stdout(|out| {
        for experiment in Experiment::all() {
            writeln!(out, "{:13} {}", experiment.name, experiment.title)?;
        }
        Ok(())
    })
}

/// Prints the findings, and where the rest is.
fn print(exhibits: &[Exhibit], bench: &ThesisBench, page: &std::path::Path) -> Result<(), Failure> {
    let [there, measured] = bench.pieces.counts();
    output::stdout(|out| {
        for exhibit in exhibits {
            writeln!(out, "{}", exhibit.title)?;
            for finding in &exhibit.findings {
                write!(out, "{}", table::wrap(&format!("- {finding}")))?;
            }
            writeln!(out)?;
        }
        writeln!(
            out,
            "{}: {measured} pieces measured, {there} were finished before",
            page.display()
        )
    })
}
