//! Arguments as rows of `f32`, and arrays for results.
//!
//! An array of `f32` whose rows are contiguous is used where it is. Everything else that numpy takes for real numbers is copied.

use bytemuck::Pod;
use merlkit::Wo;
use merlkit::glam::Vec3;
use numpy::{
    PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyReadwriteArrayDyn,
    PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple};

use crate::memory;

/// Results of more elements are allocated by numpy's own function, which refuses what is too much by an exception.
const FEW: usize = 1 << 16;

/// An array of rows: its leading axes and its numbers.
pub struct Rows<'py> {
    array: PyReadonlyArrayDyn<'py, f32>,
    axes: Vec<usize>,
    width: usize,
}

impl<'py> Rows<'py> {
    /// Reads the argument `name`, whose last axis must have `width` elements.
    ///
    /// # Errors
    /// `TypeError` for what is no array of real numbers, `ValueError` for another shape.
    pub fn read(value: &Bound<'py, PyAny>, name: &str, width: usize) -> PyResult<Self> {
        let array = match value.cast::<PyArrayDyn<f32>>() {
            Ok(array) if is_plain(array) => array.clone(),
            _ => converted(value, name)?,
        };
        let shape = array.shape();
        match shape.split_last() {
            Some((&last, axes)) if last == width => Ok(Self {
                axes: axes.to_vec(),
                array: array.try_readonly()?,
                width,
            }),
            _ => Err(PyValueError::new_err(format!(
                "{name} has the shape {}; it must be (…, {width}), such as (N, {width})",
                shape_text(shape)
            ))),
        }
    }

    /// The same rows, repeated to the leading axes `axes` by numpy's rules.
    ///
    /// # Errors
    /// `MemoryError` if they don't fit.
    pub fn repeat(self, axes: &[usize]) -> PyResult<Self> {
        if self.axes == axes {
            return Ok(self);
        }
        let py = self.array.py();
        let rows = count(axes)?;
        memory::require(rows, 2 * self.width * size_of::<f32>())?;
        let mut shape = axes.to_vec();
        shape.push(self.width);
        let shape = PyTuple::new(py, shape)?;
        let repeated = numpy_module(py)?.call_method1("broadcast_to", (&*self.array, shape))?;
        let repeated = numpy_module(py)?.call_method1("ascontiguousarray", (repeated,))?;
        let array = repeated.cast_into::<PyArrayDyn<f32>>()?;
        Ok(Self {
            array: array.try_readonly()?,
            axes: axes.to_vec(),
            width: self.width,
        })
    }

    /// The leading axes.
    pub fn axes(&self) -> &[usize] {
        &self.axes
    }

    /// The shape as numpy prints it.
    pub fn shape_text(&self) -> String {
        shape_text(self.array.shape())
    }

    /// Whether there is one row, which may serve for all rows of another array of `others` leading axes.
    fn is_one_for(&self, others: usize) -> bool {
        self.axes.len() <= others && self.axes.iter().all(|&n| n == 1)
    }

    /// The rows as vectors of `width` numbers.
    ///
    /// # Errors
    /// None for arrays that this type holds.
    pub fn vectors<V: Pod>(&self) -> PyResult<&[V]> {
        Ok(bytemuck::cast_slice(self.array.as_slice()?))
    }
}

/// `wo`, and the other argument of a batch, whose rows correspond by numpy's rules of broadcasting.
pub struct BatchInput<'py> {
    wo: Rows<'py>,
    other: Rows<'py>,
    axes: Vec<usize>,
    one: bool,
}

impl<'py> BatchInput<'py> {
    /// Reads both; a row of `other` has `width` numbers.
    ///
    /// # Errors
    /// As [`Rows::read`]; `ValueError` for shapes that don't correspond.
    pub fn read(
        wo: &Bound<'py, PyAny>,
        other: &Bound<'py, PyAny>,
        name: &str,
        width: usize,
    ) -> PyResult<Self> {
        let wo = Rows::read(wo, "wo", 3)?;
        let other = Rows::read(other, name, width)?;
        let axes = common_axes(wo.axes(), other.axes()).ok_or_else(|| {
            PyValueError::new_err(format!(
                "wo of shape {} and {name} of shape {} don't correspond; give one wo, or one for each row of {name}",
                wo.shape_text(),
                other.shape_text()
            ))
        })?;
        let one = wo.is_one_for(axes.len());
        let wo = if one { wo } else { wo.repeat(&axes)? };
        let other = other.repeat(&axes)?;
        Ok(Self {
            wo,
            other,
            axes,
            one,
        })
    }

    /// The leading axes of the result.
    pub fn axes(&self) -> &[usize] {
        &self.axes
    }

    /// The given directions.
    ///
    /// # Errors
    /// As [`Rows::vectors`].
    pub fn wo(&self) -> PyResult<Wo<'_>> {
        let directions: &[Vec3] = self.wo.vectors()?;
        Ok(match (self.one, directions.first()) {
            (true, Some(wo)) => Wo::One(*wo),
            _ => Wo::Each(directions),
        })
    }

    /// The rows of the other argument.
    ///
    /// # Errors
    /// As [`Rows::vectors`].
    pub fn other<V: Pod>(&self) -> PyResult<&[V]> {
        self.other.vectors()
    }
}

/// An array for results that is being filled.
pub struct Results<'py> {
    array: PyReadwriteArrayDyn<'py, f32>,
}

