//! Anisotropic materials: their samplers, checked as all others, and the commands that take them.

use crate::support;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use crate::support::anisotropic::{Brushed, Resolution, bsdf_of, directions};
use glam::{Quat, Vec2, Vec3};
use merlkit::brdf::{Brdf, Importance};
use merlkit::color::Rgb;
use merlkit::direction_sampler::{DirectionSample, DirectionSampler};
use merlkit::files::Overwrite;
use merlkit::geometry::{Quadrature, Symmetry, spherical};
use merlkit::material::Loaded;
use merlkit::material::Material;
use merlkit::material::merl::decode_embedded;
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::material::rgl::{Colour, RglBrdf, Tensor};
use merlkit::points::Stream;
use merlkit::sampler::store::{SamplerFile, save};
use merlkit::sampler::{ByAzimuth, Cosine, HalfVectorSettings, OwnSamplerSettings, SamplerSpec};
use merlkit::{Error, Wo};
use merlkit_evaluate::measure::accuracy::weight_spread;
use merlkit_evaluate::measure::check::{Check, CheckSettings, check_sampler};

const SYMMETRIES: [Symmetry; 3] = [Symmetry::Quarter, Symmetry::Half, Symmetry::Whole];

/// Metals that have no more symmetry than their file says.
fn metal(symmetry: Symmetry) -> Brushed {
    let turned = if symmetry == Symmetry::Quarter {
        0.0
    } else {
        0.5
    };
    Brushed {
        turned,
        ..Brushed::STRONG
    }
}

fn file(symmetry: Symmetry) -> RglBrdf {
    RglBrdf::new(bsdf_of(&metal(symmetry), symmetry, Resolution::COARSE))
}

fn settings(azimuths: usize, size: &str) -> HalfVectorSettings {
    HalfVectorSettings {
        azimuths: Some(azimuths),
        ..support::half_vector_preset(size)
    }
}

/// The seven checks of `merlkit check`, on the azimuths of tables, between them and at the seams of symmetries.
#[test]
fn every_check_passes_for_every_symmetry() {
    let on_tables = [0.25, 0.5, 1.0].map(|share| spherical(0.9, -PI + share * FRAC_PI_2).as_vec3());
    let others = directions().into_iter().step_by(3);
    let wos: Vec<Vec3> = on_tables.into_iter().chain(others).collect();
    let settings_of = CheckSettings {
        draws: 20_000,
        calls: 4,
        ..CheckSettings::default()
    };
    for symmetry in SYMMETRIES {
        let rgl = file(symmetry);
        assert_eq!(Brdf::symmetry(&rgl), symmetry);
        let few = if symmetry == Symmetry::Half {
            &[2, 5][..]
        } else {
            &[5]
        };
        for settings in few.iter().map(|&azimuths| settings(azimuths, "16KB")) {
            let sampler = ByAzimuth::build(&rgl, settings).unwrap();
            let report = check_sampler(&sampler, &rgl, &wos, &settings_of);
            let failures: Vec<_> = report.failures().collect();
            assert!(
                failures.is_empty(),
                "{symmetry:?} {settings:?}: {failures:?}"
            );
        }
    }
}

/// Without turning half vectors back, the density is that of other draws.
#[test]
fn a_wrong_density_is_rejected() {
    struct Astray(ByAzimuth);
    impl DirectionSampler for Astray {
        fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
            let wi = self.0.sample(wo, u)?.wi;
            Some(DirectionSample {
                wi,
                pdf: self.pdf(wo, wi),
            })
        }
        fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
            let turn = Quat::from_rotation_z(0.05);
            self.0.pdf(turn * wo, turn * wi)
        }
        fn bytes(&self) -> usize {
            0
        }
    }
    let rgl = file(Symmetry::Half);
    let astray = Astray(ByAzimuth::build(&rgl, settings(4, "16KB")).unwrap());
    let wos = [spherical(0.6, -1.0).as_vec3()];
    let report = check_sampler(&astray, &rgl, &wos, &CheckSettings::default());
    assert!(
        report.failures().any(|o| o.check == Check::ChiSquare),
        "{report:?}"
    );
}

