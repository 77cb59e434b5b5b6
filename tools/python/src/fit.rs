//! Analytic models fitted to a material.

use std::path::Path;

use merlkit::LookupRule;
use merlkit::files::write_new;
use merlkit_evaluate::measure::fit::{
    DEFAULT_FIT_MODELS, FitMetric, FitModel, FitPlan, MaterialFit, ModelFit, fit_models,
};
use merlkit_evaluate::report::{FitFormat, best_held, fitted_text};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::documents::to_python;
use crate::errors::{choose, overwrite, raise};
use crate::material::{PyMaterial, path_text};

/// Pairs of directions that a fit may see.
const PAIRS: std::ops::RangeInclusive<usize> = 50..=1_000_000;

const FORMATS: [(&str, FitFormat); 4] = [
    ("materialx", FitFormat::MaterialX),
    ("gltf", FitFormat::Gltf),
    ("mitsuba", FitFormat::Mitsuba),
    ("pbrt", FitFormat::Pbrt),
];

/// Analytic models fitted to one material; `fit` makes it.
#[pyclass(frozen, name = "Fit", module = "merlkit")]
pub struct PyFit {
    fit: MaterialFit,
}

/// Fits analytic models to a material, as `merlkit fit` does.
///
/// `models` are names such as "ggx", "ward" or "ggx+ggx"; without them, all are fitted. `pairs` is the number of pairs of directions that
/// a fit sees, and `seed` chooses them. Load the material with the "linear" lookup for the command's results.
#[pyfunction]
#[pyo3(signature = (material, models = None, *, metric = "cube-root", pairs = 2000, seed = 1))]
pub fn fit(
    py: Python<'_>,
    material: &Bound<'_, PyMaterial>,
    models: Option<Vec<String>>,
    metric: &str,
    pairs: usize,
    seed: u64,
) -> PyResult<PyFit> {
    if !PAIRS.contains(&pairs) {
        return Err(PyValueError::new_err(format!(
            "{pairs} pairs; give {} to {}",
            PAIRS.start(),
            PAIRS.end()
        )));
    }
    let plan = FitPlan {
        metric: choose("metric", metric, FitMetric::ALL)?,
        pairs,
        seed,
        ..FitPlan::default()
    };
    let mut names = DEFAULT_FIT_MODELS.to_vec();
    if let Some(models) = &models {
        names = models.iter().map(String::as_str).collect();
    }
    let mut parsed = Vec::new();
    for name in names {
        parsed.push(FitModel::parse(name).map_err(raise)?);
    }
    let material = material.get();
    let loaded = material.loaded().clone();
    let fit = material.run_until_interrupt(py, move || {
        fit_models(loaded.name(), &**loaded.brdf(), &parsed, &plan)
    })?;
    Ok(PyFit {
        fit: fit.map_err(raise)?,
    })
}

impl PyFit {
    fn best_fit(&self) -> PyResult<&ModelFit> {
        self.fit
            .best()
            .ok_or_else(|| PyValueError::new_err("no model was fitted; name at least one"))
    }
}

#[pymethods]
impl PyFit {
    /// All fits, each as a dictionary.
    #[getter]
    fn fits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.fit.fits)
    }

    /// The fit of the least error, as a dictionary.
    #[getter]
    fn best<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, self.best_fit()?)
    }

    /// The fit of the least error as a material.
    fn material(&self) -> PyResult<PyMaterial> {
        let source = merlkit::Material::resolve(&self.best_fit()?.material).map_err(raise)?;
        let loaded = source.load(LookupRule::default()).map_err(raise)?;
        Ok(PyMaterial::from_loaded(source, loaded))
    }

    /// The best fit that a renderer's format can hold, as the text of a file: "materialx", "gltf", "mitsuba" or "pbrt".
    fn text(&self, format: &str) -> PyResult<String> {
        let format = choose("format", format, &FORMATS)?;
        let held = best_held(format, &self.fit).ok_or_else(|| {
            PyValueError::new_err("the format can hold none of these models; fit \"ggx\"")
        })?;
        fitted_text(format, &self.fit.material, held).map_err(raise)
    }

    /// Writes that text to a file.
    #[pyo3(signature = (path, format, *, overwrite = false))]
    fn write(&self, path: &Bound<'_, PyAny>, format: &str, overwrite: bool) -> PyResult<()> {
        let text = self.text(format)?;
        let path = path_text(path)?;
        let path = Path::new(&path);
        let replace = self::overwrite(path, overwrite)?;
        write_new(path, replace, |out| {
            out.write_all(text.as_bytes())
                .map_err(|source| merlkit::Error::Io {
                    path: path.to_owned(),
                    action: "write",
                    source,
                })
        })
        .map_err(raise)
    }

    fn __repr__(&self) -> String {
        match self.fit.best() {
            Some(best) => format!(
                "<merlkit.Fit of {}: {} fits, the best {} with a relative error of {:.1} %>",
                self.fit.material,
                self.fit.fits.len(),
                best.model,
                100.0 * best.relative_error
            ),
            None => format!("<merlkit.Fit of {}: no fits>", self.fit.material),
        }
    }
}
