//! f32 and f64 arithmetic against oracles in f64 and in compensated sums.

use std::f64::consts::FRAC_1_PI;
use std::ops::Range;
use std::sync::{Arc, LazyLock};

use glam::{DVec3, Vec3};
use merlkit::brdf::Brdf;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::distribution::{Curves, Piecewise2d, WHOLE};
use merlkit::geometry::{Quadrature, half_vector, spherical};
use merlkit::light::{EnvironmentSource, LightSpec};
use merlkit::material::Material;
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::points::{PointSet, Stream};
use merlkit::render::{Budget, PlanRequest, RenderSettings, Scene, SceneSpec, render};
use merlkit::sampler::store::encode;
use merlkit::sampler::{Cosine, HalfVectorSettings, HalfVectorTable, SamplerSpec};

use crate::support::half_vector_oracle::Oracle;
use crate::support::precise::{Exact, ulp};
use crate::support::{naive, noise_table, pairs};

/// What was compared, its largest errors, and the bound.
pub struct Row {
    pub what: &'static str,
    pub ulp: f64,
    pub relative: f64,
    pub bound: f64,
}

/// All rows, computed once.
pub static TABLE: LazyLock<Vec<Row>> = LazyLock::new(|| {
    let mut rows = vec![
        eval(
            "eval, linear, to the spread of its neighbours",
            LookupRule::Linear,
        ),
        eval(
            "eval, centred, to the spread of its neighbours",
            LookupRule::Centred,
        ),
        cosine_pdf(),
        half_vector_integral(),
        half_vector_pdf(
            "pdf, half-vector, wo and wi above 5°",
            5.0..90.0,
            0.05..90.0,
            1e-4,
        ),
        half_vector_pdf("… the lower at 0.5° to 5°", 0.5..5.0, 0.05..90.0, 5e-3),
        half_vector_pdf("… the lower at 0.05° to 0.5°", 0.05..0.5, 0.05..90.0, 0.2),
        half_vector_pdf(
            "… above 5°, θh below 0.05°, where its azimuth is rounding",
            5.0..90.0,
            0.0..0.05,
            0.4,
        ),
        cdf_sums(),
        curves(),
        constant_pixel(),
    ];
    rows.extend(accumulation());
    rows
});

/// On noise between 0 and 4 a coordinate's error of 10⁻⁶ bins is an error of 4·10⁻⁶ in f, whatever f is.
fn eval(what: &'static str, rule: LookupRule) -> Row {
    let table = Arc::new(noise_table(180, 0, 3));
    let brdf = MerlBrdf::new(table.clone(), rule);
    let mut row = Row {
        what,
        ulp: 0.0,
        relative: 0.0,
        bound: 2e-5,
    };
    for (wo, wi) in pairs(200_000, 5) {
        let (exact, weight) = naive::eval(&table, rule, wo, wi);
        // Within rounding of the half vector's azimuth being undefined, neighbours in phi_d are any.
        let steep = half_vector(wo.as_dvec3(), wi.as_dvec3()).is_none_or(|h| h.x.hypot(h.y) < 1e-5);
        if weight == 0.0 || steep || (wo - wi).length() < 1e-5 {
            continue;
        }
        let found = brdf.eval(wo, wi);
        for channel in 0..3 {
            row.ulp = row.ulp.max(
                ulp(found[channel], exact[channel].max(1.0)).min(f64::MAX)
                    * f64::from(u8::from(exact[channel] >= 1.0)),
            );
            row.relative = row
                .relative
                .max((f64::from(found[channel]) - exact[channel]).abs() / 4.0);
        }
    }
    row
}

fn cosine_pdf() -> Row {
    let mut row = Row {
        what: "pdf, cosine",
        ulp: 0.0,
        relative: 0.0,
        bound: 2e-7,
    };
    for (wo, wi) in pairs(100_000, 6).filter(|(wo, wi)| wo.z > 0.0 && wi.z > 1e-30) {
        let exact = f64::from(wi.z) * FRAC_1_PI;
        let found = Cosine.pdf(wo, wi);
        row.ulp = row.ulp.max(ulp(found, exact));
        row.relative = row.relative.max((f64::from(found) / exact - 1.0).abs());
    }
    row
}

