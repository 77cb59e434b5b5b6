//! Every sampler takes every BRDF: models without tables, without bounds, and with a preferred direction on the surface.

use glam::{Vec2, Vec3};
use merlkit::brdf::Importance;
use merlkit::geometry::{Quadrature, Symmetry, spherical};
use merlkit::material::analytic::ModelFacts;
use merlkit::material::{Loaded, LookupRule, Material};
use merlkit::points::PointSet;
use merlkit::sampler::store::{SamplerFile, encode};
use merlkit::sampler::{AdaptiveDisc, Sampler, SamplerSpec};
use merlkit_evaluate::measure::accuracy::weight_spread;
use merlkit_evaluate::measure::check::{CheckSettings, check_sampler};
use std::path::Path;

fn load(text: &str) -> Loaded {
    let material = Material::resolve(text).unwrap();
    material.load(LookupRule::Floor).unwrap()
}

fn build(text: &str, material: &Loaded) -> Sampler {
    let spec: SamplerSpec = text.parse().unwrap();
    spec.build(material).unwrap()
}

/// Directions between the tables, at azimuths on both sides of every mirror.
fn directions() -> [Vec3; 4] {
    [[7.0, 31.0], [33.0, 100.0], [61.0, -47.0], [82.0, -160.0]]
        .map(|[theta, phi]: [f64; 2]| spherical(theta.to_radians(), phi.to_radians()).as_vec3())
}

/// Small tables, so that the whole list takes seconds.
const SAMPLERS: [&str; 10] = [
    "adaptive-disc:tables=6",
    "adaptive-disc:tables=6,leaves=integral",
    "adaptive-disc:tables=6,rejection-free",
    "adaptive-disc:tables=5,nearest,carry=direction",
    "cascade-cdf:tables=6,cells=90x32",
    "cascade-cdf:tables=6,cells=90x32,nearest,tolerance=none",
    "factored:tables=6,factors=2x2/32x16/half-vector/0.1",
    "factored:tables=6,factors=2x1/32x16/wi/0.1",
    "lobe:ggx,parameters=0.3/0.3/0.2",
    "half-vector:tables=6",
];

/// Bounded and not, wide and narrow, isotropic and not.
const MODELS: [&str; 6] = [
    "oren",
    "minnaert:k=0.5",
    "phong:n=1000",
    "ward:sx=0.1,sy=0.4,ks=0.5,kd=0.1",
    "beardmaxwell",
    "ashikhmin:ex=10,ey=200",
];

#[test]
fn every_sampler_passes_on_models() {
    for (number, model) in MODELS.into_iter().enumerate() {
        let material = load(model);
        for (k, sampler) in SAMPLERS.into_iter().enumerate() {
            // Each model meets every other sampler, and each sampler half of the models.
            if (number + k) % 2 == 1 {
                continue;
            }
            let settings = CheckSettings {
                draws: 10_000,
                seed: (10 * number + k) as u64,
                calls: MODELS.len() * SAMPLERS.len() / 2,
                ..CheckSettings::default()
            };
            let built = build(sampler, &material);
            let report = check_sampler(&*built, &**material.brdf(), &directions(), &settings);
            let failures: Vec<_> = report.failures().collect();
            assert!(failures.is_empty(), "{model}, {sampler}: {failures:#?}");
        }
    }
}

/// One setting of each kind of sampler, with few tables.
const KINDS: [&str; 6] = [
    "cosine",
    "half-vector:tables=3",
    "adaptive-disc:tables=3,depth=6",
    "cascade-cdf:tables=3,cells=64x16",
    "factored:tables=3,factors=2x2/32x16/half-vector/0.1",
    "lobe:blinn,parameters=20/20/0.3",
];

