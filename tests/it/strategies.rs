//! Strategies for light × BRDF: each gives the same picture and the same point, at its own cost.

use crate::render::row;
use crate::support::measured;
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};
use merlkit::brdf::{Brdf, Importance};
use merlkit::color::Rgb;
use merlkit::direction_sampler::{DirectionSample, DirectionSampler};
use merlkit::distribution::Heuristic;
use merlkit::geometry::{POINTS_PER_BIN, spherical};
use merlkit::light::{Area, Environment, EnvironmentSource, LightSpec, SkySampling};
use merlkit::points::PointSet;
use merlkit::render::{
    Budget, Film, PlanRequest, RenderSettings, Scene, SceneSpec, Strategy, Surface, render,
};
use merlkit::sampler::{Cosine, HalfVectorSettings, HalfVectorTable};
use merlkit_evaluate::measure::convergence::{ErrorAt, Incident, LitPoint, Runs, Technique};

const STRATEGIES: [Strategy; 6] = [
    Strategy::Mis(Heuristic::Power),
    Strategy::Mis(Heuristic::Balance),
    Strategy::Light,
    Strategy::Brdf,
    Strategy::Ris { candidates: 2 },
    Strategy::Ris { candidates: 16 },
];

/// A material with the default sampler, and one with none that follows it.
fn surfaces(name: &str) -> [Surface; 2] {
    let brdf = measured(name);
    let table = HalfVectorTable::build(&*brdf, HalfVectorSettings::default()).unwrap();
    [
        Surface {
            brdf: brdf.clone(),
            sampler: Some(Arc::new(table)),
        },
        Surface {
            brdf,
            sampler: Some(Arc::new(Cosine)),
        },
    ]
}

fn studio() -> LightSpec {
    LightSpec::Environment(EnvironmentSource::Studio)
}

/// Broad, and above the spheres: they hide it from one another.
fn lamp() -> LightSpec {
    let (corner, edge_u, edge_v) = (
        DVec3::new(-4.0, 4.5, -2.0),
        DVec3::X * 8.0,
        DVec3::new(0.0, -1.5, 7.0),
    );
    LightSpec::Area(Area {
        corner,
        edge_u,
        edge_v,
        radiance: Rgb::new(2.0, 1.5, 1.0),
    })
}

fn film(
    spec: &SceneSpec,
    request: PlanRequest,
    surfaces: &[Surface],
    side: usize,
    samples: u64,
) -> Film {
    let scene = Scene::build(spec, request, |i, _| Ok(surfaces[i].clone())).unwrap();
    // Random points: their standard errors are right.
    let settings = RenderSettings {
        width: side,
        height: side,
        seed: 11,
        points: PointSet::Random,
        budget: Budget::Even(samples),
    };
    render(&scene, &settings, &|_| {}).unwrap().film
}

fn planned(spec: &SceneSpec, surfaces: &[Surface], side: usize, samples: u64) -> Film {
    film(spec, PlanRequest::AsNeeded, surfaces, side, samples)
}

/// How far two films are apart: the largest distance of a block of 4 × 4 pixels in any channel, and the root of the mean of
/// the squares, both in standard errors.
fn distance(a: &Film, b: &Film) -> (f64, f64) {
    const BLOCK: usize = 4;
    let (mut squares, mut count, mut worst) = (0.0, 0.0, 0.0f64);
    let columns = a.width() / BLOCK;
    for block in 0..columns * (a.height() / BLOCK) {
        let (mut difference, mut variance) = (DVec3::ZERO, DVec3::ZERO);
        for i in 0..BLOCK * BLOCK {
            let (x, y) = (
                block % columns * BLOCK + i % BLOCK,
                block / columns * BLOCK + i / BLOCK,
            );
            difference += a.mean(x, y) - b.mean(x, y);
            variance += a.standard_error(x, y).powf(2.0) + b.standard_error(x, y).powf(2.0);
        }
        for (d, v) in difference.to_array().into_iter().zip(variance.to_array()) {
            // A block of background has no error but that of its rounding.
            if v > 1e-12 {
                squares += d * d / v;
                count += 1.0;
                worst = worst.max(d.abs() / v.sqrt());
            } else {
                assert!(d.abs() < 1e-5, "block {block} differs by {d} without noise");
            }
        }
    }
    assert!(count > 20.0, "{count} blocks with noise");
    (worst, f64::sqrt(squares / count))
}

