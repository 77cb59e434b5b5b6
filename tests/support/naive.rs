//! One line per rule, straight from the definitions, in f64.

use glam::{DVec3, Vec3};
use merlkit::geometry::HalfDiff;
use merlkit::material::merl::MerlTable;
use merlkit::material::merl::{BinIndex, LookupRule};
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

/// f_r by a lookup rule, neighbour by neighbour, in f64; and the valid neighbours' share of the weight, from 0 to 1.
pub fn eval(table: &MerlTable, rule: LookupRule, wo: Vec3, wi: Vec3) -> (DVec3, f64) {
    if !(wo.z > 0.0 && wi.z > 0.0) {
        return (DVec3::ZERO, 0.0);
    }
    let bins = table.phi_d_bins();
    let offset = match rule {
        LookupRule::Floor => {
            let b = self::bins(wo, wi, bins).unwrap();
            return (table.rgb(b.theta_h, b.theta_d, b.phi_d).as_dvec3(), 1.0);
        }
        LookupRule::Linear => 0.0,
        LookupRule::Centred => 0.5,
    };
    let (h, d, p) = coordinates(wo, wi, bins);
    let (h, d, p) = (
        (h - offset).clamp(0.0, 89.0),
        (d - offset).clamp(0.0, 89.0),
        p - offset,
    );
    let (mut sum, mut weight) = (DVec3::ZERO, 0.0);
    for corner in 0..8 {
        let far = [corner & 1, corner >> 1 & 1, corner >> 2 & 1];
        let share: f64 = [h, d, p]
            .iter()
            .zip(far)
            .map(|(x, f)| {
                if f == 1 {
                    x - x.floor()
                } else {
                    1.0 - (x - x.floor())
                }
            })
            .product();
        let clamped = |x: f64, f: i64| (x.floor() as i64 + f).min(89) as usize;
        let phi = (p.floor() as i64 + far[2]).rem_euclid(bins as i64) as usize;
        let (h, d) = (clamped(h, far[0]), clamped(d, far[1]));
        if table.is_valid(h, d, phi) {
            sum += share * table.rgb(h, d, phi).as_dvec3();
            weight += share;
        }
    }
    (
        if weight > 0.0 {
            sum / weight
        } else {
            DVec3::ZERO
        },
        weight,
    )
}

/// Whether an angle is within `slack` bins of an edge.
pub fn near_an_edge(wo: Vec3, wi: Vec3, slack: f64) -> bool {
    let p = coordinates(wo, wi, 360).2;
    near_an_edge_of_theta(wo, wi, slack) || (p - p.round()).abs() < slack
}

/// Whether θh or θd is within `slack` bins of an edge.
pub fn near_an_edge_of_theta(wo: Vec3, wi: Vec3, slack: f64) -> bool {
    let (h, d, _) = coordinates(wo, wi, 360);
    [h, d].iter().any(|x| (x - x.round()).abs() < slack)
}

fn coordinates(wo: Vec3, wi: Vec3, phi_d_bins: usize) -> (f64, f64, f64) {
    let a = HalfDiff::from_directions(wo.as_dvec3(), wi.as_dvec3()).unwrap();
    let period = if phi_d_bins == 360 { 2.0 * PI } else { PI };
    let h = (a.theta_h / FRAC_PI_2).sqrt() * 90.0;
    (
        h,
        a.theta_d / FRAC_PI_2 * 90.0,
        a.phi_d.rem_euclid(period) / PI * 180.0,
    )
}
