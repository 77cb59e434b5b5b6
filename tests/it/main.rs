//! What the library promises, one file a subject.

mod adaptive;
#[path = "../support/allocations.rs"]
mod allocations;
mod anisotropic;
mod architecture;
mod baselines;
mod batches;
mod browser;
#[path = "../support/browsers.rs"]
mod browsers;
mod bsdf;
mod cell_formats;
mod compare;
mod directions;
mod disc_mass;
mod examples;
mod fitted_files;
mod foreign_files;
mod format;
#[path = "../support/grids.rs"]
mod grid_files;
mod grids;
mod half_vector;
mod image;
mod invalid_channels;
mod layering;
mod lookup;
mod luminous;
mod measured_data;
mod measured_values;
mod measurements;
mod mitsuba;
mod model_samplers;
mod names;
mod page;
mod pictures;
mod plot;
mod render;
mod resampling;
mod sampler_checks;
mod sampler_files;
mod sampler_settings;
mod samplers;
mod scene_plans;
mod shrinking;
mod strategies;
#[path = "../support/mod.rs"]
mod support;
mod unfinished;

/// The folder of the repository.
const ROOT: &str = env!("CARGO_MANIFEST_DIR");
