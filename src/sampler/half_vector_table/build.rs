//! Tabulating a BRDF over the chart of half vectors, and fitting the tables to it.

use ndarray::{Array2, ArrayView1, Axis};
use rayon::prelude::*;

use super::row_edges::choose_row_edges;
use super::tables::{NODE_SUM, ONE, SLOPE_UNIT, STEEPEST, Stored};
use super::{HalfVectorSettings, knot_cosines};
use crate::batch::Wo;
use crate::brdf::Brdf;
use crate::color::Rgb;
use crate::geometry::half_vector_chart::{ChartEdge, HalfVectorChart, PARTS};
use crate::geometry::spherical;

/// Points a part over its cap. Each is turned by its share of a column, so that together they resolve the azimuth finer.
const CAP_POINTS: usize = 3;
/// Least number of columns that the azimuth is tabulated in; some to a segment of the tables.
const COLUMNS: usize = 48;
/// Share of every table that follows the cosine: what a table sees nothing of, its neighbours in angle may still show.
const COSINE_SHARE: f64 = 1e-4;

/// ∫ f·cosθi dσ(wi) over the chart about one `wo`, as fractions of the whole.
pub(super) struct Tabulated {
    /// `[part, column]`; > 0.
    pub mass: Array2<f64>,
    /// Sums of the parts.
    pub part: Vec<f64>,
    /// Mean position of each part's mass on its cap, 0 to 1.
    pub centre: Vec<f64>,
    /// Widths of the parts in caps.
    pub width: Vec<f64>,
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
    Stored {
        rows: each
            .iter()
            .flat_map(|table| quantise_rows(&table.iter().map(|r| r.mass).collect::<Vec<_>>()))
            .collect(),
        slopes: each.iter().flatten().map(|r| r.slope).collect(),
        nodes: each
            .iter()
            .flatten()
            .flat_map(|r| quantise_nodes(&r.density))
            .collect(),
        edges: edges.into_iter().map(|e| e as u16).collect(),
        cosines,
        width: settings.segments + 1,
    }
}

/// Columns of a tabulation, the same number to each segment.
fn columns(settings: &HalfVectorSettings) -> usize {
    settings.segments * COLUMNS.div_ceil(settings.segments).max(2)
}

fn tabulate(brdf: &dyn Brdf, settings: &HalfVectorSettings, theta_o: f64) -> Tabulated {
    let wo = spherical(theta_o, 0.0).as_vec3();
    let chart = HalfVectorChart::new(wo);
    let edge = |e: usize| f64::from(chart.edge_cap(ChartEdge::new(e)));
    let width: Vec<f64> = (0..PARTS).map(|p| edge(p + 1) - edge(p)).collect();
    // Sums of f·cosθi and of cosθi alone, by part and column.
    let mut sums = [(); 2].map(|()| Sums::new(columns(settings)));
    let (mut wi, mut jacobians, mut values) = (Vec::new(), Vec::new(), Vec::new());
    for (part, &width) in width.iter().enumerate() {
        wi.clear();
        jacobians.clear();
        for x in cap_points() {
            let azimuths = azimuths(columns(settings), settings.fold, x as f32);
            chart.for_each_azimuth((edge(part) + width * x) as f32, azimuths, |w, jacobian| {
                wi.push(w);
                jacobians.push(jacobian);
            });
        }
        values.resize(wi.len(), Rgb::ZERO);
        brdf.eval_batch(Wo::One(wo), &wi, &mut values);
        for (x, place) in cap_points().zip(0..) {
            let points = wi.len() / CAP_POINTS;
            for k in place * points..(place + 1) * points {
                let cosine = f64::from(wi[k].z.max(0.0) * jacobians[k]) * width;
                let f = f64::from(settings.importance.of(values[k]));
                sums[0].add(part, k % columns(settings), x, f * cosine);
                sums[1].add(part, k % columns(settings), x, cosine);
            }
        }
    }
    let [f, cosine] = sums;
    add_cosine(f, cosine, width)
}

/// Positions of points on the cap of a part.
fn cap_points() -> impl Iterator<Item = f64> {
    (0..CAP_POINTS).map(|i| (i as f64 + 0.5) / CAP_POINTS as f64)
}

