//! The search for the shapes: Nelder and Mead's simplex, with the best colours at every step (variable projection, Golub and
//! Pereyra 1973).

use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

use argmin::core::{CostFunction, Executor};
use argmin::solver::neldermead::NelderMead;
use glam::Vec3;
use merlkit::Result;
use merlkit::brdf::Brdf;
use merlkit::material::analytic::ModelFacts;

use super::metric::FitMetric;
use super::pairs::FitPairs;
use super::recipe::{FitModel, ShapeParameter, start_values};
use super::weights::{Channel, Parts, Weights};

/// Steps of the simplex for each shape parameter at most.
const STEPS_PER_SHAPE: u64 = 50;
/// The simplex ends where its errors spread by less.
const LEAST_SPREAD: f64 = 1e-7;
/// Edges of the first simplex: a factor of 1.6 of roughnesses and exponents.
const EDGE: f64 = 0.5;
/// The best starts, each of which is followed.
const FOLLOWED: usize = 2;

/// A material at the pairs of a fit.
pub(super) struct Target<'a> {
    pub(super) pairs: &'a FitPairs,
    pub(super) metric: FitMetric,
    pub(super) channels: [Channel; 3],
    pub(super) isotropic: bool,
}

/// Shapes with their best weights, per channel, and the sum of squares of the three.
#[derive(Clone)]
pub(super) struct Found {
    pub(super) shapes: Vec<f64>,
    pub(super) weights: [Weights; 3],
    pub(super) squares: f64,
}

impl<'a> Target<'a> {
    pub(super) fn new(brdf: &dyn Brdf, pairs: &'a FitPairs, metric: FitMetric) -> Self {
        let mut channels = [Vec::new(), Vec::new(), Vec::new()];
        for (k, (wo, wi)) in pairs.wo.iter().zip(&pairs.wi).enumerate() {
            let value = brdf.eval(*wo, *wi).as_dvec3() * pairs.cos_i[k];
            for (channel, v) in channels.iter_mut().zip(value.to_array()) {
                channel.push(v);
            }
        }
        Self {
            pairs,
            metric,
            channels: channels.map(|values| Channel::new(values, metric)),
            isotropic: brdf.is_isotropic(),
        }
    }

    /// The root mean square of the metric's values over pairs and channels.
    pub(super) fn root_mean_square(&self) -> f64 {
        let mut sum = 0.0;
        for channel in &self.channels {
            for value in channel.metric_values() {
                sum += value * value;
            }
        }
        self.rms(sum)
    }

    /// The root of the mean over pairs and channels of what `squares` is the sum of.
    pub(super) fn rms(&self, squares: f64) -> f64 {
        (squares / (3 * self.pairs.len()) as f64).sqrt()
    }

    /// The error of a BRDF: √(mean of (g(v) − g(v′))²).
    pub(super) fn error(&self, brdf: &dyn Brdf) -> f64 {
        let other = Self::new(brdf, self.pairs, self.metric);
        let mut sum = 0.0;
        for (channel, found) in self.channels.iter().zip(&other.channels) {
            for (a, b) in channel.metric_values().iter().zip(found.metric_values()) {
                sum += (a - b) * (a - b);
            }
        }
        self.rms(sum)
    }
}

/// A model that is fitted to a target.
pub(super) struct ShapeSearch<'a> {
    target: &'a Target<'a>,
    model: &'a FitModel,
    /// The shape parameters of each lobe.
    pub(super) lobes: Vec<Vec<ShapeParameter>>,
}

impl<'a> ShapeSearch<'a> {
    pub(super) fn new(target: &'a Target<'a>, model: &'a FitModel) -> Self {
        let mut lobes = Vec::new();
        for recipe in model.lobes() {
            lobes.push(recipe.shapes(target.isotropic));
        }
        Self {
            target,
            model,
            lobes,
        }
    }

    /// The values at coordinates: what lies outside a domain is moved to its end.
    pub(super) fn values(&self, x: &[f64]) -> Vec<f64> {
        let parameters = self.lobes.iter().flatten();
        let mut values = Vec::with_capacity(x.len());
        for (x, parameter) in x.iter().zip(parameters) {
            let ends = [parameter.low, parameter.high].map(|p| parameter.scale.coordinate(p));
            values.push(parameter.scale.value(x.clamp(ends[0], ends[1])));
        }
        values
    }

