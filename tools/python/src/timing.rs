//! The library's own times, beside which those of calls from Python are measured on the same arrays (`bench.py`).

use std::time::Instant;

use merlkit::color::Rgb;
use merlkit::glam::{Vec2, Vec3};
use pyo3::prelude::*;

use crate::arrays::BatchInput;
use crate::material::PyMaterial;
use crate::sampler::PySampler;

/// The least seconds of `repeats` calls of the library: of `eval` for a material, of `sample` or `pdf` for a sampler.
#[pyfunction]
pub fn _time_library(
    py: Python<'_>,
    subject: &Bound<'_, PyAny>,
    task: &str,
    wo: &Bound<'_, PyAny>,
    other: &Bound<'_, PyAny>,
    repeats: usize,
) -> PyResult<f64> {
    let width = if task == "sample" { 2 } else { 3 };
    let input = BatchInput::read(wo, other, "the other argument", width)?;
    let wo = input.wo()?;
    let mut least = f64::INFINITY;
    if let Ok(material) = subject.cast::<PyMaterial>() {
        let brdf = &**material.get().loaded().brdf();
        let wi: &[Vec3] = input.other()?;
        let mut out = vec![Rgb::ZERO; wi.len()];
        py.detach(|| {
            for _ in 0..repeats {
                let start = Instant::now();
                brdf.eval_batch(wo, wi, &mut out);
                least = least.min(start.elapsed().as_secs_f64());
            }
        });
        return Ok(least);
    }
    let sampler = subject.cast::<PySampler>()?.get().sampler().as_dyn();
    if task == "sample" {
        let u: &[Vec2] = input.other()?;
        let mut out = vec![None; u.len()];
        py.detach(|| {
            for _ in 0..repeats {
                let start = Instant::now();
                sampler.sample_batch(wo, u, &mut out);
                least = least.min(start.elapsed().as_secs_f64());
            }
        });
        return Ok(least);
    }
    let wi: &[Vec3] = input.other()?;
    let mut out = vec![0.0; wi.len()];
    py.detach(|| {
        for _ in 0..repeats {
            let start = Instant::now();
            sampler.pdf_batch(wo, wi, &mut out);
            least = least.min(start.elapsed().as_secs_f64());
        }
    });
    Ok(least)
}
