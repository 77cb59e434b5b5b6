//! Tabulating the BRDF and compressing the curves.

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};
use ndarray::{Array2, Axis};
use rayon::prelude::*;

use super::axis::ThetaAxis;
use super::settings::CascadeCdfSettings;
use super::tables::Tables;
use crate::brdf::{Brdf, Importance};
use crate::distribution::{Curves, cumulated, simplify};
use crate::geometry::{reflect_about, spherical};
use crate::sampler::azimuth_knots::TurnedBrdf;
use crate::sampler::direction_knots::DirectionKnots;

/// Evaluations that a table is worth, however few its cells: coarse cells take the mean over several points.
const POINTS: [usize; 2] = [512, 128];
/// An edge this close to that of a cell, in steps, is the same edge.
const LEAST_PART: f64 = 1e-9;
/// Between bins of θh whose densities differ by this factor a compressed marginal keeps its knots.
const JUMP: f64 = 4.0;

/// Tables of all knots, in parallel over knots.
pub(super) fn tables(
    brdf: &dyn Brdf,
    settings: &CascadeCdfSettings,
    knots: DirectionKnots,
    axis: ThetaAxis,
) -> Tables {
    let each: Vec<(Curves, Curves)> = (0..knots.count())
        .into_par_iter()
        .map(|k| {
            // Azimuths of half vectors count from that of the table.
            let [theta, azimuth] = knots.angles(k);
            let wo = spherical(theta, 0.0).as_vec3();
            let turned = TurnedBrdf::new(brdf, azimuth);
            let masses = masses([settings.theta_h, settings.phi_h], axis, |h| {
                contribution(&turned, settings.importance, wo, h)
            });
            curves(&masses, axis, settings.tolerance)
        })
        .collect();
    let mut marginal = Curves::new();
    let mut conditional = Curves::new();
    for (m, c) in &each {
        marginal.append(m);
        conditional.append(c);
    }
    Tables::new(marginal, conditional)
}

/// ∫ `value(w)` dσ(w) over each cell `[theta, phi]` of the directions above the horizon, in midpoints. Where an edge of MERL's
/// bins of θh lies within a cell of an axis that knows them, either side has a midpoint of its own: f may jump there by any factor.
pub(in crate::sampler) fn masses(
    [rows, columns]: [usize; 2],
    axis: ThetaAxis,
    value: impl Fn(DVec3) -> f64,
) -> Array2<f64> {
    let fine = [
        POINTS[0].div_ceil(rows).max(1),
        POINTS[1].div_ceil(columns).max(1),
    ];
    // The azimuths are midpoints. Each cell has `fine[1]` of them.
    let azimuths: Vec<(f64, f64)> = (0..columns * fine[1])
        .map(|j| ((j as f64 + 0.5) / (columns * fine[1]) as f64 * TAU).sin_cos())
        .collect();
    let edges = axis.merl_edges();
    let mut cells = Array2::zeros((rows, columns));
    for (i, mut row) in cells.axis_iter_mut(Axis(0)).enumerate() {
        for part in 0..fine[0] {
            let steps = (rows * fine[0]) as f64;
            for [low, high] in split((i * fine[0] + part) as f64, &edges, steps) {
                let a =
                    (i as f64 + (part as f64 + 0.5 * (low + high)) / fine[0] as f64) / rows as f64;
                let (sin, cos) = axis.theta(a).sin_cos();
                // dσ = sinθ (dθ/da) da dφ of a midpoint, with da the length of this part and dφ = 2π over all midpoints.
                let area = (high - low) * axis.solid_angle(a, sin)
                    / (rows * fine[0] * columns * fine[1]) as f64
                    * TAU;
                for (j, &(s, c)) in azimuths.iter().enumerate() {
                    row[j / fine[1]] += area * value(DVec3::new(sin * c, sin * s, cos));
                }
            }
        }
    }
    cells
}

/// The parts of [0, 1] into which `edges`, ascending in [0, 1], divide one of `steps` equal steps of [0, 1]: the one that starts
/// at `start` steps.
fn split(start: f64, edges: &[f64], steps: f64) -> Vec<[f64; 2]> {
    let first = edges.partition_point(|&edge| edge * steps - start <= LEAST_PART);
    let mut low = 0.0;
    let mut parts = Vec::with_capacity(2);
    for edge in &edges[first..] {
        let high = edge * steps - start;
        if high >= 1.0 - LEAST_PART {
            break;
        }
        parts.push([low, high]);
        low = high;
    }
    parts.push([low, 1.0]);
    parts
}

