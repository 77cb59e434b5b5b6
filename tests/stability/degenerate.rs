//! Materials and directions at which samplers of other kinds divide by zero.

use crate::support::loaded;
use std::sync::Arc;

use glam::{Vec2, Vec3};
use merlkit::brdf::Brdf;
use merlkit::geometry::spherical;
use merlkit::material::merl::{Header, MerlTable};
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::points::PointSet;
use merlkit::sampler::{
    AdaptiveDiscSettings, CascadeCdfSettings, Construction, CosineSettings, HalfVectorSettings,
    LeafChoice, SamplerSpec,
};

type Cell = fn(usize, usize, usize) -> [f64; 3];

const MATERIALS: [(&str, Cell); 9] = [
    ("black", |_, _, _| [0.0; 3]),
    ("all invalid", |_, _, _| [-1.0; 3]),
    ("one cell", |h, d, p| {
        if (h, d, p) == (12, 30, 77) {
            [2.0; 3]
        } else {
            [0.0; 3]
        }
    }),
    ("one bin of theta_h", |h, _, _| {
        if h == 0 { [1e4; 3] } else { [0.0; 3] }
    }),
    ("red only", |_, _, _| [0.3, 0.0, 0.0]),
    ("peak over mean of 1e8", |h, _, _| {
        if h == 0 { [1e6; 3] } else { [1e-2; 3] }
    }),
    ("islands", |h, d, p| {
        if (h / 7 + d / 9 + p / 20) % 5 == 0 {
            [0.0; 3]
        } else {
            [0.2; 3]
        }
    }),
    ("invalid islands", |h, d, p| {
        if (h + d + p) % 3 == 0 {
            [f64::NAN; 3]
        } else {
            [0.1, 0.2, f64::from(h as u32)]
        }
    }),
    ("near the largest f32", |_, _, _| [1e38, 1e30, 1.0]),
];

fn specs() -> Vec<(&'static str, SamplerSpec)> {
    let disc = AdaptiveDiscSettings {
        tables: 5,
        ..Default::default()
    };
    let cdf = CascadeCdfSettings {
        tables: 4,
        theta_h: 90,
        phi_h: 32,
        ..Default::default()
    };
    let (published_disc, published_cdf) = (
        AdaptiveDiscSettings::as_published(),
        CascadeCdfSettings::as_published(true),
    );
    vec![
        ("cosine", SamplerSpec::new(CosineSettings {})),
        ("disc", SamplerSpec::new(disc)),
        (
            "disc, leaves by integral",
            SamplerSpec::new(AdaptiveDiscSettings {
                leaves: LeafChoice::Integral,
                ..disc
            }),
        ),
        (
            "disc as published",
            SamplerSpec::new(AdaptiveDiscSettings {
                tables: 3,
                construction: Construction::Grid(200),
                ..published_disc
            }),
        ),
        (
            "one tree",
            SamplerSpec::new(AdaptiveDiscSettings {
                tables: 1,
                depth: 1,
                ..disc
            }),
        ),
        ("cdf", SamplerSpec::new(cdf)),
        (
            "cdf whole",
            SamplerSpec::new(CascadeCdfSettings {
                tolerance: None,
                ..cdf
            }),
        ),
        (
            "cdf as published",
            SamplerSpec::new(CascadeCdfSettings {
                tables: 3,
                theta_h: 128,
                phi_h: 64,
                ..published_cdf
            }),
        ),
        (
            "one cell",
            SamplerSpec::new(CascadeCdfSettings {
                tables: 1,
                theta_h: 1,
                phi_h: 1,
                ..cdf
            }),
        ),
        (
            "infinite tolerance",
            SamplerSpec::new(CascadeCdfSettings {
                tolerance: Some(f64::INFINITY),
                ..cdf
            }),
        ),
        (
            "zero tolerance",
            SamplerSpec::new(CascadeCdfSettings {
                tolerance: Some(0.0),
                ..cdf
            }),
        ),
        (
            "half-vector",
            SamplerSpec::new(HalfVectorSettings {
                tables: 5,
                ..Default::default()
            }),
        ),
        (
            "half-vector, least",
            SamplerSpec::new(HalfVectorSettings {
                tables: 1,
                rows: 2,
                segments: 1,
                fold: true,
                ..Default::default()
            }),
        ),
        (
            "floor only",
            SamplerSpec::new(CascadeCdfSettings { floor: 1.0, ..cdf }),
        ),
    ]
}

fn directions() -> Vec<Vec3> {
    let mut out: Vec<Vec3> = [0.0, 1e-7, 30.0, 45.0, 89.5, 89.99, 89.999_999]
        .iter()
        .flat_map(|&t| {
            [0.0, 90.0, 200.0].map(|p: f64| spherical(f64::to_radians(t), p.to_radians()).as_vec3())
        })
        .collect();
    out.extend([1e-3, 1e-6, 1e-12, f32::MIN_POSITIVE, 1e-45].map(|z| Vec3::new(1.0, 0.0, z)));
    out
}

fn points() -> Vec<Vec2> {
    let top = 1.0f32.next_down();
    let mut out = vec![
        Vec2::ZERO,
        Vec2::splat(top),
        Vec2::new(0.0, top),
        Vec2::new(top, 0.0),
        Vec2::splat(0.5),
    ];
    out.extend((1..24).map(|k| Vec2::new(0.5f32.powi(k), 1.0 - 0.5f32.powi(k))));
    out.extend((0..40).map(|i| PointSet::Sobol.point(3, i, 0)));
    out
}

