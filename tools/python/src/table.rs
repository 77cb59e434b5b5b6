//! The cells of a MERL table as arrays.

use merlkit::geometry::merl_axes::{degree_edge, theta_d, theta_h_edge};
use merlkit::glam::Vec4;
use merlkit::material::merl::{MerlTable, THETA_D_BINS, THETA_H_BINS};
use ndarray::{ArrayView4, ShapeBuilder, s};
use numpy::{PyArray1, PyArray4, PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Numbers in a cell: RGB, and whether they are valid.
const CELL: usize = 4;

/// f_r by `[theta_h, theta_d, phi_d, rgb]`, read-only. It is the memory of `table`, which belongs to `owner`, or a copy if
/// the cells are compact.
pub fn cells<'py>(owner: &Bound<'py, PyAny>, table: &MerlTable) -> PyResult<Bound<'py, PyAny>> {
    let py = owner.py();
    let array = match table.cells_in_memory() {
        Some(cells) => borrowed(owner, cells, table.phi_d_bins())?,
        None => {
            let mut numbers = Vec::with_capacity(CELL * table.header().cells());
            for cell in table.cells() {
                numbers.extend(cell.truncate().to_array());
            }
            let flat = PyArray1::from_vec(py, numbers);
            flat.reshape([THETA_H_BINS, THETA_D_BINS, table.phi_d_bins(), 3])?
        }
    };
    let options = PyDict::new(py);
    options.set_item("write", false)?;
    array.call_method("setflags", (), Some(&options))?;
    Ok(array.into_any())
}

/// An array in the memory of cells, which `owner` keeps alive.
#[allow(unsafe_code)]
fn borrowed<'py>(
    owner: &Bound<'py, PyAny>,
    cells: &[Vec4],
    phi_d_bins: usize,
) -> PyResult<Bound<'py, PyArray4<f32>>> {
    let numbers: &[f32] = bytemuck::cast_slice(cells);
    let shape = (THETA_H_BINS, THETA_D_BINS, phi_d_bins, CELL).into_shape_with_order();
    let view = ArrayView4::from_shape(shape, numbers)
        .map_err(|e| PyRuntimeError::new_err(e.to_string()))?;
    let rgb = view.slice(s![.., .., .., ..3]);
    // SAFETY: the cells are part of `owner`, a frozen object that the array holds, and nothing moves or changes them while it
    // lives. The array is made read-only before anyone sees it, and numpy makes no array writeable whose owner has no buffer.
    Ok(unsafe { PyArray4::borrow_from_array(&rgb, owner.clone()) })
}

/// Whether each channel of each cell holds a value, by `[theta_h, theta_d, phi_d, rgb]`.
pub fn valid<'py>(py: Python<'py>, table: &MerlTable) -> PyResult<Bound<'py, PyArrayDyn<bool>>> {
    let count = table.header().cells();
    let mut flags = Vec::with_capacity(3 * count);
    for cell in 0..count {
        flags.extend(table.valid_channels(cell));
    }
    let shape = vec![THETA_H_BINS, THETA_D_BINS, table.phi_d_bins(), 3];
    PyArray1::from_vec(py, flags).reshape(shape)
}

/// The lower edges of the bins of θh, θd and φd, radians.
pub fn axes<'py>(py: Python<'py>, table: &MerlTable) -> [Bound<'py, PyArray1<f64>>; 3] {
    let mut edges = [Vec::new(), Vec::new(), Vec::new()];
    for bin in 0..THETA_H_BINS {
        edges[0].push(theta_h_edge(bin));
    }
    for bin in 0..THETA_D_BINS {
        edges[1].push(theta_d(bin as f64));
    }
    for bin in 0..table.phi_d_bins() {
        edges[2].push(degree_edge(bin));
    }
    edges.map(|edge| PyArray1::from_vec(py, edge))
}
