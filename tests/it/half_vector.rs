//! The half-vector table: right at every size, never without a draw, continuous, invertible, and the same in batches.

use glam::{Vec2, Vec3};
use merlkit::Wo;
use merlkit::brdf::Importance;
use merlkit::direction_sampler::{DirectionSample, DirectionSampler};
use merlkit::geometry::{POINTS_PER_BIN, Quadrature, spherical};
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::points::PointSet;
use merlkit::sampler::{HalfVectorSettings, HalfVectorTable};
use merlkit_evaluate::measure::accuracy::{LIMIT_ANGLES_DEG, weight_spread};
use merlkit_evaluate::measure::check::{Check, CheckSettings, check_directions, check_sampler};
use merlkit_evaluate::measure::convergence::{Incident, LitPoint, Runs, slope};

use crate::support::tampered::Tampered;
use crate::support::{half_vector_preset, measured_under};

/// Upper bound of the samplers checked in this file: together they err once in a hundred seeds.
const CALLS: usize = 40;

fn direction(degrees: f64) -> Vec3 {
    spherical(degrees.to_radians(), 0.8).as_vec3()
}

fn assert_passes(brdf: &MerlBrdf, settings: HalfVectorSettings, seed: u64) {
    let table = HalfVectorTable::build(brdf, settings).unwrap();
    let check = CheckSettings {
        draws: 30_000,
        calls: CALLS,
        seed,
        importance: settings.importance,
        ..Default::default()
    };
    let report = check_sampler(&table, brdf, &check_directions(), &check);
    assert!(
        report.pass(),
        "{settings:?}: {:#?}",
        report.failures().collect::<Vec<_>>()
    );
}

macro_rules! passes_on {
    ($($test:ident: $name:literal, $seed:literal, [$($size:literal),*];)*) => {
        $(#[test]
        fn $test() {
            let brdf = measured_under($name, LookupRule::Floor);
            for (i, size) in [$($size),*].into_iter().enumerate() {
                assert_passes(&brdf, half_vector_preset(size), 10 * $seed + i as u64);
            }
        })*
    };
}

mod passes_every_check_on {
    use super::*;
    passes_on! {
        nickel: "nickel", 1, ["2KB", "64KB", "1MB"];
        chrome: "chrome", 2, ["4KB", "64KB", "256KB"];
        teflon: "teflon", 3, ["2KB", "64KB"];
        red_plastic: "red-plastic", 4, ["8KB", "64KB"];
        blue_metallic_paint: "blue-metallic-paint", 5, ["16KB", "64KB"];
        black_obsidian: "black-obsidian", 6, ["2KB", "32KB", "64KB"];
        violet_acrylic: "violet-acrylic", 7, ["2KB", "64KB"];
        alum_bronze: "alum-bronze", 8, ["64KB"];
        white_marble: "white-marble", 9, ["64KB"];
        beige_fabric: "beige-fabric", 10, ["64KB"];
        alumina_oxide: "alumina-oxide", 11, ["64KB"];
        yellow_paint: "yellow-paint", 12, ["64KB"];
    }

    #[test]
    fn other_lookups_and_importances() {
        let default = HalfVectorSettings::default();
        assert_passes(&measured_under("chrome", LookupRule::Linear), default, 200);
        assert_passes(
            &measured_under("violet-acrylic", LookupRule::Centred),
            default,
            201,
        );
        let luminance = HalfVectorSettings {
            importance: Importance::Luminance,
            ..default
        };
        assert_passes(
            &measured_under("blue-metallic-paint", LookupRule::Floor),
            luminance,
            202,
        );
    }

    #[test]
    fn odd_sizes() {
        let brdf = measured_under("nickel", LookupRule::Floor);
        for (i, (tables, rows, segments, fold)) in [
            (1, 2, 1, true),
            (2, 79, 1, false),
            (3, 2, 5, false),
            (5, 33, 6, true),
            (9, 78, 9, false),
        ]
        .into_iter()
        .enumerate()
        {
            let settings = HalfVectorSettings {
                tables,
                rows,
                segments,
                fold,
                ..Default::default()
            };
            assert_passes(&brdf, settings, 300 + i as u64);
        }
    }
}

/// The two tables' densities differ by a few per cent.
#[test]
fn a_density_of_another_resolution_is_rejected() {
    let brdf = measured_under("nickel", LookupRule::Floor);
    let build = |name| HalfVectorTable::build(&brdf, half_vector_preset(name)).unwrap();
    let (draws, claims) = (build("64KB"), build("2KB"));
    let wos = [14.5, 45.0, 75.5].map(direction);
    let settings = CheckSettings {
        draws: 1_000_000,
        ..Default::default()
    };
    let report = check_sampler(
        &Tampered {
            draws: &draws,
            claims: &claims,
            shift: 0.0,
        },
        &brdf,
        &wos,
        &settings,
    );
    let failed = report
        .failures()
        .filter(|o| o.check == Check::ChiSquare)
        .count();
    assert_eq!(failed, 3, "{report:#?}");
}

