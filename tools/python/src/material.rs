//! Materials: loaded by name, path or formula, or made of a function in Python.

use std::path::Path;
use std::sync::Arc;

use merlkit::color::Rgb;
use merlkit::geometry::{POINTS_PER_BIN, Quadrature, Symmetry};
use merlkit::glam::{DVec3, Vec3};
use merlkit::material::Origin;
use merlkit::material::merl::{BinPoint, CellFormat, tabulate_brdf, write};
use merlkit::{Brdf, Loaded, LookupRule, Material, Wo};
use merlkit_evaluate::measure::fit::sphere_image;
use numpy::{PyArray1, PyArrayDyn};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};
use rayon::prelude::*;

use crate::arrays::{BatchInput, Results, Rows};
use crate::errors::{choose, raise};
use crate::function::PythonBrdf;
use crate::{errors, render, table, work};

/// Rows that an integral evaluates together.
const BATCH: usize = 1024;
/// Pixels of a side of the sphere that a notebook shows.
const SPHERE_SIDE: usize = 128;

/// A material in memory: `load` and `from_function` make one.
///
/// A notebook shows it as a sphere.
#[pyclass(frozen, name = "Material", module = "merlkit")]
pub struct PyMaterial {
    /// Where it comes from; `None` for a function.
    source: Option<Material>,
    loaded: Loaded,
    /// The BRDF again, if it is a function.
    function: Option<Arc<PythonBrdf>>,
}

/// Loads a material.
///
/// `material` is what the command `merlkit` takes: a path to a MERL binary or a .bsdf file, the name of a built-in material
/// (`material_names`), or a formula such as "lambert:reflectance=0.5" (`model_names`).
///
/// `lookup` says how a table is read between its samples: "floor" as the original reader, "linear" or "centred". `invalid` says
/// whether a negative or non-finite channel makes the whole "cell" invalid or the "channel" alone. `table` is the format of cells in
/// memory: "f32", "f16" or "rgb9e5".
#[pyfunction]
#[pyo3(signature = (material, lookup = "floor", *, invalid = "cell", table = "f32"))]
pub fn load(
    py: Python<'_>,
    material: &Bound<'_, PyAny>,
    lookup: &str,
    invalid: &str,
    table: &str,
) -> PyResult<PyMaterial> {
    let rule = choose(
        "lookup",
        lookup,
        &LookupRule::ALL.map(|rule| (rule.name(), rule)),
    )?;
    let cells = choose(
        "table",
        table,
        &CellFormat::ALL.map(|format| (format.name(), format)),
    )?;
    let apart = choose("invalid", invalid, &[("cell", false), ("channel", true)])?;
    let source = Material::resolve(&path_text(material)?).map_err(raise)?;
    let source = source.with_channels_apart(apart).with_cell_format(cells);
    let loaded = work::on_threads(py, || source.load(rule))?.map_err(raise)?;
    Ok(PyMaterial {
        source: Some(source),
        loaded,
        function: None,
    })
}

/// A material of a function `f(wo, wi)` on arrays.
///
/// It is called with two float32 arrays of unit directions above the horizon, both of the shape (N, 3), and returns f_r in 1/sr without
/// the cosine, of the shape (N, 3). Values must be finite and not negative. An exception that it raises is raised again by the
/// call that needed the value.
///
/// `isotropic=True` says that turning both directions about the normal changes nothing; a function for which that is seen to be wrong
/// is refused. Samplers of isotropic materials are smaller and built in less time.
#[pyfunction]
#[pyo3(signature = (function, *, isotropic = false, name = "function"))]
pub fn from_function(
    py: Python<'_>,
    function: Py<PyAny>,
    isotropic: bool,
    name: &str,
) -> PyResult<PyMaterial> {
    let brdf = Arc::new(PythonBrdf::new(py, function, isotropic)?);
    Ok(PyMaterial {
        source: None,
        loaded: Loaded::from_brdf(brdf.clone())
            .named(name)
            .with_reading("values of a function"),
        function: Some(brdf),
    })
}

