//! The samplers that the tables are compared with: each passes every check, whatever the material, and fits it.

use crate::support::{baselines, loaded, measured};

use crate::support::tampered::Tampered;
use glam::{Vec2, Vec3};
use merlkit::brdf::Importance;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::geometry::{Quadrature, spherical};
use merlkit::material::merl::MerlBrdf;
use merlkit::points::PointSet;
use merlkit::sampler::{
    Cosine, Factored, FactoredSettings, Factors, LEAST_DIFFUSE, Lobe, LobeKind, LobeParameters,
    LobeSettings, Sampler,
};
use merlkit_evaluate::measure::accuracy::{LIMIT_ANGLES_DEG, weight_spread};
use merlkit_evaluate::measure::check::{Check, CheckSettings, check_directions, check_sampler};

const MATERIALS: [&str; 4] = ["nickel", "teflon", "black-obsidian", "red-plastic"];
/// Without "peak": all mass in a hundredth of a degree is too much for the check's own integration, whatever the sampler.
const HARD: [&str; 6] = [
    "black",
    "constant",
    "one-cell",
    "one-channel",
    "islands",
    "smallest",
];

/// Every check at every `step`-th direction.
fn assert_all_pass(name: &str, draws: usize, step: usize) {
    let brdf = measured(name);
    let specs = baselines();
    let directions: Vec<Vec3> = check_directions().into_iter().step_by(step).collect();
    let calls = specs.len() * (MATERIALS.len() + HARD.len());
    for spec in specs {
        // Draws of this one take up to 1000 trials.
        let draws = if spec.to_string() == "adaptive-disc:rejection" {
            2000
        } else {
            draws
        };
        let settings = CheckSettings {
            draws,
            seed: 41,
            calls,
            ..CheckSettings::default()
        };
        let sampler = spec.build(&loaded(&brdf)).unwrap();
        let report = check_sampler(&*sampler, &*brdf, &directions, &settings);
        let failures: Vec<String> = report
            .failures()
            .take(3)
            .map(|o| format!("{o:?}"))
            .collect();
        assert!(
            report.pass(),
            "{name}, {}: {}",
            spec.name(),
            failures.join("\n")
        );
    }
}

#[test]
fn all_pass_on_materials() {
    MATERIALS
        .iter()
        .for_each(|name| assert_all_pass(name, 10_000, 3));
}

#[test]
fn all_pass_on_hard_cases() {
    HARD.iter().for_each(|name| assert_all_pass(name, 5000, 4));
}

/// Geometric mean of E[w²]/E[w]² over angles that none is fitted to.
fn unevenness(sampler: &dyn DirectionSampler, brdf: &MerlBrdf) -> f64 {
    let of = |theta: &f64| {
        let quadrature = Quadrature::new(spherical(theta.to_radians(), 0.4).as_vec3(), 55);
        weight_spread(sampler, brdf, &quadrature, Importance::Mean)
            .relstd
            .powi(2)
            .ln_1p()
    };
    (LIMIT_ANGLES_DEG.iter().map(of).sum::<f64>() / LIMIT_ANGLES_DEG.len() as f64).exp()
}

