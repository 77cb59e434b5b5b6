//! One file a command.

mod build;
mod check;
mod compare;
mod completions;
mod decode;
mod demo;
mod diff;
mod eval;
mod explore;
mod export;
mod fit;
mod import;
mod info;
mod list;
mod man;
mod models;
mod plot;
mod render;
mod report;
mod sample;
mod samplers;
mod sheet;
mod study;
mod thesis;
mod tune;

use crate::failure::Outcome;

/// The commands, in the order of `--help`.
#[derive(clap::Subcommand)]
pub enum Command {
    Demo(demo::Args),
    List(list::Args),
    Models(models::Args),
    Samplers(samplers::Args),
    Info(info::Args),
    Eval(eval::Args),
    Decode(decode::Args),
    Build(build::Args),
    Sample(sample::Args),
    Export(export::Args),
    Import(import::Args),
    Plot(Box<plot::Args>),
    Report(report::Args),
    Check(check::Args),
    Compare(compare::Args),
    Tune(tune::Args),
    Fit(fit::Args),
    Explore(explore::Args),
    Render(Box<render::Args>),
    Sheet(Box<sheet::Args>),
    Diff(diff::Args),
    Study(study::Args),
    Thesis(thesis::Args),
    Completions(completions::Args),
    Man(man::Args),
}

impl Command {
    /// Runs the command; `cli` is the definition of all commands, of which completions and manual pages are made.
    pub fn run(self, cli: clap::Command) -> Outcome {
        match self {
            Self::Demo(args) => demo::run(&args),
            Self::List(args) => list::run(&args),
            Self::Models(args) => models::run(&args),
            Self::Samplers(args) => samplers::run(&args),
            Self::Info(args) => info::run(&args),
            Self::Eval(args) => eval::run(&args),
            Self::Decode(args) => decode::run(&args),
            Self::Build(args) => build::run(&args),
            Self::Sample(args) => sample::run(&args),
            Self::Export(args) => export::run(&args),
            Self::Import(args) => import::run(&args),
            Self::Plot(args) => plot::run(&args),
            Self::Report(args) => report::run(&args),
            Self::Check(args) => check::run(&args),
            Self::Compare(args) => compare::run(&args),
            Self::Tune(args) => tune::run(&args),
            Self::Fit(args) => fit::run(&args),
            Self::Explore(args) => explore::run(&args),
            Self::Render(args) => render::run(&args),
            Self::Sheet(args) => sheet::run(&args),
            Self::Diff(args) => diff::run(&args),
            Self::Study(args) => study::run(&args),
            Self::Thesis(args) => thesis::run(&args),
            Self::Completions(args) => completions::run(&args, cli),
            Self::Man(args) => man::run(&args, cli),
        }
    }
}
