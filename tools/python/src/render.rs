//! Pictures of spheres as arrays.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use merlkit::image::{Image, MAX_PIXELS, encode_png, encode_srgb};
use merlkit::points::PointSet;
use merlkit::render::{
    Budget, PlanRequest, RenderSettings, Rendering, Scene, SceneSpec, Strategy, Surface,
};
use merlkit::{Loaded, SamplerSpec};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors::{choose, raise};
use crate::material::PyMaterial;
use crate::work;

/// Paths per pixel from which Sobol points leave less error than lattices.
const SOBOL_FROM: u64 = 512;
/// The floor's reflectance: a mid grey.
const GREY: f32 = 0.35;

/// Path-traces a row of spheres, one for each material, as `merlkit render` does; see `merlkit.render`.
#[pyfunction]
#[pyo3(signature = (materials, *, lights = None, sampler = "half-vector:64KB", width = None, height = 360, spp = 64,
                    ground = false, bounces = 8, strategy = "mis", seed = 0))]
#[expect(clippy::too_many_arguments, reason = "keywords in Python")]
pub fn render<'py>(
    py: Python<'py>,
    materials: Vec<Py<PyMaterial>>,
    lights: Option<Vec<String>>,
    sampler: &str,
    width: Option<usize>,
    height: usize,
    spp: u64,
    ground: bool,
    bounces: u32,
    strategy: &str,
    seed: u64,
) -> PyResult<Bound<'py, PyAny>> {
    if materials.is_empty() || bounces == 0 {
        return Err(PyValueError::new_err(
            "a picture needs at least one material and bounces of at least 1",
        ));
    }
    let settings = RenderSettings {
        width: width.unwrap_or_else(|| (320 * materials.len()).max(480)),
        height,
        seed,
        points: match spp >= SOBOL_FROM {
            true => PointSet::Sobol,
            false => PointSet::Lattice,
        },
        budget: Budget::Even(spp),
    };
    settings.check().map_err(raise)?;
    let sampler: SamplerSpec = sampler.parse().map_err(raise)?;
    let lights = lights.unwrap_or_else(|| vec!["studio".to_owned()]);
    let aspect = settings.width as f64 / settings.height as f64;
    let mut spec = describe(py, &materials, &lights, aspect)?;
    spec.floor = ground.then_some(GREY);
    spec.depth = bounces;
    spec.strategy = choose("strategy", strategy, &STRATEGIES)?;
    let mut loaded = Vec::new();
    for material in &materials {
        loaded.push(material.get().loaded().clone());
    }
    // A function is called on one thread, and so is all the rest.
    let picture = if materials.iter().any(|m| m.get().is_function()) {
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = stop.clone();
        let paint = move || paint(&spec, &loaded, &sampler, &settings, &stopped);
        work::on_one_thread_until_interrupt(py, paint, |interrupt| {
            stop.store(true, Ordering::Relaxed);
            give_up(py, &materials, &interrupt);
        })?
    } else {
        work::on_threads_until_interrupt(py, move |stop| {
            paint(&spec, &loaded, &sampler, &settings, stop)
        })?
    };
    for material in &materials {
        material.get().raise_failure()?;
    }
    to_array(py, &picture.map_err(raise)?)
}

const STRATEGIES: [(&str, Strategy); 4] = [
    (
        "mis",
        Strategy::Mis(merlkit::distribution::Heuristic::Power),
    ),
    ("light", Strategy::Light),
    ("brdf", Strategy::Brdf),
    (
        "ris",
        Strategy::Ris {
            candidates: Strategy::CANDIDATES,
        },
    ),
];

/// The scene; materials are called by their positions, because two may have one name.
fn describe(
    py: Python<'_>,
    materials: &[Py<PyMaterial>],
    lights: &[String],
    aspect: f64,
) -> PyResult<SceneSpec> {
    let mut names = Vec::with_capacity(materials.len());
    for index in 0..materials.len() {
        names.push(index.to_string());
    }
    let mut spec = SceneSpec::row(&names, aspect);
    for (index, material) in materials.iter().enumerate() {
        if material.bind(py).get().loaded().facts().has_mirror {
            spec.mirrors.push(index);
        }
    }
    for light in lights {
        let light = spec.light(light).map_err(raise)?;
        spec.lights.push(light);
    }
    Ok(spec)
}

/// Lets the functions among materials be called no more; the exception is raised by the first.
fn give_up(py: Python<'_>, materials: &[Py<PyMaterial>], interrupt: &PyErr) {
    for material in materials {
        material.get().give_up(interrupt.clone_ref(py));
    }
}

/// Builds what the scene calls for, and renders it, unless `stop` is set meanwhile: the picture is unfinished then.
fn paint(
    spec: &SceneSpec,
    materials: &[Loaded],
    sampler: &SamplerSpec,
    settings: &RenderSettings,
    stop: &AtomicBool,
) -> merlkit::Result<Image> {
    let scene = Scene::build(spec, PlanRequest::AsNeeded, |index, directions| {
        Ok(Surface {
            brdf: materials[index].brdf().clone(),
            sampler: match directions {
                true => Some(sampler.build(&materials[index])?.shared()),
                false => None,
            },
        })
    })?;
    let mut rendering = Rendering::begin(&scene, settings)?;
    rendering.advance(&|| stop.load(Ordering::Relaxed), &|_| {});
    rendering.into_rendered().film.to_image()
}

/// Refuses a picture without pixels, or of too many.
///
/// # Errors
/// `ValueError`.
pub fn require_side(side: usize) -> PyResult<()> {
    if side > 0 && side <= MAX_PIXELS.isqrt() {
        return Ok(());
    }
    Err(PyValueError::new_err(format!(
        "a side of {side} pixels; give 1 to {}",
        MAX_PIXELS.isqrt()
    )))
}

/// Linear RGB by `[y, x, rgb]`.
///
/// # Errors
/// None for pictures of the library.
pub fn to_array<'py>(py: Python<'py>, image: &Image) -> PyResult<Bound<'py, PyAny>> {
    let flat = PyArray1::from_slice(py, bytemuck::cast_slice(image.pixels()));
    let array: Bound<'py, numpy::PyArray3<f32>> =
        flat.reshape([image.height(), image.width(), 3])?;
    Ok(array.into_any())
}

/// The bytes of an 8-bit sRGB PNG.
///
/// # Errors
/// None for pictures of the library.
pub fn to_png<'py>(py: Python<'py>, image: &Image) -> PyResult<Bound<'py, PyBytes>> {
    let bytes = encode_png(image.width(), image.height(), &encode_srgb(image, 0.0));
    Ok(PyBytes::new(py, &bytes.map_err(raise)?))
}
