//! From a pair of directions to MERL's bins without trigonometry.
//!
//! Every bin edge is an angle whose squared tangent is known beforehand ([`crate::geometry::merl_axes`]). Computed in f64,
//! the result differs from arctangents in f64 only where an angle lies within rounding of an edge.

use glam::Vec3;

use super::half_diff_tan2::HalfDiffTan2;
use crate::geometry::merl_axes::AxisBins;

/// Bin indices of a pair of directions.
///
/// The example of [`MerlTable`](crate::material::merl::MerlTable) makes a table and evaluates it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BinIndex {
    /// 0..90, spaced as √θh.
    pub theta_h: usize,
    /// 0..90, one a degree.
    pub theta_d: usize,
    /// 0..180 (φd and φd + π are one, by reciprocity) or 0..360.
    pub phi_d: usize,
}

impl BinIndex {
    /// Bins of a pair for a table of `phi_d_bins` (180 or 360); `None` unless both directions are above the horizon.
    #[inline(always)]
    pub fn find(wo: Vec3, wi: Vec3, phi_d_bins: usize) -> Option<Self> {
        find_bins(
            AxisBins::get(),
            HalfDiffTan2::from_directions(wo, wi),
            wi,
            phi_d_bins,
        )
    }

    /// Bin of θh by its squared tangent, 0 to infinity.
    #[inline]
    pub fn theta_h_of_tan2(tan2: f64) -> usize {
        AxisBins::get().theta_h.bin(tan2)
    }

    /// Bin of θd by its squared tangent, 0 to infinity.
    #[inline]
    pub fn theta_d_of_tan2(tan2: f64) -> usize {
        AxisBins::get().degrees.bin(tan2)
    }
}

/// Bins of a pair from its squared tangents and `wi`; `None` unless both directions are above the horizon.
#[inline(always)]
pub(super) fn find_bins(
    axes: &AxisBins,
    tan2: HalfDiffTan2,
    wi: Vec3,
    phi_d_bins: usize,
) -> Option<BinIndex> {
    if tan2.theta_h.is_nan() {
        return None;
    }
    let phi_d = if tan2.theta_h > 0.0 {
        let quarter = axes.degrees.bin(tan2.phi_d.abs());
        // φd and φd + π share a bin of 180. Either quarter comes as often, so it is chosen without a branch: q or 179 − q.
        let falling = usize::from(tan2.phi_d < 0.0);
        let half = (quarter ^ falling.wrapping_neg()).wrapping_add(180 * falling);
        half + 180 * usize::from((phi_d_bins == 360) & (tan2.half_turn < 0.0))
    } else {
        azimuth_bin(wi.x, wi.y, phi_d_bins)
    };
    Some(BinIndex {
        theta_h: axes.theta_h.bin(tan2.theta_h),
        theta_d: axes.degrees.bin(tan2.theta_d),
        phi_d,
    })
}

/// Bin of φd where the half vector is the normal: it is the azimuth of `wi`.
#[cold]
fn azimuth_bin(x: f32, y: f32, phi_d_bins: usize) -> usize {
    (azimuth(x, y, phi_d_bins) as usize).min(phi_d_bins - 1)
}

/// Azimuth in degrees from 0 to `phi_d_bins`; π is 0 for a table of 180.
pub(super) fn azimuth(x: f32, y: f32, phi_d_bins: usize) -> f64 {
    // Opposite azimuths are one in a table of 180: rounding must not make them differ.
    let sign = if phi_d_bins == 180 && (y < 0.0 || (y == 0.0 && x < 0.0)) {
        -1.0
    } else {
        1.0
    };
    let degrees = (sign * f64::from(y))
        .atan2(sign * f64::from(x))
        .to_degrees();
    let positive = if degrees < 0.0 {
        degrees + phi_d_bins as f64
    } else {
        degrees
    };
    if phi_d_bins == 180 && positive == 180.0 {
        0.0
    } else {
        positive
    }
}
