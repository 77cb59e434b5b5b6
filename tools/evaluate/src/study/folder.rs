//! The folder that the results of a study are kept in: one file a task, called by its key.

use std::fs;
use std::path::{Path, PathBuf};

use merlkit::files::{Overwrite, RegularFile, write_new};
use merlkit::{Error, Result};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::bench::StudyResult;
use super::plan::{PlannedTask, StudyPlan};
use super::table::StudyRecord;
use super::task::StudyTask;
use super::tiles::decode_pixels;
use crate::report::{JSON_SCHEMA, write_shared_json};

/// What the document of a result is called.
const KIND: &str = "study-result";
/// Bytes of a result, apart from those of pixels.
const MOST_BYTES: u64 = 1 << 26;

/// A folder of results.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StudyFolder {
    folder: PathBuf,
}

/// A result and what was asked.
#[derive(Serialize)]
struct ResultEntry<'a> {
    task: &'a StudyTask,
    result: &'a StudyResult,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ResultDocument {
    schema: u32,
    kind: String,
    results: StudyRecord,
}

impl StudyFolder {
    /// The results in `folder`, which need not exist.
    pub fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
        }
    }

    /// Makes the folder.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn create(&self) -> Result<()> {
        fs::create_dir_all(&self.folder).map_err(|e| Error::io(&self.folder, "create", e))
    }

    /// The file of a task's result.
    pub fn path(&self, planned: &PlannedTask) -> PathBuf {
        self.folder.join(format!("{}.json", planned.key))
    }

    /// Whether a task is done.
    pub fn holds(&self, planned: &PlannedTask) -> bool {
        self.path(planned).exists()
    }

    /// The tasks of a plan that are not done.
    pub fn missing<'a>(&self, plan: &'a StudyPlan) -> Vec<&'a PlannedTask> {
        let mut missing = Vec::new();
        for planned in plan.tasks() {
            if !self.holds(planned) {
                missing.push(planned);
            }
        }
        missing
    }

    /// Keeps a result. Its file appears whole or not at all; another process may write the same bytes meanwhile.
    ///
    /// # Errors
    /// As [`write_new`].
    pub fn keep(&self, planned: &PlannedTask, result: &StudyResult) -> Result<()> {
        let path = self.path(planned);
        let text = Self::describe(&planned.task, result)?;
        write_new(&path, Overwrite::Replace, |out| {
            let written = out.write_all(text.as_bytes());
            written.map_err(|e| Error::io(&path, "write", e))
        })
    }

    /// The text of a result's file.
    ///
    /// # Errors
    /// None for what a task found.
    pub fn describe(task: &StudyTask, result: &StudyResult) -> Result<String> {
        let mut text = Vec::new();
        write_shared_json(&mut text, KIND, &ResultEntry { task, result })
            .map_err(|e| Error::argument(format!("a result without a JSON: {e}"), "report this"))?;
        Ok(String::from_utf8_lossy(&text).into_owned())
    }

    /// Reads the result of a task that is done.
    ///
    /// # Errors
    /// [`Error::Argument`] for a file that holds none of this task; [`Error::Io`] for one that can't be read.
    pub fn read(&self, planned: &PlannedTask) -> Result<StudyRecord> {
        let path = self.path(planned);
        let bytes = RegularFile::open(&path)?.read_all(most_bytes(&planned.task))?;
        let document: Option<ResultDocument> = serde_json::from_slice(&bytes).ok();
        let is_whole = |document: &ResultDocument| {
            document.schema == JSON_SCHEMA
                && document.kind == KIND
                && document.results.task == planned.task
                && is_complete(&planned.task, &document.results.result)
        };
        let document = document.filter(is_whole).ok_or_else(|| {
            Error::argument(
                format!("{} holds no result of its task", path.display()),
                "remove it and run the study again, which runs only this task",
            )
        })?;
        Ok(document.results)
    }
}

/// Bytes of the result of a task, at most: four letters for three bytes of pixels.
fn most_bytes(task: &StudyTask) -> u64 {
    match task {
        StudyTask::Tile(tile) => MOST_BYTES + 16 * (tile.size[0] * tile.size[1]) as u64,
        StudyTask::Estimate(_) | StudyTask::Check(_) | StudyTask::Fit(_) => MOST_BYTES,
    }
}

/// Whether a result has what a result of its kind has.
fn is_complete(task: &StudyTask, result: &Value) -> bool {
    match task {
        StudyTask::Estimate(_) => {
            let is_colour = |name: &str| result[name].as_array().is_some_and(|a| a.len() == 3);
            ["mean", "deviation", "albedo"]
                .iter()
                .all(|name| is_colour(name))
                && result["failed"].is_u64()
        }
        StudyTask::Check(_) => result["passed"].is_boolean() && result["failures"].is_array(),
        StudyTask::Fit(_) => result["fits"].is_array(),
        StudyTask::Tile(tile) => {
            let text = result["pixels"].as_str();
            let count = tile.size[0] * tile.size[1];
            text.and_then(|text| decode_pixels(text, count)).is_some()
        }
    }
}