#[test]
fn fits_are_near_the_best_by_hand() {
    for name in ["nickel", "teflon"] {
        let brdf = measured(name);
        let uniform = unevenness(&Cosine, &brdf);
        for kind in LobeKind::ALL {
            let fitted = unevenness(
                &Lobe::build(&*brdf, LobeSettings::fitted(kind)).unwrap(),
                &brdf,
            );
            assert!(
                fitted < 1.01 * uniform,
                "{name}, {kind:?}: {fitted}, cosine {uniform}"
            );
            let [low, high] = kind.domain();
            for i in 1..9 {
                for diffuse in [0.003, 0.03, 0.2, 0.9] {
                    let shape = low * (high / low).powf(i as f32 / 9.0);
                    let parameters = Some(LobeParameters {
                        along: shape,
                        across: shape,
                        diffuse,
                    });
                    let lobe = Lobe::build(
                        &*brdf,
                        LobeSettings {
                            parameters,
                            ..LobeSettings::fitted(kind)
                        },
                    );
                    let by_hand = unevenness(&lobe.unwrap(), &brdf);
                    assert!(
                        fitted < 1.05 * by_hand,
                        "{name}, {kind:?} {shape} {diffuse}: {fitted} {by_hand}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_best_factors_are_no_worse_than_others() {
    let brdf = measured("red-plastic");
    let best = unevenness(
        &Factored::build(&*brdf, FactoredSettings::default()).unwrap(),
        &brdf,
    );
    for half in [true, false] {
        for (outer, inner) in [(1, 1), (3, 2)] {
            let factors = Factors {
                outer,
                inner,
                theta: 90,
                phi: 16,
                half,
                floor: 0.01,
            };
            let settings = FactoredSettings {
                factors: Some(factors),
                ..FactoredSettings::default()
            };
            let other = unevenness(&Factored::build(&*brdf, settings).unwrap(), &brdf);
            assert!(best < 1.05 * other, "{factors:?}: {best} {other}");
        }
    }
}

#[test]
fn a_wrong_density_is_rejected() {
    let brdf = measured("red-plastic");
    let directions: Vec<Vec3> = check_directions().into_iter().step_by(4).collect();
    let settings = CheckSettings {
        draws: 10_000,
        seed: 7,
        ..CheckSettings::default()
    };
    for spec in baselines() {
        let sampler = spec.build(&loaded(&brdf)).unwrap();
        let wrong = Tampered {
            draws: &*sampler,
            claims: &Cosine,
            shift: 0.0,
        };
        let report = check_sampler(&wrong, &*brdf, &directions, &settings);
        assert!(
            report.failures().any(|o| o.check == Check::ChiSquare),
            "{}",
            spec.name()
        );
    }
    for kind in LobeKind::ALL {
        // Exponent or roughness a third larger than is drawn with.
        let [low, high] = kind.domain();
        let shape = if high < 10.0 {
            0.3
        } else {
            20.0 * low.max(1.0)
        };
        let lobe = |factor: f32| {
            let shape = shape * factor;
            let parameters = Some(LobeParameters {
                along: shape,
                across: shape,
                diffuse: 0.1,
            });
            Lobe::build(
                &*brdf,
                LobeSettings {
                    parameters,
                    ..LobeSettings::fitted(kind)
                },
            )
            .unwrap()
        };
        let (draws, claims) = (lobe(1.0), lobe(4.0 / 3.0));
        let wrong = Tampered {
            draws: &draws,
            claims: &claims,
            shift: 0.0,
        };
        assert!(
            !check_sampler(&wrong, &*brdf, &directions, &settings).pass(),
            "{kind:?}"
        );
    }
}

/// Every bit of what a sampler holds that shows.
fn fingerprint(sampler: &Sampler) -> Vec<u32> {
    let mut bits = Vec::new();
    for degrees in [0.0, 31.0, 77.0] {
        let wo = spherical(f64::to_radians(degrees), 1.0).as_vec3();
        for i in 0..500 {
            if let Some(draw) = sampler.sample(wo, PointSet::Sobol.point(3, i, 0)) {
                bits.extend([draw.wi.x, draw.wi.y, draw.wi.z, draw.pdf].map(f32::to_bits));
            }
        }
    }
    bits
}

#[test]
fn threads_change_no_bit() {
    let brdf = measured("nickel");
    for spec in baselines() {
        let built = [1, 2].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| spec.build(&loaded(&brdf))).unwrap()
        });
        assert_eq!(built[0].spec(), built[1].spec());
        assert_eq!(
            fingerprint(&built[0]),
            fingerprint(&built[1]),
            "{}",
            spec.name()
        );
    }
}

#[test]
fn what_was_fitted_builds_the_same_sampler_again() {
    let brdf = measured("red-plastic");
    for spec in baselines() {
        let first = spec.build(&loaded(&brdf)).unwrap();
        let again = first.spec().build(&loaded(&brdf)).unwrap();
        assert_eq!(first.spec(), again.spec());
        assert_eq!(fingerprint(&first), fingerprint(&again), "{}", spec.name());
    }
}

#[test]
fn black_needs_no_fit() {
    let brdf = measured("black");
    for spec in baselines() {
        let sampler = spec.build(&loaded(&brdf)).unwrap();
        let wo = spherical(0.5, 0.0).as_vec3();
        let draw = sampler.sample(wo, Vec2::splat(0.4)).unwrap();
        assert!(draw.pdf > 0.0 && draw.pdf.is_finite(), "{}", spec.name());
    }
}

#[test]
fn settings_outside_their_domains_are_refused() {
    let brdf = measured("constant");
    let lobe = |kind, along, across, diffuse| {
        let parameters = Some(LobeParameters {
            along,
            across,
            diffuse,
        });
        Lobe::build(
            &*brdf,
            LobeSettings {
                parameters,
                ..LobeSettings::fitted(kind)
            },
        )
    };
    assert!(lobe(LobeKind::Ggx, 0.5, 0.5, LEAST_DIFFUSE).is_ok());
    assert!(lobe(LobeKind::CosineLobe, 30.0, 30.0, 0.0).is_ok());
    assert!(lobe(LobeKind::Ward, 0.2, 0.4, 0.0).is_ok());
    for (kind, along, across, diffuse) in [
        (LobeKind::Ggx, 0.0, 0.0, 0.1),
        (LobeKind::Ggx, f32::NAN, f32::NAN, 0.1),
        (LobeKind::Ggx, 0.5, 0.6, 0.1),
        (LobeKind::Blinn, 10.0, 10.0, -0.1),
        (LobeKind::Blinn, 10.0, 11.0, 0.1),
        (LobeKind::Blinn, 10.0, 10.0, 1.5),
        (LobeKind::AshikhminShirley, 10.0, f32::INFINITY, 0.5),
    ] {
        assert!(
            lobe(kind, along, across, diffuse).is_err(),
            "{kind:?} {along} {across} {diffuse}"
        );
    }
    let good = Factors {
        outer: 1,
        inner: 1,
        theta: 8,
        phi: 4,
        half: true,
        floor: 0.1,
    };
    let factored = |tables, factors| {
        Factored::build(
            &*brdf,
            FactoredSettings {
                tables,
                factors: Some(factors),
                ..Default::default()
            },
        )
    };
    assert!(factored(3, good).is_ok());
    for (tables, factors) in [
        (0, good),
        (3, Factors { outer: 0, ..good }),
        (3, Factors { inner: 65, ..good }),
        (3, Factors { theta: 1, ..good }),
        (3, Factors { phi: 2000, ..good }),
        (
            3,
            Factors {
                floor: f64::NAN,
                ..good
            },
        ),
    ] {
        assert!(factored(tables, factors).is_err(), "{tables} {factors:?}");
    }
}