/// The default half-vector table of nickel, and the same in f64.
static NICKEL: LazyLock<(HalfVectorTable, Oracle)> = LazyLock::new(|| {
    let material = Material::resolve("nickel").unwrap();
    let loaded = material.load(LookupRule::Floor).unwrap();
    let settings = HalfVectorSettings::default();
    let sampler = HalfVectorTable::build(&**loaded.brdf(), settings).unwrap();
    let stored = SamplerSpec::new(settings).build(&loaded).unwrap();
    let file = encode(&stored, &material).unwrap();
    (sampler, Oracle::new(&file, settings.fold))
});

/// The half-vector table computes in f32, in which directions near the horizon and half vectors near the normal lose digits.
/// Where the half vector is within 10⁻⁵ of the edge of a row, either row's density is right.
fn half_vector_pdf(
    what: &'static str,
    elevation: Range<f64>,
    theta_h: Range<f64>,
    bound: f64,
) -> Row {
    let (sampler, oracle) = &*NICKEL;
    let mut row = Row {
        what,
        ulp: 0.0,
        relative: 0.0,
        bound,
    };
    for (wo, wi) in pairs(400_000, 7) {
        let (wo64, wi64) = (wo.as_dvec3(), wi.as_dvec3());
        let lower = wo64.z.min(wi64.z).asin().to_degrees();
        let tilt = half_vector(wo64, wi64).map_or(0.0, |h| h.x.hypot(h.y).asin().to_degrees());
        if !elevation.contains(&lower) || !theta_h.contains(&tilt) {
            continue;
        }
        let (exact, from_edge) = oracle.pdf(wo64, wi64);
        if from_edge > 1e-5 {
            let found = sampler.pdf(wo, wi);
            row.ulp = row.ulp.max(ulp(found, exact));
            row.relative = row.relative.max((f64::from(found) / exact - 1.0).abs());
        }
    }
    row
}

/// The same in whole: ∫ pdf = 1.
fn half_vector_integral() -> Row {
    let (sampler, _) = &*NICKEL;
    let integral = |degrees: f64| {
        let wo = spherical(degrees.to_radians(), 0.3).as_vec3();
        Quadrature::new(wo, 987).integrate(|wi| f64::from(sampler.pdf(wo, wi)))
    };
    let relative = [0.0, 20.0, 45.0, 70.0, 85.0]
        .map(|d| (integral(d) - 1.0).abs())
        .into_iter()
        .fold(0.0, f64::max);
    Row {
        what: "pdf, half-vector, its integral",
        ulp: relative / f64::from(f32::EPSILON),
        relative,
        bound: 5e-4,
    }
}

/// Masses of a million cells over twenty orders of magnitude.
fn cdf_sums() -> Row {
    let mut random = Stream::new(8);
    let weights: Vec<f64> = (0..1000 * 1000)
        .map(|_| 10f64.powf(20.0 * random.next_f64()))
        .collect();
    let density = Piecewise2d::new(1000, 1000, &weights).unwrap();
    let mut total = Exact::default();
    weights.iter().for_each(|&w| total.add(w));
    let mut row = Row {
        what: "CDF sums in f64, 10⁶ cells over 20 decades, of the whole",
        ulp: 0.0,
        relative: 0.0,
        bound: 1e-12,
    };
    for (i, w) in weights.iter().enumerate() {
        let (exact, found) = (w / total.value(), density.mass(i % 1000, i / 1000));
        row.relative = row.relative.max((found - exact).abs());
    }
    row.ulp = row.relative / f64::from(f32::EPSILON);
    row
}

/// 16-bit curves, whose density is the derivative of what is stored.
fn curves() -> Row {
    let mut random = Stream::new(9);
    let (mut sum, mut exact) = (0.0, Exact::default());
    let mut cumulated = vec![0.0];
    let mut precise = vec![0.0];
    for _ in 0..8192 {
        let w = 10f64.powf(4.0 * random.next_f64());
        sum += w;
        exact.add(w);
        cumulated.push(sum);
        precise.push(exact.value());
    }
    let mut curves = Curves::new();
    curves.push(&cumulated, None);
    let relative = precise
        .iter()
        .zip(&curves.cdf)
        .fold(0.0, |worst: f64, (p, &c)| {
            worst.max((f64::from(c) / f64::from(WHOLE) - p / exact.value()).abs())
        });
    Row {
        what: "CDF curves of 8192 cells in 16 bits, of the whole",
        ulp: relative / f64::from(f32::EPSILON),
        relative,
        bound: 0.13,
    }
}