/// f·cosθi·dσ(wi)/dσ(h) of a half vector; 0 where it reflects below the horizon.
#[inline]
pub(in crate::sampler) fn contribution(
    brdf: &dyn Brdf,
    importance: Importance,
    wo: Vec3,
    h: DVec3,
) -> f64 {
    let wi = reflect_about(wo.as_dvec3(), h);
    if wi.z <= 0.0 {
        return 0.0;
    }
    // dσ(wi) = 4 (wo·h) dσ(h)
    let f = f64::from(importance.reduce(brdf.eval(wo, wi.as_vec3())));
    f * wi.z * 4.0 * wo.as_dvec3().dot(h)
}

/// The marginal of a table and the conditionals of its pieces, each with the knots that `tolerance` asks for.
///
/// Conditionals are sums over the rows that a piece of the marginal spans, so the density drawn from is the derivative of
/// the curves as stored.
fn curves(masses: &Array2<f64>, axis: ThetaAxis, tolerance: Option<f64>) -> (Curves, Curves) {
    let mut marginal = Curves::new();
    let mut conditional = Curves::new();
    // Step 1: the marginal over θh, with knots where its density jumps.
    let marginal_sums = cumulated(masses.sum_axis(Axis(1)));
    let jumps = jumps(&marginal_sums, axis);
    let knots = push(&mut marginal, &marginal_sums, &jumps, tolerance);
    // Step 2: for each piece that is left of it, the conditional over φh of all its rows together.
    for piece in knots.windows(2) {
        let rows = masses.slice(ndarray::s![piece[0]..piece[1], ..]);
        push(
            &mut conditional,
            &cumulated(rows.sum_axis(Axis(0))),
            &[],
            tolerance,
        );
    }
    (marginal, conditional)
}

/// Positions on both sides of the edges between MERL's bins at which the density jumps, ascending.
///
/// A tolerance in probability alone lets a knot go where a bin holds less than it, however small the bin: the density there
/// would be that of its wide surroundings, and a rare draw in it would have a weight of a thousand times the albedo.
fn jumps(cumulated: &[f64], axis: ThetaAxis) -> Vec<usize> {
    let last = cumulated.len() - 1;
    let mut edges = vec![0.0];
    edges.extend(axis.merl_edges().iter().map(|edge| edge * last as f64));
    edges.push(last as f64);
    let mut jumps = Vec::new();
    for three in edges.windows(3) {
        let (below, above) = (
            [three[0].ceil() as usize, three[1].floor() as usize],
            [three[1].ceil() as usize, three[2].floor() as usize],
        );
        // Cells that an edge divides belong to neither bin; of coarse cells none is left.
        if below[0] >= below[1] || above[0] >= above[1] {
            continue;
        }
        let density =
            |[low, high]: [usize; 2]| (cumulated[high] - cumulated[low]) / (high - low) as f64;
        let (a, b) = (density(below), density(above));
        if a.max(b) > JUMP * a.min(b) {
            jumps.extend([below[1], above[0]]);
        }
    }
    jumps.dedup();
    jumps
}

/// Adds a curve and returns the knots it was given: where `tolerance` asks for them, and at the positions `kept`, ascending.
fn push(
    curves: &mut Curves,
    cumulated: &[f64],
    kept: &[usize],
    tolerance: Option<f64>,
) -> Vec<usize> {
    match tolerance {
        None => {
            curves.push(cumulated, None);
            (0..cumulated.len()).collect()
        }
        Some(tolerance) => {
            let total = cumulated.last().copied().unwrap_or(0.0);
            let mut knots = vec![0];
            let mut start = 0;
            for &end in kept.iter().chain([&(cumulated.len() - 1)]) {
                if end > start {
                    // Each stretch between kept positions is simplified alone, so that both its ends remain knots.
                    let piece = simplify(&cumulated[start..=end], tolerance * total);
                    knots.extend(piece.iter().skip(1).map(|knot| knot + start));
                    start = end;
                }
            }
            curves.push(cumulated, Some(&knots));
            knots
        }
    }
}
