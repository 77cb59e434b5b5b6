//! The list of tasks, its file, and its parts.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::Path;
use std::str::FromStr;

use merlkit::files::RegularFile;
use merlkit::{Error, Result};
use serde::{Deserialize, Serialize};

use super::spec::MOST_TASKS;
use super::task::StudyTask;
use crate::report::JSON_SCHEMA;

/// Bytes of a plan, at most.
const MOST_BYTES: u64 = 1 << 30;

/// What the document of a plan is called.
const KIND: &str = "study-plan";

/// A task and its key.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedTask {
    /// As [`StudyTask::key`].
    pub key: String,
    /// What is asked.
    pub task: StudyTask,
}

/// Tasks within their domains, each of another key.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyPlan {
    tasks: Vec<PlannedTask>,
}

/// The plan's file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PlanDocument {
    schema: u32,
    kind: String,
    results: Vec<PlannedTask>,
}

impl StudyPlan {
    /// A plan of these tasks.
    ///
    /// # Errors
    /// [`Error::Argument`] for a task outside its domain, and for two equal ones.
    pub fn new(tasks: Vec<StudyTask>) -> Result<Self> {
        let mut planned = Vec::with_capacity(tasks.len());
        for task in tasks {
            task.check()?;
            planned.push(PlannedTask {
                key: task.key()?,
                task,
            });
        }
        Self::from_planned(planned)
    }

    fn from_planned(tasks: Vec<PlannedTask>) -> Result<Self> {
        let mut seen = BTreeSet::new();
        for planned in &tasks {
            if !seen.insert(&planned.key) {
                return Err(Error::argument(
                    format!("the task {} is there twice", planned.key),
                    "name each material, sampler and angle once",
                ));
            }
        }
        Ok(Self { tasks })
    }

    /// All tasks.
    pub fn tasks(&self) -> &[PlannedTask] {
        &self.tasks
    }

    /// The tasks of a part: neighbours in the list.
    pub fn shard(&self, shard: Shard) -> &[PlannedTask] {
        let count = self.tasks.len() as u128;
        // Part i of n is from ⌊(i − 1)·count/n⌋ to ⌊i·count/n⌋, so that parts differ by at most one task.
        let end = |part: u64| (count * u128::from(part) / u128::from(shard.count)) as usize;
        &self.tasks[end(shard.index - 1)..end(shard.index)]
    }

    /// Writes the plan's JSON, one task a line.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        write!(
            out,
            "{{\"schema\":{JSON_SCHEMA},\"kind\":\"{KIND}\",\"results\":["
        )?;
        for (number, planned) in self.tasks.iter().enumerate() {
            out.write_all(if number == 0 { b"\n" } else { b",\n" })?;
            serde_json::to_writer(&mut *out, planned)?;
        }
        writeln!(out, "\n]}}")
    }

    /// Reads a plan's file. Keys are computed again, since they become names of files.
    ///
    /// # Errors
    /// [`Error::Argument`] for a file that is no plan of this version, for a key that is not that of its task, and as
    /// [`Self::new`]; [`Error::Io`] and [`Error::Unsupported`] as [`RegularFile`].
    pub fn read(path: &Path) -> Result<Self> {
        Self::parse(&RegularFile::open(path)?.read_all(MOST_BYTES)?, path)
    }

    /// Reads the bytes of a plan's file; `path` is for messages.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(bytes: &[u8], path: &Path) -> Result<Self> {
        let again = "make the plan again with `merlkit study plan`";
        let shown = path.display();
        let document: PlanDocument = serde_json::from_slice(bytes)
            .map_err(|e| Error::argument(format!("{shown} is no plan of a study: {e}"), again))?;
        if document.schema != JSON_SCHEMA || document.kind != KIND {
            let what = format!("{shown} is no plan of a study of this version");
            return Err(Error::argument(what, again));
        }
        if document.results.len() > MOST_TASKS {
            let what = format!("{shown} has more than {MOST_TASKS} tasks");
            return Err(Error::argument(what, "make several studies of it"));
        }
        for (number, planned) in document.results.iter().enumerate() {
            let place = |e: Error| Error::argument(format!("{shown}, task {number}: {e}"), again);
            planned.task.check().map_err(place)?;
            let key = planned.task.key()?;
            if planned.key != key {
                let what = format!(
                    "{shown}, task {number}: the key \"{}\" is not its task's, which is {key}",
                    planned.key.escape_debug()
                );
                return Err(Error::argument(what, again));
            }
        }
        Self::from_planned(document.results)
    }
}

