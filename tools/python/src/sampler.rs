//! Samplers: built for a material, or read from a file.

use std::path::Path;

use merlkit::glam::{Vec2, Vec3};
use merlkit::sampler::store::{SamplerFile, encode, save};
use merlkit::{DirectionSample, Sampler, SamplerSpec, Wo};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};

use crate::arrays::{BatchInput, Results, Rows};
use crate::errors::{overwrite, raise};
use crate::material::{PyMaterial, path_text};
use crate::work;

/// Draws that are made together; they fit the cache.
const BATCH: usize = 512;
/// Drawn together at most: the points of one sequence.
const MOST_STRATIFIED: usize = 1 << 28;

/// An importance sampler, with the material that it was built for: `build`, `load` and `from_bytes` make one.
#[pyclass(frozen, name = "Sampler", module = "merlkit")]
pub struct PySampler {
    sampler: Sampler,
    material: Py<PyMaterial>,
}

/// `wi` and `pdf` of draws.
type DrawnColumns<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

impl PySampler {
    /// The sampler itself.
    pub fn sampler(&self) -> &Sampler {
        &self.sampler
    }

    /// The material that it was built for.
    pub fn subject(&self) -> &PyMaterial {
        self.material.get()
    }

    fn file(py: Python<'_>, file: SamplerFile, material: Option<Py<PyMaterial>>) -> PyResult<Self> {
        if let Some(material) = material {
            // The material as it is loaded: a wrong one is refused by its checksum.
            let source = material.get().source("a sampler file")?;
            let found = py.detach(|| source.sha256()).map_err(raise)?;
            let recorded = &file.record().source_sha256;
            if found != *recorded {
                return Err(PyValueError::new_err(format!(
                    "material {} has SHA-256 {found}, but the sampler was built from {recorded}; \
                     build the sampler again, or name the material it was built from",
                    source.name()
                )));
            }
            let loaded = material.get().loaded();
            let sampler = work::on_threads(py, || file.into_sampler(loaded))?.map_err(raise)?;
            return Ok(Self { sampler, material });
        }
        let source = file.record().material().map_err(raise)?;
        let (sampler, loaded) =
            work::on_threads(py, || file.load(Some(source.clone())))?.map_err(raise)?;
        let material = Py::new(py, PyMaterial::from_loaded(source, loaded))?;
        Ok(Self { sampler, material })
    }
}

#[pymethods]
impl PySampler {
    /// Builds a sampler for a material.
    ///
    /// `sampler` is what `--sampler` of the command `merlkit` takes: NAME or NAME:SETTING,... (`sampler_names`).
    #[staticmethod]
    #[pyo3(signature = (material, sampler = "half-vector:64KB"))]
    fn build(py: Python<'_>, material: Py<PyMaterial>, sampler: &str) -> PyResult<Self> {
        let spec: SamplerSpec = sampler.parse().map_err(raise)?;
        let subject = material.get();
        let loaded = subject.loaded().clone();
        let built = subject.run_until_interrupt(py, move || spec.build(&loaded))?;
        Ok(Self {
            sampler: built.map_err(raise)?,
            material,
        })
    }

    /// Reads a sampler file.
    ///
    /// Without `material`, the material that the file names is loaded. One that is given must be that material, loaded with the
    /// same lookup rule.
    #[staticmethod]
    #[pyo3(signature = (path, material = None))]
    fn load(
        py: Python<'_>,
        path: &Bound<'_, PyAny>,
        material: Option<Py<PyMaterial>>,
    ) -> PyResult<Self> {
        let path = path_text(path)?;
        let file = py.detach(|| SamplerFile::open(Path::new(&path)));
        Self::file(py, file.map_err(raise)?, material)
    }

    /// Reads the bytes of a sampler file.
    #[staticmethod]
    #[pyo3(signature = (data, material = None))]
    fn from_bytes(
        py: Python<'_>,
        data: Vec<u8>,
        material: Option<Py<PyMaterial>>,
    ) -> PyResult<Self> {
        let file = py.detach(|| SamplerFile::from_bytes(data, Path::new("bytes")));
        Self::file(py, file.map_err(raise)?, material)
    }

    /// The bytes of its file.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let source = self.material.get().source("a sampler file")?;
        let bytes = py.detach(|| encode(&self.sampler, source)).map_err(raise)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Writes it to a sampler file, which `load`, `merlkit sample` and the library read, and returns the number of bytes.
    #[pyo3(signature = (path, *, overwrite = false))]
    fn save(&self, py: Python<'_>, path: &Bound<'_, PyAny>, overwrite: bool) -> PyResult<u64> {
        let path = path_text(path)?;
        let path = Path::new(&path);
        let source = self.material.get().source("a sampler file")?;
        let overwrite = self::overwrite(path, overwrite)?;
        py.detach(|| save(&self.sampler, source, path, overwrite))
            .map_err(raise)
    }

    /// The method and settings that were asked for.
    #[getter]
    fn spec(&self) -> String {
        self.sampler.spec().to_string()
    }

    /// The same with what was fitted to the material.
    #[getter]
    fn fitted(&self) -> String {
        self.sampler.fitted().to_string()
    }

