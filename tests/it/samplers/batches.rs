//! Stratified batches.

use super::*;

const BATCH: usize = 256;

const SEEDS: u64 = 600;

/// Over seeds.
struct Batches {
    /// Mean weight of all draws.
    mean: f64,
    /// Variance of the mean weight of a batch.
    variance: f64,
    /// Variance of how many draws of a batch have wi.y > 0.
    count_variance: f64,
}

impl Batches {
    fn of(brdf: &MerlBrdf, wo: Vec3, draw: impl Fn(u64) -> Vec<Option<DirectionSample>>) -> Self {
        let weight = |d: &DirectionSample| {
            f64::from(Importance::Mean.reduce(brdf.eval_cos(wo, d.wi))) / f64::from(d.pdf)
        };
        let (mut means, mut counts) = (Vec::new(), Vec::new());
        for seed in 0..SEEDS {
            let draws = draw(seed);
            assert_eq!(draws.len(), BATCH);
            means.push(draws.iter().flatten().map(weight).sum::<f64>() / BATCH as f64);
            counts.push(draws.iter().flatten().filter(|d| d.wi.y > 0.0).count() as f64);
        }
        let (mean, variance) = mean_and_variance(&means);
        Self {
            mean,
            variance,
            count_variance: mean_and_variance(&counts).1,
        }
    }
}

#[test]
fn batches_are_stratified_and_unbiased() {
    let brdf = measured("nickel");
    // Between trees and between tables of each, where weights spread by more than the quadrature's 2·10⁻³; azimuth 0, so that
    // y = 0 parts the trees' first children.
    let wo = spherical(81.6_f64.to_radians(), 0.0).as_vec3();
    let quadrature = Quadrature::new(wo, POINTS_PER_BIN);
    for (spec, share) in [
        // The largest variance, as a share of that of independent draws.
        (disc(TableChoice::Mixture), 1.15),
        (disc(TableChoice::Nearest), 0.85),
        (kept(TableChoice::Nearest), 0.85),
        (rejection_free(TableChoice::Mixture), 1.15),
        (cascade(TableChoice::Mixture), 1.15),
    ] {
        let sampler = spec.build(&loaded(&brdf)).unwrap();
        let exact = weight_spread(&*sampler, &*brdf, &quadrature, Importance::Mean);
        let independent = (exact.relstd * exact.mean).powi(2) / BATCH as f64;
        let many = Batches::of(&brdf, wo, |seed| sampler.draw_stratified(wo, BATCH, seed));
        let single = Batches::of(&brdf, wo, |seed| {
            (0..BATCH as u64)
                .map(|i| sampler.sample(wo, PointSet::Random.point(seed, i, 0)))
                .collect()
        });
        // A variance over 600 seeds has a standard error of 6 %.
        assert!(
            (single.variance / independent - 1.0).abs() < 0.3,
            "{spec:?}: {} {independent}",
            single.variance
        );
        assert!(
            many.variance < share * independent,
            "{spec:?}: {} {independent}",
            many.variance
        );
        assert!(
            many.count_variance < 0.6 * single.count_variance,
            "{spec:?}: {} {}",
            many.count_variance,
            single.count_variance
        );
        let error = (independent / SEEDS as f64).sqrt();
        for mean in [many.mean, single.mean] {
            assert!(
                (mean - exact.mean).abs() < 4.5 * error,
                "{spec:?}: {mean} {error} {exact:?}"
            );
        }
    }
}

/// Hands out draws made in batches, whatever point it is asked for.
struct Batched<'a> {
    sampler: &'a Sampler,
    draws: Vec<Option<DirectionSample>>,
    next: AtomicUsize,
}

impl DirectionSampler for Batched<'_> {
    fn sample(&self, _: Vec3, _: Vec2) -> Option<DirectionSample> {
        self.draws[self.next.fetch_add(1, Ordering::Relaxed) % self.draws.len()]
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.sampler.pdf(wo, wi)
    }

    fn bytes(&self) -> usize {
        0
    }
}

/// Batches are spread more evenly than independent draws, so the test is stricter on what it is for than on chance.
#[test]
fn batches_fall_where_the_density_says() {
    let brdf = measured("chrome");
    for spec in [disc(TableChoice::Mixture), cascade(TableChoice::Mixture)] {
        let sampler = spec.build(&loaded(&brdf)).unwrap();
        for wo in [29.0, 84.7].map(direction) {
            let draws = (0..200)
                .flat_map(|seed| sampler.draw_stratified(wo, 500, seed))
                .collect();
            let batched = Batched {
                sampler: &sampler,
                draws,
                next: AtomicUsize::new(0),
            };
            let result = ChiSquareTest {
                tests: 4,
                ..Default::default()
            }
            .run(&batched, wo);
            assert_eq!(
                result.verdict,
                ChiSquareVerdict::Pass,
                "{spec:?}: {result:?}"
            );
        }
    }
}
