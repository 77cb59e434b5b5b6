//! The experiments of R. Montes's thesis (2008), repeated with our samplers, and its figures to hold ours against.
//!
//! An [`Experiment`] is a table or a scene of the thesis. Its pieces, one a material or method, are kept in a [`PieceFolder`] as they
//! are finished, and [`Experiment::run`] puts them together as an [`Exhibit`].

mod ablation;
mod bench;
mod contenders;
mod distance;
mod draws;
mod exhibit;
mod experiment;
mod gallery;
mod measured;
mod mesh_scene;
mod pieces;
mod plan;
mod printed_tree;
pub mod published;
mod quadtrees;
mod ranking;
mod spheres;
mod stage;
mod subjects;

pub use bench::ThesisBench;
pub use exhibit::{Exhibit, ResultCell, ResultTable, Thumbnail};
pub use experiment::Experiment;
pub use pieces::PieceFolder;
pub use plan::{PlanMesh, ThesisPlan};
