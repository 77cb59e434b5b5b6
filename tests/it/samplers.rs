//! The samplers themselves: each passes every check of `merlkit check` on a dozen materials, and each check that matters for
//! them fails when a real sampler's density is tampered with.
//!
//! Left out: the adaptive disc with leaves by integral. Its densities are as good as the integrals of its leaves, which are
//! estimates from points, so it is approximate and is not held to these checks; the published settings below show it.

use crate::support::loaded;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{Vec2, Vec3};
use merlkit::brdf::{Brdf, Importance};
use merlkit::direction_sampler::{DirectionSample, DirectionSampler};
use merlkit::geometry::{POINTS_PER_BIN, Quadrature, spherical};
use merlkit::material::Material;
use merlkit::material::merl::decode_embedded;
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::points::PointSet;
use merlkit::sampler::store::encode;
use merlkit::sampler::{
    AdaptiveDiscSettings, Carry, CascadeCdfSettings, CosineSettings, LeafChoice, Sampler,
    SamplerSpec, TableChoice,
};
use merlkit_evaluate::measure::accuracy::{LIMIT_ANGLES_DEG, WeightSpread, weight_spread};
use merlkit_evaluate::measure::check::{
    Check, CheckReport, CheckSettings, check_directions, check_sampler,
};
use merlkit_evaluate::measure::chi_square::{ChiSquareTest, ChiSquareVerdict};

use crate::support::tampered::Tampered;

/// Upper bound of how often [`assert_passes`] is called in this file: together they err once in a hundred seeds.
const CALLS: usize = 100;

fn measured(name: &str, rule: LookupRule) -> Arc<MerlBrdf> {
    Arc::new(MerlBrdf::new(
        Arc::new(decode_embedded(name).unwrap()),
        rule,
    ))
}

fn direction(degrees: f64) -> Vec3 {
    spherical(degrees.to_radians(), 0.8).as_vec3()
}

fn disc(choice: TableChoice) -> SamplerSpec {
    SamplerSpec::new(AdaptiveDiscSettings {
        choice,
        ..Default::default()
    })
}

fn rejection_free(choice: TableChoice) -> SamplerSpec {
    let leaves = LeafChoice::Warp;
    SamplerSpec::new(AdaptiveDiscSettings {
        choice,
        leaves,
        ..Default::default()
    })
}

/// Directions stay where a tree has them, as in the thesis.
fn kept(choice: TableChoice) -> SamplerSpec {
    let settings = AdaptiveDiscSettings {
        choice,
        carry: Carry::Direction,
        tables: 60,
        ..Default::default()
    };
    SamplerSpec::new(settings)
}

fn cascade(choice: TableChoice) -> SamplerSpec {
    SamplerSpec::new(CascadeCdfSettings {
        choice,
        ..Default::default()
    })
}

fn whole(choice: TableChoice) -> SamplerSpec {
    SamplerSpec::new(CascadeCdfSettings {
        choice,
        ..CascadeCdfSettings::uniform()
    })
}

fn coarse(choice: TableChoice) -> SamplerSpec {
    SamplerSpec::new(CascadeCdfSettings {
        choice,
        tolerance: Some(1e-2),
        ..Default::default()
    })
}

/// A sampler with its default settings but for what serves a `wo` between two tables.
type Spec = fn(TableChoice) -> SamplerSpec;

fn settings(seed: u64) -> CheckSettings {
    CheckSettings {
        draws: 30_000,
        calls: CALLS,
        seed,
        ..CheckSettings::default()
    }
}

fn assert_passes(spec: SamplerSpec, brdf: &Arc<MerlBrdf>, settings: &CheckSettings) {
    let sampler = spec.build(&loaded(brdf)).unwrap();
    let report = check_sampler(&*sampler, &**brdf, &check_directions(), settings);
    assert_eq!(report.outcomes.len(), 13 * 7);
    assert!(
        report.pass(),
        "{spec:?}: {:#?}",
        report.failures().collect::<Vec<_>>()
    );
}

/// Every sampler with the mixture; with the nearest table the default ones for every second material, the others for the rest.
fn assert_all_pass(name: &str, seed: u64) {
    use TableChoice::{Mixture, Nearest};
    let brdf = measured(name, LookupRule::Floor);
    let nearest = match seed.is_multiple_of(2) {
        true => [disc(Nearest), cascade(Nearest)],
        false => [whole(Nearest), coarse(Nearest)],
    };
    let mixtures = [
        disc(Mixture),
        rejection_free(Mixture),
        cascade(Mixture),
        whole(Mixture),
        coarse(Mixture),
    ];
    for (i, spec) in mixtures.into_iter().chain(nearest).enumerate() {
        assert_passes(spec, &brdf, &settings(100 * seed + i as u64));
    }
}

