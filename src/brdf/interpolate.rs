//! Trilinear lookup that leaves invalid bins out.

use glam::{Vec3, Vec4};
use std::f64::consts::FRAC_PI_2;

use super::bins::fold_phi_d;
use crate::color::Rgb;
use crate::geom::{HalfDiff, is_upper};
use crate::merl::{MerlTable, THETA_D_BINS, THETA_H_BINS};

/// Two neighbouring bins and the share of the second.
#[derive(Clone, Copy)]
struct Pair {
    low: usize,
    high: usize,
    share: f32,
}

impl Pair {
    /// Neighbours of a coordinate in units of bins, clamped at both ends of the axis.
    fn clamped(x: f64, bins: usize) -> Self {
        let x = x.clamp(0.0, (bins - 1) as f64);
        let low = x as usize;
        Self { low, high: (low + 1).min(bins - 1), share: (x - low as f64) as f32 }
    }

    /// Neighbours on an axis that closes on itself.
    fn periodic(x: f64, bins: usize) -> Self {
        let floor = x.floor();
        let low = (floor as i64).rem_euclid(bins as i64) as usize;
        Self { low, high: if low + 1 == bins { 0 } else { low + 1 }, share: (x - floor) as f32 }
    }
}

/// Value between the samples at `bin + offset`, from the valid ones among its eight neighbours, renormalised; zero if none
/// is valid. `offset` is 0 for values at bin edges and ½ for values at bin centres.
pub(super) fn trilinear(table: &MerlTable, offset: f64, wo: Vec3, wi: Vec3) -> Rgb {
    if !is_upper(wo) || !is_upper(wi) {
        return Rgb::ZERO;
    }
    let Some(angles) = HalfDiff::of(wo.as_dvec3(), wi.as_dvec3()) else {
        return Rgb::ZERO;
    };
    let bins = table.phi_d_bins();
    let h = Pair::clamped((angles.theta_h / FRAC_PI_2).sqrt() * THETA_H_BINS as f64 - offset, THETA_H_BINS);
    let d = Pair::clamped(angles.theta_d / FRAC_PI_2 * THETA_D_BINS as f64 - offset, THETA_D_BINS);
    let p = Pair::periodic(fold_phi_d(angles.phi_d, bins) - offset, bins);
    let cells = table.cells();
    let along_phi = |h: usize, d: usize| {
        let row = table.index(h, d, 0);
        cells[row + p.low].lerp(cells[row + p.high], p.share)
    };
    let along_theta_d = |h: usize| along_phi(h, d.low).lerp(along_phi(h, d.high), d.share);
    let sum: Vec4 = along_theta_d(h.low).lerp(along_theta_d(h.high), h.share);
    if sum.w > 0.0 { sum.truncate() / sum.w } else { Rgb::ZERO }
}
