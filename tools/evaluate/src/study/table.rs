//! All results of a study as one table.

use merlkit::image::Image;
use merlkit::{Error, Result};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::folder::StudyFolder;
use super::plan::StudyPlan;
use super::task::{StudyTask, TileTask};
use super::tiles::{TiledPicture, decode_pixels};
use crate::report::Sheet;

/// A task and what it found. Of a picture, the task is the whole picture and the result the name of its file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyRecord {
    /// What was asked.
    pub task: StudyTask,
    /// What was found: the JSON of a [`super::StudyResult`].
    pub result: Value,
}

/// All records in the order of the plan.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(transparent)]
pub struct StudyTable {
    /// The records.
    pub records: Vec<StudyRecord>,
}

/// Puts all results together. Pictures are in memory one after another: `keep` takes each, with the whole picture as its task and a name,
/// and returns the name of its file.
///
/// # Errors
/// Those of [`StudyFolder::read`] and `keep`; [`Error::Argument`] if the tiles of a picture are no neighbours in the plan, or
/// don't cover it.
pub fn merge_study(
    plan: &StudyPlan,
    folder: &StudyFolder,
    keep: &mut dyn FnMut(&TileTask, &str, Image) -> Result<String>,
) -> Result<StudyTable> {
    let mut table = StudyTable::default();
    let mut open: Option<TiledPicture> = None;
    for planned in plan.tasks() {
        let record = folder.read(planned)?;
        let StudyTask::Tile(tile) = &record.task else {
            table.records.push(record);
            continue;
        };
        let mut picture = match open.take() {
            Some(picture) if picture.task == tile.whole_picture() => picture,
            Some(picture) => return Err(incomplete(&picture)),
            None => TiledPicture::new(tile),
        };
        let text = record.result["pixels"].as_str().unwrap_or_default();
        let pixels = decode_pixels(text, tile.size[0] * tile.size[1]);
        if picture.paste(tile, &pixels.unwrap_or_default())? {
            table.records.push(finish_picture(picture, keep)?);
        } else {
            open = Some(picture);
        }
    }
    match open {
        Some(picture) => Err(incomplete(&picture)),
        None => Ok(table),
    }
}

/// Hands a picture over, and returns its record.
fn finish_picture(
    picture: TiledPicture,
    keep: &mut dyn FnMut(&TileTask, &str, Image) -> Result<String>,
) -> Result<StudyRecord> {
    let whole = picture.task.clone();
    let task = StudyTask::Tile(whole.clone());
    let name = task.key()?.replacen("tile", "picture", 1);
    let file = keep(&whole, &name, picture.into_image()?)?;
    Ok(StudyRecord {
        task,
        result: json!({ "picture": file }),
    })
}

fn incomplete(picture: &TiledPicture) -> Error {
    Error::argument(
        format!(
            "the tiles of a picture of {} don't cover it",
            picture.task.material
        ),
        "make the plan again with `merlkit study plan`, which puts them together",
    )
}

/// Columns of the CSV.
const HEADING: [&str; 22] = [
    "kind",
    "material",
    "lookup",
    "sampler",
    "theta_deg",
    "seed",
    "draws",
    "mean_r",
    "mean_g",
    "mean_b",
    "deviation_r",
    "deviation_g",
    "deviation_b",
    "albedo_r",
    "albedo_g",
    "albedo_b",
    "failed",
    "passed",
    "model",
    "relative_error",
    "fitted",
    "picture",
];

impl StudyTable {
    /// The table for CSV: one row a record, and of fits one row a model. What a kind has not is empty.
    pub fn sheet(&self) -> Sheet {
        let mut sheet = Sheet::new(&HEADING);
        for record in &self.records {
            match &record.result["fits"] {
                Value::Array(fits) => {
                    for fit in fits {
                        sheet.push(row(record, fit));
                    }
                }
                _ => sheet.push(row(record, &Value::Null)),
            }
        }
        sheet
    }
}

/// The cells of a record, or of one of its fits.
fn row(record: &StudyRecord, fit: &Value) -> Vec<String> {
    let task = serde_json::to_value(&record.task).unwrap_or_default();
    let result = &record.result;
    let mut cells = Vec::with_capacity(HEADING.len());
    for name in [
        "kind", "material", "lookup", "sampler", "theta", "seed", "draws",
    ] {
        cells.push(show(&task[name]));
    }
    for name in ["mean", "deviation", "albedo"] {
        for channel in 0..3 {
            cells.push(show(&result[name][channel]));
        }
    }
    cells.push(show(&result["failed"]));
    cells.push(show(&result["passed"]));
    cells.push(show(&fit["model"]));
    cells.push(show(&fit["relative_error"]));
    cells.push(show(&fit["material"]));
    cells.push(show(&result["picture"]));
    cells
}

/// A number or text as a cell; nothing is empty.
fn show(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_have_a_cell_for_each_column() {
        let task = serde_json::from_value(json!({
            "kind": "fit", "material": "nickel", "lookup": "floor", "models": ["ggx", "ward"]
        }));
        let fits = json!([
            {"model": "ggx", "relative_error": 0.25, "material": "ggx:ax=0.1"},
            {"model": "ward", "relative_error": 0.5, "material": "ward:sx=0.1"}
        ]);
        let table = StudyTable {
            records: vec![StudyRecord {
                task: task.unwrap(),
                result: json!({ "fits": fits }),
            }],
        };
        let sheet = table.sheet();
        assert_eq!(sheet.rows.len(), 2);
        for row in &sheet.rows {
            assert_eq!(row.len(), HEADING.len());
        }
        assert_eq!(sheet.rows[1][18..21], ["ward", "0.5", "ward:sx=0.1"]);
    }
}
