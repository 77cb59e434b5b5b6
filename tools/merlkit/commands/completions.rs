//! `merlkit completions`

use std::process::ExitCode;

use clap_complete::Shell;

use crate::failure::Outcome;
use crate::output;

/// Print a script that completes commands and options in a shell
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
                        merlkit completions bash > ~/.local/share/bash-completion/completions/merlkit\n  \
                        merlkit completions zsh > \"${fpath[1]}/_merlkit\"\n  \
                        merlkit completions fish > ~/.config/fish/completions/merlkit.fish")]
pub struct Args {
    /// The shell that reads the script
    shell: Shell,
}

pub fn run(args: &Args, mut cli: clap::Command) -> Outcome {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut cli, "merlkit", &mut script);
    output::stdout(|out| out.write_all(&script))?;
    Ok(ExitCode::SUCCESS)
}
