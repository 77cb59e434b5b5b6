//! Results as dictionaries and lists: the same as in the JSON files of the `merlkit` command.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use serde::Serialize;

/// A result as Python's own objects; numbers that are not finite become `None`.
///
/// # Errors
/// None for what the package's own types hold.
pub fn to_python<'py, T: Serialize + ?Sized>(
    py: Python<'py>,
    result: &T,
) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(result).map_err(|e| PyRuntimeError::new_err(e.to_string()))?;
    py.import("json")?.call_method1("loads", (text,))
}