/// Sums of points.
struct Sums {
    /// `[part, column]`.
    mass: Array2<f64>,
    /// First moments of the parts over their caps.
    first: Vec<f64>,
}

impl Sums {
    fn new(columns: usize) -> Self {
        Self {
            mass: Array2::zeros((PARTS, columns)),
            first: vec![0.0; PARTS],
        }
    }

    fn add(&mut self, part: usize, column: usize, x: f64, value: f64) {
        self.mass[[part, column]] += value;
        self.first[part] += value * x;
    }
}

/// Azimuth shares in [−1, 1], one a column at the share `x` of its width; first all of one side, then of the other where
/// folded.
fn azimuths(columns: usize, fold: bool, x: f32) -> impl Iterator<Item = f32> + Clone {
    let sides = if fold { 2 } else { 1 };
    (0..columns * sides).map(move |i| {
        let y = ((i % columns) as f32 + x) / columns as f32;
        match (fold, i < columns) {
            (false, _) => 2.0 * y - 1.0,
            (true, true) => y,
            (true, false) => -y,
        }
    })
}

/// The BRDF's masses and a little of the cosine's; the cosine's alone where the BRDF has none.
fn add_cosine(f: Sums, cosine: Sums, width: Vec<f64>) -> Tabulated {
    let (total, all) = (f.mass.sum(), cosine.mass.sum());
    let (of_f, of_cosine) = if total > 0.0 && total.is_finite() {
        ((1.0 - COSINE_SHARE) / total, COSINE_SHARE / all)
    } else {
        (0.0, 1.0 / all)
    };
    let first = f
        .first
        .iter()
        .zip(&cosine.first)
        .map(|(f, c)| f * of_f + c * of_cosine);
    let mass = f.mass * of_f + cosine.mass * of_cosine;
    let part = mass.sum_axis(Axis(1)).to_vec();
    let centre = first.zip(&part).map(|(first, sum)| first / sum).collect();
    Tabulated {
        mass,
        part,
        centre,
        width,
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

/// The slope of the density 1 + slope·(2x − 1) whose mean position is that of the parts' mass: mean = ½ + slope/6.
pub(super) fn slope_of(tabulated: &Tabulated, parts: std::ops::Range<usize>) -> f64 {
    let (mut mass, mut first, mut start) = (0.0, 0.0, 0.0);
    for part in parts {
        let m = tabulated.part[part];
        first += m * (start + tabulated.centre[part] * tabulated.width[part]);
        start += tabulated.width[part];
        mass += m;
    }
    // Midpoints see 1 − 1/n² of a part's own slope, which is little of a row of many parts.
    if mass > 0.0 {
        6.0 * (first / (mass * start) - 0.5)
    } else {
        0.0
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

/// Nodes are at least this share of the mean.
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

    /// The node before a column's middle, and the share of the node after it.
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
    let (n, mut sum, mut last) = (masses.len(), 0.0, 0u32);
    let room = |i: usize| u32::from(ONE) - (n - 1 - i) as u32;
    let step = |(i, mass): (usize, &f64)| {
        sum += mass;
        let at = if i + 1 == n {
            u32::from(ONE)
        } else {
            (sum * f64::from(ONE)).round() as u32
        };
        last = at.clamp(last + 1, room(i));
        last as u16
    };
    masses.iter().enumerate().map(step).collect()
}

/// Nodes of a density, ≥ 0 and not all 0, scaled to [`NODE_SUM`] and each at least one unit.
pub fn quantise_nodes(density: &[f64]) -> Vec<u16> {
    let last = density.len() - 1;
    // The two ends count once, the others twice.
    let weight = |i: usize| if i == 0 || i == last { 1 } else { 2 };
    let sum: f64 = density
        .iter()
        .enumerate()
        .map(|(i, d)| d * f64::from(weight(i)))
        .sum();
    let scale = f64::from(NODE_SUM) / sum;
    let (mut nodes, mut spent, mut exact) = (Vec::with_capacity(last + 1), 0u32, 0.0);
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

    #[test]
    fn azimuths_cover_both_sides() {
        for fold in [false, true] {
            let all: Vec<f32> = azimuths(8, fold, 0.25).collect();
            assert!(all.iter().any(|b| *b < -0.8) && all.iter().any(|b| *b > 0.75));
            assert!(all.iter().all(|b| (-1.0..=1.0).contains(b)));
        }
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
