//! The folder that finished pieces of a run are kept in, so that a run that was stopped goes on.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use merlkit::files::{Overwrite, RegularFile, write_new};
use merlkit::{Error, Result};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::plan::ThesisPlan;

/// The file that says what the pieces are of.
const PLAN: &str = "plan.json";
/// Most bytes of a piece: those of its pictures.
const MOST_BYTES: u64 = 1 << 26;

/// What the pieces are of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct PiecePlan {
    plan: ThesisPlan,
    /// Day of the first piece.
    begun: String,
}

/// A folder of pieces, one file each, called by its key. A file appears whole or not at all.
#[derive(Debug)]
pub struct PieceFolder {
    folder: PathBuf,
    begun: String,
    /// Keys of the pieces that were there before.
    found: HashSet<String>,
    /// Those that were measured in this run.
    measured: HashSet<String>,
}

impl PieceFolder {
    /// The pieces of `plan` in `folder`, which is made if it is missing; `today` is the day of a run that begins.
    ///
    /// # Errors
    /// [`Error::Argument`] if it has pieces of another plan, unless `anew`, which removes them; [`Error::Io`].
    pub fn open(folder: &Path, plan: &ThesisPlan, today: &str, anew: bool) -> Result<Self> {
        let path = folder.join(PLAN);
        if anew && path.exists() {
            remove_pieces(folder)?;
        }
        if path.exists() {
            let known: Option<PiecePlan> = read(&path);
            let known = known.filter(|known| known.plan == *plan);
            let known = known.ok_or_else(|| {
                Error::argument(
                    format!(
                        "{} has the pieces of a run with other options, of another version or of another machine",
                        folder.display()
                    ),
                    "repeat its options, name another folder with -o, or start again with --force",
                )
            })?;
            return Ok(Self::new(folder, known.begun));
        }
        fs::create_dir_all(folder).map_err(|e| Error::io(folder, "create", e))?;
        let begun = today.to_owned();
        let plan = plan.clone();
        write(&path, &PiecePlan { plan, begun })?;
        Ok(Self::new(folder, today.to_owned()))
    }

    fn new(folder: &Path, begun: String) -> Self {
        Self {
            folder: folder.to_owned(),
            begun,
            found: HashSet::new(),
            measured: HashSet::new(),
        }
    }

    /// Day on which the run began.
    pub fn begun(&self) -> &str {
        &self.begun
    }

    /// How many pieces were there before, and how many were measured. Experiments may have pieces in common, which count once.
    pub fn counts(&self) -> [usize; 2] {
        [self.found.len(), self.measured.len()]
    }

    /// The piece called `key`: as it was finished before, or measured and kept now. A file that holds something else is replaced.
    ///
    /// # Errors
    /// Those of `measure`, and [`Error::Io`].
    pub(super) fn recall_or<T: Serialize + DeserializeOwned>(
        &mut self,
        key: &str,
        measure: impl FnOnce() -> Result<T>,
    ) -> Result<T> {
        let path = self.folder.join(format!("{}.json", key.replace('/', "-")));
        if let Some(value) = read(&path) {
            if !self.measured.contains(key) {
                self.found.insert(key.to_owned());
            }
            return Ok(value);
        }
        let value = measure()?;
        write(&path, &value)?;
        self.measured.insert(key.to_owned());
        Ok(value)
    }
}

/// Removes the pieces and their plan, and nothing else.
fn remove_pieces(folder: &Path) -> Result<()> {
    let entries = fs::read_dir(folder).map_err(|e| Error::io(folder, "read", e))?;
    for entry in entries {
        let path = entry.map_err(|e| Error::io(folder, "read", e))?.path();
        if path.extension().is_some_and(|e| e == "json") {
            fs::remove_file(&path).map_err(|e| Error::io(&path, "remove", e))?;
        }
    }
    Ok(())
}

/// What a file holds; `None` for one that is missing, too large or something else.
fn read<T: DeserializeOwned>(path: &Path) -> Option<T> {
    let bytes = RegularFile::open(path).ok()?.read_all(MOST_BYTES).ok()?;
    serde_json::from_slice(&bytes).ok()
}

fn write(path: &Path, value: &impl Serialize) -> Result<()> {
    let text = serde_json::to_vec(value)
        .map_err(|e| Error::argument(format!("a piece without a JSON: {e}"), "report this"))?;
    write_new(path, Overwrite::Replace, |out| {
        let written = out.write_all(&text);
        written.map_err(|e| Error::io(path, "write", e))
    })
}