impl<'py> Results<'py> {
    /// An array of the leading axes `axes`, and of rows of `width` numbers unless `width` is `None`.
    ///
    /// # Errors
    /// `MemoryError` if it doesn't fit.
    pub fn new(py: Python<'py>, axes: &[usize], width: Option<usize>) -> PyResult<Self> {
        let rows = count(axes)?;
        memory::require(rows, width.unwrap_or(1) * size_of::<f32>())?;
        let mut shape = axes.to_vec();
        shape.extend(width);
        let array = if rows <= FEW {
            PyArrayDyn::zeros(py, shape, false)
        } else {
            let shape = PyTuple::new(py, shape)?;
            let empty = numpy_module(py)?.call_method1("empty", (shape, "f4"))?;
            empty.cast_into::<PyArrayDyn<f32>>()?
        };
        Ok(Self {
            array: array.try_readwrite()?,
        })
    }

    /// The rows, to be written.
    ///
    /// # Errors
    /// None for arrays that this type holds.
    pub fn vectors<V: Pod>(&mut self) -> PyResult<&mut [V]> {
        Ok(bytemuck::cast_slice_mut(self.array.as_slice_mut()?))
    }

    /// The array; a number where it has no axes.
    pub fn finish(self) -> PyResult<Bound<'py, PyAny>> {
        let array: Bound<'py, PyArrayDyn<f32>> = (**self.array).clone();
        drop(self.array);
        if array.ndim() > 0 {
            return Ok(array.into_any());
        }
        array.get_item(PyTuple::empty(array.py()))
    }
}

/// numpy itself.
pub fn numpy_module(py: Python<'_>) -> PyResult<&Bound<'_, PyModule>> {
    static NUMPY: PyOnceLock<Py<PyModule>> = PyOnceLock::new();
    let module = NUMPY.get_or_try_init(py, || Ok::<_, PyErr>(py.import("numpy")?.unbind()))?;
    Ok(module.bind(py))
}

/// Whether the numbers of an array lie one after another and are aligned, and it is no subclass with a meaning of its own.
fn is_plain(array: &Bound<'_, PyArrayDyn<f32>>) -> bool {
    let address = array.data() as usize;
    array.is_c_contiguous() && address.is_multiple_of(align_of::<f32>()) && !is_masked(array)
}

/// Whether values of an array are hidden by a mask.
fn is_masked(array: &Bound<'_, PyAny>) -> bool {
    static MASKED: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let py = array.py();
    if array.is_exact_instance_of::<PyArrayDyn<f32>>() {
        return false;
    }
    let masked = MASKED.get_or_try_init(py, || {
        Ok::<_, PyErr>(py.import("numpy.ma")?.getattr("MaskedArray")?.unbind())
    });
    match masked {
        Ok(class) => array.is_instance(class.bind(py)).unwrap_or(false),
        Err(_) => false,
    }
}

/// A contiguous copy in `f32` of what numpy takes for an array of real numbers.
fn converted<'py>(value: &Bound<'py, PyAny>, name: &str) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    let py = value.py();
    if is_masked(value) {
        return Err(PyTypeError::new_err(format!(
            "{name} is a masked array; fill it first, for example by {name}.filled(0)"
        )));
    }
    let array = numpy_module(py)?.call_method1("asarray", (value,))?;
    let untyped = array.cast::<PyUntypedArray>()?;
    let kind = untyped.dtype().kind();
    if !matches!(kind, b'f' | b'i' | b'u') {
        return Err(PyTypeError::new_err(format!(
            "{name} has the dtype {}; give an array of real numbers, best of float32",
            untyped.dtype()
        )));
    }
    let rows = untyped.len() / untyped.shape().last().map_or(1, |&n| n.max(1));
    // The result will be as large.
    memory::require(rows, 6 * size_of::<f32>())?;
    let options = PyDict::new(py);
    options.set_item("order", "C")?;
    let copied = array.call_method("astype", ("=f4",), Some(&options))?;
    let copied = numpy_module(py)?.call_method1("asarray", (copied,))?;
    Ok(copied.cast_into::<PyArrayDyn<f32>>()?)
}

/// The leading axes of a result by numpy's rules of broadcasting; `None` if two lengths contradict each other.
fn common_axes(a: &[usize], b: &[usize]) -> Option<Vec<usize>> {
    if a == b {
        return Some(a.to_vec());
    }
    let axes = a.len().max(b.len());
    let mut common = Vec::with_capacity(axes);
    for axis in 0..axes {
        // Axes are aligned at the last one; those that are missing in front have the length 1.
        let first = (axis + a.len()).checked_sub(axes).map_or(1, |i| a[i]);
        let second = (axis + b.len()).checked_sub(axes).map_or(1, |i| b[i]);
        common.push(match (first, second) {
            (x, y) if x == y => x,
            (1, y) => y,
            (x, 1) => x,
            _ => return None,
        });
    }
    Some(common)
}

/// How many rows leading axes have.
fn count(axes: &[usize]) -> PyResult<usize> {
    let mut rows = 1usize;
    for &n in axes {
        rows = rows
            .checked_mul(n)
            .ok_or_else(|| PyValueError::new_err("more rows than an array can have"))?;
    }
    Ok(rows)
}

/// A shape as numpy prints it.
fn shape_text(shape: &[usize]) -> String {
    let mut words = Vec::with_capacity(shape.len());
    for n in shape {
        words.push(n.to_string());
    }
    match words.as_slice() {
        [one] => format!("({one},)"),
        _ => format!("({})", words.join(", ")),
    }
}