macro_rules! all_pass_on {
    ($($test:ident: $name:literal, $seed:literal;)*) => {
        $(#[test]
        fn $test() {
            assert_all_pass($name, $seed);
        })*
    };
}

mod every_sampler_passes_on {
    use super::assert_all_pass;
    all_pass_on! {
        nickel: "nickel", 1;
        chrome: "chrome", 2;
        teflon: "teflon", 3;
        red_plastic: "red-plastic", 4;
        blue_metallic_paint: "blue-metallic-paint", 5;
        black_obsidian: "black-obsidian", 6;
        violet_acrylic: "violet-acrylic", 7;
        alum_bronze: "alum-bronze", 8;
        white_marble: "white-marble", 9;
        beige_fabric: "beige-fabric", 10;
        alumina_oxide: "alumina-oxide", 11;
        yellow_paint: "yellow-paint", 12;
    }
}

#[test]
fn cosine_passes_on_dull_materials() {
    for (seed, name) in ["white-marble", "beige-fabric", "yellow-paint"]
        .into_iter()
        .enumerate()
    {
        assert_passes(
            SamplerSpec::new(CosineSettings {}),
            &measured(name, LookupRule::Floor),
            &settings(2000 + seed as u64),
        );
    }
}

#[test]
fn luminance_passes() {
    let brdf = measured("blue-metallic-paint", LookupRule::Floor);
    let importance = Importance::Luminance;
    let specs = [
        SamplerSpec::new(AdaptiveDiscSettings {
            importance,
            ..Default::default()
        }),
        SamplerSpec::new(CascadeCdfSettings {
            importance,
            ..Default::default()
        }),
    ];
    for (seed, spec) in specs.into_iter().enumerate() {
        assert_passes(
            spec,
            &brdf,
            &CheckSettings {
                importance,
                ..settings(2100 + seed as u64)
            },
        );
    }
}

#[test]
fn other_lookup_rules_pass() {
    let cases = [
        ("chrome", LookupRule::Linear),
        ("violet-acrylic", LookupRule::Centred),
    ];
    for (seed, (name, rule)) in cases.into_iter().enumerate() {
        let brdf = measured(name, rule);
        for spec in [
            disc(TableChoice::Mixture),
            rejection_free(TableChoice::Mixture),
            cascade(TableChoice::Nearest),
        ] {
            assert_passes(spec, &brdf, &settings(2200 + seed as u64));
        }
    }
}

/// Checks with the usual number of draws.
fn check_tampered(
    draws: &dyn DirectionSampler,
    claims: &dyn DirectionSampler,
    shift: f64,
    wos: &[Vec3],
    brdf: &MerlBrdf,
) -> CheckReport {
    check_sampler(
        &Tampered {
            draws,
            claims,
            shift,
        },
        brdf,
        wos,
        &CheckSettings::default(),
    )
}

fn failed(report: &CheckReport, check: Check) -> usize {
    report.failures().filter(|o| o.check == check).count()
}

#[test]
fn the_density_of_the_neighbouring_tree_is_rejected() {
    let brdf = measured("nickel", LookupRule::Floor);
    let sampler = kept(TableChoice::Nearest).build(&loaded(&brdf)).unwrap();
    let wos = [14.5, 45.0, 75.5].map(direction);
    // Its density knows of `wo` only the azimuth and the trees, which stand 90°/59 apart.
    let right = check_tampered(&*sampler, &*sampler, 0.0, &wos, &brdf);
    let wrong = check_tampered(
        &*sampler,
        &*sampler,
        (90.0_f64 / 59.0).to_radians(),
        &wos,
        &brdf,
    );
    assert!(right.pass(), "{:#?}", right.failures().collect::<Vec<_>>());
    assert_eq!(failed(&wrong, Check::ChiSquare), 3, "{wrong:#?}");
}

/// The floor is a thousandth of the draws, which takes a few million of them to see.
#[test]
fn a_density_without_the_floor_is_rejected() {
    let brdf = measured("chrome", LookupRule::Floor);
    let without = [
        SamplerSpec::new(AdaptiveDiscSettings {
            floor: 0.0,
            ..Default::default()
        }),
        SamplerSpec::new(CascadeCdfSettings {
            floor: 0.0,
            ..Default::default()
        }),
    ];
    let test = ChiSquareTest {
        draws: 2_000_000,
        tests: 4,
        ..Default::default()
    };
    for (ours, without) in [disc, cascade]
        .map(|s| s(TableChoice::Mixture))
        .into_iter()
        .zip(without)
    {
        let (draws, claims) = (
            ours.build(&loaded(&brdf)).unwrap(),
            without.build(&loaded(&brdf)).unwrap(),
        );
        let wrong = Tampered {
            draws: &*draws,
            claims: &*claims,
            shift: 0.0,
        };
        let (right, wrong) = (
            test.run(&*draws, direction(45.0)),
            test.run(&wrong, direction(45.0)),
        );
        assert_eq!(right.verdict, ChiSquareVerdict::Pass, "{ours:?}: {right:?}");
        assert_ne!(wrong.verdict, ChiSquareVerdict::Pass, "{ours:?}: {wrong:?}");
    }
}

