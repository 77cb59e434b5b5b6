//! The library's errors as Python's exceptions, with the library's texts.

use std::io::ErrorKind;
use std::path::Path;

use merlkit::Error;
use merlkit::files::Overwrite;
use pyo3::exceptions::{
    PyFileExistsError, PyFileNotFoundError, PyOSError, PyPermissionError, PyValueError,
};
use pyo3::{PyErr, PyResult, create_exception};

create_exception!(
    merlkit,
    FormatError,
    PyValueError,
    "A file's content contradicts its format, or is of a kind that merlkit does not read."
);

/// The exception for an error of the library.
pub fn raise(error: Error) -> PyErr {
    let text = error.to_string();
    match error {
        Error::Io { source, .. } => match source.kind() {
            ErrorKind::NotFound => PyFileNotFoundError::new_err(text),
            ErrorKind::PermissionDenied => PyPermissionError::new_err(text),
            ErrorKind::AlreadyExists => PyFileExistsError::new_err(text),
            _ => PyOSError::new_err(text),
        },
        Error::Invalid { .. } | Error::Unsupported { .. } => FormatError::new_err(text),
        _ => PyValueError::new_err(text),
    }
}

/// The value that has a name among `names`.
///
/// # Errors
/// `ValueError` with all names.
pub fn choose<T: Copy>(what: &str, word: &str, names: &[(&str, T)]) -> PyResult<T> {
    for (name, value) in names {
        if *name == word {
            return Ok(*value);
        }
    }
    let mut all = Vec::with_capacity(names.len());
    for (name, _) in names {
        all.push(format!("\"{name}\""));
    }
    Err(PyValueError::new_err(format!(
        "{what} \"{word}\" is unknown; choose one of {}",
        all.join(", ")
    )))
}

/// Whether a file may be replaced.
///
/// # Errors
/// `FileExistsError` for a file that is there and must be kept.
pub fn overwrite(path: &Path, replace: bool) -> PyResult<Overwrite> {
    if replace {
        return Ok(Overwrite::Replace);
    }
    if path.exists() {
        return Err(PyFileExistsError::new_err(format!(
            "{} exists; pass overwrite=True to replace it, or name another file",
            path.display()
        )));
    }
    Ok(Overwrite::Refuse)
}
