//! Tabulating, factoring, and the choice of factors.

use glam::DVec3;
use ndarray::{Array1, Array2, Axis};
use rayon::prelude::*;

use super::mixture::{Factored, Terms};
use super::settings::{FactoredSettings, Factors};
use crate::Result;
use crate::brdf::{Brdf, Importance};
use crate::distribution::{Curves, cumulated};
use crate::geometry::{Symmetry, spherical};
use crate::sampler::azimuth_knots::{AzimuthKnots, check_azimuths};
use crate::sampler::cascade_cdf::{ThetaAxis, contribution, masses};
use crate::sampler::direction_knots::DirectionKnots;
use crate::sampler::lobe::Nodes;
use crate::sampler::{Settings, TableChoice, ThetaSpacing};

/// Rounds of multiplicative updates; the divergence changes by some thousandths of itself after these.
const ROUNDS: usize = 80;
/// What is tried when the factors are not given: J, K, and cells over φw. θw has one cell a bin of MERL's.
const TRIED: ([usize; 4], [usize; 3], [usize; 2]) = ([1, 2, 4, 8], [1, 2, 4], [16, 32]);
const THETA: usize = 90;
/// The fraction of cosine that those are tried with, and what is tried for the best of them.
const FIRST_FLOOR: f64 = 0.01;
const FLOORS: [f64; 6] = [1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3];

impl Factored {
    /// Factors `brdf` on the threads of the current pool; the result does not depend on their number.
    ///
    /// # Errors
    /// [`crate::Error::Argument`] for settings outside their domains.
    pub fn build(brdf: &dyn Brdf, settings: FactoredSettings) -> Result<Self> {
        settings.check()?;
        check_azimuths(settings.azimuths, brdf.symmetry())?;
        let settings = FactoredSettings {
            azimuths: AzimuthKnots::new(brdf.symmetry(), settings.azimuths).setting(),
            ..settings
        };
        match settings.factors {
            Some(factors) => factored(brdf, settings, factors),
            None => best(brdf, settings),
        }
    }
}

/// The sampler of the given factors.
fn factored(brdf: &dyn Brdf, settings: FactoredSettings, factors: Factors) -> Result<Factored> {
    let grid = grid(brdf, &settings, &factors)?;
    let outer = Factorisation::factorise(&grid, factors.outer);
    Factored::from_parts(settings, brdf.symmetry(), terms(&outer, &factors))
}

/// The sampler of those factors that make weights most even, by the measure that lobes are fitted by. The first of equals, that
/// is the smallest; for a black material, the smallest of all.
fn best(brdf: &dyn Brdf, settings: FactoredSettings) -> Result<Factored> {
    let least = Factors {
        outer: 1,
        inner: 1,
        theta: THETA,
        phi: TRIED.2[0],
        half: true,
        floor: FIRST_FLOOR,
    };
    let smallest = factored(
        brdf,
        FactoredSettings {
            factors: Some(least),
            ..settings
        },
        least,
    )?;
    let nodes = Nodes::tabulate(brdf, settings.importance);
    if nodes.is_empty() {
        return Ok(smallest);
    }
    let trial = Trial {
        settings,
        symmetry: brdf.symmetry(),
        nodes: &nodes,
    };
    // Step 1: every grid and rank with its best inner rank, in parallel; then the best of these.
    let grids = grids(brdf, &settings, least)?;
    let jobs: Vec<_> = grids
        .iter()
        .flat_map(|grid| TRIED.0.map(|outer| (grid, outer)))
        .collect();
    let each: Vec<Result<Option<(f64, Factored)>>> = jobs
        .par_iter()
        .map(|((base, grid), outer)| trial.find_inner(base, grid, *outer))
        .collect();
    let chosen = first_least(each.into_iter().filter_map(Result::transpose))?;
    let Factored { factors, terms, .. } = chosen.map_or(smallest, |best| best.1);
    // Step 2: the best floor for them.
    let floors = FLOORS.map(|floor| trial.rate(Factors { floor, ..factors }, terms.clone()));
    match first_least(floors.into_iter())? {
        Some((_, sampler)) => Ok(sampler),
        None => trial.rate(factors, terms).map(|rated| rated.1),
    }
}

