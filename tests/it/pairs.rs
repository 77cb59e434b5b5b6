//! Many pairs at once: every sampler gives what single calls give, to the bit, at every difficult place.

use crate::support;
use std::sync::Arc;

use crate::support::anisotropic::{Brushed, Resolution, bsdf_of};
use glam::{Vec2, Vec3};
use merlkit::brdf::Brdf;
use merlkit::direction_sampler::{DirectionSample, DirectionSampler};
use merlkit::geometry::Symmetry;
use merlkit::material::analytic::Lambert;
use merlkit::material::merl::decode_embedded;
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit::material::rgl::RglBrdf;
use merlkit::points::{PointSet, Stream};
use merlkit::sampler::{
    ByAzimuth, ByAzimuthSettings, FactoredSettings, HalfVectorSettings, LobeKind, LobeSettings,
    SamplerSpec,
};
use merlkit_evaluate::measure::hard::hard_samplers;

const PAIRS: usize = 10_000;

/// Pairs of all kinds, with other lengths, and directions on, at and below the horizon and none at all between them.
fn difficult_pairs() -> (Vec<Vec3>, Vec<Vec3>) {
    let special = [
        Vec3::Z,
        Vec3::NEG_Z,
        Vec3::X,
        -Vec3::Y,
        Vec3::ZERO,
        Vec3::NAN,
        Vec3::INFINITY,
        Vec3::new(0.3, f32::NAN, 0.5),
        Vec3::new(-0.0, 1.0, 1e-45),
        Vec3::new(0.6, -0.0, -0.8),
        Vec3::new(0.6, 0.8, 1e-9),
        Vec3::new(1e-40, -1e-45, 1.0),
        Vec3::splat(f32::MAX),
    ];
    let mut random = Stream::new(7);
    let mut odd = |k: usize, w: Vec3| match k % 200 {
        3 => special[random.next_u64() as usize % special.len()],
        17 => w * 1.5f32.powi((random.next_f64() * 200.0) as i32 - 100),
        41 => Vec3::new(w.x, w.y, -w.z),
        _ => w,
    };
    // The first few batches are of ordinary directions alone; elsewhere both, one or none are odd.
    let pair = |(k, (wo, wi)): (usize, (Vec3, Vec3))| {
        if k < 200 {
            (wo, wi)
        } else {
            (odd(k, wo), odd(k / 3, wi))
        }
    };
    support::pairs(PAIRS, 31).enumerate().map(pair).unzip()
}

fn points() -> Vec<Vec2> {
    let corner = |k: u64| {
        [
            Vec2::ZERO,
            Vec2::splat(1f32.next_down()),
            Vec2::new(0.0, 0.5),
        ][k as usize % 3]
    };
    let point = |k: u64| {
        if k % 97 == 5 {
            corner(k)
        } else {
            PointSet::Random.point(11, k, 0)
        }
    };
    (0..PAIRS as u64).map(point).collect()
}

fn bits(sample: Option<DirectionSample>) -> Option<[u32; 4]> {
    sample.map(|s| [s.wi.x, s.wi.y, s.wi.z, s.pdf].map(f32::to_bits))
}

/// Batches of 1, 2, 3, … pairs.
fn batches() -> impl Iterator<Item = std::ops::Range<usize>> {
    (1..).scan(0, |start, length| {
        let batch = *start..(*start + length).min(PAIRS);
        *start = batch.end;
        (!batch.is_empty()).then_some(batch)
    })
}

fn assert_same(name: &str, sampler: &dyn DirectionSampler) {
    let ((wo, wi), points) = (difficult_pairs(), points());
    let (mut drawn, mut pdfs) = (vec![None; PAIRS], vec![f32::NAN; PAIRS]);
    for batch in batches() {
        sampler.sample_pairs(
            &wo[batch.clone()],
            &points[batch.clone()],
            &mut drawn[batch.clone()],
        );
        sampler.pdf_pairs(&wo[batch.clone()], &wi[batch.clone()], &mut pdfs[batch]);
    }
    let (mut draws, mut densities) = (0, 0);
    for k in 0..PAIRS {
        let (wo, wi) = (wo[k], wi[k]);
        assert_eq!(
            bits(drawn[k]),
            bits(sampler.sample(wo, points[k])),
            "{name} {wo} {}",
            points[k]
        );
        assert_eq!(
            pdfs[k].to_bits(),
            sampler.pdf(wo, wi).to_bits(),
            "{name} {wo} {wi}"
        );
        draws += usize::from(drawn[k].is_some());
        densities += usize::from(pdfs[k] > 0.0);
    }
    // Most pairs are ordinary ones; lobes may have no density at some, and some samplers lose draws.
    assert!((PAIRS / 2..PAIRS - 20).contains(&draws), "{name}: {draws}");
    assert!(
        (PAIRS / 10..PAIRS - 20).contains(&densities),
        "{name}: {densities}"
    );
}

