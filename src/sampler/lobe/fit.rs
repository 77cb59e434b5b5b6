//! Fitting: the parameters that make the weights of a material most even.

use argmin::core::{CostFunction, Executor};
use argmin::solver::neldermead::NelderMead;

use super::nodes::Nodes;
use super::settings::{LEAST_DIFFUSE, LobeKind, LobeParameters, LobeSettings};
use super::shape::LobeMixture;

/// The number of shapes, evenly spaced in the logarithm, and the diffuse fractions that the search starts from.
const STARTS: (usize, [f32; 4]) = (9, [0.01, 0.1, 0.4, 0.9]);
const MOST_STEPS: u64 = 120;
/// What a black material is given: the cosine alone.
const COSINE: LobeParameters = LobeParameters {
    along: 1.0,
    across: 1.0,
    diffuse: 1.0,
};

/// Unbounded coordinates of the parameters: logarithms of the shapes and the logit of the diffuse fraction.
struct Search<'a> {
    settings: &'a LobeSettings,
    nodes: &'a Nodes,
}

impl Search<'_> {
    fn cost_of(&self, parameters: &LobeParameters) -> f64 {
        let mixture = LobeMixture::new(self.settings, parameters);
        self.nodes.unevenness(|wo, wi| mixture.density(wo, wi))
    }

    /// Whether the lobe is fitted with a shape along each axis. Ward's has one in the plane of incidence, where two gain nothing.
    fn has_two_shapes(&self) -> bool {
        match self.settings.kind {
            LobeKind::AshikhminShirley => true,
            LobeKind::Ward => self.settings.surface_axes,
            _ => false,
        }
    }

    /// The parameters at `x`: what lies outside the domain is moved to its edge.
    fn parameters(&self, x: &[f64]) -> LobeParameters {
        let [low, high] = self.settings.kind.domain();
        // The last coordinate is the logit of the diffuse fraction; a lobe of one shape has it in both directions.
        let (along, across, logit) = match x {
            [along, across, logit] => (*along, *across, *logit),
            [shape, logit] => (*shape, *shape, *logit),
            [logit] => (0.0, 0.0, *logit),
            _ => (0.0, 0.0, 0.0),
        };
        let [along, across] = [along, across].map(|x| (x.exp() as f32).clamp(low, high));
        let diffuse = (1.0 / (1.0 + (-logit).exp())) as f32;
        LobeParameters {
            along,
            across,
            diffuse: diffuse.clamp(LEAST_DIFFUSE, 1.0),
        }
    }

    fn coordinates(&self, p: &LobeParameters) -> Vec<f64> {
        let [along, across, diffuse] = [p.along, p.across, p.diffuse].map(f64::from);
        // A fraction of 1 has an infinite logit, with which no simplex can compute.
        let logit = (diffuse / (1.0 - diffuse)).ln().min(12.0);
        if self.has_two_shapes() {
            return vec![along.ln(), across.ln(), logit];
        }
        vec![along.ln(), logit]
    }

    /// The best of a coarse grid, the first of equals.
    fn start(&self) -> (LobeParameters, f64) {
        let [low, high] = self.settings.kind.domain().map(f32::ln);
        let (shapes, shares) = STARTS;
        let points = (0..shapes).flat_map(|i| {
            // Neither end: a lobe at the edge of its domain is a bad place to search from.
            let shape = (low + (i as f32 + 0.5) / shapes as f32 * (high - low)).exp();
            shares.map(|diffuse| LobeParameters {
                along: shape,
                across: shape,
                diffuse,
            })
        });
        let costs = points.map(|p| (p, self.cost_of(&p)));
        costs.fold((COSINE, f64::INFINITY), |best, next| {
            if next.1 < best.1 { next } else { best }
        })
    }
}

impl CostFunction for Search<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, x: &Vec<f64>) -> Result<f64, argmin::core::Error> {
        Ok(self.cost_of(&self.parameters(x)))
    }
}

/// The parameters found by Nelder and Mead's simplex (1965) from the best of a grid; never worse than that.
pub(super) fn fit(settings: &LobeSettings, nodes: &Nodes) -> LobeParameters {
    if nodes.is_empty() {
        return COSINE;
    }
    let search = Search { settings, nodes };
    let (start, start_cost) = search.start();
    let origin = search.coordinates(&start);
    // Edges of 0.7, about ln 2, double the shapes and the odds of the cosine.
    let mut simplex = vec![origin.clone()];
    for i in 0..origin.len() {
        let mut corner = origin.clone();
        corner[i] += 0.7;
        simplex.push(corner);
    }
    let run = NelderMead::new(simplex)
        .with_sd_tolerance(1e-5)
        .and_then(|solver| {
            Executor::new(Search { settings, nodes }, solver)
                .configure(|s| s.max_iters(MOST_STEPS))
                .run()
        });
    let found = run
        .ok()
        .and_then(|r| r.state.best_param)
        .map(|x| search.parameters(&x));
    found
        // The simplex may end above its start, for example at the edge of the domain. Then the start is kept.
        .filter(|p| search.cost_of(p) < start_cost)
        .unwrap_or(start)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brdf::Importance;
    use crate::material::merl::decode_embedded;
    use crate::material::merl::{LookupRule, MerlBrdf};
    use std::sync::Arc;

    #[test]
    fn a_fit_is_no_worse_than_its_start_and_than_its_neighbours() {
        for name in ["nickel", "teflon", "red-plastic"] {
            let brdf = MerlBrdf::new(Arc::new(decode_embedded(name).unwrap()), LookupRule::Floor);
            let nodes = Nodes::tabulate(&brdf, Importance::Mean);
            for kind in LobeKind::ALL {
                let settings = &LobeSettings::fitted(kind);
                let search = Search {
                    settings,
                    nodes: &nodes,
                };
                let found = fit(settings, &nodes);
                let cost = search.cost_of(&found);
                assert!(cost <= search.start().1, "{name}, {kind:?}: {found:?}");
                let x = search.coordinates(&found);
                for step in [-0.1, 0.1] {
                    for i in 0..x.len() {
                        let mut moved = x.clone();
                        moved[i] += step;
                        let worse = search.cost_of(&search.parameters(&moved));
                        assert!(
                            cost < worse + 1e-3,
                            "{name}, {kind:?} {i}{step:+}: {cost} {worse}, {found:?}"
                        );
                    }
                }
            }
        }
    }
}
