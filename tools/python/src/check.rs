//! The proof that a sampler is right, and figures of samplers.

use merlkit::SamplerSpec;
use merlkit::glam::Vec3;
use merlkit_evaluate::measure::check::{CheckSettings, check_directions_of, check_sampler};
use merlkit_evaluate::measure::profile::{ProfileSettings, profile};
use merlkit_evaluate::report::{CheckResult, SamplerReport};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::Rows;
use crate::documents::to_python;
use crate::errors::raise;
use crate::material::PyMaterial;
use crate::sampler::PySampler;
use crate::work;

/// Draws of a statistical check: with fewer nothing would fail; with more, nobody would wait.
const DRAWS: std::ops::RangeInclusive<usize> = 1000..=10_000_000;

/// Runs every check of a sampler at every direction.
#[pyfunction]
#[pyo3(signature = (sampler, *, draws = 100_000, seed = 1, significance = 0.01, wo = None))]
pub fn check<'py>(
    py: Python<'py>,
    sampler: &Bound<'py, PySampler>,
    draws: usize,
    seed: u64,
    significance: f64,
    wo: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    if !(DRAWS.contains(&draws) && significance > 0.0 && significance < 1.0) {
        return Err(PyValueError::new_err(format!(
            "{draws} draws, significance {significance}; choose 1000 to 10000000 draws, and a significance between 0 and 1"
        )));
    }
    let sampler = sampler.get();
    let material = sampler.subject();
    let brdf = material.loaded().brdf().clone();
    let rows = wo.map(|wo| Rows::read(wo, "wo", 3)).transpose()?;
    let directions = match &rows {
        Some(rows) => rows.vectors::<Vec3>()?.to_vec(),
        None => check_directions_of(material.loaded().symmetry()),
    };
    let settings = CheckSettings {
        draws,
        seed,
        significance,
        ..CheckSettings::default()
    };
    let drawing = sampler.sampler().shared();
    let report = material.run_until_interrupt(py, move || {
        check_sampler(&*drawing, &*brdf, &directions, &settings)
    })?;
    let result = CheckResult {
        material: material.loaded().name().into(),
        sampler: sampler.sampler().spec().to_string(),
        report,
    };
    to_python(py, &result)
}

/// Measures the memory, times and accuracy of samplers for a material, as `merlkit report` does.
///
/// `samplers` are texts such as "half-vector:64KB". The result is the dictionary of the command's JSON.
#[pyfunction]
#[pyo3(signature = (material, samplers, *, draws = 100_000, seed = 1))]
pub fn report<'py>(
    py: Python<'py>,
    material: &Bound<'py, PyMaterial>,
    samplers: Vec<String>,
    draws: usize,
    seed: u64,
) -> PyResult<Bound<'py, PyAny>> {
    if draws == 0 {
        return Err(PyValueError::new_err(
            "0 draws are too few to estimate a bias; give at least 1",
        ));
    }
    let material = material.get();
    let source = material.source("a report")?;
    let names: Vec<&str> = samplers.iter().map(String::as_str).collect();
    let specs = SamplerSpec::parse_all(&names).map_err(raise)?;
    let facts = material.loaded().facts();
    for spec in &specs {
        spec.check_supports(&facts).map_err(raise)?;
    }
    let settings = ProfileSettings {
        draws,
        seed,
        ..ProfileSettings::default()
    };
    let rule = material.loaded().rule().unwrap_or_default();
    let source = source.clone();
    let figures = work::on_threads_until_interrupt(py, move |_| {
        profile(&source, rule, &specs, &settings, &|| {})
    })?;
    to_python(py, &SamplerReport::new(figures.map_err(raise)?))
}
