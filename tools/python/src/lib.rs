//! The native part of the Python package `merlkit`: materials, samplers and pictures on numpy arrays.
//!
//! The Python side is `python/merlkit/`; what each class and function promises is in `_native.pyi` there. Every number is the
//! library's, to the bit. Calls that take time let other Python threads run meanwhile.
#![deny(unsafe_code)]
#![warn(missing_docs)]
#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod arrays;
mod check;
mod documents;
mod errors;
mod export;
mod fit;
mod function;
mod lists;
mod material;
mod memory;
mod render;
mod sampler;
mod study;
mod table;
mod timing;
mod work;

use pyo3::prelude::*;

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("FormatError", module.py().get_type::<errors::FormatError>())?;
    module.add_class::<material::PyMaterial>()?;
    module.add_class::<sampler::PySampler>()?;
    module.add_class::<fit::PyFit>()?;
    module.add_function(wrap_pyfunction!(material::load, module)?)?;
    module.add_function(wrap_pyfunction!(material::from_function, module)?)?;
    module.add_function(wrap_pyfunction!(check::check, module)?)?;
    module.add_function(wrap_pyfunction!(check::report, module)?)?;
    module.add_function(wrap_pyfunction!(fit::fit, module)?)?;
    module.add_function(wrap_pyfunction!(render::render, module)?)?;
    module.add_function(wrap_pyfunction!(export::export, module)?)?;
    module.add_function(wrap_pyfunction!(study::_plan_study, module)?)?;
    module.add_function(wrap_pyfunction!(study::_plan_tasks, module)?)?;
    module.add_function(wrap_pyfunction!(study::_check_plan, module)?)?;
    module.add_function(wrap_pyfunction!(study::_task_key, module)?)?;
    module.add_function(wrap_pyfunction!(study::_run_task, module)?)?;
    module.add_function(wrap_pyfunction!(study::_merge_study, module)?)?;
    module.add_function(wrap_pyfunction!(timing::_time_library, module)?)?;
    module.add_function(wrap_pyfunction!(lists::_primary_spectra, module)?)?;
    module.add_function(wrap_pyfunction!(lists::material_names, module)?)?;
    module.add_function(wrap_pyfunction!(lists::model_names, module)?)?;
    module.add_function(wrap_pyfunction!(lists::sampler_names, module)?)
}
