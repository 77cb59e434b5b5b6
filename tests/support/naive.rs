//! One line per rule, straight from the definitions, in f64.

use glam::Vec3;
use merlkit::brdf::BinIndex;
use merlkit::geom::HalfDiff;
use std::f64::consts::{FRAC_PI_2, PI};

/// MERL's bins from arctangents, by the definition of each axis.
pub fn bins(wo: Vec3, wi: Vec3, phi_d_bins: usize) -> Option<BinIndex> {
    if !(wo.z > 0.0 && wi.z > 0.0) {
        return None;
    }
    let (h, d, p) = coordinates(wo, wi, phi_d_bins);
    Some(BinIndex {
        theta_h: (h as usize).min(89),
        theta_d: (d as usize).min(89),
        phi_d: (p as usize).min(phi_d_bins - 1),
    })
}

/// Whether an angle is within `slack` bins of an edge.
pub fn near_an_edge(wo: Vec3, wi: Vec3, slack: f64) -> bool {
    let (h, d, p) = coordinates(wo, wi, 360);
    [h, d, p].iter().any(|x| (x - x.round()).abs() < slack)
}

fn coordinates(wo: Vec3, wi: Vec3, phi_d_bins: usize) -> (f64, f64, f64) {
    let a = HalfDiff::of(wo.as_dvec3(), wi.as_dvec3()).unwrap();
    let period = if phi_d_bins == 360 { 2.0 * PI } else { PI };
    let h = (a.theta_h / FRAC_PI_2).sqrt() * 90.0;
    (h, a.theta_d / FRAC_PI_2 * 90.0, a.phi_d.rem_euclid(period) / PI * 180.0)
}
