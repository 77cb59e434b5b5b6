//! Finished measurements of a long run, one JSON line each, so that a run that was stopped can go on.

use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};

use merlkit::Error;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

/// Measurements by key. The first line of the file is what was asked for; a last line that a stopped run left unfinished
/// counts for nothing.
pub struct Journal {
    path: PathBuf,
    file: File,
    finished: HashMap<String, Value>,
}

impl Journal {
    /// Starts a journal for `plan`, or with `resume` goes on with the one that is there.
    ///
    /// # Errors
    /// [`Error::Argument`] if there is one of another plan; [`Error::Io`].
    pub fn open(path: &Path, plan: &impl Serialize, resume: bool) -> Result<Self, Error> {
        let plan = json(plan)?;
        let lines = if resume { read(path)? } else { Vec::new() };
        let Some((first, rest)) = lines.split_first() else {
            return Self::start(path, &plan);
        };
        if *first != plan {
            return Err(Error::argument(
                format!("{} belongs to a run with other options", path.display()),
                "repeat the options of that run, or omit --resume to start again",
            ));
        }
        let entry = |line: &Value| {
            Some((
                line.get("key")?.as_str()?.to_owned(),
                line.get("value")?.clone(),
            ))
        };
        let finished = rest.iter().filter_map(entry).collect();
        let mut journal = Self {
            path: path.into(),
            file: append(path)?,
            finished,
        };
        // Ends a line that was not finished.
        journal.write("")?;
        Ok(journal)
    }

    fn start(path: &Path, plan: &Value) -> Result<Self, Error> {
        if path.exists() {
            std::fs::remove_file(path).map_err(|e| Error::io(path, "remove", e))?;
        }
        let mut journal = Self {
            path: path.into(),
            file: append(path)?,
            finished: HashMap::new(),
        };
        journal.write(&plan.to_string())?;
        Ok(journal)
    }

    /// The measurement called `key`: as it was finished before, or measured and kept now.
    ///
    /// # Errors
    /// Those of `measure`, and [`Error::Io`].
    pub fn recall_or<T: Serialize + DeserializeOwned>(
        &mut self,
        key: &str,
        measure: impl FnOnce() -> Result<T, Error>,
    ) -> Result<T, Error> {
        if let Some(value) = self
            .finished
            .remove(key)
            .and_then(|v| serde_json::from_value(v).ok())
        {
            return Ok(value);
        }
        let value = measure()?;
        let line = serde_json::json!({ "key": key, "value": json(&value)? });
        self.write(&line.to_string())?;
        Ok(value)
    }

    /// Removes the file: its content has a better place now.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn finish(self) -> Result<(), Error> {
        std::fs::remove_file(&self.path).map_err(|e| Error::io(&self.path, "remove", e))
    }

    /// A whole line in one write.
    fn write(&mut self, line: &str) -> Result<(), Error> {
        self.file
            .write_all(format!("{line}\n").as_bytes())
            .map_err(|e| Error::io(&self.path, "write", e))
    }
}

fn append(path: &Path) -> Result<File, Error> {
    OpenOptions::new()
        .create(true)
        .append(true)
        .open(path)
        .map_err(|e| Error::io(path, "write", e))
}

/// A value as it is read back.
fn json(value: &impl Serialize) -> Result<Value, Error> {
    serde_json::to_value(value).map_err(|e| Error::argument(e.to_string(), "report this"))
}

/// The lines that are whole.
fn read(path: &Path) -> Result<Vec<Value>, Error> {
    let file = match File::open(path) {
        Ok(file) => file,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(e) => return Err(Error::io(path, "read", e)),
    };
    let lines: Result<Vec<String>, _> = BufReader::new(file).lines().collect();
    let lines = lines.map_err(|e| Error::io(path, "read", e))?;
    Ok(lines
        .iter()
        .filter_map(|line| serde_json::from_str(line).ok())
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finished_measurements_are_not_repeated() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("j");
        let mut journal = Journal::open(&path, &"plan", false).unwrap();
        assert_eq!(journal.recall_or("a", || Ok(0.1 + 0.2)).unwrap(), 0.1 + 0.2);
        drop(journal);
        append(&path)
            .unwrap()
            .write_all(b"{\"key\":\"b\",\"val")
            .unwrap();
        let mut journal = Journal::open(&path, &"plan", true).unwrap();
        assert_eq!(journal.recall_or("a", || Ok(1.0)).unwrap(), 0.1 + 0.2);
        assert_eq!(journal.recall_or("b", || Ok(2.0)).unwrap(), 2.0);
        drop(journal);
        let mut journal = Journal::open(&path, &"plan", true).unwrap();
        assert_eq!(journal.recall_or("b", || Ok(3.0)).unwrap(), 2.0);
        assert!(Journal::open(&path, &"another", true).is_err());
        let mut journal = Journal::open(&path, &"another", false).unwrap();
        assert_eq!(journal.recall_or("a", || Ok(4.0)).unwrap(), 4.0);
        journal.finish().unwrap();
        assert!(!path.exists());
    }
}
