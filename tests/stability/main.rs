//! Ugly data and extreme directions: a right answer or a clear error.

mod crossing;
mod degenerate;
mod lengths;
mod page;
mod precision;
mod reproducible;
#[path = "../support/mod.rs"]
mod support;

/// The folder of the repository.
const ROOT: &str = env!("CARGO_MANIFEST_DIR");
