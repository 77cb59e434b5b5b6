//! `merlkit explore`

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::mpsc::channel;

use merlkit::Error;
use merlkit::files::check_writable;
use merlkit::material::LookupRule;
use merlkit_explore::{Explorer, Session, StoredPage, open_in_browser};

use crate::failure::{Failure, Outcome};
use crate::{args, interrupt, output};

/// Show a BRDF and its samplers on a page in the browser
///
/// The page shows the lobe, the albedo, what samplers draw, their tables, environments, fits and formulas with sliders. A server on this
/// machine computes what it asks for, exactly as the other commands do. Only 127.0.0.1 reaches it, and only with the token in the
/// printed address. Ctrl-C ends it.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  merlkit explore nickel\n  merlkit explore nickel ward:sx=0.1,sy=0.3 --no-open --port 8080\n  \
                  merlkit explore nickel --mesh bunny.obj\n  \
                  merlkit explore nickel teflon --export page.html"
)]
pub struct Args {
    /// MERL binaries, .bsdf files or folders of either, names of built-in materials, or formulas
    #[arg(value_name = "MATERIAL", default_value = "nickel")]
    materials: Vec<String>,
    /// How values between the samples of a table are interpolated
    #[arg(help_heading = "Materials", long, value_name = "floor|linear|centred", hide_possible_values = true, default_value = "floor", value_parser = args::lookup_rule())]
    lookup: LookupRule,
    #[command(flatten, next_help_heading = "Materials")]
    tables: args::TableOptions,
    /// OBJ, PLY or glTF file of a mesh that is shown in place of the sphere; repeatable [default: the sphere]
    #[arg(help_heading = "Page", long = "mesh", value_name = "FILE")]
    meshes: Vec<PathBuf>,
    /// Port of 127.0.0.1; 0 takes any that is free
    #[arg(help_heading = "Page", long, value_name = "N", default_value_t = 0)]
    port: u16,
    /// Print the address without opening a browser [default: open it]
    #[arg(help_heading = "Page", long)]
    no_open: bool,
    /// Write the page with answers for a grid of angles to FILE, which needs no server, and end [default: serve]
    #[arg(help_heading = "Page", long, value_name = "FILE", conflicts_with_all = ["port", "no_open"])]
    export: Option<PathBuf>,
    /// Replace an existing FILE [default: refuse]
    #[arg(help_heading = "Page", long, requires = "export")]
    force: bool,
}

pub fn run(args: &Args) -> Outcome {
    let materials = args::resolve(&args.materials, &args.tables)?;
    args::refuse_repeated(&materials)?;
    let session = Session::new(&materials, args.lookup)?;
    for path in &args.meshes {
        session.add_mesh(path)?;
    }
    match &args.export {
        Some(path) => export(args, &session, path),
        None => serve(args, session),
    }
}

/// Writes the page with its answers.
fn export(args: &Args, session: &Session, path: &Path) -> Outcome {
    let overwrite = output::overwrite(args.force);
    check_writable(path, overwrite)?;
    let page = StoredPage::compute(session).map_err(|refusal| {
        Error::argument(
            refusal.message,
            "leave the material out, or explore it live",
        )
    })?;
    let bytes = page.write(path, overwrite)?;
    output::stdout(|out| {
        let megabytes = bytes as f64 / 1e6;
        writeln!(
            out,
            "wrote {}: {} answers, {megabytes:.1} MB",
            path.display(),
            page.keys().len()
        )
    })?;
    Ok(ExitCode::SUCCESS)
}

/// Serves the page until Ctrl-C.
fn serve(args: &Args, session: Session) -> Outcome {
    let explorer = Explorer::bind(session, args.port)?;
    let address = explorer.address();
    let stopper = explorer.stopper();
    let (ended, has_ended) = channel();
    interrupt::run_until_stopped(move || {
        stopper.stop();
        // A server that ended by itself has said by that how it ended.
        has_ended.recv().unwrap_or(Ok(()))
    });
    output::stdout(|out| writeln!(out, "{address}"))?;
    output::message("Ctrl-C ends the server");
    if !args.no_open
        && let Err(error) = open_in_browser(&address)
    {
        output::message(&format!("merlkit: {error}"));
    }
    let outcome = explorer.run().map_err(Failure::from);
    if ended.send(outcome).is_ok() {
        interrupt::finish()?;
        interrupt::wait_if_stopping();
    }
    Ok(ExitCode::SUCCESS)
}
