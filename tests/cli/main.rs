//! The command line as a user types it.

mod anisotropic;
#[path = "../support/anisotropic.rs"]
mod brushed;
mod compare;
mod eval;
mod materials;
mod plot;
mod render;
mod reports;
mod run;
mod samplers;
mod usage;
