//! `merlkit man`

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use merlkit::Error;
use merlkit::files::write_new;

use crate::failure::Outcome;
use crate::output;

/// Print the manual page of merlkit or of one command, or write all pages to a folder
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
                        merlkit man render | man -l -\n  \
                        merlkit man -o ~/.local/share/man/man1")]
pub struct Args {
    /// Command whose page is printed [default: merlkit itself]
    #[arg(value_name = "COMMAND", conflicts_with = "output")]
    command: Option<String>,
    /// Write all pages to the folder DIR; created if missing
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace existing pages [default: refuse]
    #[arg(long)]
    force: bool,
}

pub fn run(args: &Args, mut cli: clap::Command) -> Outcome {
    // Names such as merlkit-render, and options of all commands, are only set in a finished definition.
    cli.build();
    let Some(folder) = &args.output else {
        let page = manual_page(find_command(&cli, args.command.as_deref())?)?;
        output::stdout(|out| out.write_all(&page))?;
        return Ok(ExitCode::SUCCESS);
    };
    std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, "create", e))?;
    for command in std::iter::once(&cli).chain(cli.get_subcommands()) {
        let page = manual_page(command)?;
        let file = folder.join(format!("{}.1", full_name(command)));
        write_new(&file, output::overwrite(args.force), |out| {
            out.write_all(&page)
                .map_err(|e| Error::io(&file, "write", e))
        })?;
        output::stdout(|out| writeln!(out, "{}", file.display()))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The command of that name, or the one that holds all.
fn find_command<'a>(
    cli: &'a clap::Command,
    name: Option<&str>,
) -> Result<&'a clap::Command, Error> {
    let Some(name) = name else {
        return Ok(cli);
    };
    cli.find_subcommand(name).ok_or_else(|| {
        Error::argument(
            format!("merlkit has no command {name}"),
            "`merlkit --help` lists the commands",
        )
    })
}

/// The name of a page, as merlkit-render.
fn full_name(command: &clap::Command) -> &str {
    command
        .get_display_name()
        .unwrap_or_else(|| command.get_name())
}

/// The page in roff, which `man` reads.
fn manual_page(command: &clap::Command) -> Result<Vec<u8>, Error> {
    let mut page = Vec::new();
    let man = clap_mangen::Man::new(command.clone());
    man.render(&mut page)
        .map_err(|e| Error::io(Path::new(full_name(command)), "format", e))?;
    Ok(page)
}
