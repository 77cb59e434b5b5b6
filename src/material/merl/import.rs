//! From any isotropic reflectance to a table.

use glam::{DQuat, DVec3};
use rayon::prelude::*;

use super::{Header, MerlTable, THETA_D_BINS};
use crate::brdf::Brdf;
use crate::geometry::{merl_axes, reflect_about, spherical};
use crate::{Error, Result};

/// Where in a bin the value of a table is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinPoint {
    /// At its lower edges, where [`crate::material::LookupRule::Linear`] places it.
    Edge,
    /// At its centre, where the other two rules place it.
    Centre,
}

const HEADER: Header = Header { phi_d_bins: 180 };

/// Tabulates an isotropic BRDF on the threads of the current pool. A bin's value is f_r in sr⁻¹ at its `point`, the mean of
/// both orders of the directions, since a table is reciprocal. A bin below the horizon is invalid; one whose centre alone is
/// has the mean of its corners above.
///
/// # Errors
/// [`Error::Argument`] for an anisotropic BRDF.
pub fn tabulate_brdf(brdf: &dyn Brdf, point: BinPoint) -> Result<MerlTable> {
    if !brdf.is_isotropic() {
        return Err(Error::argument(
            "a MERL table has no azimuth of the surface, and this material is anisotropic",
            "use the material as it is: every command but those that need a table takes it",
        ));
    }
    let mut values = vec![[0.0f64; 3]; HEADER.cells()];
    let row = THETA_D_BINS * HEADER.phi_d_bins;
    values.par_chunks_mut(row).enumerate().for_each(|(h, row)| {
        for (k, value) in row.iter_mut().enumerate() {
            let bin = [h, k / HEADER.phi_d_bins, k % HEADER.phi_d_bins];
            *value = bin_value(brdf, bin, point);
        }
    });
    let mut values = values.into_iter();
    Ok(MerlTable::from_fn(HEADER, |_, _, _| {
        values.next().unwrap_or([-1.0; 3])
    }))
}

/// The value of a bin, −1 where it is below the horizon.
fn bin_value(brdf: &dyn Brdf, bin: [usize; 3], point: BinPoint) -> [f64; 3] {
    let offset = if point == BinPoint::Edge { 0.0 } else { 0.5 };
    if let Some(value) = value_within(brdf, bin, [offset; 3]) {
        return value.to_array();
    }
    if point == BinPoint::Edge {
        return [-1.0; 3];
    }
    // The centre is below the horizon: the mean of the corners above it, taken a little inside the bin.
    let (mut sum, mut count) = (DVec3::ZERO, 0);
    for corner in 0..8 {
        let inside = |axis: usize| if corner >> axis & 1 == 0 { 0.05 } else { 0.95 };
        if let Some(value) = value_within(brdf, bin, [inside(0), inside(1), inside(2)]) {
            sum += value;
            count += 1;
        }
    }
    if count == 0 {
        return [-1.0; 3];
    }
    (sum / f64::from(count)).to_array()
}

/// The value at `offsets` of a bin's edges, in parts of the bin; `None` below the horizon.
fn value_within(brdf: &dyn Brdf, bin: [usize; 3], offsets: [f64; 3]) -> Option<DVec3> {
    let [h, d, p] = [0, 1, 2].map(|axis| bin[axis] as f64 + offsets[axis]);
    let theta_h = merl_axes::theta_h(h);
    let theta_d = merl_axes::theta_d(d);
    // The difference vector, turned from the normal to the half vector, is wi; its mirror image is wo.
    let wi = DQuat::from_rotation_y(theta_h) * spherical(theta_d, p.to_radians());
    let wo = reflect_about(wi, spherical(theta_h, 0.0));
    let (wo, wi) = (wo.as_vec3(), wi.as_vec3());
    if wo.z <= 0.0 || wi.z <= 0.0 {
        return None;
    }
    Some(0.5 * (brdf.eval(wo, wi).as_dvec3() + brdf.eval(wi, wo).as_dvec3()))
}