fn isotropic_samplers() -> Vec<(String, SamplerSpec)> {
    let half_vector = HalfVectorSettings::PRESETS.iter().map(|&(size, settings)| {
        (
            format!("half-vector {size}"),
            SamplerSpec::HalfVector(settings),
        )
    });
    let hard = hard_samplers()
        .into_iter()
        .map(|hard| (hard.name.to_owned(), hard.spec));
    let fitted = [
        (
            "lobe".to_owned(),
            SamplerSpec::Lobe(LobeSettings::fitted(LobeKind::Ggx)),
        ),
        (
            "factored".to_owned(),
            SamplerSpec::Factored(FactoredSettings::default()),
        ),
    ];
    half_vector.chain(hard).chain(fitted).collect()
}

#[test]
fn every_isotropic_sampler_gives_the_bits_of_single_calls() {
    let table = decode_embedded("nickel").unwrap();
    let brdf = Arc::new(MerlBrdf::new(Arc::new(table), LookupRule::Floor));
    for (name, spec) in isotropic_samplers() {
        assert_same(&name, &spec.build(&brdf).unwrap());
    }
}

#[test]
fn every_brdf_times_the_cosine_gives_the_bits_of_single_calls() {
    let table = Arc::new(decode_embedded("nickel").unwrap());
    let measured = LookupRule::ALL.map(|rule| MerlBrdf::new(table.clone(), rule));
    let file = RglBrdf::new(bsdf_of(
        &Brushed::STRONG,
        Symmetry::Quarter,
        Resolution::COARSE,
    ));
    let lambert = Lambert {
        reflectance: Vec3::splat(0.5),
    };
    let (wo, wi) = difficult_pairs();
    let measured = measured.iter().map(|m| m as &dyn Brdf);
    for (i, brdf) in measured.chain([&file as &dyn Brdf, &lambert]).enumerate() {
        let mut values = vec![Vec3::NAN; PAIRS];
        for batch in batches() {
            brdf.eval_cos_pairs(&wo[batch.clone()], &wi[batch.clone()], &mut values[batch]);
        }
        let bits = |v: Vec3| v.to_array().map(f32::to_bits);
        for (k, value) in values.iter().enumerate() {
            assert_eq!(
                bits(*value),
                bits(brdf.eval_cos(wo[k], wi[k])),
                "{i} {} {}",
                wo[k],
                wi[k]
            );
        }
        assert!(
            values.iter().filter(|v| v.x > 0.0).count() > PAIRS / 10,
            "{i}"
        );
    }
}

#[test]
fn every_anisotropic_sampler_gives_the_bits_of_single_calls() {
    let file = RglBrdf::new(bsdf_of(
        &Brushed::STRONG,
        Symmetry::Quarter,
        Resolution::COARSE,
    ));
    let table = ByAzimuthSettings::of(HalfVectorSettings::PRESETS[0].1);
    assert_same("by azimuth", &ByAzimuth::build(&file, table).unwrap());
    assert_same("file", &file);
}

#[test]
fn slices_of_unequal_lengths_fill_as_many_as_the_shortest_holds() {
    let brdf = MerlBrdf::new(
        Arc::new(decode_embedded("nickel").unwrap()),
        LookupRule::Floor,
    );
    let brdf = Arc::new(brdf);
    let ((wo, wi), points) = (difficult_pairs(), points());
    let untouched = Some(DirectionSample {
        wi: Vec3::NEG_Z,
        pdf: -1.0,
    });
    for spec in [
        SamplerSpec::HalfVector(HalfVectorSettings::PRESETS[0].1),
        SamplerSpec::Cosine,
    ] {
        let sampler = spec.build(&brdf).unwrap();
        for (views, given, wanted) in [
            (0, 5, 5),
            (5, 0, 5),
            (5, 5, 0),
            (7, 200, 90),
            (63, 64, 65),
            (130, 129, 128),
            (64, 64, 64),
        ] {
            let count = views.min(given).min(wanted);
            let mut drawn = vec![untouched; wanted];
            sampler.sample_pairs(&wo[..views], &points[..given], &mut drawn);
            let mut pdfs = vec![-1.0; wanted];
            sampler.pdf_pairs(&wo[..views], &wi[..given], &mut pdfs);
            for k in 0..wanted {
                let (sample, pdf) = match k < count {
                    true => (sampler.sample(wo[k], points[k]), sampler.pdf(wo[k], wi[k])),
                    false => (untouched, -1.0),
                };
                assert_eq!(
                    (drawn[k], pdfs[k]),
                    (sample, pdf),
                    "{views} {given} {wanted} {k}"
                );
            }
        }
    }
}