fn assert_same(a: &Film, b: &Film, what: &str) {
    let (worst, root) = distance(a, b);
    assert!(
        worst < 4.6 && root < 1.3,
        "{what}: {worst} and {root} standard errors"
    );
}

#[test]
fn all_strategies_show_the_same_spheres_under_the_studio() {
    for name in ["nickel", "teflon"] {
        let surfaces = surfaces(name);
        for (sampler, surface) in ["half-vector", "cosine"].iter().zip(&surfaces) {
            // Chance hardly finds nickel's lobe by the cosine, and standard errors are not known then.
            if (name, *sampler) == ("nickel", "cosine") {
                continue;
            }
            let films = STRATEGIES.map(|strategy| {
                let spec = row(1, vec![studio()], strategy);
                // Lights alone need the lobe to be found by chance too: more of them.
                let samples = if strategy == Strategy::Light {
                    2048
                } else {
                    192
                };
                planned(&spec, std::slice::from_ref(surface), 24, samples)
            });
            for (film, strategy) in films.iter().zip(STRATEGIES).skip(1) {
                assert_same(&films[0], film, &format!("{name}, {sampler}, {strategy:?}"));
            }
        }
    }
}

/// Two lights, one in front of the other, a floor, shadows, and light from one sphere on another.
#[test]
fn all_strategies_show_the_same_where_everything_meets() {
    let surfaces = [
        surfaces("teflon")[0].clone(),
        surfaces("red-plastic")[0].clone(),
    ];
    let films = STRATEGIES.map(|strategy| {
        let lights = vec![
            lamp(),
            LightSpec::Environment(EnvironmentSource::Uniform(Rgb::splat(0.2))),
        ];
        let spec = SceneSpec {
            floor: Some(0.5),
            depth: 4,
            ..row(2, lights, strategy)
        };
        planned(&spec, &surfaces, 24, 192)
    });
    for (film, strategy) in films.iter().zip(STRATEGIES).skip(1) {
        assert_same(&films[0], film, &format!("{strategy:?}"));
    }
}

#[test]
fn resampling_beside_all_other_effects_shows_the_same() {
    let surfaces = [surfaces("teflon")[0].clone()];
    let spec = SceneSpec {
        floor: Some(0.5),
        depth: 3,
        ..row(1, vec![studio(), lamp()], Strategy::Ris { candidates: 4 })
    };
    let forced = film(&spec, PlanRequest::Everything, &surfaces, 24, 192);
    assert_same(
        &planned(&spec, &surfaces, 24, 192),
        &forced,
        "everything forced on",
    );
}

/// Draws by the cosine, but says that it is denser than it is.
struct Boastful(f32);

impl DirectionSampler for Boastful {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        Cosine.sample(wo, u).map(|s| DirectionSample {
            pdf: s.pdf * self.0,
            ..s
        })
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        Cosine.pdf(wo, wi) * self.0
    }

    fn bytes(&self) -> usize {
        0
    }
}

#[test]
fn a_wrong_normalisation_is_seen() {
    let right = surfaces("teflon")[0].clone();
    let boast = Boastful(1.05);
    let wrong = Surface {
        sampler: Some(Arc::new(boast)),
        ..right.clone()
    };
    let [mis, ris] = [STRATEGIES[0], STRATEGIES[5]];
    let spec = |strategy| row(1, vec![studio()], strategy);
    let expected = planned(&spec(mis), std::slice::from_ref(&right), 24, 512);
    let (worst, root) = distance(&expected, &planned(&spec(ris), &[wrong], 24, 512));
    assert!(
        worst > 5.0 && root > 2.0,
        "a density 5 % too high is {worst} and {root} standard errors off"
    );
}

/// Mean over the picture of the pixels' squared standard errors.
fn noise(film: &Film) -> f64 {
    let pixels = (0..film.width() * film.height()).map(|i| (i % film.width(), i / film.width()));
    pixels
        .map(|(x, y)| film.standard_error(x, y).length_squared())
        .sum()
}

