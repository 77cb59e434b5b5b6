//! The density of what the tables draw.

use std::f64::consts::{FRAC_1_PI, TAU};

use glam::{DVec2, DVec3};

use super::axis::ThetaAxis;
use super::cascade::CascadeCdf;
use crate::distribution::Segment;
use crate::geometry::approx;
use crate::sampler::direction_knots::DirectionNeighbours;

/// A half vector, as far as it is the same for all tables.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfVectorPoint {
    /// wo + wi.
    sum: DVec3,
    /// Coordinate of θh, 0 to 1.
    a: f64,
    /// What a density over the square is multiplied by.
    to_solid_angle: f64,
    /// The density of the cosine, which a table without mass has.
    pub cosine: f64,
}

impl HalfVectorPoint {
    #[inline(always)]
    pub fn new(axis: &ThetaAxis, wo: DVec3, wi: DVec3) -> Self {
        // Step 1: θh of the half vector as a coordinate in [0, 1].
        let sum = wo + wi;
        let rho = (sum.x * sum.x + sum.y * sum.y).sqrt();
        let a = axis.coordinate(approx::atan2(rho, sum.z));
        // Step 2: dσ(h) = 2π sinθh (dθh/da) da db, and dσ(wi) = 4 (wo·h) dσ(h) with wo·h = |wo + wi|/2.
        let length = sum.length();
        Self {
            sum,
            a,
            to_solid_angle: 1.0 / (TAU * axis.solid_angle(a, rho / length) * 2.0 * length),
            cosine: wi.z * FRAC_1_PI,
        }
    }
}

impl CascadeCdf {
    /// Where a half vector lies on the grid of the tables of an azimuth, whose direction in the plane is `axis`.
    #[inline(always)]
    pub(super) fn grid_position(&self, point: &HalfVectorPoint, axis: DVec2) -> DVec2 {
        // φh of the half vector against the azimuth of the table, as a coordinate in [0, 1].
        let sum = point.sum;
        let angle = match axis {
            DVec2::ZERO => approx::atan2(sum.y, sum.x),
            axis => approx::atan2(axis.perp_dot(sum.truncate()), axis.dot(sum.truncate())),
        };
        let turn = angle * (1.0 / TAU);
        let b = if turn < 0.0 { turn + 1.0 } else { turn };
        debug_assert!((0.0..=1.0).contains(&point.a) && (0.0..=1.0).contains(&b));
        DVec2::new(
            point.a * self.settings.theta_h as f64,
            b * self.settings.phi_h as f64,
        )
    }

    /// Density per solid angle in a piece of a marginal and a piece of its conditional.
    #[inline(always)]
    pub(super) fn density_in(
        &self,
        row: &Segment,
        column: &Segment,
        point: &HalfVectorPoint,
    ) -> f64 {
        // p(a, b) = dF(a)/da · dF(b | a)/db, the slopes of both pieces. Grid units are cells, and the square has sides 1.
        let cells = (self.settings.theta_h * self.settings.phi_h) as f64;
        // One division for both densities: it is what takes time here.
        let square = (row.c1 - row.c0) * (column.c1 - column.c0) * cells
            / ((row.x1 - row.x0) * (column.x1 - column.x0));
        square * point.to_solid_angle
    }

    /// Density of table `k` per solid angle; that of the cosine for a void table.
    #[inline]
    fn table_density(&self, k: usize, at: DVec2, point: &HalfVectorPoint) -> f64 {
        if self.tables.marginal.is_void(k) {
            return point.cosine;
        }
        let row = self.tables.marginal.find_segment(k, at.x);
        let conditional = self.tables.find_conditional(k, &row);
        let column = self.tables.conditional.find_segment(conditional, at.y);
        self.density_in(&row, &column, point)
    }

    /// Density of `wi`, among the azimuths that have tables as the `wo` of `near` is.
    pub(super) fn density(&self, near: &DirectionNeighbours, wi: DVec3) -> f32 {
        let point = HalfVectorPoint::new(&self.axis, near.wo.as_dvec3(), wi);
        let mut densities = [0.0; 4];
        for azimuth in 0..2 {
            if !has_weight(near, azimuth) {
                continue;
            }
            let at = self.grid_position(&point, near.axes[azimuth]);
            for (polar, knot) in [near.polar.first, near.polar.second]
                .into_iter()
                .enumerate()
            {
                // A table without weight is not looked up.
                if polar_weight(near, polar) > 0.0 {
                    let k = near.starts[azimuth] + knot;
                    densities[2 * azimuth + polar] = self.table_density(k, at, &point);
                }
            }
        }
        self.mix(near, &densities, point.cosine)
    }

    /// Density per solid angle of the mixture of four tables, those of the first azimuth before those of the second, and the floor.
    #[inline(always)]
    pub(super) fn mix(&self, near: &DirectionNeighbours, densities: &[f64; 4], cosine: f64) -> f32 {
        // (1 − a)·((1 − t)·p₁ + t·p₂) + a·((1 − t)·p₃ + t·p₄)
        let [p1, p2, p3, p4] = densities;
        let share = near.polar.share;
        let mut tables = 0.0;
        for (pair, weight) in [([p1, p2], 1.0 - near.weight), ([p3, p4], near.weight)] {
            if weight > 0.0 {
                tables += weight * ((1.0 - share) * pair[0] + share * pair[1]);
            }
        }
        let floor = self.settings.floor;
        ((1.0 - floor) * tables + floor * cosine).min(f64::from(f32::MAX)) as f32
    }
}

/// Whether the tables of an azimuth, the first or the second, have a weight.
#[inline(always)]
pub(super) fn has_weight(near: &DirectionNeighbours, azimuth: usize) -> bool {
    let weight = if azimuth == 0 {
        1.0 - near.weight
    } else {
        near.weight
    };
    weight > 0.0
}

/// Weight of the first or the second polar angle.
#[inline(always)]
pub(super) fn polar_weight(near: &DirectionNeighbours, polar: usize) -> f64 {
    if polar == 0 {
        1.0 - near.polar.share
    } else {
        near.polar.share
    }
}
