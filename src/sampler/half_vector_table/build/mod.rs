//! Fitting tables of integers to a BRDF that is tabulated over the chart of half vectors.

mod tabulate;

use std::f64::consts::PI;

use ndarray::{ArrayView1, Axis};
use rayon::prelude::*;

use self::tabulate::{Tabulated, choose_row_edges, columns, slope_of, tabulate};
use super::settings::HalfVectorSettings;
use super::tables::lookup::{NODE_SUM, ONE};
use super::tables::packed::SLOPE_UNIT;
use super::tables::{STEEPEST, Stored};
use crate::brdf::Brdf;

/// The angle of the last table, short of the horizon.
const LAST_KNOT: f64 = 89.0 / 180.0 * PI;

/// Cosines of the angles that have a table: 0° to 89°, denser towards the horizon, and the more so the fewer there are.
fn knot_cosines(tables: usize) -> Vec<f32> {
    let steps = tables.saturating_sub(1).max(1) as f64;
    let power = if tables < 8 { 2.0 } else { 1.5 };
    (0..tables)
        .map(|k| (LAST_KNOT * (1.0 - (1.0 - k as f64 / steps).powf(power))).cos() as f32)
        .collect()
}

/// Tables of all knots, in parallel over knots.
pub(super) fn build_tables(brdf: &dyn Brdf, settings: &HalfVectorSettings) -> Stored {
    let cosines = knot_cosines(settings.tables);
    let tabulated: Vec<Tabulated> = cosines
        .par_iter()
        .map(|&c| tabulate(brdf, settings, f64::from(c).acos()))
        .collect();
    let edges = choose_row_edges(&tabulated, settings.rows);
    let fit = Fit::new(columns(settings), settings.segments);
    let each: Vec<Vec<FittedRow>> = tabulated
        .par_iter()
        .map(|t| {
            edges
                .windows(2)
                .map(|pair| FittedRow::new(t, pair[0]..pair[1], &fit))
                .collect()
        })
        .collect();
    let (mut rows, mut slopes, mut nodes) = (Vec::new(), Vec::new(), Vec::new());
    for table in &each {
        let masses: Vec<f64> = table.iter().map(|row| row.mass).collect();
        rows.extend(quantise_rows(&masses));
        for row in table {
            slopes.push(row.slope);
            nodes.extend(quantise_nodes(&row.density));
        }
    }
    Stored {
        rows,
        slopes,
        nodes,
        edges: edges.into_iter().map(|e| e as u16).collect(),
        cosines,
        width: settings.segments + 1,
    }
}

/// A row before it is quantised.
struct FittedRow {
    mass: f64,
    slope: i8,
    density: Vec<f64>,
}

impl FittedRow {
    fn new(tabulated: &Tabulated, parts: std::ops::Range<usize>, fit: &Fit) -> Self {
        let span = tabulated.mass.slice(ndarray::s![parts.clone(), ..]);
        let columns = span.sum_axis(Axis(0));
        let mass = columns.sum();
        let slope = slope_of(tabulated, parts) / f64::from(SLOPE_UNIT);
        let steepest = f64::from(STEEPEST);
        Self {
            mass,
            slope: slope.round().clamp(-steepest, steepest) as i8,
            density: fit.nodes(columns.view()),
        }
    }
}

/// Least-squares fit of a function that is linear between equidistant nodes to sums over columns.
struct Fit {
    columns: usize,
    segments: usize,
    /// Thomas's elimination of the normal equations: diagonal and factors.
    diagonal: Vec<f64>,
    factor: Vec<f64>,
}

/// Nodes are at least this fraction of the mean.
const LOWEST_NODE: f64 = 2e-3;

impl Fit {
    fn new(columns: usize, segments: usize) -> Self {
        let mut fit = Self {
            columns,
            segments,
            diagonal: vec![0.0; segments + 1],
            factor: vec![0.0; segments],
        };
        for column in 0..columns {
            let (i, x) = fit.hat(column);
            fit.diagonal[i] += (1.0 - x) * (1.0 - x);
            fit.diagonal[i + 1] += x * x;
            fit.factor[i] += x * (1.0 - x);
        }
        for i in 0..segments {
            let off = fit.factor[i];
            fit.factor[i] = off / fit.diagonal[i];
            fit.diagonal[i + 1] -= fit.factor[i] * off;
        }
        fit
    }

    /// The node before a column's middle, and the weight of the node after it.
    fn hat(&self, column: usize) -> (usize, f64) {
        let at = (column as f64 + 0.5) * self.segments as f64 / self.columns as f64;
        (at as usize, at.fract())
    }

    fn nodes(&self, masses: ArrayView1<'_, f64>) -> Vec<f64> {
        let mut nodes = vec![0.0; self.segments + 1];
        for (column, mass) in masses.iter().enumerate() {
            let (i, x) = self.hat(column);
            nodes[i] += (1.0 - x) * mass;
            nodes[i + 1] += x * mass;
        }
        for i in 0..self.segments {
            nodes[i + 1] -= self.factor[i] * nodes[i];
        }
        nodes[self.segments] /= self.diagonal[self.segments];
        for i in (0..self.segments).rev() {
            nodes[i] = nodes[i] / self.diagonal[i] - self.factor[i] * nodes[i + 1];
        }
        let lowest = LOWEST_NODE * masses.sum() / self.columns as f64;
        nodes.into_iter().map(|n| n.max(lowest)).collect()
    }
}

