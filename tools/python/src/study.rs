//! Tasks of studies: what `merlkit study` runs, by the same code.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use merlkit::Error;
use merlkit_evaluate::report::write_shared_json;
use merlkit_evaluate::study::{
    StudyBench, StudyFolder, StudyPlan, StudySpec, StudyTask, merge_study,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::errors::raise;
use crate::work;

thread_local! {
    /// The material of the last task of this thread, and what was made of it.
    static BENCH: RefCell<StudyBench> = RefCell::default();
}

/// The plan of a study that is given as JSON, as the text of its file.
#[pyfunction]
pub fn _plan_study(py: Python<'_>, spec: &str) -> PyResult<String> {
    let spec: StudySpec = serde_json::from_str(spec).map_err(|e| refuse("study", &e))?;
    let plan = py.detach(|| spec.plan()).map_err(raise)?;
    text_of(&plan)
}

/// The plan of tasks that are given as a JSON list, as the text of its file.
#[pyfunction]
pub fn _plan_tasks(tasks: &str) -> PyResult<String> {
    let tasks: Vec<StudyTask> = serde_json::from_str(tasks).map_err(|e| refuse("task", &e))?;
    text_of(&StudyPlan::new(tasks).map_err(raise)?)
}

/// Refuses the bytes of a file that are no plan.
#[pyfunction]
pub fn _check_plan(data: &[u8], path: &str) -> PyResult<()> {
    StudyPlan::parse(data, Path::new(path)).map_err(raise)?;
    Ok(())
}

/// The key of a task that is given as JSON.
#[pyfunction]
pub fn _task_key(task: &str) -> PyResult<String> {
    parse_task(task)?.key().map_err(raise)
}

/// Runs a task that is given as JSON, and returns the text of its result's file.
#[pyfunction]
pub fn _run_task(py: Python<'_>, task: &str) -> PyResult<String> {
    let task = parse_task(task)?;
    // The bench goes along to the threads that do the work. An interrupted call leaves none behind, and the next makes another.
    let mut bench = BENCH.take();
    let (bench, text) = work::on_threads_until_interrupt(py, move |_| {
        let result = bench.run(&task);
        let text = result.and_then(|result| StudyFolder::describe(&task, &result));
        (bench, text)
    })?;
    BENCH.replace(bench);
    text.map_err(raise)
}

/// The results of the plan in a file, as the text of the file that `merlkit study merge` writes; all of them must be there.
#[pyfunction]
pub fn _merge_study(py: Python<'_>, plan: PathBuf, folder: PathBuf) -> PyResult<String> {
    let merged = py.detach(|| {
        let plan = StudyPlan::read(&plan)?;
        merge_study(&plan, &StudyFolder::new(&folder), &mut |_, _, _| {
            Err(Error::argument(
                "the results hold tiles of pictures",
                "put them together with the command `merlkit study merge`",
            ))
        })
    });
    let mut text = Vec::new();
    write_shared_json(&mut text, "study", &merged.map_err(raise)?)?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

fn parse_task(text: &str) -> PyResult<StudyTask> {
    serde_json::from_str(text).map_err(|e| refuse("task", &e))
}

fn text_of(plan: &StudyPlan) -> PyResult<String> {
    let mut text = Vec::new();
    plan.write(&mut text)?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

fn refuse(what: &str, error: &serde_json::Error) -> PyErr {
    PyValueError::new_err(format!("this is no {what} of a study: {error}"))
}
