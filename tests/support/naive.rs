//! One line per rule, straight from the definitions, in f64.

use glam::{DQuat, DVec3, Vec3};
use merlkit::brdf::BinIndex;
use std::f64::consts::{FRAC_PI_2, PI};

/// Half and difference angles by the two rotations of the definition.
pub fn angles(wo: DVec3, wi: DVec3) -> (f64, f64, f64) {
    let h = (wo + wi).normalize();
    let theta_h = h.x.hypot(h.y).atan2(h.z);
    let phi_h = h.y.atan2(h.x);
    let d = DQuat::from_rotation_y(-theta_h) * (DQuat::from_rotation_z(-phi_h) * wi);
    (theta_h, d.x.hypot(d.y).atan2(d.z), d.y.atan2(d.x))
}

/// MERL's bins by the definition of each axis.
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

/// Whether an angle is within `slack` bins of an edge, or φd is too ill-defined for its bin to mean anything.
pub fn near_an_edge(wo: Vec3, wi: Vec3, slack: f64) -> bool {
    let (h, d, p) = coordinates(wo, wi, 360);
    let near = |x: f64| (x - x.round()).abs() < slack;
    near(h) || near(d) || near(p) || h < 0.02 || d < 1e-4
}

fn coordinates(wo: Vec3, wi: Vec3, phi_d_bins: usize) -> (f64, f64, f64) {
    let (h, d, p) = angles(wo.as_dvec3(), wi.as_dvec3());
    let period = if phi_d_bins == 360 { 2.0 * PI } else { PI };
    ((h / FRAC_PI_2).sqrt() * 90.0, d / FRAC_PI_2 * 90.0, p.rem_euclid(period) / PI * 180.0)
}
