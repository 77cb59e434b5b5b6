//! Values of f where lobes usually are, by the square that holds them.
//!
//! A lobe a tenth of a degree wide falls between the points of any coarse grid. Half vectors about the normal, dense as MERL's
//! bins are, meet it, and squares that hold what they met are divided until a grid sees it too.

use glam::{DVec2, Vec3};

use super::quad_cell::{DEEPEST, z_place};
use super::slice::Slice;
use crate::geometry::{Quadrature, is_upper};

/// Points in each of MERL's bins of θh.
const POINTS: usize = 55;

/// Values at points, in the Z-order of their squares.
pub(super) struct Scouts {
    places: Vec<u32>,
    values: Vec<f64>,
    integral: f64,
}

impl Scouts {
    /// Evaluates f; `to_square` takes the disc to the unit square that the tree divides.
    pub fn send(slice: &Slice<'_>, to_square: fn(DVec2) -> DVec2) -> Self {
        let (mut nodes, mut solid_angles) = (Vec::new(), Vec::new());
        Quadrature::new(slice.wo, POINTS).for_each(|wi, d_sigma| {
            nodes.push(wi);
            solid_angles.push(d_sigma);
        });
        let mut values = vec![0.0; nodes.len()];
        slice.values(&nodes, &mut values);
        let mut met = Vec::with_capacity(nodes.len());
        let mut integral = 0.0;
        for ((wi, d_sigma), &f) in nodes.iter().zip(solid_angles).zip(&values) {
            // dx dy = cosθi dσ(wi)
            integral += f * f64::from(wi.z) * d_sigma;
            met.push((z_place(to_square(wi.truncate().as_dvec2())), f));
        }
        // Lobes may have their tops exactly in the mirror direction, at wo itself, or at the normal.
        let wo = slice.wo;
        for wi in [Vec3::new(-wo.x, -wo.y, wo.z), wo, Vec3::Z] {
            if is_upper(wi) {
                let place = z_place(to_square(wi.truncate().as_dvec2()));
                met.push((place, slice.value(wi)));
            }
        }
        met.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        Self {
            places: met.iter().map(|m| m.0).collect(),
            values: met.iter().map(|m| m.1).collect(),
            integral,
        }
    }

    /// ∫ f over the disc, roughly.
    pub fn integral(&self) -> f64 {
        self.integral
    }

    /// The largest value met in a square of the unit square, whose side is 1 halved up to [`DEEPEST`] times; 0 if none was.
    pub fn largest(&self, low: DVec2, side: f64) -> f64 {
        // A square of side s holds (2^DEEPEST·s)² places, from that of its lower corner on.
        let across = (side * f64::from(1u32 << DEEPEST)).round() as u32;
        let first = z_place(low + 0.25 * side / f64::from(across));
        let from = self.places.partition_point(|&place| place < first);
        let until = self
            .places
            .partition_point(|&place| place - first.min(place) < across * across);
        let values = self.values.get(from..until).unwrap_or_default();
        values.iter().copied().fold(0.0, f64::max)
    }
}

/// The unit square about the disc.
pub(super) fn about_disc(p: DVec2) -> DVec2 {
    (p + 1.0) * 0.5
}