#[test]
fn every_draw_and_density_is_finite_and_agrees() {
    for (material, cell) in MATERIALS {
        let table = Arc::new(MerlTable::from_fn(Header { phi_d_bins: 180 }, cell));
        for rule in [LookupRule::Floor, LookupRule::Linear] {
            let brdf = Arc::new(MerlBrdf::new(table.clone(), rule));
            for (name, spec) in specs() {
                let sampler = spec.build(&loaded(&brdf)).unwrap();
                for &wo in &directions() {
                    for &u in &points() {
                        let Some(s) = sampler.sample(wo, u) else {
                            continue;
                        };
                        let place =
                            || format!("{material}, {name}, {rule:?}, {wo:?}, {u:?}: {s:?}");
                        assert!(s.pdf > 0.0 && s.pdf.is_finite(), "{}", place());
                        assert!(
                            s.wi.z > 0.0 && (s.wi.length() - 1.0).abs() < 1e-5,
                            "{}",
                            place()
                        );
                        assert_eq!(s.pdf, sampler.pdf(wo, s.wi), "{}", place());
                        let weight = brdf.eval_cos(wo, s.wi).as_dvec3() / f64::from(s.pdf);
                        assert!(
                            weight.is_finite() && weight.min_element() >= 0.0,
                            "{}",
                            place()
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn directions_outside_the_domain_draw_nothing() {
    let table = Arc::new(MerlTable::from_fn(Header { phi_d_bins: 180 }, |_, _, _| {
        [0.3; 3]
    }));
    let brdf = Arc::new(MerlBrdf::new(table, LookupRule::Floor));
    let bad = [
        Vec3::new(1.0, 0.0, 0.0),
        Vec3::new(1.0, 0.0, -1e-9),
        Vec3::NEG_Z,
        Vec3::NAN,
        Vec3::new(f32::INFINITY, 0.0, 1.0),
        Vec3::ZERO,
    ];
    for (name, spec) in specs() {
        let sampler = spec.build(&loaded(&brdf)).unwrap();
        for wo in bad {
            assert_eq!(sampler.sample(wo, Vec2::splat(0.3)), None, "{name} {wo}");
            assert_eq!(sampler.pdf(wo, Vec3::Z), 0.0, "{name} {wo}");
            assert_eq!(sampler.pdf(Vec3::Z, wo), 0.0, "{name} {wo}");
            assert_eq!(brdf.eval(Vec3::Z, wo), Vec3::ZERO);
            assert!(
                sampler
                    .draw_stratified(wo, 5, 1)
                    .iter()
                    .all(Option::is_none),
                "{name} {wo}"
            );
        }
    }
}

#[test]
fn settings_out_of_range_are_errors() {
    let table = Arc::new(MerlTable::from_fn(Header { phi_d_bins: 180 }, |_, _, _| {
        [0.3; 3]
    }));
    let brdf = Arc::new(MerlBrdf::new(table, LookupRule::Floor));
    let (disc, cdf) = (
        AdaptiveDiscSettings::default(),
        CascadeCdfSettings::default(),
    );
    for spec in [
        SamplerSpec::new(AdaptiveDiscSettings { tables: 0, ..disc }),
        SamplerSpec::new(AdaptiveDiscSettings { n_max: 1.0, ..disc }),
        SamplerSpec::new(AdaptiveDiscSettings {
            n_max: f64::NAN,
            ..disc
        }),
        SamplerSpec::new(AdaptiveDiscSettings { depth: 40, ..disc }),
        SamplerSpec::new(AdaptiveDiscSettings { floor: 1.5, ..disc }),
        SamplerSpec::new(AdaptiveDiscSettings {
            construction: Construction::Grid(1),
            ..disc
        }),
        SamplerSpec::new(CascadeCdfSettings { theta_h: 0, ..cdf }),
        SamplerSpec::new(CascadeCdfSettings {
            phi_h: 100_000,
            ..cdf
        }),
        SamplerSpec::new(CascadeCdfSettings { floor: -0.1, ..cdf }),
        SamplerSpec::new(CascadeCdfSettings {
            tolerance: Some(f64::NAN),
            ..cdf
        }),
    ] {
        assert!(
            matches!(
                spec.build(&loaded(&brdf)),
                Err(merlkit::Error::Argument { .. })
            ),
            "{spec:?}"
        );
    }
}

/// A draw that rounding takes across the edge of the only bin with light would have the floor's density alone, and a weight
/// of 10⁷ where the mean is 10⁻³.
#[test]
fn no_weight_is_beyond_all_bounds_where_light_ends_at_an_edge() {
    let table = Arc::new(
        merlkit::material::merl::HardCase::named("one-row")
            .unwrap()
            .table(),
    );
    let brdf = Arc::new(MerlBrdf::new(table, LookupRule::Floor));
    let settings = AdaptiveDiscSettings {
        tables: 3,
        ..Default::default()
    };
    let disc = SamplerSpec::new(settings).build(&loaded(&brdf)).unwrap();
    let wo = spherical(60.25f64.to_radians(), 2.5).as_vec3();
    let (mut heaviest, mut lost) = (0.0f32, 0);
    for i in 0..100_000 {
        match disc.sample(wo, PointSet::Random.point(1, i, 0)) {
            Some(s) => heaviest = heaviest.max(brdf.eval_cos(wo, s.wi).x / s.pdf),
            None => lost += 1,
        }
    }
    assert!(heaviest > 1e-4 && heaviest < 1e-1, "{heaviest}");
    assert!(lost < 100, "{lost}");
}
