//! One file a command.

mod decode;
mod eval;
mod info;
mod list;

use crate::failure::Outcome;

/// The commands, in the order of `--help`.
#[derive(clap::Subcommand)]
pub enum Command {
    List(list::Args),
    Info(info::Args),
    Eval(eval::Args),
    Decode(decode::Args),
}

impl Command {
    /// Runs the command.
    pub fn run(self) -> Outcome {
        match self {
            Self::List(args) => list::run(&args),
            Self::Info(args) => info::run(&args),
            Self::Eval(args) => eval::run(&args),
            Self::Decode(args) => decode::run(&args),
        }
    }
}
