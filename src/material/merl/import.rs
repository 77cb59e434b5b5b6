//! From any isotropic reflectance to a table.

use glam::{DQuat, DVec3, Vec3};
use rayon::prelude::*;

use super::{Header, MerlTable, THETA_D_BINS};
use crate::brdf::Brdf;
use crate::color::Rgb;
use crate::geometry::{is_upper, merl_axes, reflect_about, spherical};
use crate::{Error, Result};

/// Where in a bin the value of a table is taken.
///
/// The example of [`MerlTable`](crate::material::merl::MerlTable) makes a table and evaluates it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinPoint {
    /// At its lower edges, where [`crate::material::LookupRule::Linear`] places it.
    Edge,
    /// At its centre, where the other two rules place it.
    Centre,
}

const HEADER: Header = Header { phi_d_bins: 180 };

/// Where the search for a point above the horizon ends, as a fraction of the way from the uppermost corner to the centre: beyond,
/// heights are of the size of rounding.
const LEAST_DISTANCE: f64 = 1e-6;

/// Tabulates an isotropic BRDF on the threads of the current pool. A bin's value is the [`reciprocal_mean`] at its `point`, in
/// sr⁻¹. A bin that lies below the horizon is invalid; where only its centre does, the value is that of the first point above
/// the horizon on the way from the centre to the bin's uppermost corner.
///
/// See [`MerlTable`](crate::material::merl::MerlTable) for an example of a table.
///
/// # Errors
/// [`Error::Argument`] for an anisotropic BRDF.
pub fn tabulate_brdf(brdf: &dyn Brdf, point: BinPoint) -> Result<MerlTable> {
    if !brdf.is_isotropic() {
        return Err(Error::argument(
            "a MERL table is isotropic, and this material is anisotropic",
            "use the material as it is; only commands that need a table refuse it",
        ));
    }
    Ok(tabulate_pairs(point, &|wo, wi| {
        reciprocal_mean(brdf, wo, wi).as_dvec3().to_array()
    }))
}

/// Tabulates a function of two directions on the threads of the current pool: `value` is called with the pair at the `point` of
/// each bin, as [`tabulate_brdf`] does, and gives −1 for a gap.
pub(in crate::material) fn tabulate_pairs(
    point: BinPoint,
    value: &(dyn Fn(Vec3, Vec3) -> [f64; 3] + Sync),
) -> MerlTable {
    let mut values = vec![[0.0f64; 3]; HEADER.cells()];
    let row = THETA_D_BINS * HEADER.phi_d_bins;
    values.par_chunks_mut(row).enumerate().for_each(|(h, row)| {
        for (k, cell) in row.iter_mut().enumerate() {
            let bin = [h, k / HEADER.phi_d_bins, k % HEADER.phi_d_bins];
            let pair = match point {
                BinPoint::Edge => upper_pair(bin, [0.0; 3]),
                BinPoint::Centre => central_pair(bin),
            };
            *cell = pair.map_or([-1.0; 3], |(wo, wi)| value(wo, wi));
        }
    });
    let mut values = values.into_iter();
    MerlTable::from_fn(HEADER, |_, _, _| values.next().unwrap_or([-1.0; 3]))
}

/// The reciprocal reflectance closest to one that need not be: the mean of f_r over both orders of the directions, each
/// weighted by the cosine of its incident direction.
///
/// ```text
/// f̄(wo, wi) = (f(wo, wi)·cosθᵢ + f(wi, wo)·cosθₒ)/(cosθᵢ + cosθₒ)
/// ```
///
/// A MERL table has one value for both orders. Measured f_r·cosθᵢ does not vanish at the horizon, so f_r has no bound there;
/// the weights leave out what the quotient makes of it, and keep the energy that a grazing `wo` reflects. 0 unless both
/// directions are above the horizon.
///
/// See [`MerlTable`](crate::material::merl::MerlTable) for an example of a table.
pub fn reciprocal_mean(brdf: &dyn Brdf, wo: Vec3, wi: Vec3) -> Rgb {
    if !is_upper(wo) || !is_upper(wi) {
        return Rgb::ZERO;
    }
    let sum = brdf.eval_cos(wo, wi).as_dvec3() + brdf.eval_cos(wi, wo).as_dvec3();
    (sum / (f64::from(wo.z) + f64::from(wi.z))).as_vec3()
}

/// The pair at a bin's centre or, if that is below the horizon, as near to it as can be told on the way to the uppermost corner;
/// `None` if that corner is below as well.
fn central_pair(bin: [usize; 3]) -> Option<(Vec3, Vec3)> {
    // The lower direction has the height cosθh·cosθd − sinθh·sinθd·|cosφd|: least θh and θd, and φd closest to 90°, lift it.
    let towards_90 = f64::from(bin[2] < HEADER.phi_d_bins / 2);
    let corner = [0.0, 0.0, towards_90];
    let mut distance = 1.0;
    while distance > LEAST_DISTANCE {
        let offsets = corner.map(|c| c + distance * (0.5 - c));
        if let Some(pair) = upper_pair(bin, offsets) {
            return Some(pair);
        }
        distance *= 0.5;
    }
    upper_pair(bin, corner)
}

/// The pair (`wo`, `wi`) at `offsets` of a bin's edges, in parts of the bin; `None` below the horizon.
fn upper_pair(bin: [usize; 3], offsets: [f64; 3]) -> Option<(Vec3, Vec3)> {
    let [h, d, p] = [0, 1, 2].map(|axis| bin[axis] as f64 + offsets[axis]);
    let (wo, wi) = pair_of_angles(merl_axes::theta_h(h), merl_axes::theta_d(d), p.to_radians());
    let (wo, wi) = (wo.as_vec3(), wi.as_vec3());
    (is_upper(wo) && is_upper(wi)).then_some((wo, wi))
}

/// (`wo`, `wi`) by their half and difference angles, in radians, with the half vector in the plane y = 0.
pub(in crate::material) fn pair_of_angles(
    theta_h: f64,
    theta_d: f64,
    phi_d: f64,
) -> (DVec3, DVec3) {
    // The difference vector, turned from the normal to the half vector, is wi; its mirror image is wo.
    let wi = DQuat::from_rotation_y(theta_h) * spherical(theta_d, phi_d);
    (reflect_about(wi, spherical(theta_h, 0.0)), wi)
}

/// Whether part of a bin is above the horizon.
pub(in crate::material) fn bin_is_upper(bin: [usize; 3]) -> bool {
    central_pair(bin).is_some()
}