/// 0, the largest number below 1, and powers of two between.
fn extremes() -> Vec<f32> {
    let mut all: Vec<f32> = (1..=30)
        .flat_map(|k| [0.5f32.powi(k), 1.0 - 0.5f32.powi(k.min(24))])
        .collect();
    all.extend([0.0, f32::MIN_POSITIVE, 1e-45, 1.0f32.next_down()]);
    all
}

fn extreme_directions() -> Vec<Vec3> {
    let mut all: Vec<Vec3> = [
        0.0, 1e-7, 1e-3, 30.0, 45.0, 88.9, 89.0, 89.1, 89.99, 89.999_999,
    ]
    .iter()
    .flat_map(|&t| [0.0, 90.0, 200.0].map(|p: f64| spherical(f64::to_radians(t), p).as_vec3()))
    .collect();
    all.extend([1e-3, 1e-6, 1e-12, f32::MIN_POSITIVE, 1e-45].map(|z| Vec3::new(1.0, 0.0, z)));
    all.extend([1e-20, 1e-30, 1e-45].map(|x| Vec3::new(x, -x, 1.0)));
    all
}

#[test]
fn no_draw_fails_and_every_density_is_its_own() {
    for name in ["chrome", "black-obsidian"] {
        let brdf = measured_under(name, LookupRule::Floor);
        for size in ["2KB", "64KB"] {
            let table = HalfVectorTable::build(&brdf, half_vector_preset(size)).unwrap();
            for wo in extreme_directions() {
                for x in extremes() {
                    for y in extremes() {
                        let u = Vec2::new(x, y);
                        let s = table
                            .sample(wo, u)
                            .unwrap_or_else(|| panic!("{name} {size} {wo} {u}"));
                        let sound = s.wi.z > 0.0 && (s.wi.length() - 1.0).abs() < 4e-6;
                        assert!(sound, "{name} {size} {wo} {u}: {s:?}");
                        assert!(
                            s.pdf > 0.0 && s.pdf < f32::MAX,
                            "{name} {size} {wo} {u}: {s:?}"
                        );
                        assert_eq!(
                            s.pdf.to_bits(),
                            table.pdf(wo, s.wi).to_bits(),
                            "{name} {size} {wo} {u}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn invalid_directions_have_no_draw_and_no_density() {
    let table = HalfVectorTable::build(
        &measured_under("nickel", LookupRule::Floor),
        half_vector_preset("2KB"),
    )
    .unwrap();
    for wo in [
        Vec3::ZERO,
        -Vec3::Z,
        Vec3::X,
        Vec3::NAN,
        Vec3::new(0.0, 0.0, f32::INFINITY),
    ] {
        assert_eq!(table.sample(wo, Vec2::splat(0.5)), None);
        assert_eq!(table.pdf(wo, Vec3::Z), 0.0);
        assert_eq!(table.pdf(Vec3::Z, wo), 0.0);
        assert_eq!(table.invert(Vec3::Z, wo), None);
        assert_eq!(draw(&table, wo, &[Vec2::ZERO; 3]), [None; 3]);
    }
}

/// Draws about one `wo`, as a batch.
fn draw(table: &HalfVectorTable, wo: Vec3, points: &[Vec2]) -> Vec<Option<DirectionSample>> {
    let mut draws = vec![None; points.len()];
    table.sample_batch(Wo::One(wo), points, &mut draws);
    draws
}

#[test]
fn batches_draw_the_same_bits() {
    for (name, size) in [("teflon", "8KB"), ("nickel", "64KB")] {
        let table = HalfVectorTable::build(
            &measured_under(name, LookupRule::Floor),
            half_vector_preset(size),
        )
        .unwrap();
        for wo in extreme_directions() {
            for count in [0, 1, 63, 64, 65, 1000] {
                let points: Vec<Vec2> = (0..count)
                    .map(|i| PointSet::Random.point(count, i, 0))
                    .collect();
                let single: Vec<_> = points.iter().map(|&u| table.sample(wo, u)).collect();
                assert_eq!(draw(&table, wo, &points), single, "{wo}");
            }
        }
    }
}

#[test]
fn draws_can_be_inverted() {
    for (name, size) in [("nickel", "64KB"), ("teflon", "2KB"), ("chrome", "16KB")] {
        let table = HalfVectorTable::build(
            &measured_under(name, LookupRule::Floor),
            half_vector_preset(size),
        )
        .unwrap();
        for degrees in [0.0, 0.76, 30.0, 60.25, 84.7, 89.5] {
            let wo = direction(degrees);
            let mut far = 0;
            for i in 0..4000 {
                let u = PointSet::Random.point(3, i, 0);
                let back = table.invert(wo, table.sample(wo, u).unwrap().wi).unwrap();
                // On an edge between rows, rounding takes a direction to the other row, whose azimuths are others.
                far += usize::from((back - u).abs().max_element() > 2e-3);
            }
            assert!(far < 20, "{name} {size} {degrees}°: {far} of 4000");
        }
    }
}

/// Between rows the azimuth may jump; within one, and over `wo`, small changes have small effects.
#[test]
fn draws_move_little_when_their_point_or_wo_does() {
    let table = HalfVectorTable::build(
        &measured_under("red-plastic", LookupRule::Floor),
        half_vector_preset("64KB"),
    )
    .unwrap();
    let mut jumps = [0; 2];
    for i in 0..4000 {
        let u = PointSet::Random.point(9, i, 0);
        let degrees = 89.0 * f64::from(PointSet::Random.point(10, i, 0).x);
        let wi = table.sample(direction(degrees), u).unwrap().wi;
        let moved = table.sample(direction(degrees + 1e-3), u).unwrap().wi;
        jumps[0] += usize::from(moved.distance(wi) > 0.01);
        let moved = table
            .sample(direction(degrees), u + Vec2::new(0.0, 1e-5))
            .unwrap()
            .wi;
        jumps[1] += usize::from(moved.distance(wi) > 0.01);
    }
    assert!(jumps[0] < 40 && jumps[1] == 0, "{jumps:?} of 4000");
}

#[test]
fn sizes_are_what_they_are_called() {
    let brdf = measured_under("alum-bronze", LookupRule::Floor);
    for (name, settings) in HalfVectorSettings::PRESETS {
        let bytes = HalfVectorTable::build(&brdf, settings).unwrap().bytes();
        let (number, unit) = name.split_at(name.len() - 2);
        let nominal =
            number.parse::<usize>().unwrap() * if unit == "MB" { 1_000_000 } else { 1000 };
        assert_eq!(bytes, settings.bytes(), "{name}");
        assert!(
            bytes <= nominal * 105 / 100 && bytes >= nominal * 85 / 100,
            "{name}: {bytes}"
        );
    }
}

#[test]
fn settings_outside_their_domains_are_refused() {
    let brdf = measured_under("nickel", LookupRule::Floor);
    let d = HalfVectorSettings::default();
    for settings in [
        HalfVectorSettings { tables: 0, ..d },
        HalfVectorSettings { tables: 1025, ..d },
        HalfVectorSettings { rows: 1, ..d },
        HalfVectorSettings { rows: 80, ..d },
        HalfVectorSettings { segments: 0, ..d },
        HalfVectorSettings { segments: 257, ..d },
    ] {
        assert!(
            HalfVectorTable::build(&brdf, settings).is_err(),
            "{settings:?}"
        );
    }
}

/// The figures of the performance page, with a little room.
#[test]
fn weights_spread_little() {
    const MATERIALS: [&str; 3] = ["chrome", "red-plastic", "black-obsidian"];
    for (size, most) in [("2KB", 0.16), ("64KB", 0.06), ("1MB", 0.05)] {
        for name in MATERIALS {
            let brdf = measured_under(name, LookupRule::Floor);
            let table = HalfVectorTable::build(&brdf, half_vector_preset(size)).unwrap();
            let spread = |&degrees: &f64| {
                let quadrature = Quadrature::new(direction(degrees), POINTS_PER_BIN / 4);
                weight_spread(&table, &brdf, &quadrature, Importance::Mean)
            };
            let spreads: Vec<_> = LIMIT_ANGLES_DEG.iter().map(spread).collect();
            let mean = spreads.iter().map(|s| s.relstd).sum::<f64>() / spreads.len() as f64;
            assert!(mean < most, "{name} {size}: {mean}");
            assert!(
                spreads.iter().all(|s| s.holes == 0.0),
                "{name} {size}: {spreads:?}"
            );
        }
    }
}

/// Broad lamps, so that it is the map from points to directions that counts.
#[test]
fn well_spread_points_stay_well_spread() {
    let brdf = measured_under("blue-metallic-paint", LookupRule::Floor);
    let table = HalfVectorTable::build(&brdf, HalfVectorSettings::default()).unwrap();
    let radiance =
        |wi: Vec3| 0.2 + 4.0 * f64::from(wi.dot(Vec3::new(0.5, 0.3, 0.81)).max(0.0)).powi(8);
    let point = LitPoint {
        brdf: &brdf,
        importance: Importance::Mean,
        light: Incident::Function(&radiance),
        wo: direction(45.0),
    };
    let reference = point.reference(POINTS_PER_BIN);
    let slopes = [PointSet::Random, PointSet::Sobol].map(|points| {
        let runs = Runs {
            points,
            seeds: 100,
            first_seed: 1,
        };
        slope(&point.errors(&table, reference, &[16, 64, 256, 1024], runs))
    });
    assert!(
        (slopes[0] + 0.5).abs() < 0.1 && slopes[1] < -0.9,
        "{slopes:?}"
    );
}

#[test]
fn builds_do_not_depend_on_threads() {
    let brdf = measured_under("alum-bronze", LookupRule::Floor);
    let draws = [1, 2, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let table = pool
            .install(|| HalfVectorTable::build(&brdf, half_vector_preset("8KB")))
            .unwrap();
        let points: Vec<Vec2> = (0..1000).map(|i| PointSet::Random.point(1, i, 0)).collect();
        LIMIT_ANGLES_DEG.map(|d| draw(&table, direction(d), &points))
    });
    assert!(draws[0] == draws[1] && draws[0] == draws[2]);
}