/// One of several parts of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    index: u64,
    count: u64,
}

impl Shard {
    /// All of a plan.
    pub const ALL: Self = Self { index: 1, count: 1 };

    /// Part `index` of `count`, from 1 on.
    ///
    /// # Errors
    /// [`Error::Argument`] for an index outside 1 to `count`.
    pub fn new(index: u64, count: u64) -> Result<Self> {
        if (1..=count).contains(&index) {
            return Ok(Self { index, count });
        }
        Err(Error::argument(
            format!("shard {index}/{count}"),
            format!("give one from 1/{count} to {count}/{count}"),
        ))
    }
}

impl FromStr for Shard {
    type Err = Error;

    /// Reads "3/8".
    fn from_str(text: &str) -> Result<Self> {
        let parts = text.split_once('/');
        let numbers = parts.and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        let (index, count) = numbers.ok_or_else(|| {
            Error::argument(
                format!("shard \"{text}\""),
                "give one such as 3/8, the third of eight",
            )
        })?;
        Self::new(index, count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::StudySpec;

    fn plan() -> StudyPlan {
        let spec = StudySpec {
            materials: vec!["nickel".into(), "chrome".into()],
            samplers: vec!["cosine".into()],
            thetas: vec![10.0, 60.0, 80.0],
            seeds: 3,
            ..StudySpec::default()
        };
        spec.plan().unwrap()
    }

    #[test]
    fn parts_are_neighbours_and_make_the_whole() {
        let plan = plan();
        for count in [1, 2, 5, 18, 40] {
            let mut all = Vec::new();
            for index in 1..=count {
                let part = plan.shard(Shard::new(index, count).unwrap());
                assert!(part.len() as u64 <= 18u64.div_ceil(count));
                all.extend_from_slice(part);
            }
            assert_eq!(all, plan.tasks());
        }
        assert_eq!("3/8".parse::<Shard>().unwrap(), Shard::new(3, 8).unwrap());
        for text in [
            "0/3",
            "4/3",
            "1/0",
            "1",
            "/",
            "a/b",
            "-1/3",
            "1/99999999999999999999",
        ] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
        assert_eq!(plan.shard(Shard::new(u64::MAX, u64::MAX).unwrap()).len(), 1);
    }

    #[test]
    fn files_come_back_and_hostile_ones_are_refused() {
        let path = Path::new("plan.json");
        let mut text = Vec::new();
        plan().write(&mut text).unwrap();
        let text = String::from_utf8(text).unwrap();
        assert_eq!(StudyPlan::parse(text.as_bytes(), path).unwrap(), plan());
        let key = plan().tasks()[0].key.clone();
        for (from, to, words) in [
            (key.as_str(), "../../outside", "is not its task's"),
            (key.as_str(), "", "is not its task's"),
            ("\"theta\":10.0", "\"theta\":1e9", "polar angle"),
            (
                "\"draws\":10000",
                "\"draws\":99999999999",
                "draws of an estimate",
            ),
            ("\"draws\":10000", "\"draws\":-1", "no plan of a study"),
            (
                "\"draws\":10000",
                "\"draws\":10000,\"more\":1",
                "no plan of a study",
            ),
            ("\"schema\":3", "\"schema\":2", "of this version"),
            ("study-plan", "study", "of this version"),
            ("\n]}", "", "no plan of a study"),
        ] {
            let bad = text.replacen(from, to, 1);
            assert_ne!(bad, text, "{from}");
            let error = StudyPlan::parse(bad.as_bytes(), path)
                .unwrap_err()
                .to_string();
            assert!(error.contains(words), "{from} → {to}: {error}");
        }
        let line = text.lines().nth(1).unwrap();
        let twice = text.replacen(line, &format!("{line}\n{line}"), 1);
        let error = StudyPlan::parse(twice.as_bytes(), path)
            .unwrap_err()
            .to_string();
        assert!(error.contains("twice"), "{error}");
    }
}