/// Mean over directions of the relative standard deviation of a weight, and the largest.
fn spreads(sampler: &dyn DirectionSampler, brdf: &dyn Brdf, azimuths: &[f64]) -> (f64, f64) {
    let mut all = Vec::new();
    for theta in [14.5, 45.0, 60.25, 75.5] {
        for &phi in azimuths {
            let quadrature = Quadrature::new(spherical(f64::to_radians(theta), phi).as_vec3(), 377);
            let spread = weight_spread(sampler, brdf, &quadrature, Importance::Mean);
            assert!(spread.holes == 0.0, "{theta}° {phi}: {spread:?}");
            all.push(spread.relstd);
        }
    }
    (
        all.iter().sum::<f64>() / all.len() as f64,
        all.into_iter().fold(0.0, f64::max),
    )
}

#[test]
fn tables_follow_a_brushed_metal() {
    let rgl = RglBrdf::new(bsdf_of(
        &metal(Symmetry::Half),
        Symmetry::Half,
        Resolution::FINE,
    ));
    let sampler = ByAzimuth::build(&rgl, HalfVectorSettings::default()).unwrap();
    let azimuths = [-3.0, -1.4, 0.4];
    let of = |s: &dyn DirectionSampler| spreads(s, &rgl, &azimuths);
    let (cosine, own, tables) = (of(&Cosine), of(&rgl), of(&sampler));
    println!(
        "cosine {cosine:.3?}, file {own:.3?}, half-vector {tables:.3?}, {} bytes",
        sampler.bytes()
    );
    assert!(
        tables.0 < 0.2 && tables.1 < 0.5 && tables.0 < 0.05 * cosine.0,
        "{cosine:?} {tables:?}"
    );
    assert!(
        own.0 < tables.0,
        "the file, of ten times the bytes, draws as it evaluates: {own:?}"
    );
}

/// What a file repeats is drawn and weighted alike, to the bit.
#[test]
fn symmetries_are_kept() {
    let mirrors = [
        Vec3::new(-1.0, -1.0, 1.0),
        Vec3::new(-1.0, 1.0, 1.0),
        Vec3::new(1.0, -1.0, 1.0),
    ];
    for (symmetry, mirrors) in [
        (Symmetry::Half, &mirrors[..1]),
        (Symmetry::Quarter, &mirrors[..]),
    ] {
        let sampler = ByAzimuth::build(&file(symmetry), settings(3, "8KB")).unwrap();
        let mut random = Stream::new(5);
        for (wo, wi) in support::pairs(500, 3) {
            let u = Vec2::new(random.next_f32(), random.next_f32());
            let draw = sampler.sample(wo, u).unwrap();
            for &m in mirrors {
                assert_eq!(
                    sampler.pdf(wo, wi),
                    sampler.pdf(m * wo, m * wi),
                    "{wo} {wi} {m}"
                );
                let other = sampler.sample(m * wo, u).unwrap();
                assert_eq!((draw.wi, draw.pdf), (m * other.wi, other.pdf));
            }
        }
    }
}

/// An azimuth with a table, approached from both sides, and the seams of a symmetry.
#[test]
fn densities_are_continuous_over_the_azimuth() {
    let rgl = file(Symmetry::Half);
    let sampler = ByAzimuth::build(&rgl, settings(4, "16KB")).unwrap();
    let mut random = Stream::new(9);
    for knot in [-PI, -0.75 * PI, -0.25 * PI, 0.0, FRAC_PI_2, PI] {
        let mut jumps = 0;
        for _ in 0..500 {
            let (theta, u) = (
                0.2 + random.next_f64(),
                Vec2::new(random.next_f32(), random.next_f32()),
            );
            let at = |offset: f64| spherical(theta, knot + offset).as_vec3();
            let wi = sampler.sample(at(0.0), u).unwrap().wi;
            let [a, b] = [-1e-5, 1e-5].map(|o| sampler.pdf(at(o), wi));
            jumps += usize::from((a / b).ln().abs() > 0.01);
        }
        // Rows of a table jump, and few draws stand that near to one's end.
        assert!(jumps < 5, "{knot}: {jumps}");
    }
}

