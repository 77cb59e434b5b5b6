//! How fast an estimate of reflected radiance converges: one point under an environment.

mod techniques;

pub use techniques::Technique;

use glam::Vec3;
use rayon::prelude::*;

use merlkit::Result;
use merlkit::brdf::{Brdf, Importance};
use merlkit::color::Rgb;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::geometry::Quadrature;
use merlkit::light::Environment;
use merlkit::points::PointSet;
use techniques::{TechniqueDraws, to_world};

/// What is estimated: ∫ f cosθ L dσ for one `wo`, as a scalar.
pub struct LitPoint<'a> {
    /// The surface.
    pub brdf: &'a dyn Brdf,
    /// Reduction of RGB to the scalar.
    pub importance: Importance,
    /// The light that arrives.
    pub light: Incident<'a>,
    /// Towards the viewer.
    pub wo: Vec3,
}

/// The light that arrives at a point.
#[derive(Clone, Copy)]
pub enum Incident<'a> {
    /// Radiance from a direction of the local frame, equal in all channels. It can't be sampled.
    Function(&'a (dyn Fn(Vec3) -> f64 + Sync)),
    /// An environment over a surface that faces up: local (x, y, z) is (x, z, −y) of the environment, so that the normal is
    /// its zenith, `x` its `x`, and `y` points at the middle of its map.
    Environment(&'a Environment),
}

/// Which estimates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Runs {
    /// How points follow each other.
    pub points: PointSet,
    /// Independent estimates at each number of samples.
    pub seeds: u64,
    /// The first of their seeds.
    pub first_seed: u64,
}

/// Error of estimates from `samples` draws each.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct ErrorAt {
    /// Samples of one estimate, as the technique counts them.
    pub samples: usize,
    /// How often the BRDF and the light were evaluated for it.
    pub evaluations: usize,
    /// Root of the mean squared error over the reference.
    pub rmse: f64,
}

impl LitPoint<'_> {
    fn integrand(&self, wi: Vec3) -> f64 {
        match self.light {
            Incident::Function(radiance) => {
                f64::from(self.importance.reduce(self.brdf.eval_cos(self.wo, wi))) * radiance(wi)
            }
            Incident::Environment(sky) => self.reflected(wi, sky.radiance(to_world(wi))),
        }
    }

    /// f·cos·L as a scalar, for light of any colour; what exceeds f32 counts as its largest value.
    fn reflected(&self, wi: Vec3, radiance: Rgb) -> f64 {
        let reflected = self.brdf.eval_cos(self.wo, wi) * radiance;
        f64::from(self.importance.reduce(reflected.min(Rgb::splat(f32::MAX))))
    }

    /// The integral by quadrature, independent of every sampler.
    pub fn reference(&self, points_per_bin: usize) -> f64 {
        Quadrature::new(self.wo, points_per_bin).integrate(|wi| self.integrand(wi))
    }

    /// Relative errors of `sampler` at each number of samples: [`Self::errors_by`] with [`Technique::Brdf`].
    pub fn errors(
        &self,
        sampler: &dyn DirectionSampler,
        reference: f64,
        samples: &[usize],
        runs: Runs,
    ) -> Vec<ErrorAt> {
        self.measured(Technique::Brdf, sampler, reference, samples, runs)
    }

    /// Relative errors of `technique`, with `sampler` to draw from the BRDF, at each number of samples, in parallel over
    /// seeds; the same for any number of threads.
    ///
    /// 0 where `reference` is 0. A failed draw is a sample of weight 0. All techniques of a seed use the same points, one
    /// pair of dimensions for the BRDF and one for the light.
    ///
    /// # Errors
    /// [`merlkit::Error::Argument`] for a technique that samples light which is a function, or for no candidates.
    pub fn errors_by(
        &self,
        technique: Technique,
        sampler: &dyn DirectionSampler,
        reference: f64,
        samples: &[usize],
        runs: Runs,
    ) -> Result<Vec<ErrorAt>> {
        technique.check(self.light)?;
        Ok(self.measured(technique, sampler, reference, samples, runs))
    }

    /// For each seed, the squared relative error at each number of samples, of a technique that suits the light; 0 where
    /// `reference` is 0.
    pub(super) fn squared_errors(
        &self,
        technique: Technique,
        sampler: &dyn DirectionSampler,
        reference: f64,
        samples: &[usize],
        runs: Runs,
    ) -> Vec<Vec<f64>> {
        let most = samples.iter().copied().max().unwrap_or(0);
        let relative = |estimate: f64| {
            if reference > 0.0 {
                estimate / reference - 1.0
            } else {
                0.0
            }
        };
        let of_seed = |seed: u64| -> Vec<f64> {
            let draws =
                TechniqueDraws::new(self, sampler, technique, most, runs, runs.first_seed + seed);
            samples
                .iter()
                .map(|&n| relative(draws.estimate(n)).powi(2))
                .collect()
        };
        (0..runs.seeds).into_par_iter().map(of_seed).collect()
    }

    /// One estimate from `samples` samples, of the first seed of `runs`.
    pub(super) fn estimate(
        &self,
        technique: Technique,
        sampler: &dyn DirectionSampler,
        samples: usize,
        runs: Runs,
    ) -> f64 {
        TechniqueDraws::new(self, sampler, technique, samples, runs, runs.first_seed)
            .estimate(samples)
    }

    fn measured(
        &self,
        technique: Technique,
        sampler: &dyn DirectionSampler,
        reference: f64,
        samples: &[usize],
        runs: Runs,
    ) -> Vec<ErrorAt> {
        let squares = self.squared_errors(technique, sampler, reference, samples, runs);
        let rmse = |i: usize| {
            (squares.iter().map(|s| s[i]).sum::<f64>() / runs.seeds.max(1) as f64).sqrt()
        };
        let at = |(i, &samples): (usize, &usize)| ErrorAt {
            samples,
            evaluations: technique.evaluations(samples),
            rmse: rmse(i),
        };
        samples.iter().enumerate().map(at).collect()
    }
}