/// What samplers of other factors are tried with.
struct Trial<'a> {
    settings: FactoredSettings,
    symmetry: Symmetry,
    nodes: &'a Nodes,
}

impl Trial<'_> {
    /// How uneven the weights of a sampler are, and the sampler.
    fn rate(&self, factors: Factors, terms: Terms) -> Result<(f64, Factored)> {
        let settings = FactoredSettings {
            factors: Some(factors),
            ..self.settings
        };
        let sampler = Factored::from_parts(settings, self.symmetry, terms)?;
        let unevenness = self.nodes.unevenness(|wo, wi| sampler.density(wo, wi));
        Ok((unevenness, sampler))
    }

    /// The best inner rank for a grid that is factored with rank `outer`.
    fn find_inner(
        &self,
        base: &Factors,
        grid: &Array2<f64>,
        outer: usize,
    ) -> Result<Option<(f64, Factored)>> {
        let found = Factorisation::factorise(grid, outer);
        let each = TRIED.1.map(|inner| Factors {
            outer,
            inner,
            ..*base
        });
        first_least(each.into_iter().map(|f| self.rate(f, terms(&found, &f))))
    }
}

/// The grids that are factored, by cells over φw and by what w is.
fn grids(
    brdf: &dyn Brdf,
    settings: &FactoredSettings,
    least: Factors,
) -> Result<Vec<(Factors, Array2<f64>)>> {
    let each = TRIED
        .2
        .into_iter()
        .flat_map(|phi| [true, false].map(|half| Factors { phi, half, ..least }));
    each.map(|factors| Ok((factors, grid(brdf, settings, &factors)?)))
        .collect()
}

/// The first of the least of what is rated.
fn first_least<T>(mut rated: impl Iterator<Item = Result<(f64, T)>>) -> Result<Option<(f64, T)>> {
    rated.try_fold(None, |best: Option<(f64, T)>, next| {
        let next = next?;
        Ok(match best {
            Some(best) if best.0 <= next.0 => Some(best),
            _ => Some(next),
        })
    })
}

/// Fractions of ∫ f·cosθ over the cells of w, `[table][theta · phi]`; a row adds up to 1, or to 0 where the material is black.
fn grid(brdf: &dyn Brdf, settings: &FactoredSettings, factors: &Factors) -> Result<Array2<f64>> {
    let (tables, azimuths) = (settings.tables, settings.azimuths);
    let knots = DirectionKnots::new(tables, TableChoice::Mixture, brdf.symmetry(), azimuths)?;
    let axis = ThetaAxis::new(ThetaSpacing::Merl, factors.theta);
    let importance = settings.importance;
    let rows: Vec<Array2<f64>> = (0..knots.count())
        .into_par_iter()
        .map(|k| {
            let [theta, azimuth] = knots.angles(k);
            let wo = spherical(theta, azimuth).as_vec3();
            masses([factors.theta, factors.phi], axis, |w| match factors.half {
                true => contribution(brdf, importance, wo, w),
                false => of_direction(brdf, importance, wo.as_dvec3(), w),
            })
        })
        .collect();
    let mut grid = Array2::zeros((knots.count(), factors.theta * factors.phi));
    for (mut row, cells) in grid.outer_iter_mut().zip(&rows) {
        let sum = cells.sum();
        if sum > 0.0 {
            row.assign(&(cells.flatten() / sum));
        }
    }
    Ok(grid)
}

/// f·cosθi of a direction.
fn of_direction(brdf: &dyn Brdf, importance: Importance, wo: DVec3, wi: DVec3) -> f64 {
    f64::from(importance.reduce(brdf.eval(wo.as_vec3(), wi.as_vec3()))) * wi.z
}

/// A matrix as a product of two without negative numbers, `left · right`; rows of `right` add up to 1, or to 0.
struct Factorisation {
    left: Array2<f64>,
    right: Array2<f64>,
}

