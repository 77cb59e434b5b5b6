//! The colours of a fit for given shapes: weights of the diffuse part and of each lobe, one set a channel.

use super::metric::FitMetric;

/// The most parts: the diffuse one and three lobes.
pub(super) const MOST_PARTS: usize = 4;

/// Weights of the parts.
pub(super) type Weights = [f64; MOST_PARTS];

/// Steps of Gauss and Newton at most.
const MOST_STEPS: usize = 25;
/// A step that lowers the sum of squares by less, relatively, is the last.
const LEAST_GAIN: f64 = 1e-7;
/// Sweeps over the weights that solve the quadratic program of a step.
const SWEEPS: usize = 60;
/// The weights that the search starts from are at least this fraction of what explains all of the material.
const FLOOR: f64 = 1e-4;

/// f_r·cosθi of each part with weight 1, at all pairs, and the largest weight of each.
pub(super) struct Parts {
    pub(super) values: Vec<Vec<f64>>,
    pub(super) largest: Vec<f64>,
}

/// A material's channel, in the metric.
pub(super) struct Channel {
    /// v = f_r·cosθi.
    values: Vec<f64>,
    /// g(v).
    metric_values: Vec<f64>,
    metric: FitMetric,
}

/// The normal equations of a step: JᵀJ and Jᵀr, with the sum of squares r·r.
struct NormalEquations {
    matrix: [Weights; MOST_PARTS],
    right: Weights,
    squares: f64,
}

impl Channel {
    pub(super) fn new(values: Vec<f64>, metric: FitMetric) -> Self {
        let mut metric_values = Vec::with_capacity(values.len());
        for v in &values {
            metric_values.push(metric.value_and_slope(*v)[0]);
        }
        Self {
            values,
            metric_values,
            metric,
        }
    }

    /// g(v) of the material.
    pub(super) fn metric_values(&self) -> &[f64] {
        &self.metric_values
    }

    /// The weights that minimise Σ (g(v) − g(Σ a_j·b_j))² within 0 ≤ a_j ≤ `parts.largest`, and that sum.
    pub(super) fn solve(&self, parts: &Parts) -> (Weights, f64) {
        let mut weights = self.start(parts);
        let mut equations = self.linearise(parts, &weights);
        for _ in 0..MOST_STEPS {
            let target = solve_bounded(&equations, &weights, &parts.largest);
            let Some((next, squares)) =
                self.search_line(parts, &weights, &target, equations.squares)
            else {
                break;
            };
            let gain = equations.squares - squares;
            weights = next;
            if gain <= LEAST_GAIN * equations.squares {
                return (weights, squares);
            }
            equations = self.linearise(parts, &weights);
        }
        (weights, equations.squares)
    }

    /// The weights that minimise Σ g′(v)²·(v − Σ a_j·b_j)²: the problem linearised at the material's own values.
    fn start(&self, parts: &Parts) -> Weights {
        let mut equations = NormalEquations {
            matrix: [[0.0; MOST_PARTS]; MOST_PARTS],
            right: [0.0; MOST_PARTS],
            squares: 0.0,
        };
        for (k, v) in self.values.iter().enumerate() {
            let slope = self.metric.value_and_slope(v.max(1e-4))[1];
            equations.add(parts, k, slope, slope * v);
        }
        let mut weights = solve_bounded(&equations, &[0.0; MOST_PARTS], &parts.largest);
        // A weight of exactly 0 has an infinite slope in the cube root, so it starts a little above.
        for (j, largest) in parts.largest.iter().enumerate() {
            let diagonal = equations.matrix[j][j];
            if diagonal > 0.0 {
                let alone = (equations.right[j] / diagonal).max(0.0);
                weights[j] = weights[j].max(FLOOR * alone).min(*largest);
            }
        }
        weights
    }

    /// Linearises g(Σ a_j·b_j) at the weights: J has the columns g′·b_j, and r = g(v) − g(Σ a_j·b_j).
    fn linearise(&self, parts: &Parts, weights: &Weights) -> NormalEquations {
        let mut equations = NormalEquations {
            matrix: [[0.0; MOST_PARTS]; MOST_PARTS],
            right: [0.0; MOST_PARTS],
            squares: 0.0,
        };
        for (k, expected) in self.metric_values.iter().enumerate() {
            let [value, slope] = self.metric.value_and_slope(mix(parts, weights, k));
            equations.add(parts, k, slope, expected - value);
        }
        equations
    }

