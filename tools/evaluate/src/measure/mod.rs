//! Figures about a material or a method: facts of tables, what a sampler costs and whether it is right.
//!
//! Everything here returns plain results, the same bits for any number of threads (measured times apart); words and files
//! are [`crate::report`]'s business.

pub mod accuracy;
mod albedo;
pub mod check;
pub mod chi_square;
pub mod cloud;
pub mod compare;
pub mod convergence;
pub mod cost;
pub mod difference;
mod expected;
mod facts;
pub mod fit;
pub mod hard;
pub mod lobe_mesh;
mod probe;
pub mod profile;
mod reproduction;
pub mod sky_draws;
pub mod views;

pub use albedo::{
    AlbedoEstimate, albedo_by_degree, directional_albedo, directional_albedo_with_error,
};
pub use facts::{Albedo, AlbedoAboveOne, Asymmetry, Facts, TableFacts, facts, table_facts};
pub use reproduction::{
    DrawQuality, LARGEST_ALBEDO_ERROR, ResamplingErrors, ValueErrors, colour_error, draw_quality,
    resampling_errors, size_within, value_errors,
};