    /// The material that it was built for.
    #[getter]
    fn material(&self, py: Python<'_>) -> Py<PyMaterial> {
        self.material.clone_ref(py)
    }

    /// Bytes of its tables.
    #[getter]
    fn nbytes(&self) -> usize {
        self.sampler.as_dyn().bytes()
    }

    /// Draws a `wi` for each `wo` and each point `u` of the unit square, and returns `(wi, pdf)`.
    ///
    /// `wo` has the shape (..., 3) and `u` (..., 2), with numbers in [0, 1); leading axes are broadcast. `wi` has the shape (..., 3)
    /// and `pdf` (...), per solid angle in 1/sr, float32. A failed draw has the pdf 0 and the direction (0, 0, 0); it counts as a
    /// sample of weight 0.
    fn sample<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        u: &Bound<'py, PyAny>,
    ) -> PyResult<DrawnColumns<'py>> {
        let input = BatchInput::read(wo, u, "u", 2)?;
        let mut directions = Results::new(py, input.axes(), Some(3))?;
        let mut densities = Results::new(py, input.axes(), None)?;
        let (wo, u): (_, &[Vec2]) = (input.wo()?, input.other()?);
        let (wi, pdf): (&mut [Vec3], &mut [f32]) = (directions.vectors()?, densities.vectors()?);
        py.detach(|| self.draw(wo, u, wi, pdf));
        Ok((directions.finish()?, densities.finish()?))
    }

    /// The density of drawing `wi`, per solid angle in 1/sr; 0 where it can't be drawn.
    ///
    /// `wo` and `wi` have the shape (..., 3), and their leading axes are broadcast; the result has these axes, float32.
    fn pdf<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        wi: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let input = BatchInput::read(wo, wi, "wi", 3)?;
        let mut densities = Results::new(py, input.axes(), None)?;
        let (wo, wi, out) = (input.wo()?, input.other()?, densities.vectors()?);
        py.detach(|| self.sampler.as_dyn().pdf_batch(wo, wi, out));
        densities.finish()
    }

    /// Draws `count` directions for one `wo`, spread as evenly as the method can, and returns `(wi, pdf)`.
    ///
    /// `wo` has the shape (3,), `wi` (count, 3) and `pdf` (count,).
    #[pyo3(signature = (wo, count, seed = 0))]
    fn draw_stratified<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        count: usize,
        seed: u64,
    ) -> PyResult<DrawnColumns<'py>> {
        let rows = Rows::read(wo, "wo", 3)?;
        let [wo] = rows.vectors::<Vec3>()? else {
            return Err(PyValueError::new_err(
                "wo must be one direction, of the shape (3,)",
            ));
        };
        if count > MOST_STRATIFIED {
            return Err(PyValueError::new_err(format!(
                "{count} draws are too many; give at most {MOST_STRATIFIED}"
            )));
        }
        crate::memory::require(count, size_of::<Option<DirectionSample>>() + 16)?;
        let mut directions = Results::new(py, &[count], Some(3))?;
        let mut densities = Results::new(py, &[count], None)?;
        let (wi, pdf): (&mut [Vec3], &mut [f32]) = (directions.vectors()?, densities.vectors()?);
        py.detach(|| {
            let draws = self.sampler.draw_stratified(*wo, count, seed);
            split(&draws, wi, pdf);
        });
        Ok((directions.finish()?, densities.finish()?))
    }

    fn __repr__(&self) -> String {
        format!(
            "<merlkit.Sampler {} for {}: {} bytes of tables>",
            self.sampler.spec(),
            self.material.get().loaded().name(),
            self.nbytes()
        )
    }

    /// Samplers are pickled as their files and materials, or, without a file, as what they were built from.
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let class = py.get_type::<Self>();
        if self.sampler.spec().is_stored() {
            let arguments = (self.to_bytes(py)?, self.material(py));
            return Ok((class.getattr("from_bytes")?, arguments.into_pyobject(py)?));
        }
        let arguments = (self.material(py), self.spec());
        Ok((class.getattr("build")?, arguments.into_pyobject(py)?))
    }
}

impl PySampler {
    fn draw(&self, wo: Wo<'_>, u: &[Vec2], wi: &mut [Vec3], pdf: &mut [f32]) {
        let mut draws = [None; BATCH];
        for start in (0..u.len()).step_by(BATCH) {
            let lanes = start..u.len().min(start + BATCH);
            let draws = &mut draws[..lanes.len()];
            let sampler = self.sampler.as_dyn();
            sampler.sample_batch(wo.lanes(lanes.clone()), &u[lanes.clone()], draws);
            split(draws, &mut wi[lanes.clone()], &mut pdf[lanes]);
        }
    }
}

/// The columns of draws; 0 for one that failed.
fn split(draws: &[Option<DirectionSample>], wi: &mut [Vec3], pdf: &mut [f32]) {
    for (lane, draw) in draws.iter().enumerate() {
        (wi[lane], pdf[lane]) = draw.map_or((Vec3::ZERO, 0.0), |draw| (draw.wi, draw.pdf));
    }
}
