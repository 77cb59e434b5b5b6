//! Batches: every BRDF and sampler gives what single calls give, to the bit, at every difficult place, for one `wo` or one in
//! each lane, and allocates nothing.

use crate::allocations::allocations;
use crate::support;
use crate::support::loaded;
use std::sync::Arc;

use crate::support::anisotropic::{Brushed, Resolution, bsdf_of};
use glam::{Vec2, Vec3};
use merlkit::Wo;
use merlkit::brdf::Brdf;
use merlkit::direction_sampler::{DirectionSample, DirectionSampler};
use merlkit::geometry::Symmetry;
use merlkit::material::merl::decode_embedded;
use merlkit::material::merl::{CellFormat, LookupRule, MerlBrdf};
use merlkit::material::rgl::{BsdfSize, RglBrdf, tabulate};
use merlkit::points::{PointSet, Stream};
use merlkit::sampler::{
    ByAzimuth, Cosine, FactoredSettings, HalfVectorSettings, HalfVectorTable, LobeKind,
    LobeSettings, SamplerSpec,
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

/// Batches of the lengths that end within, at and past the ends of blocks of 32 and 64 lanes, then of 1, 2, 3, … lanes.
fn ranges() -> impl Iterator<Item = std::ops::Range<usize>> {
    [0, 1, 31, 32, 33, 64, 200]
        .into_iter()
        .chain(1..)
        .scan(0, |start, length| {
            let range = *start..(*start + length).min(PAIRS);
            *start = range.end;
            (range.end < PAIRS || !range.is_empty()).then_some(range)
        })
}

/// Directions that are given to all lanes of a batch: ordinary, mirrored, of other lengths, at the horizon, and none.
fn given_directions() -> Vec<Vec3> {
    vec![
        Vec3::Z,
        Vec3::new(0.36, 0.48, 0.8),
        Vec3::new(-0.6, 0.0, 0.8),
        Vec3::new(0.3, -5.0, 0.4),
        Vec3::new(0.6, 0.8, 1e-6),
        Vec3::X,
        Vec3::NAN,
    ]
}

/// Batches of `compute` for one `wo` and for each its own, against `single` of each lane.
fn assert_lanes<I: Copy, O: Copy + PartialEq + std::fmt::Debug>(
    name: &str,
    (wo, inputs): (&[Vec3], &[I]),
    untouched: O,
    batch: impl Fn(Wo<'_>, &[I], &mut [O]),
    single: impl Fn(Vec3, I) -> O,
) -> Vec<O> {
    let mut all = vec![untouched; PAIRS];
    for range in ranges() {
        batch(
            Wo::Each(&wo[range.clone()]),
            &inputs[range.clone()],
            &mut all[range],
        );
    }
    for k in 0..PAIRS {
        assert_eq!(all[k], single(wo[k], inputs[k]), "{name} {k} {}", wo[k]);
    }
    for wo in given_directions() {
        for count in [0, 1, 31, 32, 33, 64, 200, 300] {
            let mut out = vec![untouched; count];
            batch(Wo::One(wo), &inputs[300..300 + count], &mut out);
            for (k, out) in out.into_iter().enumerate() {
                assert_eq!(out, single(wo, inputs[300 + k]), "{name} one {wo} {k}");
            }
        }
    }
    all
}

fn assert_same_draws(name: &str, sampler: &dyn DirectionSampler) {
    let ((wo, wi), points) = (difficult_pairs(), points());
    let drawn = assert_lanes(
        name,
        (&wo, &points),
        Some([u32::MAX; 4]),
        |wo, u, out| {
            let mut drawn = vec![None; out.len()];
            sampler.sample_batch(wo, u, &mut drawn);
            for (out, drawn) in out.iter_mut().zip(drawn) {
                *out = bits(drawn);
            }
        },
        |wo, u| bits(sampler.sample(wo, u)),
    );
    let pdfs = assert_lanes(
        name,
        (&wo, &wi),
        u32::MAX,
        |wo, wi, out| {
            let mut pdfs = vec![f32::NAN; out.len()];
            sampler.pdf_batch(wo, wi, &mut pdfs);
            for (out, pdf) in out.iter_mut().zip(pdfs) {
                *out = pdf.to_bits();
            }
        },
        |wo, wi| sampler.pdf(wo, wi).to_bits(),
    );
    // Most pairs are ordinary ones; lobes may have no density at some, and some samplers lose draws.
    let draws = drawn.iter().flatten().count();
    assert!((PAIRS / 2..PAIRS - 20).contains(&draws), "{name}: {draws}");
    let densities = pdfs.iter().filter(|&&p| f32::from_bits(p) > 0.0).count();
    assert!(
        (PAIRS / 10..PAIRS - 20).contains(&densities),
        "{name}: {densities}"
    );
}

fn isotropic_samplers() -> Vec<(String, SamplerSpec)> {
    let half_vector = HalfVectorSettings::PRESETS
        .iter()
        .map(|&(size, settings)| (format!("half-vector {size}"), SamplerSpec::new(settings)));
    let hard = hard_samplers()
        .unwrap()
        .into_iter()
        .map(|hard| (hard.name.to_owned(), hard.spec));
    let fitted = [
        (
            "lobe".to_owned(),
            SamplerSpec::new(LobeSettings::fitted(LobeKind::Ggx)),
        ),
        (
            "factored".to_owned(),
            SamplerSpec::new(FactoredSettings::default()),
        ),
    ];
    half_vector.chain(hard).chain(fitted).collect()
}

fn anisotropic_file(symmetry: Symmetry) -> RglBrdf {
    RglBrdf::new(bsdf_of(&Brushed::STRONG, symmetry, Resolution::COARSE))
}

fn isotropic_file(brdf: &dyn Brdf) -> RglBrdf {
    let file = tabulate(|wo, wi| brdf.eval(wo, wi), BsdfSize::ALL[0], "test".into());
    let rgl = RglBrdf::new(file);
    assert!(rgl.is_isotropic());
    rgl
}

#[test]
fn every_isotropic_sampler_gives_the_bits_of_single_calls() {
    let table = decode_embedded("nickel").unwrap();
    let brdf = Arc::new(MerlBrdf::new(Arc::new(table), LookupRule::Floor));
    for (name, spec) in isotropic_samplers() {
        assert_same_draws(&name, &*spec.build(&loaded(&brdf)).unwrap());
    }
}

/// The BRDF of a formula.
fn formula(text: &str) -> Arc<dyn Brdf> {
    let material = merlkit::Material::resolve(text).unwrap();
    material.load(LookupRule::Floor).unwrap().brdf().clone()
}

/// Tables that are too large to be mixed beforehand on the stack.
#[test]
fn the_largest_tables_give_the_bits_of_single_calls() {
    let largest = HalfVectorSettings {
        tables: 2,
        rows: 79,
        segments: 256,
        ..HalfVectorSettings::default()
    };
    let lambert = formula("lambert:reflectance=0.5");
    assert_same_draws(
        "largest",
        &HalfVectorTable::build(&*lambert, largest).unwrap(),
    );
}

#[test]
fn every_anisotropic_sampler_gives_the_bits_of_single_calls() {
    for symmetry in [Symmetry::Quarter, Symmetry::Half, Symmetry::Whole] {
        let file = anisotropic_file(symmetry);
        let settings = HalfVectorSettings::PRESETS[0].1;
        let name = format!("by azimuth, {symmetry:?}");
        assert_same_draws(&name, &ByAzimuth::build(&file, settings).unwrap());
        if symmetry == Symmetry::Quarter {
            assert_same_draws("file", &file);
        }
    }
}

#[test]
fn every_brdf_gives_the_bits_of_single_calls() {
    let table = Arc::new(decode_embedded("nickel").unwrap());
    let measured = LookupRule::ALL.map(|rule| MerlBrdf::new(table.clone(), rule));
    let file = anisotropic_file(Symmetry::Quarter);
    let isotropic = isotropic_file(&measured[0]);
    let lambert = formula("lambert:reflectance=0.5");
    let ward = formula("ward:sx=0.2,sy=0.4");
    let (wo, wi) = difficult_pairs();
    let channels = |v: Vec3| v.to_array().map(f32::to_bits);
    let mut compact = Vec::new();
    for format in [CellFormat::F16, CellFormat::Rgb9e5] {
        let table = Arc::new((*table).clone().with_cell_format(format).unwrap());
        compact.extend(LookupRule::ALL.map(|rule| MerlBrdf::new(table.clone(), rule)));
    }
    let measured = measured.iter().map(|m| m as &dyn Brdf);
    for (i, brdf) in measured
        .chain(compact.iter().map(|m| m as &dyn Brdf))
        .chain([&file as &dyn Brdf, &isotropic, &*lambert, &*ward])
        .enumerate()
    {
        let values = assert_lanes(
            &format!("f of BRDF {i}"),
            (&wo, &wi),
            [u32::MAX; 3],
            |wo, wi, out| {
                let mut values = vec![Vec3::NAN; out.len()];
                brdf.eval_batch(wo, wi, &mut values);
                for (out, value) in out.iter_mut().zip(values) {
                    *out = channels(value);
                }
            },
            |wo, wi| channels(brdf.eval(wo, wi)),
        );
        assert_lanes(
            &format!("f cos of BRDF {i}"),
            (&wo, &wi),
            [u32::MAX; 3],
            |wo, wi, out| {
                let mut values = vec![Vec3::NAN; out.len()];
                brdf.eval_cos_batch(wo, wi, &mut values);
                for (out, value) in out.iter_mut().zip(values) {
                    *out = channels(value);
                }
            },
            |wo, wi| channels(brdf.eval_cos(wo, wi)),
        );
        let lit = values.iter().filter(|v| f32::from_bits(v[0]) > 0.0).count();
        assert!(lit > PAIRS / 10, "{i}: {lit}");
    }
}

/// Whether `call` panics because slices differ in length.
fn refuses(call: impl FnOnce()) -> bool {
    let Err(panic) = std::panic::catch_unwind(std::panic::AssertUnwindSafe(call)) else {
        return false;
    };
    let message = panic.downcast_ref::<String>().unwrap();
    message.contains("the slices of a batch must be of one length")
}

#[test]
fn slices_of_unequal_lengths_are_refused() {
    let table = Arc::new(decode_embedded("nickel").unwrap());
    let merl = Arc::new(MerlBrdf::new(table, LookupRule::Floor));
    let file = anisotropic_file(Symmetry::Quarter);
    let half_vector = SamplerSpec::new(HalfVectorSettings::PRESETS[0].1)
        .build(&loaded(&merl))
        .unwrap();
    let settings = HalfVectorSettings::PRESETS[0].1;
    let by_azimuth = ByAzimuth::build(&file, settings).unwrap();
    let samplers: [&dyn DirectionSampler; 4] = [&*half_vector, &by_azimuth, &Cosine, &file];
    let brdfs: [&dyn Brdf; 2] = [&*merl, &file];
    let each = [Vec3::Z; 130];
    let points = [Vec2::splat(0.5); 130];
    for (wo, inputs, outputs) in [
        (Wo::Each(&each[..0]), 5, 5),
        (Wo::Each(&each[..5]), 0, 5),
        (Wo::Each(&each[..5]), 5, 0),
        (Wo::Each(&each[..65]), 64, 64),
        (Wo::Each(&each[..130]), 130, 129),
        (Wo::One(Vec3::Z), 4, 5),
        (Wo::One(Vec3::Z), 5, 4),
        (Wo::One(Vec3::NAN), 1, 0),
    ] {
        for sampler in samplers {
            let mut drawn = vec![None; outputs];
            assert!(refuses(|| sampler.sample_batch(
                wo,
                &points[..inputs],
                &mut drawn
            )));
            let mut pdfs = vec![0.0; outputs];
            assert!(refuses(|| sampler.pdf_batch(
                wo,
                &each[..inputs],
                &mut pdfs
            )));
        }
        for brdf in brdfs {
            let mut values = vec![Vec3::ZERO; outputs];
            assert!(refuses(|| brdf.eval_batch(
                wo,
                &each[..inputs],
                &mut values
            )));
            assert!(refuses(|| brdf.eval_cos_batch(
                wo,
                &each[..inputs],
                &mut values
            )));
        }
    }
    assert!(!refuses(|| Cosine.sample_batch(
        Wo::One(Vec3::Z),
        &[],
        &mut []
    )));
}

#[test]
fn batches_allocate_nothing() {
    let table = Arc::new(decode_embedded("nickel").unwrap());
    let merl = Arc::new(MerlBrdf::new(table, LookupRule::Linear));
    let file = anisotropic_file(Symmetry::Quarter);
    let lambert = formula("lambert:reflectance=0.5");
    let ward = formula("ward:sx=0.2,sy=0.4");
    let mut samplers: Vec<(String, Arc<dyn DirectionSampler>)> = Vec::new();
    for (name, spec) in isotropic_samplers() {
        samplers.push((name, spec.build(&loaded(&merl)).unwrap().shared()));
    }
    let settings = HalfVectorSettings::PRESETS[0].1;
    let by_azimuth = ByAzimuth::build(&file, settings).unwrap();
    samplers.push(("by azimuth".to_owned(), Arc::new(by_azimuth)));
    samplers.push(("file".to_owned(), Arc::new(file)));
    let file = anisotropic_file(Symmetry::Quarter);
    let brdfs: [&dyn Brdf; 4] = [&*merl, &file, &*lambert, &*ward];

    let ((wo, wi), points) = (difficult_pairs(), points());
    let (wo, wi, points) = (&wo[..1000], &wi[..1000], &points[..1000]);
    let mut drawn = vec![None; 1000];
    let mut pdfs = vec![0.0; 1000];
    let mut values = vec![Vec3::ZERO; 1000];
    for given in [Wo::Each(wo), Wo::One(Vec3::new(0.6, 0.0, 0.8))] {
        for (name, sampler) in &samplers {
            let count = allocations(|| {
                sampler.sample_batch(given, points, &mut drawn);
                sampler.pdf_batch(given, wi, &mut pdfs);
            });
            assert_eq!(count, 0, "{name}");
        }
        for (i, brdf) in brdfs.iter().enumerate() {
            // The small tables of the lookup are filled by the first call of a program.
            brdf.eval_batch(given, wi, &mut values);
            let count = allocations(|| {
                brdf.eval_batch(given, wi, &mut values);
                brdf.eval_cos_batch(given, wi, &mut values);
            });
            assert_eq!(count, 0, "BRDF {i}");
        }
    }
    assert_eq!(allocations(|| drop(vec![1u8])), 1);
}
