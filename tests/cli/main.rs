//! The command line as a user types it.

mod anisotropic;
mod batch;
#[path = "../support/browsers.rs"]
mod browsers;
#[path = "../support/anisotropic.rs"]
mod brushed;
mod cells;
mod clouds;
mod compare;
mod diff;
mod environments;
mod eval;
mod every_material;
mod explore;
mod explore_page;
mod explore_shapes;
mod fit;
mod grf;
#[path = "../support/grids.rs"]
mod grid_files;
mod hard;
mod import;
mod materials;
mod memory;
mod models;
mod notes;
mod plot;
mod plot_files;
mod progress;
mod python;
mod render;
mod reports;
mod resume;
mod run;
mod samplers;
mod scene_files;
mod scenes;
mod schemas;
mod sheet;
mod shell;
mod study;
mod tasks;
mod thesis;
mod unlucky;
mod usage;
mod widths;
mod writing;
