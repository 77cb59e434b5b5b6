//! How far the data pin a fit's parameters down.

use merlkit::Result;
use serde::Serialize;

use super::search::{Found, ShapeSearch, Target};
use super::weights::{Weights, mix};

/// The relative growth of the error that a parameter's range allows.
pub const ALLOWED_GROWTH: f64 = 0.05;

/// Steps of the derivatives by shapes, in the coordinates of the search.
const STEP: f64 = 1e-2;

/// A parameter with the range that the data leave it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PinnedParameter {
    /// Its key, as "ggx ax", or "diffuse red".
    pub name: String,
    /// Its value.
    pub value: f64,
    /// The range in which the error grows by at most 5 % when all other parameters are fitted again, from the Gauss-Newton
    /// Hessian.
    pub range: [f64; 2],
    /// How far it is known.
    pub pinned: Pinned,
}

/// How far a parameter is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pinned {
    /// Its range lies inside the domain.
    Down,
    /// Its range reaches an end of the domain.
    NotDown,
    /// Its value is an end of the domain.
    AtTheEnd,
}

/// A column of the Jacobian: the parameter, its coordinate, and the derivatives of all residuals, channel by channel.
struct Column {
    name: String,
    value: f64,
    ends: [f64; 2],
    /// The values at a coordinate moved by −δ and δ, given δ.
    spread: Spread,
    derivatives: Vec<f64>,
    at_the_end: bool,
}

/// From a range of the coordinate to one of the value.
#[derive(Clone, Copy)]
enum Spread {
    Shape(super::recipe::ShapeParameter),
    Weight,
}

impl Spread {
    fn range(self, value: f64, delta: f64) -> [f64; 2] {
        match self {
            Self::Weight => [value - delta, value + delta],
            Self::Shape(parameter) => {
                let ends = [parameter.low, parameter.high].map(|p| parameter.scale.coordinate(p));
                let x = parameter.scale.coordinate(value);
                [x - delta, x + delta].map(|x| parameter.scale.value(x.clamp(ends[0], ends[1])))
            }
        }
    }
}

/// The range of each parameter of a fit.
///
/// With J the Jacobian of the residuals at the optimum and S their sum of squares, S(x + δ) ≈ S + δᵀJᵀJδ. Where the other
/// parameters follow, the least growth for a given δ_i is δ_i²/((JᵀJ)⁻¹)_ii, so the error √S grows by the factor 1 + g at
/// δ_i = √(((1 + g)² − 1)·S·((JᵀJ)⁻¹)_ii).
///
/// # Errors
/// Those of the models' texts.
pub(super) fn pin_parameters(
    target: &Target<'_>,
    search: &ShapeSearch<'_>,
    found: &Found,
    names: &[&str],
) -> Result<Vec<PinnedParameter>> {
    let mut columns = shape_columns(target, search, found, names)?;
    columns.extend(weight_columns(target, search, found, names)?);
    let free: Vec<usize> = (0..columns.len())
        .filter(|i| !columns[*i].at_the_end)
        .collect();
    let variances = invert_diagonal(&normal_matrix(&columns, &free));
    let growth = (1.0 + ALLOWED_GROWTH).powi(2) - 1.0;
    let mut pinned = Vec::with_capacity(columns.len());
    for (i, column) in columns.into_iter().enumerate() {
        let place = free.iter().position(|k| *k == i);
        let delta = place.map(|k| (growth * found.squares * variances[k]).sqrt());
        pinned.push(column.finish(delta));
    }
    Ok(pinned)
}

impl Column {
    /// The parameter with its range, given the δ of its coordinate; `None` at the end of its domain.
    fn finish(self, delta: Option<f64>) -> PinnedParameter {
        let [low, high] = self.ends;
        let (range, pinned) = match delta {
            None => ([self.value; 2], Pinned::AtTheEnd),
            Some(delta) => {
                let [a, b] = self.spread.range(self.value, delta);
                let inside = a > low && b < high;
                let pinned = if inside {
                    Pinned::Down
                } else {
                    Pinned::NotDown
                };
                ([a.max(low), b.min(high)], pinned)
            }
        };
        PinnedParameter {
            name: self.name,
            value: self.value,
            range,
            pinned,
        }
    }
}

