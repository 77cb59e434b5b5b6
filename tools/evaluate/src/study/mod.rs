//! Studies of many materials: a list of independent tasks that any number of machines work on.
//!
//! ```text
//! StudySpec → StudyPlan, a list of StudyTask with a key each → StudyBench runs a task → StudyFolder keeps its result
//!                                                               all results → StudyTable and pictures
//! ```
//!
//! A key depends on its task alone, and so do the bytes of a result, so that it does not matter which process, on how many threads,
//! runs a task, or how often. The command and the Python package both run tasks through this module.

mod bench;
mod folder;
mod plan;
mod spec;
mod table;
mod task;
mod tiles;

pub use bench::{StudyBench, StudyResult};
pub use folder::StudyFolder;
pub use plan::{PlannedTask, Shard, StudyPlan};
pub use spec::{MOST_TASKS, StudyPictures, StudySpec};
pub use table::{StudyRecord, StudyTable, merge_study};
pub use task::{CheckTask, EstimateTask, FitTask, StudyTask, TileTask};