#[test]
fn odd_input_gives_nothing_and_extreme_input_something() {
    let sampler = ByAzimuth::build(&file(Symmetry::Whole), settings(2, "2KB")).unwrap();
    for w in [Vec3::NAN, Vec3::ZERO, -Vec3::Z, Vec3::X, Vec3::INFINITY] {
        assert_eq!(sampler.sample(w, Vec2::splat(0.5)), None);
        assert_eq!(
            (sampler.pdf(w, Vec3::Z), sampler.pdf(Vec3::Z, w)),
            (0.0, 0.0)
        );
        let untouched = DirectionSample {
            wi: Vec3::Z,
            pdf: 1.0,
        };
        let mut drawn = [Some(untouched); 3];
        sampler.sample_batch(Wo::One(w), &[Vec2::ZERO; 3], &mut drawn);
        assert_eq!(drawn, [None; 3]);
    }
    let last = 1f32.next_down();
    let tiny = [1e-20, 1e-13, 1e-7].map(|x| Vec3::new(-x, x, 1.0));
    for wo in directions()
        .into_iter()
        .chain(tiny)
        .chain([Vec3::Z * 7.0, Vec3::new(1.0, 0.0, 1e-9)])
    {
        let corners = [
            (0.0, 0.0),
            (last, 0.0),
            (0.0, last),
            (last, last),
            (0.5, 0.5),
        ];
        let corners = corners.map(|(x, y)| Vec2::new(x, y));
        let mut batch = [None; 5];
        sampler.sample_batch(Wo::One(wo), &corners, &mut batch);
        for (u, drawn) in corners.iter().zip(batch) {
            let draw = sampler.sample(wo, *u).unwrap();
            assert_eq!(drawn, Some(draw));
            assert!(
                draw.wi.is_normalized() && draw.wi.z > 0.0,
                "{wo} {u}: {draw:?}"
            );
            assert!(draw.pdf > 0.0 && draw.pdf.is_finite(), "{wo} {u}: {draw:?}");
            assert_eq!(sampler.pdf(wo, draw.wi), draw.pdf, "{wo} {u}");
        }
    }
}

/// Black, noise, and a file that is black about some azimuths.
#[test]
fn ugly_files_keep_every_check() {
    let mut ugly = bsdf_of(&metal(Symmetry::Half), Symmetry::Half, Resolution::COARSE);
    let slice = ugly.luminance.shape[1] * ugly.luminance.shape[2].pow(2);
    let Colour::Rgb(rgb) = &mut ugly.colour else {
        panic!()
    };
    rgb.values[3 * slice..9 * slice].fill(0.0);
    let mut random = Stream::new(3);
    rgb.values[12 * slice..]
        .iter_mut()
        .for_each(|v| *v *= random.next_f32().powi(8) * 50.0);
    let mut black = ugly.clone();
    black.colour = Colour::Rgb(Tensor::filled(&[5, 6, 3, 16, 16], 0.0));
    let wos: Vec<Vec3> = directions().into_iter().step_by(2).collect();
    let checks = CheckSettings {
        draws: 5000,
        calls: 2,
        ..CheckSettings::default()
    };
    for rgl in [ugly, black].map(RglBrdf::new) {
        let sampler = ByAzimuth::build(&rgl, settings(3, "4KB")).unwrap();
        let report = check_sampler(&sampler, &rgl, &wos, &checks);
        assert!(report.pass(), "{:?}", report.failures().collect::<Vec<_>>());
    }
}

#[test]
fn any_number_of_threads_builds_the_same() {
    let rgl = file(Symmetry::Half);
    let draws = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let sampler = pool.install(|| ByAzimuth::build(&rgl, settings(5, "8KB")).unwrap());
        let mut random = Stream::new(1);
        let draw = |wo| {
            sampler
                .sample(wo, Vec2::new(random.next_f32(), random.next_f32()))
                .unwrap()
        };
        directions()
            .into_iter()
            .map(draw)
            .map(|d| (d.wi, d.pdf))
            .collect::<Vec<_>>()
    };
    assert_eq!(draws(1), draws(3));
}