    /// The first of the points all, half, a quarter… of the way to `target` with a lower sum of squares, and that sum.
    fn search_line(
        &self,
        parts: &Parts,
        weights: &Weights,
        target: &Weights,
        squares: f64,
    ) -> Option<(Weights, f64)> {
        let mut step = 1.0;
        for _ in 0..8 {
            let mut next = *weights;
            for (a, b) in next.iter_mut().zip(target) {
                *a += step * (b - *a);
            }
            let found = self.sum_squares(parts, &next);
            if found < squares {
                return Some((next, found));
            }
            step *= 0.5;
        }
        None
    }

    /// Σ (g(v) − g(Σ a_j·b_j))².
    pub(super) fn sum_squares(&self, parts: &Parts, weights: &Weights) -> f64 {
        let mut sum = 0.0;
        for (k, expected) in self.metric_values.iter().enumerate() {
            let found = self.metric.value_and_slope(mix(parts, weights, k))[0];
            sum += (expected - found) * (expected - found);
        }
        sum
    }
}

/// Σ a_j·b_j at a pair.
pub(super) fn mix(parts: &Parts, weights: &Weights, pair: usize) -> f64 {
    let mut sum = 0.0;
    for (values, weight) in parts.values.iter().zip(weights) {
        sum += weight * values[pair];
    }
    sum
}

impl NormalEquations {
    /// Adds the pair `k`, whose row of J is `slope`·b_j and whose residual is `residual`.
    fn add(&mut self, parts: &Parts, k: usize, slope: f64, residual: f64) {
        for (j, values) in parts.values.iter().enumerate() {
            let row = slope * values[k];
            self.right[j] += row * residual;
            for (i, others) in parts.values[..=j].iter().enumerate() {
                self.matrix[j][i] += row * slope * others[k];
            }
        }
        self.squares += residual * residual;
    }

    fn entry(&self, i: usize, j: usize) -> f64 {
        self.matrix[i.max(j)][i.min(j)]
    }
}

/// The weights a within 0 ≤ a_j ≤ `largest` that minimise ½(a − a₀)ᵀJᵀJ(a − a₀) − (a − a₀)ᵀJᵀr, by descent along one weight
/// after the other.
fn solve_bounded(equations: &NormalEquations, origin: &Weights, largest: &[f64]) -> Weights {
    let mut weights = *origin;
    for _ in 0..SWEEPS {
        for (j, largest) in largest.iter().enumerate() {
            let diagonal = equations.entry(j, j);
            if diagonal <= 0.0 {
                continue;
            }
            let mut gradient = equations.right[j];
            for i in 0..weights.len() {
                gradient -= equations.entry(i, j) * (weights[i] - origin[i]);
            }
            weights[j] = (weights[j] + gradient / diagonal).clamp(0.0, *largest);
        }
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_a_sum_are_found_in_every_metric() {
        let mut values = vec![Vec::new(), Vec::new()];
        let mut sum = Vec::new();
        for k in 0..500 {
            let x = f64::from(k) / 500.0;
            values[0].push(0.3);
            values[1].push(20.0 * (-40.0 * x).exp() + 0.01 * x);
            sum.push(0.3 * 0.25 + 0.6 * values[1][k as usize]);
        }
        let parts = Parts {
            values,
            largest: vec![1.0; 2],
        };
        for (_, metric) in FitMetric::ALL {
            let channel = Channel::new(sum.clone(), *metric);
            let (weights, squares) = channel.solve(&parts);
            assert!(squares < 1e-10, "{metric:?}: {squares}");
            assert!((weights[0] - 0.25).abs() < 1e-5 && (weights[1] - 0.6).abs() < 1e-5);
        }
    }

    #[test]
    fn weights_stay_in_their_domain() {
        let parts = Parts {
            values: vec![vec![0.1, 0.2], vec![0.0, 5.0]],
            largest: vec![1.0; 2],
        };
        for (_, metric) in FitMetric::ALL {
            let channel = Channel::new(vec![3.0, 0.0], *metric);
            let weights = channel.solve(&parts).0;
            assert!(
                weights.iter().all(|w| (0.0..=1.0).contains(w)),
                "{weights:?}"
            );
        }
    }
}