/// Half vectors follow `wo`: their density at an angle of `wo` half a degree away is another.
#[test]
fn a_density_for_another_angle_is_rejected() {
    let brdf = measured("nickel", LookupRule::Floor);
    let wos = [14.5, 45.0, 75.5].map(direction);
    for spec in [
        disc(TableChoice::Mixture),
        rejection_free(TableChoice::Mixture),
    ] {
        let sampler = spec.build(&loaded(&brdf)).unwrap();
        let right = check_tampered(&*sampler, &*sampler, 0.0, &wos, &brdf);
        let wrong = check_tampered(&*sampler, &*sampler, 0.5_f64.to_radians(), &wos, &brdf);
        assert!(
            right.pass(),
            "{spec:?}: {:#?}",
            right.failures().collect::<Vec<_>>()
        );
        assert_eq!(failed(&wrong, Check::ChiSquare), 3, "{spec:?}: {wrong:#?}");
    }
}

/// Next to the horizon what is carried past it is turned up; nothing is lost there, and the density knows.
#[test]
fn half_vectors_carried_past_the_horizon_are_accounted_for() {
    let test = ChiSquareTest {
        draws: 400_000,
        tests: 12,
        ..Default::default()
    };
    for name in ["chrome", "white-marble"] {
        let brdf = measured(name, LookupRule::Floor);
        for spec in [
            disc(TableChoice::Nearest),
            rejection_free(TableChoice::Mixture),
        ] {
            let sampler = spec.build(&loaded(&brdf)).unwrap();
            for degrees in [83.0, 88.0, 89.8] {
                let result = test.run(&*sampler, direction(degrees));
                assert_eq!(
                    (result.verdict, result.failed),
                    (ChiSquareVerdict::Pass, 0),
                    "{spec:?} {degrees}: {result:?}"
                );
            }
        }
    }
}

/// Two numbers make a draw without rejection, so well-spread points give a better estimate than random ones.
#[test]
fn well_spread_points_serve_the_rejection_free_disc() {
    let brdf = measured("nickel", LookupRule::Floor);
    let sampler = rejection_free(TableChoice::Mixture)
        .build(&loaded(&brdf))
        .unwrap();
    for wo in [29.75, 60.25].map(direction) {
        let [random, sobol] = [PointSet::Random, PointSet::Sobol].map(|points| {
            // A smooth light that tells directions apart, so that the spread of places counts, not only that of weights.
            let light = |wi: Vec3| f64::from(1.0 + wi.x).powi(2) + f64::from(wi.y);
            let estimates: Vec<f64> = (0..200)
                .map(|seed| {
                    let weight = |s: DirectionSample| {
                        f64::from(Importance::Mean.reduce(brdf.eval_cos(wo, s.wi)))
                            / f64::from(s.pdf)
                            * light(s.wi)
                    };
                    let draws =
                        (0..256).filter_map(|i| sampler.sample(wo, points.point(seed, i, 0)));
                    draws.map(weight).sum::<f64>() / 256.0
                })
                .collect();
            mean_and_variance(&estimates)
        });
        assert!(
            (random.0 / sobol.0 - 1.0).abs() < 0.01,
            "{wo}: {random:?} {sobol:?}"
        );
        assert!(sobol.1 < 0.25 * random.1, "{wo}: {random:?} {sobol:?}");
    }
}

#[test]
fn draws_of_the_nearest_table_with_the_density_of_the_mixture_are_rejected() {
    let brdf = measured("nickel", LookupRule::Floor);
    // Midway between trees 1.5° apart, and between tables 6° apart where half vectors change fast.
    let cases: [(Spec, _); 2] = [(kept, [14.5, 45.0, 75.5]), (cascade, [75.0, 81.0, 87.0])];
    for (spec, angles) in cases {
        let wos = angles.map(direction);
        let (draws, claims) = (
            spec(TableChoice::Nearest).build(&loaded(&brdf)).unwrap(),
            spec(TableChoice::Mixture).build(&loaded(&brdf)).unwrap(),
        );
        let report = check_tampered(&*draws, &*claims, 0.0, &wos, &brdf);
        assert_eq!(
            failed(&report, Check::ChiSquare),
            3,
            "{:?}: {report:#?}",
            draws.spec()
        );
    }
}

