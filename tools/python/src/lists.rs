//! The names that `load` and `Sampler.build` take.

use merlkit::SamplerSpec;
use merlkit::material::analytic::ModelFacts;
use merlkit::material::merl::embedded_names;
use merlkit::material::rgl::BsdfFile;
use pyo3::prelude::*;

/// Names of the built-in materials.
#[pyfunction]
pub fn material_names() -> Vec<String> {
    embedded_names().to_vec()
}

/// Names of the analytic models.
#[pyfunction]
pub fn model_names() -> Vec<&'static str> {
    let mut names = Vec::new();
    for model in ModelFacts::all() {
        names.push(model.name);
    }
    names
}

/// Names of the samplers, the default first.
#[pyfunction]
pub fn sampler_names() -> Vec<&'static str> {
    let mut names = Vec::new();
    for method in SamplerSpec::methods() {
        names.push(method.name());
    }
    names
}

/// Wavelengths in nm, and there the spectra of red, green and blue that exported `.bsdf` files mix.
#[pyfunction]
pub fn _primary_spectra() -> ([f32; 7], [[f32; 7]; 3]) {
    BsdfFile::primary_spectra()
}
