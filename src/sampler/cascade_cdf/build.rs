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
use crate::sampler::knots::ThetaKnots;

/// Evaluations that a table is worth, however few its cells: coarse cells take the mean over several points.
const POINTS: [usize; 2] = [512, 128];

/// Tables of all knots, in parallel over knots.
pub(super) fn tables(
    brdf: &dyn Brdf,
    settings: &CascadeCdfSettings,
    knots: ThetaKnots,
    axis: ThetaAxis,
) -> Tables {
    let each: Vec<(Curves, Curves)> = (0..knots.count())
        .into_par_iter()
        .map(|k| {
            let wo = spherical(knots.theta(k), 0.0).as_vec3();
            let value = |h| contribution(brdf, settings.importance, wo, h);
            curves(
                &masses([settings.theta_h, settings.phi_h], axis, value),
                settings.tolerance,
            )
        })
        .collect();
    let (mut marginal, mut conditional) = (Curves::new(), Curves::new());
    for (m, c) in &each {
        marginal.append(m);
        conditional.append(c);
    }
    Tables::new(marginal, conditional)
}

/// ∫ `value(w)` dσ(w) over each cell `[theta, phi]` of the directions above the horizon, in midpoints.
pub(in crate::sampler) fn masses(
    [rows, columns]: [usize; 2],
    axis: ThetaAxis,
    value: impl Fn(DVec3) -> f64,
) -> Array2<f64> {
    let fine = [
        POINTS[0].div_ceil(rows).max(1),
        POINTS[1].div_ceil(columns).max(1),
    ];
    let azimuths: Vec<(f64, f64)> = (0..columns * fine[1])
        .map(|j| ((j as f64 + 0.5) / (columns * fine[1]) as f64 * TAU).sin_cos())
        .collect();
    let mut cells = Array2::zeros((rows, columns));
    for (i, mut row) in cells.axis_iter_mut(Axis(0)).enumerate() {
        for part in 0..fine[0] {
            let a = (i as f64 + (part as f64 + 0.5) / fine[0] as f64) / rows as f64;
            let (sin, cos) = axis.theta(a).sin_cos();
            let area = axis.solid_angle(a, sin) / (rows * fine[0] * columns * fine[1]) as f64 * TAU;
            for (j, &(s, c)) in azimuths.iter().enumerate() {
                row[j / fine[1]] += area * value(DVec3::new(sin * c, sin * s, cos));
            }
        }
    }
    cells
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
    let f = f64::from(importance.reduce(brdf.eval(wo, wi.as_vec3())));
    f * wi.z * 4.0 * wo.as_dvec3().dot(h)
}

/// The marginal of a table and the conditionals of its pieces, each with the knots that `tolerance` asks for.
///
/// Conditionals are sums over the rows that a piece of the marginal spans, so the density drawn from is the derivative of
/// the curves as stored.
fn curves(masses: &Array2<f64>, tolerance: Option<f64>) -> (Curves, Curves) {
    let (mut marginal, mut conditional) = (Curves::new(), Curves::new());
    let marginal_sums = cumulated(masses.sum_axis(Axis(1)));
    let knots = push(&mut marginal, &marginal_sums, tolerance);
    for piece in knots.windows(2) {
        let rows = masses.slice(ndarray::s![piece[0]..piece[1], ..]);
        push(
            &mut conditional,
            &cumulated(rows.sum_axis(Axis(0))),
            tolerance,
        );
    }
    (marginal, conditional)
}

/// Adds a curve and returns the knots it was given.
fn push(curves: &mut Curves, cumulated: &[f64], tolerance: Option<f64>) -> Vec<usize> {
    match tolerance {
        None => {
            curves.push(cumulated, None);
            (0..cumulated.len()).collect()
        }
        Some(tolerance) => {
            let total = cumulated.last().copied().unwrap_or(0.0);
            let knots = simplify(cumulated, tolerance * total);
            curves.push(cumulated, Some(&knots));
            knots
        }
    }
}