fn spreads(spec: SamplerSpec, brdf: &Arc<MerlBrdf>) -> Vec<WeightSpread> {
    let sampler = spec.build(&loaded(brdf)).unwrap();
    let at = |&degrees: &f64| {
        let quadrature = Quadrature::new(direction(degrees), POINTS_PER_BIN);
        weight_spread(&*sampler, &**brdf, &quadrature, Importance::Mean)
    };
    LIMIT_ANGLES_DEG.iter().map(at).collect()
}

#[test]
fn the_published_cascade_has_holes() {
    let brdf = measured("teflon", LookupRule::Floor);
    let sampler = SamplerSpec::new(CascadeCdfSettings::as_published(true))
        .build(&loaded(&brdf))
        .unwrap();
    let report = check_sampler(
        &*sampler,
        &*brdf,
        &[direction(29.75), direction(30.0)],
        &settings(1),
    );
    assert_eq!(failed(&report, Check::Positivity), 2, "{report:#?}");
    // It is honest about them: its density is what it draws from.
    assert_eq!(failed(&report, Check::ChiSquare), 0, "{report:#?}");
}

#[test]
fn the_published_cascade_is_heavy_tailed_and_ours_is_not() {
    let brdf = measured("red-plastic", LookupRule::Floor);
    let published = spreads(
        SamplerSpec::new(CascadeCdfSettings::as_published(true)),
        &brdf,
    );
    let ours = spreads(SamplerSpec::new(CascadeCdfSettings::default()), &brdf);
    assert!(published.iter().any(|s| s.relstd > 1.0), "{published:#?}");
    assert!(
        ours.iter().all(|s| s.relstd < 0.3 && s.holes == 0.0),
        "{ours:#?}"
    );
}

#[test]
fn the_published_disc_has_a_density_that_is_off() {
    let brdf = measured("chrome", LookupRule::Floor);
    let sampler = SamplerSpec::new(AdaptiveDiscSettings::as_published())
        .build(&loaded(&brdf))
        .unwrap();
    let report = check_sampler(
        &*sampler,
        &*brdf,
        &[0.0, 45.0, 75.5].map(direction),
        &settings(1),
    );
    assert_eq!(failed(&report, Check::ChiSquare), 3, "{report:#?}");
    assert_eq!(failed(&report, Check::PdfIntegral), 3, "{report:#?}");
    let bias = report
        .failures()
        .filter(|o| o.check == Check::Bias)
        .map(|o| o.value)
        .fold(0.0, f64::max);
    assert!(bias > 0.02, "{report:#?}");
}

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

fn mean_and_variance(values: &[f64]) -> (f64, f64) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (
        mean,
        values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64,
    )
}

#[test]
fn batches_are_stratified_and_unbiased() {
    let brdf = measured("nickel", LookupRule::Floor);
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
    let brdf = measured("chrome", LookupRule::Floor);
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

#[test]
fn builds_do_not_depend_on_threads() {
    let material = Material::resolve("alum-bronze").unwrap();
    let brdf = measured("alum-bronze", LookupRule::Floor);
    let specs = [
        SamplerSpec::new(AdaptiveDiscSettings {
            tables: 20,
            ..Default::default()
        }),
        rejection_free(TableChoice::Mixture),
        SamplerSpec::new(CascadeCdfSettings {
            tables: 7,
            ..Default::default()
        }),
        SamplerSpec::new(CascadeCdfSettings {
            tables: 7,
            ..CascadeCdfSettings::uniform()
        }),
    ];
    for spec in specs {
        let bytes = [1, 2, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            let sampler = pool.install(|| spec.build(&loaded(&brdf))).unwrap();
            encode(&sampler, &material).unwrap()
        });
        assert!(bytes[0] == bytes[1] && bytes[0] == bytes[2], "{spec:?}");
    }
}

/// A tree of four leaves would need thousands of trials a draw, and giving up would contradict the pdf: it stands for the
/// uniform disc.
#[test]
fn shallow_trees_lose_no_draws() {
    let settings = AdaptiveDiscSettings {
        tables: 1,
        depth: 1,
        ..Default::default()
    };
    let disc = SamplerSpec::new(settings)
        .build(&loaded(&measured("nickel", LookupRule::Floor)))
        .unwrap();
    for i in 0..200 {
        assert!(
            disc.sample(Vec3::Z, PointSet::Random.point(1, i, 0))
                .is_some(),
            "draw {i}"
        );
    }
    assert!(
        disc.draw_stratified(Vec3::Z, 200, 1)
            .iter()
            .all(Option::is_some)
    );
}
