//! Measurements on a grid of directions, which are read between their points, and the table that they become.

use std::f64::consts::TAU;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DVec2, DVec3, Vec3};

use crate::geometry::cosine_hemisphere;
use crate::material::merl::{BinPoint, MerlTable, tabulate_pairs};

/// Pairs of directions at which a table is compared with the grid it was made of.
const PROBES: u32 = 20_000;

/// Reflectance of an isotropic material that was measured on a grid.
pub(super) trait MeasuredGrid: Send + Sync {
    /// f_r in sr⁻¹ of two unit directions above the horizon, which noise may leave below 0; `None` where nothing was measured.
    fn value(&self, wo: Vec3, wi: Vec3) -> Option<DVec3>;

    /// Points of the grid that have a value.
    fn count(&self) -> usize;
}

/// Two neighbouring points of an axis, and how far on the way from the first to the second a coordinate is.
#[derive(Clone, Copy)]
pub(super) struct Neighbours {
    points: [usize; 2],
    fraction: f64,
}

impl Neighbours {
    /// On an axis of rising points that ends at both sides, where its last values go on.
    pub fn clamped(axis: &[f64], x: f64) -> Self {
        let high = axis.partition_point(|&point| point <= x);
        let high = high.clamp(1, axis.len() - 1);
        let [start, end] = [axis[high - 1], axis[high]];
        Self {
            points: [high - 1, high],
            fraction: ((x - start) / (end - start)).clamp(0.0, 1.0),
        }
    }

    /// On an axis of rising angles in radians that closes on itself after a turn; its first and last point may be the same.
    pub fn periodic(axis: &[f64], x: f64) -> Self {
        let (first, last) = (axis[0], axis[axis.len() - 1]);
        let x = first + (x - first).rem_euclid(TAU);
        if x <= last {
            return Self::clamped(axis, x);
        }
        Self {
            points: [axis.len() - 1, 0],
            fraction: ((x - last) / (first + TAU - last)).clamp(0.0, 1.0),
        }
    }

    /// The points with their weights.
    pub fn weighted(self) -> [(usize, f64); 2] {
        let [low, high] = self.points;
        [(low, 1.0 - self.fraction), (high, self.fraction)]
    }
}

/// Linear interpolation on three axes over the eight points around a place: Σ w·v/Σ w over those whose value is finite; `None`
/// without any.
pub(super) fn interpolate(
    axes: [Neighbours; 3],
    value: impl Fn([usize; 3]) -> DVec3,
) -> Option<DVec3> {
    let mut sum = DVec3::ZERO;
    let mut total = 0.0;
    for (a, weight_a) in axes[0].weighted() {
        for (b, weight_b) in axes[1].weighted() {
            for (c, weight_c) in axes[2].weighted() {
                let weight = weight_a * weight_b * weight_c;
                let value = value([a, b, c]);
                if weight > 0.0 && value.is_finite() {
                    sum += weight * value;
                    total += weight;
                }
            }
        }
    }
    (total > 0.0).then(|| sum / total)
}

/// The table of a grid, and in words what was changed on the way.
///
/// A MERL table has one value for both orders of a pair. A cell is their mean, weighted by the cosine of the incident
/// direction, or the one that was measured where the other was not:
///
/// ```text
/// f̄(wo, wi) = (f(wo, wi)·cosθᵢ + f(wi, wo)·cosθₒ)/(cosθᵢ + cosθₒ)
/// ```
pub(super) fn tabulate_grid(grid: &dyn MeasuredGrid, point: BinPoint) -> (MerlTable, Vec<String>) {
    let raised = AtomicU64::new(0);
    let table = tabulate_pairs(point, &|wo, wi| match reciprocal_value(grid, wo, wi) {
        Some(mean) => {
            if mean.min_element() < 0.0 {
                raised.fetch_add(1, Ordering::Relaxed);
            }
            mean.max(DVec3::ZERO).to_array()
        }
        None => [-1.0; 3],
    });
    let mut notes = vec![format!("measured directions: {}", grid.count())];
    let raised = raised.into_inner();
    if raised > 0 {
        notes.push(format!(
            "cells with a negative channel, which counts as 0: {raised}"
        ));
    }
    (table, notes)
}

/// The mean of both orders of a pair, as in [`tabulate_grid`].
pub(super) fn reciprocal_value(grid: &dyn MeasuredGrid, wo: Vec3, wi: Vec3) -> Option<DVec3> {
    let mut sum = DVec3::ZERO;
    let mut total = 0.0;
    for (wo, wi) in [(wo, wi), (wi, wo)] {
        if let Some(value) = grid.value(wo, wi) {
            sum += f64::from(wi.z) * value;
            total += f64::from(wi.z);
        }
    }
    (total > 0.0).then(|| sum / total)
}

/// Pairs that follow the cosine with the values of the grid, where it has some: the same pairs for every grid.
pub(super) fn probe_pairs(grid: &dyn MeasuredGrid) -> Vec<(Vec3, Vec3, DVec3)> {
    // Fractional parts of multiples of powers of one irrational number fill the hypercube evenly (Roberts 2018): x⁵ = x + 1.
    const STEP: f64 = 1.0 / 1.167_303_978_261_418_7;
    let step = [STEP, STEP.powi(2), STEP.powi(3), STEP.powi(4)];
    let mut pairs = Vec::new();
    for k in 1..=PROBES {
        let [a, b, c, d] = step.map(|s| (f64::from(k) * s).fract());
        let wo = cosine_hemisphere(DVec2::new(a, b)).as_vec3();
        let wi = cosine_hemisphere(DVec2::new(c, d)).as_vec3();
        if wo.z > 0.0
            && wi.z > 0.0
            && let Some(value) = grid.value(wo, wi)
        {
            pairs.push((wo, wi, value));
        }
    }
    pairs
}
