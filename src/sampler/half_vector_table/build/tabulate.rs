//! Tabulating a BRDF over the chart of half vectors, and choosing which parts of the chart become a row of the tables.

use ndarray::{Array2, Axis};

use super::super::HalfVectorSettings;
use crate::batch::Wo;
use crate::brdf::Brdf;
use crate::color::Rgb;
use crate::geometry::half_vector_chart::{ChartEdge, HalfVectorChart, MERL_PARTS, PARTS};
use crate::geometry::spherical;

/// Points a part over its cap. Each is turned by its fraction of a column, so that together they resolve the azimuth finer.
const CAP_POINTS: usize = 3;
/// Least number of columns that the azimuth is tabulated in; some to a segment of the tables.
const COLUMNS: usize = 48;
/// Fraction of every table that follows the cosine: what a table sees nothing of, its neighbours in angle may still show.
const COSINE_FRACTION: f64 = 1e-4;

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

/// Columns of a tabulation, the same number to each segment.
pub(super) fn columns(settings: &HalfVectorSettings) -> usize {
    settings.segments * COLUMNS.div_ceil(settings.segments).max(2)
}

pub(super) fn tabulate(brdf: &dyn Brdf, settings: &HalfVectorSettings, theta_o: f64) -> Tabulated {
    let wo = spherical(theta_o, 0.0).as_vec3();
    let chart = HalfVectorChart::new(wo);
    let mut edges = [0.0; PARTS + 1];
    for (e, edge) in edges.iter_mut().enumerate() {
        *edge = f64::from(chart.edge_cap(ChartEdge::new(e)));
    }
    let width: Vec<f64> = edges.windows(2).map(|pair| pair[1] - pair[0]).collect();
    // Sums of f·cosθi and of cosθi alone, by part and column.
    let mut sums = [(); 2].map(|()| Sums::new(columns(settings)));
    let mut wi = Vec::new();
    let mut jacobians = Vec::new();
    let mut values = Vec::new();
    for (part, &width) in width.iter().enumerate() {
        wi.clear();
        jacobians.clear();
        for x in cap_points() {
            let azimuths = azimuths(columns(settings), settings.fold, x as f32);
            chart.for_each_azimuth((edges[part] + width * x) as f32, azimuths, |w, jacobian| {
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
                let f = f64::from(settings.importance.reduce(values[k]));
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

/// Azimuth fractions in [−1, 1], one a column at the fraction `x` of its width; first all of one side, then of the other where
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
        ((1.0 - COSINE_FRACTION) / total, COSINE_FRACTION / all)
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

// Which parts share a row: the choice that adds least variance, by dynamic programming.

/// Columns that the shape over the azimuth is compared in.
const COARSE_COLUMNS: usize = 8;

/// Edges of `count` rows (2 to [`PARTS`]) among the parts' edges, from 0 to [`PARTS`].
///
/// Minimises Σ over tables of ∫ f²/p, with p what a row can represent. No row spans the last of MERL's parts, beyond which
/// parts grow with θo.
pub(super) fn choose_row_edges(tables: &[Tabulated], count: usize) -> Vec<usize> {
    if count == PARTS {
        return (0..=PARTS).collect();
    }
    let coarse: Vec<CoarseTabulation> = tables.iter().map(CoarseTabulation::new).collect();
    let longest = PARTS - count + 1;
    // best[r][j]: least cost of r rows up to edge j, and where the last of them starts.
    let mut best = vec![vec![(f64::INFINITY, 0); PARTS + 1]; count + 1];
    best[0][0].0 = 0.0;
    for start in 0..PARTS {
        let end = if start < MERL_PARTS {
            MERL_PARTS
        } else {
            PARTS
        };
        for stop in start + 1..=end.min(start + longest) {
            let cost: f64 = coarse.iter().map(|t| t.cost(start, stop)).sum();
            for rows in 1..=count {
                let sum = best[rows - 1][start].0 + cost;
                if sum < best[rows][stop].0 {
                    best[rows][stop] = (sum, start);
                }
            }
        }
    }
    let mut edges = vec![PARTS];
    for rows in (1..=count).rev() {
        edges.push(best[rows][edges[edges.len() - 1]].1);
    }
    edges.reverse();
    edges
}

/// A tabulation in few columns.
struct CoarseTabulation<'a> {
    tabulated: &'a Tabulated,
    /// Masses of each part's columns.
    mass: Vec<[f64; COARSE_COLUMNS]>,
}

impl<'a> CoarseTabulation<'a> {
    fn new(tabulated: &'a Tabulated) -> Self {
        let mut mass = vec![[0.0; COARSE_COLUMNS]; PARTS];
        let columns = tabulated.mass.ncols();
        for ((part, column), m) in tabulated.mass.indexed_iter() {
            mass[part][column * COARSE_COLUMNS / columns] += m;
        }
        Self { tabulated, mass }
    }

    /// ∫ f²/p over a row of parts, less its mass, which is what p = f would give.
    fn cost(&self, start: usize, stop: usize) -> f64 {
        let mass = &self.mass[start..stop];
        let width = &self.tabulated.width[start..stop];
        let columns = mass.iter().fold([0.0; COARSE_COLUMNS], |sum, m| {
            std::array::from_fn(|c| sum[c] + m[c])
        });
        let inverse = columns.map(|c| if c > 0.0 { 1.0 / c } else { 0.0 });
        let per_width = 1.0 / width.iter().sum::<f64>();
        let slope = slope_of(self.tabulated, start..stop).clamp(-0.95, 0.95);
        let mut x = 0.0;
        let mut cost = -columns.iter().sum::<f64>();
        for (m, w) in mass.iter().zip(width) {
            let step = w * per_width;
            let p = step * (1.0 + slope * (2.0 * x + step - 1.0));
            x += step;
            cost += m.iter().zip(&inverse).map(|(m, i)| m * m * i).sum::<f64>() / p;
        }
        cost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn azimuths_cover_both_sides() {
        for fold in [false, true] {
            let all: Vec<f32> = azimuths(8, fold, 0.25).collect();
            assert!(all.iter().any(|b| *b < -0.8) && all.iter().any(|b| *b > 0.75));
            assert!(all.iter().all(|b| (-1.0..=1.0).contains(b)));
        }
    }

    /// A density over the parts, the same at every azimuth.
    fn tabulated(density: impl Fn(usize) -> f64) -> Tabulated {
        let mut mass = Array2::from_shape_fn((PARTS, 16), |(part, _)| density(part));
        mass /= mass.sum();
        let part = mass.sum_axis(Axis(1)).to_vec();
        Tabulated {
            mass,
            part,
            centre: vec![0.5; PARTS],
            width: vec![1.0; PARTS],
        }
    }

    #[test]
    fn rows_are_cut_where_the_density_jumps() {
        let steps = |p: usize| {
            [5.0, 1.0, 3.0, 0.2, 0.1][[7, 20, 40, 63].iter().filter(|&&e| p >= e).count()]
        };
        assert_eq!(
            choose_row_edges(&[tabulated(steps)], 5),
            [0, 7, 20, 40, 63, PARTS]
        );
    }

    #[test]
    fn any_number_of_rows_can_be_had() {
        let table = [tabulated(|p| 1.0 / (1.0 + p as f64))];
        for count in [2, 3, 9, 40, PARTS - 1, PARTS] {
            let edges = choose_row_edges(&table, count);
            assert_eq!((edges.len(), edges[0], edges[count]), (count + 1, 0, PARTS));
            assert!(edges.is_sorted_by(|a, b| a < b) && edges.contains(&MERL_PARTS));
        }
    }
}
