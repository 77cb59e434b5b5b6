//! From a `.bsdf` file to a table.

use std::path::Path;

use glam::{DQuat, DVec3};
use rayon::prelude::*;

use super::{Header, MerlTable, THETA_D_BINS};
use crate::geometry::{merl_axes, reflect_about, spherical};
use crate::material::rgl::{BsdfFile, RglBrdf};
use crate::{Error, Result};

/// Where in a bin a table's value stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinPoint {
    /// At its lower edges, as [`crate::material::merl::LookupRule::Linear`] has it.
    Edge,
    /// At its centre, as the other two have it.
    Centre,
}

const HEADER: Header = Header { phi_d_bins: 180 };

/// Resamples an isotropic `.bsdf` file as a table, and returns the file's own values too. A bin's value is f_r in sr⁻¹ at its
/// `point`, the mean of both orders of the directions, since a table is reciprocal. A bin that is below the horizon is
/// invalid; one whose centre alone is has the mean of its corners above.
///
/// # Errors
/// As [`BsdfFile::open`]; [`Error::Unsupported`] for an anisotropic material.
pub fn import_bsdf(path: &Path, point: BinPoint) -> Result<(MerlTable, RglBrdf)> {
    let file = BsdfFile::open(path)?;
    if !file.is_isotropic() {
        return Err(Error::Unsupported {
            path: path.to_owned(),
            what: format!("an anisotropic material, of {} azimuths,", file.phi_i.len()),
            fix: "name an isotropic one: a MERL table has no azimuth of the surface; eval, build, sample, check, report and render \
                  take anisotropic ones as they are"
                .into(),
        });
    }
    let rgl = RglBrdf::new(file);
    Ok((resample(&rgl, point), rgl))
}

/// The table of an isotropic file; see [`import_bsdf`].
fn resample(rgl: &RglBrdf, point: BinPoint) -> MerlTable {
    let mut values = vec![[0.0f64; 3]; HEADER.cells()];
    let row = THETA_D_BINS * HEADER.phi_d_bins;
    values.par_chunks_mut(row).enumerate().for_each(|(h, row)| {
        for (k, value) in row.iter_mut().enumerate() {
            *value = bin(
                rgl,
                [h, k / HEADER.phi_d_bins, k % HEADER.phi_d_bins],
                point,
            );
        }
    });
    let mut values = values.into_iter();
    MerlTable::from_fn(HEADER, |_, _, _| values.next().unwrap_or([-1.0; 3]))
}

/// The value of a bin, −1 where it is below the horizon.
fn bin(rgl: &RglBrdf, bin: [usize; 3], point: BinPoint) -> [f64; 3] {
    let at = |offsets: [f64; 3]| {
        value(
            rgl,
            std::array::from_fn(|axis| bin[axis] as f64 + offsets[axis]),
        )
    };
    let offset = if point == BinPoint::Edge { 0.0 } else { 0.5 };
    if let Some(value) = at([offset; 3]) {
        return value.to_array();
    }
    if point == BinPoint::Edge {
        return [-1.0; 3];
    }
    let corners =
        (0..8).map(|k| [0, 1, 2].map(|axis| if k >> axis & 1 == 0 { 0.05 } else { 0.95 }));
    let above: Vec<DVec3> = corners.filter_map(at).collect();
    let mean = above.iter().sum::<DVec3>() / above.len() as f64;
    if above.is_empty() {
        [-1.0; 3]
    } else {
        mean.to_array()
    }
}

/// The value at coordinates in bins; `None` below the horizon.
fn value(rgl: &RglBrdf, [h, d, p]: [f64; 3]) -> Option<DVec3> {
    let theta_h = merl_axes::theta_h(h);
    let theta_d = merl_axes::theta_d(d);
    let wi = DQuat::from_rotation_y(theta_h) * spherical(theta_d, p.to_radians());
    let wo = reflect_about(wi, spherical(theta_h, 0.0));
    let (wo, wi) = (wo.as_vec3(), wi.as_vec3());
    (wo.z > 0.0 && wi.z > 0.0)
        .then(|| 0.5 * (rgl.value(wo, wi).as_dvec3() + rgl.value(wi, wo).as_dvec3()))
}