/// The columns of the shapes, by central differences of the lobes with the weights held.
fn shape_columns(
    target: &Target<'_>,
    search: &ShapeSearch<'_>,
    found: &Found,
    names: &[&str],
) -> Result<Vec<Column>> {
    let x = search.coordinates(&found.shapes);
    let mut columns = Vec::new();
    for (lobe, parameters) in search.lobes.iter().enumerate() {
        for parameter in parameters {
            let i = columns.len();
            let value = found.shapes[i];
            let mut sides = Vec::with_capacity(2);
            for step in [-STEP, STEP] {
                let mut moved = x.clone();
                moved[i] += step;
                let values = search.values(&moved);
                let width = parameter.scale.coordinate(values[i]) - x[i];
                sides.push((
                    metric_column(target, search, &values, &found.weights)?,
                    width,
                ));
            }
            let width = sides[1].1 - sides[0].1;
            let both = sides[0].0.iter().zip(&sides[1].0);
            columns.push(Column {
                name: format!("{} {}", names[lobe], parameter.keys.join("=")),
                value,
                ends: [parameter.low, parameter.high],
                spread: Spread::Shape(*parameter),
                derivatives: both.map(|(a, b)| (b - a) / width).collect(),
                at_the_end: is_end(value, [parameter.low, parameter.high]),
            });
        }
    }
    Ok(columns)
}

/// Whether a value is an end of its domain, but for rounding.
fn is_end(value: f64, [low, high]: [f64; 2]) -> bool {
    value <= low + 1e-4 * low.abs().max(1e-3) || value >= high * (1.0 - 1e-4)
}

/// g at all pairs for shapes and weights, channel by channel.
fn metric_column(
    target: &Target<'_>,
    search: &ShapeSearch<'_>,
    values: &[f64],
    weights: &[Weights; 3],
) -> Result<Vec<f64>> {
    let parts = search.parts(values)?;
    let mut column = Vec::new();
    for weights in weights {
        for k in 0..target.pairs.len() {
            let v = mix(&parts, weights, k);
            column.push(target.metric.value_and_slope(v)[0]);
        }
    }
    Ok(column)
}

/// The columns of the weights: g′·b_j in their channel and 0 in the others.
fn weight_columns(
    target: &Target<'_>,
    search: &ShapeSearch<'_>,
    found: &Found,
    names: &[&str],
) -> Result<Vec<Column>> {
    let parts = search.parts(&found.shapes)?;
    let count = target.pairs.len();
    let mut columns = Vec::new();
    for (j, values) in parts.values.iter().enumerate() {
        let name = if j == 0 { "diffuse" } else { names[j - 1] };
        for (c, colour) in ["red", "green", "blue"].iter().enumerate() {
            let weights = &found.weights[c];
            let mut derivatives = vec![0.0; 3 * count];
            for (k, value) in values.iter().enumerate() {
                let v = mix(&parts, weights, k);
                derivatives[c * count + k] = target.metric.value_and_slope(v)[1] * value;
            }
            let ends = [0.0, parts.largest[j]];
            columns.push(Column {
                name: format!("{name} {colour}"),
                value: weights[j],
                ends,
                spread: Spread::Weight,
                derivatives,
                at_the_end: is_end(weights[j], ends),
            });
        }
    }
    Ok(columns)
}

/// JᵀJ of the columns that are free.
fn normal_matrix(columns: &[Column], free: &[usize]) -> Vec<Vec<f64>> {
    let mut matrix = Vec::with_capacity(free.len());
    for i in free {
        let mut row = Vec::with_capacity(free.len());
        for j in free {
            let pairs = columns[*i].derivatives.iter().zip(&columns[*j].derivatives);
            row.push(pairs.map(|(a, b)| a * b).sum());
        }
        matrix.push(row);
    }
    matrix
}

/// The diagonal of the inverse of a symmetric, positive matrix, by Cholesky's A = LLᵀ: (A⁻¹)_ii = Σ_k ((L⁻¹)_ki)². Directions
/// that the data don't see have an infinite variance.
fn invert_diagonal(matrix: &[Vec<f64>]) -> Vec<f64> {
    let n = matrix.len();
    let mut lower = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let mut sum = matrix[i][j];
            for (a, b) in lower[i][..j].iter().zip(&lower[j][..j]) {
                sum -= a * b;
            }
            lower[i][j] = if i == j {
                sum.max(1e-12 * matrix[i][i]).sqrt()
            } else {
                sum / lower[j][j]
            };
        }
    }
    let mut diagonal = Vec::with_capacity(n);
    for i in 0..n {
        // Column i of L⁻¹, by forward substitution.
        let mut column = vec![0.0; n];
        let mut squares = 0.0;
        for k in i..n {
            let mut sum = if k == i { 1.0 } else { 0.0 };
            for m in i..k {
                sum -= lower[k][m] * column[m];
            }
            column[k] = sum / lower[k][k];
            squares += column[k] * column[k];
        }
        diagonal.push(squares);
    }
    diagonal
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_diagonal_of_an_inverse_is_known() {
        // [[4, 2], [2, 3]]⁻¹ = 1/8·[[3, −2], [−2, 4]].
        let found = invert_diagonal(&[vec![4.0, 2.0], vec![2.0, 3.0]]);
        assert!((found[0] - 0.375).abs() < 1e-12 && (found[1] - 0.5).abs() < 1e-12);
    }
}