    pub(super) fn coordinates(&self, values: &[f64]) -> Vec<f64> {
        let parameters = self.lobes.iter().flatten();
        let mut x = Vec::with_capacity(values.len());
        for (value, parameter) in values.iter().zip(parameters) {
            x.push(parameter.scale.coordinate(*value));
        }
        x
    }

    /// The lobe of weight 1 with these shapes, all of the model's in a row.
    fn unit_lobe(&self, lobe: usize, values: &[f64]) -> Result<Arc<dyn Brdf>> {
        let recipe = self.model.lobes()[lobe];
        let own = self.own_shapes(lobe, values);
        ModelFacts::brdf(&recipe.text(&self.lobes[lobe], own, [1.0; 3]))
    }

    /// Those of the shapes in a row that belong to a lobe.
    pub(super) fn own_shapes<'v>(&self, lobe: usize, values: &'v [f64]) -> &'v [f64] {
        let start: usize = self.lobes[..lobe].iter().map(Vec::len).sum();
        &values[start..start + self.lobes[lobe].len()]
    }

    /// f_r·cosθi of the diffuse part and of the lobes.
    pub(super) fn parts(&self, values: &[f64]) -> Result<Parts> {
        let pairs = self.target.pairs;
        let diffuse = pairs.cos_i.iter().map(|cos_i| cos_i * FRAC_1_PI);
        let mut parts = Parts {
            values: vec![diffuse.collect()],
            largest: vec![1.0],
        };
        for (lobe, recipe) in self.model.lobes().iter().enumerate() {
            let brdf = self.unit_lobe(lobe, values)?;
            let mut column = Vec::with_capacity(pairs.len());
            for (k, (wo, wi)) in pairs.wo.iter().zip(&pairs.wi).enumerate() {
                let value: Vec3 = brdf.eval(*wo, *wi);
                column.push(f64::from(value.x) * pairs.cos_i[k]);
            }
            parts.values.push(column);
            let own = self.own_shapes(lobe, values);
            parts.largest.push(recipe.largest_weight(own));
        }
        Ok(parts)
    }

    /// The best colours for shapes.
    pub(super) fn project(&self, values: &[f64]) -> Result<Found> {
        let parts = self.parts(values)?;
        let mut found = Found {
            shapes: values.to_vec(),
            weights: Default::default(),
            squares: 0.0,
        };
        for (channel, weights) in self.target.channels.iter().zip(&mut found.weights) {
            let (solved, squares) = channel.solve(&parts);
            *weights = solved;
            found.squares += squares;
        }
        Ok(found)
    }

    /// The best of all starts that are followed to their ends.
    ///
    /// # Errors
    /// Those of the models' texts, which the recipes exclude.
    pub(super) fn run(&self) -> Result<Found> {
        let mut starts = Vec::new();
        for values in start_values(self.model, self.target.isotropic) {
            starts.push(self.project(&values)?);
        }
        // A stable sort: of equals the first start is taken.
        starts.sort_by(|a, b| a.squares.total_cmp(&b.squares));
        let mut best = starts[0].clone();
        for start in starts.iter().take(FOLLOWED) {
            let found = self.follow(start)?;
            if found.squares < best.squares {
                best = found;
            }
        }
        Ok(best)
    }

    /// The end of the simplex that starts at these shapes.
    fn follow(&self, start: &Found) -> Result<Found> {
        let origin = self.coordinates(&start.shapes);
        let mut simplex = vec![origin.clone()];
        for i in 0..origin.len() {
            let mut corner = origin.clone();
            // Inwards, where outwards would end at the edge of the domain.
            corner[i] += EDGE;
            if self.values(&corner)[i] == self.values(&origin)[i] {
                corner[i] -= 2.0 * EDGE;
            }
            simplex.push(corner);
        }
        let steps = STEPS_PER_SHAPE * origin.len() as u64;
        let run = NelderMead::new(simplex)
            .with_sd_tolerance(LEAST_SPREAD)
            .and_then(|solver| {
                Executor::new(self, solver)
                    .configure(|state| state.max_iters(steps))
                    .run()
            });
        match run.ok().and_then(|result| result.state.best_param) {
            Some(x) => self.project(&self.values(&x)),
            None => Ok(start.clone()),
        }
    }
}

impl CostFunction for &ShapeSearch<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, x: &Vec<f64>) -> std::result::Result<f64, argmin::core::Error> {
        let found = self.project(&self.values(x))?;
        Ok(self.target.rms(found.squares))
    }
}
