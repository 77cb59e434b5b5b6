//! Errors against time: what is measured is what it says, and choices hold on fresh seeds.

use crate::support::loaded;
use std::sync::Arc;

use merlkit::distribution::Heuristic;
use merlkit::geometry::Symmetry;
use merlkit::light::{Environment, SkySampling, broad_lamps};
use merlkit::material::merl::{HardCase, decode_embedded};
use merlkit::material::{Loaded, LookupRule, MaterialFacts, MerlBrdf};
use merlkit::sampler::{CosineSettings, HalfVectorSettings, SamplerSpec};
use merlkit_evaluate::measure::compare::{
    Competitor, ErrorPoint, PicturePlan, PointPlan, SceneKind, Tuning, Wish, competitors, curve,
    knobs, picture_reference, pictures, reach, references, setting, tunable, tune, verdict,
};
use merlkit_evaluate::measure::convergence::Technique;

fn measured(name: &str) -> Arc<MerlBrdf> {
    Arc::new(MerlBrdf::new(
        Arc::new(decode_embedded(name).unwrap()),
        LookupRule::Floor,
    ))
}

const TABLE: MaterialFacts = MaterialFacts {
    symmetry: Symmetry::Isotropic,
    has_table: true,
    has_own_sampler: false,
};

fn sky() -> Environment {
    broad_lamps(SkySampling::Importance)
}

fn plan(samples: &[usize], seeds: u64) -> PointPlan {
    PointPlan {
        samples: samples.to_vec(),
        seeds,
        timed: 300,
        ..PointPlan::quick(1)
    }
}

const HALF_VECTOR: fn() -> SamplerSpec = || SamplerSpec::new(HalfVectorSettings::default());

/// A diffuse table under an even sky: cosine sampling has no error but the floor lookup's rounding, and its reference is π
/// times the albedo over π.
#[test]
fn a_weight_without_spread_has_no_error() {
    let brdf = Arc::new(MerlBrdf::new(
        Arc::new(HardCase::named("constant").unwrap().table()),
        LookupRule::Floor,
    ));
    let even = Environment::uniform(merlkit::color::Rgb::ONE).unwrap();
    let plan = plan(&[1, 16], 8);
    let references = references(&*brdf, &even, &plan);
    for r in &references {
        assert!(
            (r.radiance / (0.25 * std::f64::consts::PI) - 1.0).abs() < 1e-4 && r.error < 1e-4,
            "{r:?}"
        );
    }
    let competitor = Competitor::brdf(SamplerSpec::new(CosineSettings {}));
    let sampler = competitor.spec.build(&loaded(&brdf)).unwrap();
    let curve = curve(
        competitor,
        &*sampler,
        0.0,
        &*brdf,
        &even,
        (&plan, &references),
    );
    for e in curve.random.iter().chain(&curve.sobol) {
        assert!(e.rmse < 2e-4, "{e:?}");
    }
}

/// The interval is one: errors on other seeds are within it as often as it says, and errors fall as the root of samples.
#[test]
fn intervals_hold_and_random_errors_fall_as_the_root() {
    let (brdf, sky) = (measured("red-plastic"), sky());
    let competitor = Competitor::brdf(HALF_VECTOR());
    let sampler = competitor.spec.build(&loaded(&brdf)).unwrap();
    let plan = plan(&[16, 64, 256], 100);
    let references = references(&*brdf, &sky, &plan);
    let at = |first_seed: u64| {
        let plan = PointPlan {
            first_seed,
            ..plan.clone()
        };
        curve(
            competitor.clone(),
            &*sampler,
            0.0,
            &*brdf,
            &sky,
            (&plan, &references),
        )
        .random
    };
    let many: Vec<Vec<ErrorPoint>> = (0..12).map(|i| at(1000 * i + 1)).collect();
    let truth =
        |k: usize| (many.iter().map(|e| e[k].rmse.powi(2)).sum::<f64>() / many.len() as f64).sqrt();
    let inside: usize = (0..3)
        .map(|k| {
            many.iter()
                .filter(|e| e[k].low <= truth(k) && truth(k) <= e[k].high)
                .count()
        })
        .sum();
    assert!(inside >= 30, "{inside} of 36 intervals hold");
    assert!(
        (truth(0) / truth(2) - 4.0).abs() < 0.4,
        "{} {}",
        truth(0),
        truth(2)
    );
}

#[test]
fn the_table_beats_cosine_on_metal_and_the_verdict_says_so() {
    let (brdf, sky) = (measured("nickel"), sky());
    let plan = plan(&[4, 16, 64, 256, 1024], 24);
    let references = references(&*brdf, &sky, &plan);
    let curves: Vec<_> = [SamplerSpec::new(CosineSettings {}), HALF_VECTOR()]
        .map(|spec| {
            let sampler = spec.build(&loaded(&brdf)).unwrap();
            curve(
                Competitor::brdf(spec),
                &*sampler,
                0.03,
                &*brdf,
                &sky,
                (&plan, &references),
            )
        })
        .to_vec();
    let [cosine, table] = [0, 1].map(|i| reach(&curves[i], 0.01).unwrap());
    assert!(
        cosine.samples > 10.0 * table.samples,
        "{cosine:?} {table:?}"
    );
    // Shared by one estimate, the whole precomputation counts; by a thousand million samples, next to nothing.
    assert!(
        table.seconds[0] > 0.03 && table.seconds[2] < table.seconds[0] / 2.0,
        "{table:?}"
    );
    let verdict = verdict("nickel", &curves).unwrap();
    assert_eq!(verdict.sampler, "half-vector");
    assert!(
        verdict.sentence.contains("less time than cosine"),
        "{}",
        verdict.sentence
    );
    let reversed: Vec<_> = curves.iter().rev().cloned().collect();
    assert_eq!(
        merlkit_evaluate::measure::compare::verdict("nickel", &reversed)
            .unwrap()
            .best,
        verdict.best
    );
    assert!(merlkit_evaluate::measure::compare::verdict("nickel", &[]).is_none());
}