#[test]
fn more_candidates_make_less_noise() {
    let surface = &surfaces("teflon")[0];
    let noise_of = |strategy| {
        noise(&planned(
            &row(1, vec![studio()], strategy),
            std::slice::from_ref(surface),
            24,
            64,
        ))
    };
    let one = noise_of(Strategy::Brdf);
    for (candidates, most) in [(4, 0.4), (16, 0.15)] {
        let share = noise_of(Strategy::Ris { candidates }) / one;
        assert!(
            share < most,
            "{candidates} candidates: {share} of the variance of one"
        );
    }
}

#[test]
fn no_candidates_are_refused() {
    let spec = row(1, vec![studio()], Strategy::Ris { candidates: 0 });
    let built = Scene::build(&spec, PlanRequest::AsNeeded, |_, _| {
        Ok(surfaces("teflon")[0].clone())
    });
    assert!(
        built
            .err()
            .is_some_and(|e| e.to_string().contains("at least 1"))
    );
}

const TECHNIQUES: [Technique; 6] = [
    Technique::Brdf,
    Technique::Light,
    Technique::Mis(Heuristic::Power),
    Technique::Mis(Heuristic::Balance),
    Technique::Ris(1),
    Technique::Ris(8),
];

/// Errors of all techniques at 1, 63 and 2¹⁴ samples, of a point under the studio.
fn point_errors(brdf: &dyn Brdf, sampler: &dyn DirectionSampler) -> [Vec<ErrorAt>; 6] {
    let sky = merlkit::light::studio(SkySampling::Importance);
    let wo = spherical(0.6, 0.8).as_vec3();
    let point = LitPoint {
        brdf,
        importance: Importance::Mean,
        light: Incident::Environment(&sky),
        wo,
    };
    let reference = point.reference(POINTS_PER_BIN);
    let runs = Runs {
        points: PointSet::Sobol,
        seeds: 8,
        first_seed: 1,
    };
    let errors = |technique| {
        point
            .errors_by(technique, sampler, reference, &[1, 63, 1 << 14], runs)
            .unwrap()
    };
    TECHNIQUES.map(errors)
}

#[test]
fn all_techniques_converge_to_the_quadrature() {
    for name in ["nickel", "teflon"] {
        let [table, cosine] = surfaces(name);
        for surface in [table, cosine] {
            let sampler = surface.sampler.unwrap();
            let errors = point_errors(&*surface.brdf, &*sampler);
            for (technique, e) in TECHNIQUES.iter().zip(&errors) {
                let most = if name == "nickel" { 0.03 } else { 0.003 };
                assert!(e[2].rmse < most, "{name}, {technique:?}: {e:?}");
                assert!(e[0].rmse > 2.0 * e[2].rmse, "{name}, {technique:?}: {e:?}");
            }
        }
    }
}

#[test]
fn techniques_that_are_one_are_equal() {
    let [surface, _] = surfaces("nickel");
    let [brdf, _, power, balance, one, many] =
        point_errors(&*surface.brdf, &*surface.sampler.unwrap());
    assert_eq!(brdf, one);
    // One sample of two techniques is the BRDF's.
    assert_eq!((power[0], balance[0]), (brdf[0], brdf[0]));
    assert_ne!(power[1], balance[1]);
    assert_eq!((many[1].samples, many[1].evaluations), (63, 504));
    assert!(many[1].rmse < brdf[1].rmse);
}

#[test]
fn an_environment_of_one_colour_is_a_constant_function() {
    let [surface, _] = surfaces("teflon");
    let (sky, wo) = (
        Environment::uniform(Rgb::splat(2.0)).unwrap(),
        spherical(0.6, 0.8).as_vec3(),
    );
    let constant = |_: Vec3| 2.0;
    let point = |light| LitPoint {
        brdf: &*surface.brdf,
        importance: Importance::Mean,
        light,
        wo,
    };
    let [a, b] = [
        point(Incident::Environment(&sky)),
        point(Incident::Function(&constant)),
    ];
    assert!((a.reference(89) / b.reference(89) - 1.0).abs() < 1e-6);
    let runs = Runs {
        points: PointSet::Random,
        seeds: 1,
        first_seed: 1,
    };
    for technique in [Technique::Light, Technique::Mis(Heuristic::Power)] {
        assert!(b.errors_by(technique, &Cosine, 1.0, &[1], runs).is_err());
        assert!(a.errors_by(technique, &Cosine, 1.0, &[1], runs).is_ok());
    }
    assert!(
        b.errors_by(Technique::Ris(0), &Cosine, 1.0, &[1], runs)
            .is_err()
    );
}
