//! The command line as a user types it.

mod eval;
mod materials;
mod render;
mod reports;
mod run;
mod samplers;
mod usage;