/// The text of a path or a name.
pub fn path_text(value: &Bound<'_, PyAny>) -> PyResult<String> {
    if let Ok(text) = value.extract::<String>() {
        return Ok(text);
    }
    match value.call_method0("__fspath__") {
        Ok(path) => path.extract(),
        Err(_) => Err(PyTypeError::new_err(
            "expected a name or a path: a str or an os.PathLike",
        )),
    }
}

impl PyMaterial {
    /// A material that a sampler file was built for.
    pub fn from_loaded(source: Material, loaded: Loaded) -> Self {
        Self {
            source: Some(source),
            loaded,
            function: None,
        }
    }

    /// The material in memory.
    pub fn loaded(&self) -> &Loaded {
        &self.loaded
    }

    /// Where it comes from, for `purpose`, which needs to know.
    ///
    /// # Errors
    /// `ValueError` for a function.
    pub fn source(&self, purpose: &str) -> PyResult<&Material> {
        self.source.as_ref().ok_or_else(|| {
            PyValueError::new_err(format!(
                "{purpose} needs a material with a name or a file, and {} is a function; \
                 write it as a file first, by Material.write_merl",
                self.loaded.name()
            ))
        })
    }

    /// Runs `work` on its BRDF while other Python threads run; a function's own exception is raised again.
    ///
    /// # Errors
    /// Those of the function.
    pub fn run<R: Send>(&self, py: Python<'_>, task: impl FnOnce() -> R + Send) -> PyResult<R> {
        match &self.function {
            None => work::on_threads(py, task),
            Some(function) => {
                let result = work::on_one_thread(py, task)?;
                function.raise_failure()?;
                Ok(result)
            }
        }
    }

    /// As [`Self::run`], but Ctrl-C ends the call: see [`work::on_threads_until_interrupt`]. A function is not called any more after
    /// that.
    ///
    /// # Errors
    /// Those of the function, and `KeyboardInterrupt`.
    pub fn run_until_interrupt<R: Send + 'static>(
        &self,
        py: Python<'_>,
        task: impl FnOnce() -> R + Send + 'static,
    ) -> PyResult<R> {
        match &self.function {
            None => work::on_threads_until_interrupt(py, move |_| task()),
            Some(function) => {
                let give_up = |interrupt| function.give_up(interrupt);
                let result = work::on_one_thread_until_interrupt(py, task, give_up)?;
                function.raise_failure()?;
                Ok(result)
            }
        }
    }

    /// Whether it is a function in Python.
    pub fn is_function(&self) -> bool {
        self.function.is_some()
    }

    /// Raises the exception that a function's call met, if one did.
    ///
    /// # Errors
    /// That exception.
    pub fn raise_failure(&self) -> PyResult<()> {
        self.function
            .as_ref()
            .map_or(Ok(()), |function| function.raise_failure())
    }

    /// Lets a function be called no more by the work that is going on, which then raises this exception.
    pub fn give_up(&self, why: PyErr) {
        if let Some(function) = &self.function {
            function.give_up(why);
        }
    }

    /// Runs a batch on the calling thread while other Python threads run.
    ///
    /// # Errors
    /// Those of the function.
    fn run_batch(&self, py: Python<'_>, task: impl FnOnce() + Send) -> PyResult<()> {
        py.detach(task);
        self.raise_failure()
    }
}

#[pymethods]
impl PyMaterial {
    /// Its name in messages and reports.
    #[getter]
    fn name(&self) -> &str {
        self.loaded.name()
    }

    /// What it was loaded from, as `load` takes it; None for a function.
    #[getter]
    fn origin(&self) -> Option<String> {
        let source = self.source.as_ref()?;
        Some(match source.origin() {
            Origin::File(path) => path.to_string_lossy().into_owned(),
            Origin::Embedded(name) => name.to_string(),
            Origin::Formula(text) => text.clone(),
        })
    }

    /// How its values are come by.
    #[getter]
    fn reading(&self) -> String {
        self.loaded.reading()
    }

