//! What the `merlkit` command measures, checks, compares and plots, apart from the library that others build on.
//!
//! [`measure`] returns plain results, [`report`] puts them into words, tables and files, and [`plot`] draws charts from
//! numbers alone. [`study`] does this for many materials on many machines, and [`thesis`] repeats the experiments of the thesis
//! that the project follows.
#![deny(unsafe_code)]
#![warn(missing_docs)]
#![warn(clippy::print_stdout, clippy::print_stderr, clippy::exit)]
#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod measure;
pub mod plot;
pub mod report;
pub mod study;
pub mod thesis;
