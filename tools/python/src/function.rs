//! A function in Python as a BRDF.

use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicBool, Ordering};

use merlkit::color::Rgb;
use merlkit::geometry::{spherical, unit_upper};
use merlkit::glam::Vec3;
use merlkit::{Brdf, Wo};
use numpy::{PyArray2, PyArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::arrays::Rows;

/// Angles about the normal that both directions are turned by to see whether a function is isotropic, radians.
const TURNS: [f64; 2] = [0.7, 2.9];
/// Relative difference that rounding may make between values of turned directions.
const ROUNDING: f32 = 1e-3;

/// A function of two arrays of directions. It is called with unit directions above the horizon.
///
/// A BRDF can't fail, so the first exception is kept for [`Self::raise_failure`], and values after it are 0.
pub struct PythonBrdf {
    function: Py<PyAny>,
    isotropic: bool,
    failed: AtomicBool,
    failure: Mutex<Option<PyErr>>,
}

impl PythonBrdf {
    /// Calls the function once to see whether it fits.
    ///
    /// # Errors
    /// `TypeError` for what can't be called; `ValueError` for a result of the wrong shape, and for a function that is said to be
    /// isotropic and is not; the function's own exceptions.
    pub fn new(py: Python<'_>, function: Py<PyAny>, isotropic: bool) -> PyResult<Self> {
        if !function.bind(py).is_callable() {
            return Err(PyTypeError::new_err(
                "expected a function f(wo, wi) of two arrays of the shape (N, 3)",
            ));
        }
        let brdf = Self {
            function,
            isotropic,
            failed: AtomicBool::new(false),
            failure: Mutex::new(None),
        };
        brdf.try_out()?;
        Ok(brdf)
    }

    /// Lets the work that is calling the function come to its end: it is not called any more, and this exception is raised then.
    pub fn give_up(&self, why: PyErr) {
        let mut failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner);
        failure.get_or_insert(why);
        self.failed.store(true, Ordering::Relaxed);
    }

    /// Raises the exception that a call met, if one did, and forgets it.
    ///
    /// # Errors
    /// That exception.
    pub fn raise_failure(&self) -> PyResult<()> {
        if !self.failed.swap(false, Ordering::Relaxed) {
            return Ok(());
        }
        let mut failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner);
        failure.take().map_or(Ok(()), Err)
    }

    /// Evaluates a few pairs, and the same pairs turned about the normal.
    fn try_out(&self) -> PyResult<()> {
        let angles = [
            [0.3, 0.0, 0.4, 1.0],
            [0.9, 2.0, 0.2, -1.0],
            [1.2, 0.5, 1.1, 3.3],
        ];
        let mut values = Vec::new();
        for turn in [0.0, TURNS[0], TURNS[1]] {
            let (mut wo, mut wi) = (Vec::new(), Vec::new());
            for [theta_o, phi_o, theta_i, phi_i] in angles {
                wo.push(spherical(theta_o, phi_o + turn).as_vec3());
                wi.push(spherical(theta_i, phi_i + turn).as_vec3());
            }
            let mut found = vec![Rgb::ZERO; wo.len()];
            self.evaluate(Wo::Each(&wo), &wi, &mut found);
            self.raise_failure()?;
            values.push(found);
        }
        if !self.isotropic {
            return Ok(());
        }
        for turned in &values[1..] {
            for (a, b) in values[0].iter().zip(turned) {
                if (*a - *b).abs().max_element() > ROUNDING * a.max(*b).max_element() {
                    return Err(PyValueError::new_err(
                        "the function is not isotropic: turning both directions about the normal changes its value; \
                         pass isotropic=False",
                    ));
                }
            }
        }
        Ok(())
    }

    /// The values of a batch; 0 after a failure.
    fn evaluate(&self, wo: Wo<'_>, wi: &[Vec3], out: &mut [Rgb]) {
        if wi.is_empty() || self.failed.load(Ordering::Relaxed) {
            out.fill(Rgb::ZERO);
            return;
        }
        let result = Python::attach(|py| self.call(py, wo, wi, out));
        if let Err(error) = result {
            out.fill(Rgb::ZERO);
            self.give_up(error);
        }
    }

    fn call(&self, py: Python<'_>, wo: Wo<'_>, wi: &[Vec3], out: &mut [Rgb]) -> PyResult<()> {
        // Step 1: unit directions above the horizon. Others have the value 0, and their place is taken by the normal.
        let mut given = Vec::with_capacity(wi.len());
        let mut sampled = Vec::with_capacity(wi.len());
        let mut inside = Vec::with_capacity(wi.len());
        for (lane, wi) in wi.iter().enumerate() {
            let pair = unit_upper(wo.lane(lane)).zip(unit_upper(*wi));
            let (wo, wi) = pair.unwrap_or((Vec3::Z, Vec3::Z));
            inside.push(pair.is_some());
            given.push(wo);
            sampled.push(wi);
        }
        // Step 2: the call.
        let result = self
            .function
            .bind(py)
            .call1((to_array(py, &given)?, to_array(py, &sampled)?))?;
        // Step 3: its values, which must be finite and not negative.
        let rows = Rows::read(&result, "the function's result", 3)?;
        if rows.axes() != [wi.len()] {
            return Err(PyValueError::new_err(format!(
                "the function's result has the shape {}; for {count} pairs it must be ({count}, 3)",
                rows.shape_text(),
                count = wi.len()
            )));
        }
        let values: &[Rgb] = rows.vectors()?;
        for (lane, value) in values.iter().enumerate() {
            out[lane] = match inside[lane] {
                true => checked(*value, given[lane], sampled[lane])?,
                false => Rgb::ZERO,
            };
        }
        Ok(())
    }
}

impl Brdf for PythonBrdf {
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let mut value = [Rgb::ZERO];
        self.evaluate(Wo::One(wo), &[wi], &mut value);
        value[0]
    }

    fn eval_batch(&self, wo: Wo<'_>, wi: &[Vec3], out: &mut [Rgb]) {
        wo.assert_lanes(wi.len(), out.len());
        self.evaluate(wo, wi, out);
    }

    fn eval_cos_batch(&self, wo: Wo<'_>, wi: &[Vec3], out: &mut [Rgb]) {
        self.eval_batch(wo, wi, out);
        for (value, wi) in out.iter_mut().zip(wi) {
            *value *= unit_upper(*wi).map_or(0.0, |wi| wi.z);
        }
    }

    fn is_isotropic(&self) -> bool {
        self.isotropic
    }
}

fn to_array<'py>(py: Python<'py>, rows: &[Vec3]) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let array = PyArray2::zeros(py, [rows.len(), 3], false);
    array
        .try_readwrite()?
        .as_slice_mut()?
        .copy_from_slice(bytemuck::cast_slice(rows));
    Ok(array)
}

/// The value, unless it is none that a BRDF can have.
fn checked(value: Rgb, wo: Vec3, wi: Vec3) -> PyResult<Rgb> {
    if value.is_finite() && value.min_element() >= 0.0 {
        return Ok(value);
    }
    Err(PyValueError::new_err(format!(
        "the function's value at wo = {wo}, wi = {wi} is {value}; values must be finite and not negative"
    )))
}