    /// The lookup rule of its table; None without a table.
    #[getter]
    fn lookup(&self) -> Option<&'static str> {
        self.loaded.rule().map(LookupRule::name)
    }

    /// Whether turning both directions about the normal leaves its values as they are.
    #[getter]
    fn is_isotropic(&self) -> bool {
        self.loaded.symmetry() == Symmetry::Isotropic
    }

    /// What its users should know.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.loaded.notes().to_vec()
    }

    /// Bytes of its tables in memory.
    #[getter]
    fn nbytes(&self) -> usize {
        self.loaded.bytes()
    }

    /// SHA-256 of the bytes that define it.
    #[getter]
    fn sha256(&self, py: Python<'_>) -> PyResult<String> {
        let source = self.source("a checksum")?;
        py.detach(|| source.sha256()).map_err(raise)
    }

    /// f_r of pairs of directions, in 1/sr, without the cosine.
    ///
    /// `wo` and `wi` have the shape (..., 3), and their leading axes are broadcast; the result has these axes and 3 for RGB, float32.
    /// Directions of other lengths than 1 are renormalised. The value is 0 where a direction is not finite or not above the
    /// horizon.
    fn eval<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        wi: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let input = BatchInput::read(wo, wi, "wi", 3)?;
        let mut out = Results::new(py, input.axes(), Some(3))?;
        let (wo, wi, values) = (input.wo()?, input.other()?, out.vectors()?);
        self.run_batch(py, || self.loaded.brdf().eval_batch(wo, wi, values))?;
        out.finish()
    }

    /// f_r times the cosine of `wi`, in 1/sr; shapes are those of `eval`.
    fn eval_cos<'py>(
        &self,
        py: Python<'py>,
        wo: &Bound<'py, PyAny>,
        wi: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let input = BatchInput::read(wo, wi, "wi", 3)?;
        let mut out = Results::new(py, input.axes(), Some(3))?;
        let (wo, wi, values) = (input.wo()?, input.other()?, out.vectors()?);
        self.run_batch(py, || self.loaded.brdf().eval_cos_batch(wo, wi, values))?;
        out.finish()
    }

    /// The directional albedo: the fraction of light from everywhere that is reflected towards `wo`.
    ///
    /// `wo` has the shape (..., 3), the result too: a fraction for each channel, by quadrature.
    fn albedo<'py>(&self, py: Python<'py>, wo: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let rows = Rows::read(wo, "wo", 3)?;
        let mut out = Results::new(py, rows.axes(), Some(3))?;
        let directions: &[Vec3] = rows.vectors()?;
        let values: &mut [Rgb] = out.vectors()?;
        self.run(py, || {
            let brdf = &**self.loaded.brdf();
            values
                .par_iter_mut()
                .zip(directions)
                .for_each(|(value, wo)| *value = integrate_albedo(brdf, *wo));
        })?;
        out.finish()
    }

    /// f_r in the cells of its MERL table, in 1/sr, by [theta_h, theta_d, phi_d, rgb]: (90, 90, 180, 3), float32, read-only.
    ///
    /// It is the material's own memory, with a stride of 16 bytes between cells; a copy if cells are kept as f16 or rgb9e5. Channels
    /// are scaled as they should be, and invalid cells are 0 (`valid`). `merlkit.axes` has the angles.
    #[getter]
    fn table<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let loaded = &slf.get().loaded;
        let measured = loaded.require_table("an array of cells").map_err(raise)?;
        table::cells(slf.as_any(), measured.table())
    }

    /// Which channels of which cells of `table` hold a value: an array of bool of its shape.
    #[getter]
    fn valid<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<bool>>> {
        let measured = self
            .loaded
            .require_table("a mask of cells")
            .map_err(raise)?;
        table::valid(py, measured.table())
    }

    /// Angles of the cells' lower edges, radians.
    #[getter]
    fn _axes<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyArray1<f64>>; 3]> {
        let measured = self.loaded.require_table("axes of cells").map_err(raise)?;
        Ok(table::axes(py, measured.table()))
    }

    /// Writes it as a MERL binary. A material that is no table is tabulated at the centres of bins; it must be isotropic.
    #[pyo3(signature = (path, *, overwrite = false))]
    fn write_merl(&self, py: Python<'_>, path: &Bound<'_, PyAny>, overwrite: bool) -> PyResult<()> {
        let path = path_text(path)?;
        let path = Path::new(&path);
        let overwrite = errors::overwrite(path, overwrite)?;
        let facts = self.loaded.facts();
        facts
            .require_isotropic(self.loaded.name(), "a MERL table")
            .map_err(raise)?;
        let table = self.run(py, || match self.loaded.table() {
            Some(measured) => Ok((**measured.table()).clone()),
            None => tabulate_brdf(&**self.loaded.brdf(), BinPoint::Centre),
        })?;
        let table = table.map_err(raise)?;
        py.detach(|| write(&table, path, overwrite)).map_err(raise)
    }

    /// A sphere of it under two directional lights, linear RGB of the shape (side, side, 3).
    #[pyo3(signature = (side = 128))]
    fn sphere<'py>(&self, py: Python<'py>, side: usize) -> PyResult<Bound<'py, PyAny>> {
        render::require_side(side)?;
        let image = self.run(py, || sphere_image(&**self.loaded.brdf(), side))?;
        render::to_array(py, &image.map_err(raise)?)
    }

    /// A sphere for notebooks.
    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let image = self.run(py, || sphere_image(&**self.loaded.brdf(), SPHERE_SIDE))?;
        render::to_png(py, &image.map_err(raise)?)
    }

    fn __repr__(&self) -> String {
        let symmetry = match self.loaded.symmetry() {
            Symmetry::Isotropic => "isotropic",
            _ => "anisotropic",
        };
        format!(
            "<merlkit.Material {}: {}, {symmetry}, {} bytes of tables>",
            self.loaded.name(),
            self.loaded.reading(),
            self.loaded.bytes()
        )
    }

    /// Materials are pickled as what they were loaded from.
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let source = self.source("a pickle")?;
        let restore = py.import("merlkit")?.getattr("_restore_material")?;
        let invalid = match source.keeps_channels_apart() {
            true => "channel",
            false => "cell",
        };
        let arguments = (
            self.origin(),
            self.lookup().unwrap_or("floor"),
            invalid,
            source.cell_format().name(),
        );
        Ok((restore, arguments.into_pyobject(py)?))
    }
}