/// A file of tables brings back the sampler; damaged, or with another material, an error.
#[test]
fn tables_come_back_from_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let (bsdf, path) = (
        folder.path().join("brushed.bsdf"),
        folder.path().join("tables"),
    );
    let symmetry = Symmetry::Quarter;
    bsdf_of(&metal(symmetry), symmetry, Resolution::COARSE)
        .write(&bsdf, Overwrite::Refuse)
        .unwrap();
    let material = Material::resolve(bsdf.to_str().unwrap()).unwrap();
    let brdf = material.load(LookupRule::Floor).unwrap();
    let sampler = SamplerSpec::new(settings(3, "2KB")).build(&brdf).unwrap();
    save(&sampler, &material, &path, Overwrite::Refuse).unwrap();
    let (loaded, _) = SamplerFile::open(&path).unwrap().load(None).unwrap();
    assert_eq!(loaded.spec(), sampler.spec());
    for (i, wo) in directions().into_iter().enumerate() {
        let u = Vec2::new(0.37, i as f32 / 30.0);
        assert_eq!(loaded.sample(wo, u), sampler.sample(wo, u));
    }
    // Settings are JSON within JSON.
    for (setting, to, says) in [
        (r#"azimuths\":3"#, b'4', "12 values in tensor"),
        (r#"azimuths\":3"#, b'1', "2 to 256"),
        (r#"tables\":3"#, b'2', "6 values in tensor"),
    ] {
        let mut bytes = std::fs::read(&path).unwrap();
        let at = bytes
            .windows(setting.len())
            .position(|w| w == setting.as_bytes())
            .unwrap();
        bytes[at + setting.len() - 1] = to;
        let loaded = SamplerFile::from_bytes(bytes, &path).and_then(|f| f.load(None));
        let text = loaded.unwrap_err().to_string();
        assert!(text.contains(says), "{says}: {text}");
    }
    let own = SamplerSpec::new(OwnSamplerSettings {})
        .build(&brdf)
        .unwrap();
    assert!(save(&own, &material, &path, Overwrite::Replace).is_err());
    let table = Arc::new(MerlBrdf::new(
        Arc::new(decode_embedded("nickel").unwrap()),
        LookupRule::Floor,
    ));
    assert!(
        SamplerFile::open(&path)
            .unwrap()
            .into_sampler(&Loaded::from_table(table))
            .is_err()
    );
}

#[test]
fn bytes_are_those_of_all_tables() {
    let sampler = ByAzimuth::build(&file(Symmetry::Half), settings(3, "8KB")).unwrap();
    assert_eq!(sampler.bytes(), 3 * sampler.settings().bytes());
    let rgl = file(Symmetry::Half);
    assert!(DirectionSampler::bytes(&rgl) < rgl.table_bytes());
}

#[test]
fn what_does_not_fit_is_refused() {
    struct Grey;
    impl Brdf for Grey {
        fn eval(&self, _: Vec3, _: Vec3) -> Rgb {
            Rgb::ONE
        }
        fn is_isotropic(&self) -> bool {
            true
        }
    }
    let refused = |e: Error| matches!(e, Error::Argument { .. });
    assert!(refused(
        ByAzimuth::build(&Grey, settings(4, "2KB")).unwrap_err()
    ));
    let rgl = file(Symmetry::Half);
    for azimuths in [0, 1, 257] {
        assert!(refused(
            ByAzimuth::build(&rgl, settings(azimuths, "2KB")).unwrap_err()
        ));
    }
    let no_rows = HalfVectorSettings {
        rows: 0,
        ..HalfVectorSettings::default()
    };
    assert!(refused(ByAzimuth::build(&rgl, no_rows).unwrap_err()));
    let brdf = {
        let rgl = Arc::new(rgl);
        Loaded::from_brdf(rgl.clone()).with_own_sampler(rgl)
    };
    let (_, preset) = HalfVectorSettings::PRESETS[0];
    let built = SamplerSpec::new(preset).build(&brdf).unwrap();
    assert_eq!(built.spec().to_string(), "half-vector:2KB");
    let fitted = built.fitted();
    assert_eq!(
        fitted.settings(),
        Some(&HalfVectorSettings {
            tables: 3,
            rows: 18,
            segments: 9,
            fold: false,
            azimuths: Some(8),
            ..preset
        })
    );
    // What was fitted builds the same again.
    let again = fitted.build(&brdf).unwrap();
    assert_eq!(again.fitted(), fitted);
    let (wo, u) = (spherical(0.7, 0.3).as_vec3(), Vec2::new(0.2, 0.6));
    assert_eq!(again.sample(wo, u), built.sample(wo, u));
}