/// Every model of the catalogue with every kind of sampler: few draws of each, so that what is wrong by much is found.
#[test]
fn every_model_passes_with_every_kind_of_sampler() {
    let models = ModelFacts::all();
    let mut failures = Vec::new();
    for (number, model) in models.iter().enumerate() {
        let material = load(&model.material);
        for (k, sampler) in KINDS.into_iter().enumerate() {
            let settings = CheckSettings {
                draws: 2000,
                seed: (KINDS.len() * number + k) as u64,
                calls: models.len() * KINDS.len(),
                ..CheckSettings::default()
            };
            let built = build(sampler, &material);
            let report = check_sampler(&*built, &**material.brdf(), &directions()[1..3], &settings);
            for failure in report.failures() {
                failures.push(format!("{}, {sampler}: {failure:?}", model.material));
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

/// At a tree's own direction every weight is the tree's normaliser, which must be the albedo: a claim to 10⁻⁴ that draws would take
/// 10⁷ to refute.
#[test]
fn weights_at_a_direction_of_a_tree_are_the_albedo() {
    for (model, allowed) in [
        ("oren", 1e-4),
        ("minnaert:k=0.5", 2e-3),
        ("phong:n=1000", 2e-4),
        ("torrance", 2e-4),
    ] {
        let material = load(model);
        let sampler = build("adaptive-disc:tables=10,floor=0", &material);
        let wo = spherical(4.0 * std::f64::consts::FRAC_PI_2 / 9.0, 0.0).as_vec3();
        let brdf = material.brdf();
        let albedo = Quadrature::new(wo, 10_946).integrate(|wi| brdf.eval_cos(wo, wi).x.into());
        for u in [Vec2::new(0.37, 0.61), Vec2::new(0.81, 0.2)] {
            let draw = sampler.sample(wo, u).unwrap();
            let weight = f64::from(brdf.eval_cos(wo, draw.wi).x) / f64::from(draw.pdf);
            assert!(
                (weight / albedo - 1.0).abs() < allowed,
                "{model}: {weight}, {albedo}"
            );
        }
    }
}

/// What bounds do not hold is said, and little.
#[test]
fn discs_say_how_much_exceeds_their_bounds() {
    let excess = |model: &str, text: &str| {
        let sampler = build(text, &load(model));
        let disc = sampler.downcast::<AdaptiveDisc>().unwrap();
        assert!((1.0..4.0).contains(&disc.mean_trials()), "{model}");
        disc.largest_excess()
    };
    assert!(excess("lambert", "adaptive-disc:tables=4") < 1e-6);
    assert!(excess("phong:n=1000", "adaptive-disc:tables=4") < 1e-4);
    let unbounded = excess("beardmaxwell", "adaptive-disc:tables=4");
    assert!((1e-6..0.05).contains(&unbounded), "{unbounded}");
    assert_eq!(
        excess("beardmaxwell", "adaptive-disc:tables=4,rejection-free"),
        0.0
    );
    assert_eq!(excess("nickel", "adaptive-disc:tables=4"), 0.0);
}

/// Finer settings give more memory and fewer trials.
#[test]
fn smaller_n_max_costs_memory_and_saves_trials() {
    let material = load("phong:n=200");
    let mut last: Option<(usize, f64)> = None;
    for n_max in ["1.2", "2", "4"] {
        let sampler = build(&format!("adaptive-disc:tables=4,n-max={n_max}"), &material);
        let trials = sampler.downcast::<AdaptiveDisc>().unwrap().mean_trials();
        if let Some((bytes, fewer)) = last {
            assert!(sampler.bytes() < bytes && trials > fewer, "{n_max}");
        }
        last = Some((sampler.bytes(), trials));
    }
}

/// Streaks stay on the surface: tables at azimuths serve an anisotropic model far better than one azimuth could.
#[test]
fn azimuths_follow_streaks() {
    let text = "ward:sx=0.05,sy=0.3,ks=0.8,kd=0.05";
    let material = load(text);
    assert_eq!(material.symmetry(), Symmetry::Quarter);
    for (sampler, most) in [
        ("adaptive-disc:tables=10,azimuths=5", 1.2),
        ("cascade-cdf:tables=10,azimuths=5", 1.2),
        (
            "factored:tables=10,azimuths=5,factors=4x4/90x64/half-vector/0.05",
            1.5,
        ),
    ] {
        let built = build(sampler, &material);
        for wo in &directions()[..3] {
            let quadrature = Quadrature::new(*wo, 233);
            let spread = weight_spread(&*built, &**material.brdf(), &quadrature, Importance::Mean);
            assert!(spread.relstd < most, "{sampler} {wo}: {spread:?}");
        }
    }
}

/// A file gives back what was built, whatever the material is.
#[test]
fn samplers_of_models_come_back_from_their_files() {
    for model in ["minnaert:k=0.5", "ward"] {
        let material = Material::resolve(model).unwrap();
        let loaded = load(model);
        for text in [
            "adaptive-disc:tables=3",
            "adaptive-disc:tables=3,rejection-free",
            "cascade-cdf:tables=3,cells=64x16",
            "factored:tables=3,factors=1x2/16x8/half-vector/0.1",
            "lobe:ward,parameters=0.1/0.4/0.1,axes=surface",
        ] {
            let built = build(text, &loaded);
            let bytes = encode(&built, &material).unwrap();
            let file = SamplerFile::from_bytes(bytes, Path::new("stored")).unwrap();
            let read = file.into_sampler(&loaded).unwrap();
            assert_eq!(read.fitted(), built.fitted());
            for (index, wo) in directions().into_iter().enumerate() {
                let u = PointSet::Sobol.point(3, index as u64, 0);
                assert_eq!(read.sample(wo, u), built.sample(wo, u), "{model}, {text}");
            }
        }
    }
}

/// Lobes as the thesis has them: with no cosine, lost below the horizon or drawn again; along the surface's axes.
#[test]
fn lobes_have_the_density_that_they_claim() {
    for text in [
        "lobe:cosine,parameters=30/30/0",
        "lobe:cosine-hemisphere,parameters=30/30/0",
        "lobe:cosine-hemisphere,parameters=1/1/0",
        "lobe:ward,parameters=0.1/0.4/0",
        "lobe:ward,parameters=0.1/0.4/0,axes=surface",
        "lobe:ashikhmin-shirley,parameters=25/100/0,axes=surface",
    ] {
        let sampler = build(text, &load("ward"));
        for wo in directions() {
            let mass = Quadrature::new(wo, 2584).integrate(|wi| sampler.pdf(wo, wi).into());
            let draws = (0..20_000).map(|i| sampler.sample(wo, PointSet::Sobol.point(5, i, 0)));
            let lost = draws.filter(Option::is_none).count() as f64 / 20_000.0;
            assert!(
                (mass + lost - 1.0).abs() < 5e-3,
                "{text}, {wo}: {mass}, {lost} lost"
            );
            if text.contains("hemisphere") {
                assert_eq!(lost, 0.0, "{text}, {wo}");
            }
        }
    }
}