/// Least-squares slope of log error over log samples.
pub fn slope(errors: &[ErrorAt]) -> f64 {
    slope_of(errors.iter().map(|e| (e.samples, e.rmse)))
}

/// The least-squares slope of log error against log samples: −½ for independent draws. 0 for fewer than two errors above 0.
pub(super) fn slope_of(errors: impl Iterator<Item = (usize, f64)>) -> f64 {
    let logs: Vec<(f64, f64)> = errors
        .filter(|&(samples, rmse)| samples > 0 && rmse > 0.0)
        .map(|(samples, rmse)| ((samples as f64).ln(), rmse.ln()))
        .collect();
    let n = logs.len() as f64;
    let (mx, my) = logs
        .iter()
        .fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let variance: f64 = logs.iter().map(|p| (p.0 - mx).powi(2)).sum();
    if variance > 0.0 {
        logs.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum::<f64>() / variance
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use merlkit::geometry::spherical;
    use merlkit::sampler::Cosine;

    struct Lambert;

    impl Brdf for Lambert {
        fn eval(&self, _: Vec3, wi: Vec3) -> Vec3 {
            if wi.z > 0.0 {
                Vec3::splat(std::f32::consts::FRAC_1_PI)
            } else {
                Vec3::ZERO
            }
        }

        fn is_isotropic(&self) -> bool {
            true
        }
    }

    fn point<'a>(radiance: &'a (dyn Fn(Vec3) -> f64 + Sync)) -> LitPoint<'a> {
        let wo = spherical(0.5, 0.0).as_vec3();
        LitPoint {
            brdf: &Lambert,
            importance: Importance::Mean,
            light: Incident::Function(radiance),
            wo,
        }
    }

    const SAMPLES: [usize; 4] = [16, 64, 256, 1024];

    /// With L = cosθ and cosine sampling the weight is z, whose mean is ⅔ and variance 1/18.
    #[test]
    fn random_points_converge_as_the_root() {
        let radiance = |wi: Vec3| f64::from(wi.z);
        let point = point(&radiance);
        let reference = point.reference(233);
        assert!((reference - 2.0 / 3.0).abs() < 1e-5, "{reference}");
        let runs = Runs {
            points: PointSet::Random,
            seeds: 400,
            first_seed: 1,
        };
        let errors = point.errors(&Cosine, reference, &SAMPLES, runs);
        for e in &errors {
            let expected = (1.0 / 18.0 / e.samples as f64).sqrt() / reference;
            assert!((e.rmse / expected - 1.0).abs() < 0.15, "{e:?} {expected}");
        }
        assert!((slope(&errors) + 0.5).abs() < 0.05, "{}", slope(&errors));
    }

    #[test]
    fn sobol_points_converge_faster() {
        let radiance = |wi: Vec3| f64::from(wi.z);
        let point = point(&radiance);
        let runs = Runs {
            points: PointSet::Sobol,
            seeds: 100,
            first_seed: 1,
        };
        let errors = point.errors(&Cosine, point.reference(233), &SAMPLES, runs);
        assert!(slope(&errors) < -1.1, "{errors:?}");
    }

    #[test]
    fn darkness_has_no_error() {
        let point = point(&|_| 0.0);
        let runs = Runs {
            points: PointSet::Random,
            seeds: 3,
            first_seed: 1,
        };
        let errors = point.errors(&Cosine, 0.0, &SAMPLES, runs);
        assert!(errors.iter().all(|e| e.rmse == 0.0) && slope(&errors) == 0.0);
    }
}
