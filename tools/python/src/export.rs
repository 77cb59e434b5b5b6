//! Files for other programs.

use std::path::{Path, PathBuf};

use merlkit::SamplerSpec;
use merlkit::export::Export;
use merlkit::files::write_new;
use merlkit::material::rgl::{BsdfSize, RglBrdf, tabulate};
use merlkit::sampler::HalfVectorSettings;
use merlkit_evaluate::measure::{LARGEST_ALBEDO_ERROR, value_errors};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::errors::{choose, overwrite, raise};
use crate::material::{PyMaterial, path_text};

#[derive(Clone, Copy, PartialEq, Eq)]
enum FileKind {
    Bsdf,
    Npz,
    Header,
    Runtime,
}

const KINDS: [(&str, FileKind); 4] = [
    ("bsdf", FileKind::Bsdf),
    ("npz", FileKind::Npz),
    ("header", FileKind::Header),
    ("runtime", FileKind::Runtime),
];

/// Writes a material for other programs into a folder, as `merlkit export` does, and returns the files' paths.
///
/// `format` is "npz" (arrays for numpy), "header" (C, C++ and GLSL), "runtime" (a file that C, C++, CUDA and shaders load at run time, with
/// their code) or "bsdf" (Mitsuba 3 and pbrt-v4). `sampler` sets the half-vector table in npz, header and runtime, `size` the size of a
/// .bsdf file.
#[pyfunction]
#[pyo3(signature = (material, folder, format, *, sampler = "half-vector:64KB", size = "6MB", overwrite = false))]
pub fn export(
    py: Python<'_>,
    material: &Bound<'_, PyMaterial>,
    folder: &Bound<'_, PyAny>,
    format: &str,
    sampler: &str,
    size: &str,
    overwrite: bool,
) -> PyResult<Vec<PathBuf>> {
    let kind = choose("format", format, &KINDS)?;
    let folder = PathBuf::from(path_text(folder)?);
    std::fs::create_dir_all(&folder).map_err(|source| {
        raise(merlkit::Error::Io {
            path: folder.clone(),
            action: "create",
            source,
        })
    })?;
    let material = material.get();
    let ends: &[&str] = match kind {
        FileKind::Bsdf => &["rgb.bsdf", "spectral.bsdf"],
        FileKind::Npz => &["npz"],
        FileKind::Header => &["f32", "h"],
        FileKind::Runtime => &["merlkit"],
    };
    let mut paths = Vec::new();
    for end in ends {
        paths.push(folder.join(format!("{}.{end}", material.loaded().name())));
    }
    let code = if kind == FileKind::Runtime {
        Export::missing_runtime_code(&folder)
    } else {
        Vec::new()
    };
    for path in paths.iter().chain(code.iter().map(|(path, _)| path)) {
        self::overwrite(path, overwrite)?;
    }
    match kind {
        FileKind::Bsdf => write_bsdf(py, material, size, &paths, overwrite)?,
        FileKind::Npz | FileKind::Header | FileKind::Runtime => {
            write_table(py, material, sampler, &paths, overwrite)?;
        }
    }
    for (path, text) in code {
        let written = write_new(&path, self::overwrite(&path, overwrite)?, |out| {
            out.write_all(text.as_bytes())
                .map_err(|e| merlkit::Error::io(&path, "write", e))
        });
        written.map_err(raise)?;
        paths.push(path);
    }
    Ok(paths)
}

/// Writes the half-vector table with the values.
fn write_table(
    py: Python<'_>,
    material: &PyMaterial,
    sampler: &str,
    paths: &[PathBuf],
    replace: bool,
) -> PyResult<()> {
    let spec: SamplerSpec = sampler.parse().map_err(raise)?;
    let settings: HalfVectorSettings = *spec.settings().ok_or_else(|| {
        PyValueError::new_err(format!(
            "npz, header and runtime hold the half-vector table only, not {}; choose half-vector with any settings",
            spec.name()
        ))
    })?;
    let source = material.source("an export")?;
    let export = material.run(py, || Export::new(source, material.loaded(), settings))?;
    let export = export.map_err(raise)?;
    for path in paths {
        let overwrite = overwrite(path, replace)?;
        let written = match path.extension().and_then(|e| e.to_str()) {
            Some("npz") => export.write_npz(path, overwrite),
            Some("h") => export.write_header(path, overwrite),
            Some("merlkit") => export.write_runtime(path, overwrite),
            _ => export.write_values(path, overwrite),
        };
        written.map_err(raise)?;
    }
    Ok(())
}

/// Writes files for Mitsuba's and pbrt's measured materials, unless they would be far off.
fn write_bsdf(
    py: Python<'_>,
    material: &PyMaterial,
    size: &str,
    paths: &[PathBuf],
    replace: bool,
) -> PyResult<()> {
    let loaded = material.loaded();
    loaded
        .facts()
        .require_isotropic(loaded.name(), "an exported .bsdf file")
        .map_err(raise)?;
    let size = choose("size", size, &BsdfSize::ALL.map(|size| (size.name, size)))?;
    let brdf = &**loaded.brdf();
    let description = format!(
        "{}, {}; merlkit {}",
        loaded.name(),
        loaded.reading(),
        env!("CARGO_PKG_VERSION")
    );
    let (file, errors) = material.run(py, || {
        let file = tabulate(|wo, wi| brdf.eval(wo, wi), size, description);
        let errors = value_errors(&RglBrdf::new(file.clone()), brdf);
        (file, errors)
    })?;
    if errors.albedo > LARGEST_ALBEDO_ERROR || errors.albedo.is_nan() {
        return Err(PyValueError::new_err(format!(
            "the albedo of the file would be off by {:.0} %, more than the limit of {:.0} %; choose another lookup rule or size",
            100.0 * errors.albedo,
            100.0 * LARGEST_ALBEDO_ERROR
        )));
    }
    write_variants(&file, paths, replace)
}

fn write_variants(
    file: &merlkit::material::rgl::BsdfFile,
    paths: &[PathBuf],
    replace: bool,
) -> PyResult<()> {
    for path in paths {
        let overwrite = overwrite(path, replace)?;
        let spectral = is_spectral(path);
        let written = match spectral {
            true => file.to_spectral().write(path, overwrite),
            false => file.write(path, overwrite),
        };
        written.map_err(raise)?;
    }
    Ok(())
}

fn is_spectral(path: &Path) -> bool {
    path.to_string_lossy().ends_with(".spectral.bsdf")
}