/// A picture of nothing but a uniform sky: every sample is the same but for the rounding of the sky's f32 interpolation.
fn constant_pixel() -> Row {
    let radiance = Vec3::new(0.1, 1e-30, 3e37);
    let row = SceneSpec::row(&["none".into()], 1.0);
    let lights = vec![LightSpec::Environment(EnvironmentSource::Uniform(radiance))];
    let spec = SceneSpec {
        spheres: Vec::new(),
        materials: Vec::new(),
        lights,
        ..row
    };
    let scene = Scene::build(&spec, PlanRequest::AsNeeded, |_, _| unreachable!()).unwrap();
    let settings = RenderSettings {
        width: 1,
        height: 1,
        seed: 1,
        points: PointSet::Random,
        budget: Budget::Even(1 << 22),
    };
    let film = render(&scene, &settings, &|_| {}).unwrap().film;
    let relative = (film.mean(0, 0) / radiance.as_dvec3() - DVec3::ONE)
        .abs()
        .max_element();
    let image = film.to_image().unwrap().pixel(0, 0);
    let ulp = (0..3)
        .map(|c| ulp(image[c], radiance[c].into()))
        .fold(0.0, f64::max);
    Row {
        what: "pixel of 4·10⁶ samples of a uniform sky, rendered",
        ulp,
        relative,
        bound: 1e-9,
    }
}

/// The film's running mean (Welford), from sample `first` on: what was before is exact.
fn running_mean(first: u64, count: u64, sample: impl Fn(u64) -> f64) -> (f64, f64) {
    let (mut before, mut after) = (Exact::default(), Exact::default());
    // A period of the samples stands for all before.
    for i in 0..PERIOD {
        before.add(sample(i) / PERIOD as f64);
    }
    let mut mean = if first == 0 { 0.0 } else { before.value() };
    for i in first..first + count {
        mean += (sample(i % PERIOD) - mean) / (i + 1) as f64;
        after.add(sample(i % PERIOD));
    }
    (
        mean,
        (before.value() * first as f64 + after.value()) / (first + count) as f64,
    )
}

/// What sample `i` adds to a pixel.
type Samples<'a> = &'a dyn Fn(u64) -> f64;

const PERIOD: u64 = 1_000_000;

/// Ten million samples from the first, and ten million from sample 10⁹ on.
fn accumulation() -> Vec<Row> {
    let noise = |i: u64| PointSet::Random.point(3, i % 4096, 0).x.into();
    let samples: [(_, _, Samples); 3] = [
        (
            "running mean of 10⁷ equal samples",
            "the same at sample 10⁹",
            &|_| 0.1,
        ),
        ("… of 10⁷ noisy samples", "the same at sample 10⁹ ", &noise),
        (
            "… of 10⁷ samples, one in 10⁶ a spike of 10¹²",
            "the same at sample 10⁹  ",
            &|i| {
                if i % PERIOD == 777_777 { 1e12 } else { 1e-3 }
            },
        ),
    ];
    let mut rows = Vec::new();
    for (what, late, sample) in samples {
        for (what, first) in [(what, 0), (late, 1_000_000_000)] {
            let (found, exact) = running_mean(first, 10 * PERIOD, sample);
            let relative = (found / exact - 1.0).abs();
            rows.push(Row {
                what,
                ulp: relative / f64::from(f32::EPSILON),
                relative,
                bound: 1e-8,
            });
        }
    }
    rows
}

#[test]
fn errors_stay_below_their_bounds() {
    for row in TABLE.iter() {
        assert!(
            row.relative <= row.bound,
            "{}: {:.2e}, {:.2} ulp",
            row.what,
            row.relative,
            row.ulp
        );
    }
}