/// Every technique goes to the same reference.
#[test]
fn all_competitors_converge_to_the_reference() {
    let (brdf, sky) = (measured("red-plastic"), sky());
    let plan = plan(&[16, 1024], 16);
    let references = references(&*brdf, &sky, &plan);
    for competitor in competitors(true, &[TABLE])
        .unwrap()
        .into_iter()
        .filter(|c| c.spec.name() != "factored")
    {
        let sampler = competitor.spec.build(&loaded(&brdf)).unwrap();
        let errors = curve(
            competitor.clone(),
            &*sampler,
            0.0,
            &*brdf,
            &sky,
            (&plan, &references),
        )
        .sobol;
        assert!(
            errors[1].rmse < 0.05 && errors[1].rmse < 0.5 * errors[0].rmse,
            "{competitor:?} {errors:?}"
        );
    }
}

fn tuned(name: &str, wish: Wish) -> Tuning {
    let specs: Vec<SamplerSpec> = tunable(&TABLE, false)
        .unwrap()
        .into_iter()
        .filter(|s| matches!(s.name(), "half-vector" | "cosine"))
        .collect();
    tune(
        &Loaded::from_table(measured(name)),
        &sky(),
        wish,
        &specs,
        &plan(&[4, 16, 64, 256, 1024], 16),
        &|| {},
    )
    .unwrap()
}

const WISH: Wish = Wish {
    error: 0.02,
    max_bytes: None,
    max_build: None,
    shared_by: 1_000_000,
};

#[test]
fn a_choice_holds_on_fresh_seeds() {
    let tuning = tuned("nickel", WISH);
    let proof = tuning.proof.unwrap();
    assert!(
        proof.error.rmse <= 0.02 && proof.first_seed > 1 << 31,
        "{proof:?}"
    );
    let choice = &tuning.tried[tuning.chosen.unwrap()];
    assert_eq!(choice.curve.competitor.spec.name(), "half-vector");
    let quickest = tuning
        .tried
        .iter()
        .filter_map(|t| t.seconds)
        .fold(f64::INFINITY, f64::min);
    assert_eq!(choice.seconds, Some(quickest));
}

#[test]
fn limits_are_kept_and_what_cannot_be_had_is_not_chosen() {
    let small = tuned(
        "nickel",
        Wish {
            max_bytes: Some(3000),
            ..WISH
        },
    );
    let choice = &small.tried[small.chosen.unwrap()];
    assert!(choice.curve.table_bytes <= 3000);
    let no_tables = tuned(
        "nickel",
        Wish {
            max_bytes: Some(0),
            max_build: Some(1e-12),
            ..WISH
        },
    );
    assert!(no_tables.chosen.is_none() && no_tables.proof.is_none());
    let nothing = tuned(
        "nickel",
        Wish {
            error: 1e-9,
            max_bytes: Some(3000),
            ..WISH
        },
    );
    assert!(nothing.chosen.is_none(), "{:?}", nothing.chosen);
    assert!(nothing.nearest().unwrap().1.rmse > 1e-9);
}

#[test]
fn pictures_are_nearer_their_reference_with_more_samples_and_better_samplers() {
    let named = [Loaded::from_table(measured("nickel")).named("nickel")];
    let plan = PicturePlan {
        side: 24,
        samples: vec![4, 25],
        reference_samples: 1024,
        seed: 1,
    };
    let (reference, film) = picture_reference(SceneKind::Environment, &named, &plan).unwrap();
    assert!(
        reference.relative_error > 0.0 && reference.relative_error < 0.02,
        "{reference:?}"
    );
    let errors = |competitor| {
        let results = pictures(SceneKind::Environment, &named, competitor, &plan, &film).unwrap();
        // Shown at the thesis's 25 samples.
        assert!(results[0].png.is_empty() && results[1].png.starts_with(b"\x89PNG"));
        [results[0].errors, results[1].errors]
    };
    let cosine = errors(Competitor::brdf(SamplerSpec::new(CosineSettings {})));
    let mis = errors(Competitor {
        spec: HALF_VECTOR(),
        technique: Technique::Mis(Heuristic::Power),
    });
    assert!(
        mis[1].mean_relative < mis[0].mean_relative && mis[1].rel_mse < mis[0].rel_mse,
        "{mis:?}"
    );
    assert!(
        mis[1].mean_relative < 0.3 * cosine[1].mean_relative,
        "{mis:?} {cosine:?}"
    );
}

#[test]
fn settings_trade_bytes_for_error() {
    let material = Loaded::from_table(measured("nickel"));
    let of = |value: &str| {
        let knob = knobs(false, LookupRule::Floor, &TABLE)
            .into_iter()
            .find(|k| k.value == value)
            .unwrap();
        setting(&material, &sky(), knob, &plan(&[1], 16)).unwrap()
    };
    let [small, large] = ["2KB", "256KB"].map(of);
    assert!(small.table_bytes < large.table_bytes / 50);
    assert!(small.relstd > 2.0 * large.relstd, "{small:?} {large:?}");
    assert!(
        (1e-4..0.1).contains(&small.rmse) && (1e-4..0.1).contains(&large.rmse),
        "{small:?} {large:?}"
    );
    assert!(small.build_seconds > 0.0 && small.sample_ns > 0.0);
}
