//! Which parts of the chart share a row: the choice that adds least variance, by dynamic programming.

use super::build::{Tabulated, slope_of};
use crate::geometry::half_vector_chart::{MERL_PARTS, PARTS};

/// Columns that the shape over the azimuth is compared in.
const COLUMNS: usize = 8;

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
    mass: Vec<[f64; COLUMNS]>,
}

impl<'a> CoarseTabulation<'a> {
    fn new(tabulated: &'a Tabulated) -> Self {
        let mut mass = vec![[0.0; COLUMNS]; PARTS];
        let columns = tabulated.mass.ncols();
        for ((part, column), m) in tabulated.mass.indexed_iter() {
            mass[part][column * COLUMNS / columns] += m;
        }
        Self { tabulated, mass }
    }

    /// ∫ f²/p over a row of parts, less its mass, which is what p = f would give.
    fn cost(&self, start: usize, stop: usize) -> f64 {
        let (mass, width) = (&self.mass[start..stop], &self.tabulated.width[start..stop]);
        let columns = mass.iter().fold([0.0; COLUMNS], |sum, m| {
            std::array::from_fn(|c| sum[c] + m[c])
        });
        let inverse = columns.map(|c| if c > 0.0 { 1.0 / c } else { 0.0 });
        let per_width = 1.0 / width.iter().sum::<f64>();
        let slope = slope_of(self.tabulated, start..stop).clamp(-0.95, 0.95);
        let (mut x, mut cost) = (0.0, -columns.iter().sum::<f64>());
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
    use ndarray::{Array2, Axis};

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