impl Factorisation {
    /// The product of rank `rank` nearest to `matrix` in Kullback–Leibler's divergence, by multiplicative updates (Lee and
    /// Seung 2001). The divergence, unlike squares, keeps the sums of rows and leaves no cell with mass at 0.
    fn factorise(matrix: &Array2<f64>, rank: usize) -> Self {
        let (rows, columns) = matrix.dim();
        let block = |i: usize| i * rank / rows;
        // Each term begins as the mean of a block of rows, with some of all rows so that nothing is 0 for good.
        let mut left =
            Array2::from_shape_fn((rows, rank), |(i, j)| if block(i) == j { 1.0 } else { 0.1 });
        let mean = matrix.sum_axis(Axis(0)) / rows as f64;
        let mut right = Array2::zeros((rank, columns));
        for (i, row) in matrix.outer_iter().enumerate() {
            right.row_mut(block(i)).scaled_add(1.0, &row);
        }
        for mut row in right.outer_iter_mut() {
            row.scaled_add(0.1, &mean);
        }
        for _ in 0..ROUNDS {
            // Each round, with R = M/(L·Q), entry by entry, L ← L·(R Qᵀ)/Σ Q over columns, then Q ← Q·(Lᵀ R)/Σ L over rows.
            let ratio = ratio(matrix, &left.dot(&right));
            left = left * ratio.dot(&right.t()) / &positive(right.sum_axis(Axis(1)));
            let ratio = self::ratio(matrix, &left.dot(&right));
            let sums = positive(left.sum_axis(Axis(0))).insert_axis(Axis(1));
            right = right * left.t().dot(&ratio) / &sums;
        }
        // In the end rows of the right factor become densities, and the left factor takes their sums.
        let sums = right.sum_axis(Axis(1));
        left *= &sums;
        right /= &positive(sums).insert_axis(Axis(1));
        Self { left, right }
    }
}

/// `matrix`/`product`, 0 where there is nothing to be matched.
fn ratio(matrix: &Array2<f64>, product: &Array2<f64>) -> Array2<f64> {
    ndarray::Zip::from(matrix)
        .and(product)
        .map_collect(|&m, &p| if m > 0.0 && p > 0.0 { m / p } else { 0.0 })
}

/// Divisors: 1 in place of 0, which divides nothing but 0.
fn positive(sums: Array1<f64>) -> Array1<f64> {
    sums.mapv(|s| if s > 0.0 { s } else { 1.0 })
}

/// Factors each function of w again, and gathers all terms.
fn terms(outer: &Factorisation, factors: &Factors) -> Terms {
    let tables = outer.left.nrows();
    let mut weights: Array2<f64> = Array2::zeros((tables, factors.terms()));
    let mut theta = Curves::new();
    let mut phi = Curves::new();
    for (j, function) in outer.right.outer_iter().enumerate() {
        let cells = Array2::from_shape_fn((factors.theta, factors.phi), |(a, b)| {
            function[a * factors.phi + b]
        });
        let inner = Factorisation::factorise(&cells, factors.inner);
        // With rows of `inner.right` that sum to 1, a term has the mass of its column of `inner.left`.
        let masses = inner.left.sum_axis(Axis(0));
        let whole = masses.sum();
        for k in 0..factors.inner {
            theta.push(&cumulated(inner.left.column(k).iter().copied()), None);
            phi.push(&cumulated(inner.right.row(k).iter().copied()), None);
            let l = j * factors.inner + k;
            // A factor without mass has no curve to draw from, and its term is never chosen.
            let drawn = whole > 0.0 && !theta.is_void(l) && !phi.is_void(l);
            let share = if drawn { masses[k] / whole } else { 0.0 };
            weights
                .column_mut(l)
                .assign(&(&outer.left.column(j) * share));
        }
    }
    let sums = positive(weights.sum_axis(Axis(1))).insert_axis(Axis(1));
    let weights = (weights / &sums).iter().map(|&w| w as f32).collect();
    Terms {
        weights,
        theta,
        phi,
    }
}