/// ∫ f_r(wo, wi) cosθᵢ dσ(wi), with the nodes and in the order of the library's own albedo, and so its bits.
fn integrate_albedo(brdf: &dyn Brdf, wo: Vec3) -> Rgb {
    let quadrature = Quadrature::new(wo, POINTS_PER_BIN);
    let mut sum = DVec3::ZERO;
    let (mut wi, mut solid_angles) = (Vec::with_capacity(BATCH), Vec::with_capacity(BATCH));
    let mut values = [Rgb::ZERO; BATCH];
    quadrature.for_each(|direction, d_sigma| {
        wi.push(direction);
        solid_angles.push(d_sigma);
        if wi.len() == BATCH {
            sum_batch(brdf, wo, &wi, &solid_angles, &mut values, &mut sum);
            wi.clear();
            solid_angles.clear();
        }
    });
    sum_batch(brdf, wo, &wi, &solid_angles, &mut values, &mut sum);
    sum.as_vec3()
}

/// Adds f_r·cosθᵢ·Δσ of a few nodes, one after another.
fn sum_batch(
    brdf: &dyn Brdf,
    wo: Vec3,
    wi: &[Vec3],
    solid_angles: &[f64],
    values: &mut [Rgb],
    sum: &mut DVec3,
) {
    let values = &mut values[..wi.len()];
    brdf.eval_cos_batch(Wo::One(wo), wi, values);
    for (value, d_sigma) in values.iter().zip(solid_angles) {
        *sum += value.as_dvec3() * *d_sigma;
    }
}