// Integers: every row and node gets at least one unit, and sums are exact.

/// Cumulative probabilities of `masses`, which sum to 1 and are ≥ 0, each at least one unit: nothing is left out.
pub fn quantise_rows(masses: &[f64]) -> Vec<u16> {
    let count = masses.len();
    let mut sum = 0.0;
    let mut last = 0u32;
    let mut cumulative = Vec::with_capacity(count);
    for (i, mass) in masses.iter().enumerate() {
        sum += mass;
        let rounded = if i + 1 == count {
            u32::from(ONE)
        } else {
            (sum * f64::from(ONE)).round() as u32
        };
        // At least one unit above the row before, and one unit left for each row that follows.
        last = rounded.clamp(last + 1, u32::from(ONE) - (count - 1 - i) as u32);
        cumulative.push(last as u16);
    }
    cumulative
}

/// Nodes of a density, ≥ 0 and not all 0, scaled to [`NODE_SUM`] and each at least one unit.
pub fn quantise_nodes(density: &[f64]) -> Vec<u16> {
    let last = density.len() - 1;
    // The two ends count once, the others twice.
    let weight = |i: usize| if i == 0 || i == last { 1 } else { 2 };
    let mut sum = 0.0;
    for (i, d) in density.iter().enumerate() {
        sum += d * f64::from(weight(i));
    }
    let scale = f64::from(NODE_SUM) / sum;
    let mut nodes = Vec::with_capacity(last + 1);
    let mut spent = 0u32;
    let mut exact = 0.0;
    for (i, d) in density[..last].iter().enumerate() {
        let w = f64::from(weight(i));
        exact += d * scale * w;
        // What rounding took from the nodes before goes to this one.
        let node = ((exact - f64::from(spent)) / w).round().max(1.0) as u32;
        spent += node * weight(i);
        nodes.push(node);
    }
    // The last node takes the rest; if others at their least have used it up, the largest gives some back.
    while spent >= NODE_SUM {
        let largest = (0..last).max_by_key(|&i| nodes[i]).unwrap_or(0);
        nodes[largest] -= 1;
        spent -= weight(largest);
    }
    nodes.push(NODE_SUM - spent);
    nodes.into_iter().map(|n| n as u16).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::Stream;
    use ndarray::Array1;

    #[test]
    fn fits_recover_functions_that_are_linear_between_nodes() {
        for segments in [1, 2, 5, 16] {
            let fit = Fit::new(columns_of(segments), segments);
            let truth: Vec<f64> = (0..=segments).map(|i| 1.0 + (i * 7 % 4) as f64).collect();
            let masses: Array1<f64> = (0..fit.columns)
                .map(|c| {
                    let (i, x) = fit.hat(c);
                    truth[i] * (1.0 - x) + truth[i + 1] * x
                })
                .collect();
            for (a, b) in fit.nodes(masses.view()).iter().zip(&truth) {
                assert!((a - b).abs() < 1e-9, "{segments}: {a} {b}");
            }
        }
    }

    fn columns_of(segments: usize) -> usize {
        columns(&HalfVectorSettings {
            segments,
            ..HalfVectorSettings::default()
        })
    }

    fn random(count: usize, seed: u64) -> Vec<f64> {
        let mut stream = Stream::new(seed);
        (0..count).map(|_| stream.next_f64().powi(8)).collect()
    }

    #[test]
    fn rows_rise_to_one_whatever_the_masses() {
        let spike = |at: usize| {
            (0..79)
                .map(|i| f64::from(u8::from(i == at)))
                .collect::<Vec<_>>()
        };
        for masses in [
            spike(0),
            spike(40),
            spike(78),
            vec![1.0 / 79.0; 79],
            vec![1.0],
        ] {
            let rows = quantise_rows(&masses);
            assert!(rows[0] > 0 && rows.is_sorted_by(|a, b| a < b));
            assert_eq!(*rows.last().unwrap(), ONE);
        }
        let rows = quantise_rows(&[0.25, 0.0, 0.75]);
        assert_eq!(rows, [16384, 16385, ONE]);
    }

    #[test]
    fn nodes_keep_their_sum_and_their_shape() {
        for width in [2, 3, 4, 9, 17, 65, 256] {
            for (seed, end) in [(1, 0.0), (2, 0.0), (3, 1e6)] {
                let mut density = random(width, seed + 100 * width as u64);
                density[0] += end + 1e-9;
                let nodes = quantise_nodes(&density);
                let sum: u32 = nodes
                    .windows(2)
                    .map(|p| u32::from(p[0]) + u32::from(p[1]))
                    .sum();
                assert_eq!(sum, NODE_SUM, "{width} {seed}");
                let total: f64 = density.windows(2).map(|p| p[0] + p[1]).sum();
                for (n, d) in nodes.iter().zip(&density) {
                    let exact = d / total * f64::from(NODE_SUM);
                    assert!(
                        *n >= 1 && (f64::from(*n) - exact).abs() <= 3.0 + 2.0 * width as f64,
                        "{width} {seed}: {n} {exact}"
                    );
                }
            }
        }
    }
}
