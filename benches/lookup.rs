//! Evaluation by each lookup rule, for pairs anywhere, pairs near the mirror direction and pairs drawn for the material: one at
//! a time, each waiting for the one before, many at once, and the bins alone. Then evaluation of a `.bsdf` file that is made of
//! the same material, and draws and densities by the sampler that it holds. Tables in each format of cells are read by pairs so few that
//! their cells stay in the caches, and so many that they don't. `cargo bench --bench lookup`.

mod harness;

use std::f64::consts::TAU;
use std::hint::black_box;
use std::sync::Arc;

use glam::{Vec2, Vec3};
use harness::{Group, Harness};
use merlkit::Wo;
use merlkit::brdf::Brdf;
use merlkit::color::Rgb;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::geometry::{cosine_hemisphere, reflect_about, spherical};
use merlkit::material::merl::{BinIndex, CellFormat, LookupRule, MerlBrdf};
use merlkit::material::merl::{MerlTable, decode_embedded};
use merlkit::material::rgl::{BsdfSize, RglBrdf, tabulate};
use merlkit::points::PointSet;
use merlkit::sampler::{HalfVectorSettings, HalfVectorTable};

const PAIRS: u64 = 4096;
/// Pairs whose cells are most of a table, so that few of them are in a cache when they are read.
const MANY_PAIRS: u64 = 1 << 18;

/// `wo` and `wi` of some pairs, and the place they come from.
struct Pairs {
    place: &'static str,
    wo: Vec<Vec3>,
    wi: Vec<Vec3>,
}

impl Pairs {
    fn anywhere(count: u64) -> Self {
        let direction = |pair| {
            let u = move |i| PointSet::Random.point(1, i, pair).as_dvec2();
            (0..count)
                .map(|i| cosine_hemisphere(u(i)).as_vec3())
                .collect()
        };
        Self {
            place: "anywhere",
            wo: direction(0),
            wi: direction(1),
        }
    }

    /// Half vectors within 3° of the normal, viewers up to 80°.
    fn near_the_mirror() -> Self {
        let pair = |i| {
            let u = PointSet::Random.point4(2, i, 0).map(f64::from);
            let wo = spherical(u[0] * 1.4, u[1] * TAU);
            let h = spherical(u[2] * 0.05, u[3] * TAU);
            (wo.as_vec3(), reflect_about(wo, h).as_vec3())
        };
        let (wo, wi) = (0..PAIRS).map(pair).unzip();
        Self {
            place: "near the mirror",
            wo,
            wi,
        }
    }

    /// As paths of a renderer ask: viewers nearly equal within each 64, lights drawn from a half-vector table.
    fn drawn(brdf: &MerlBrdf, count: u64) -> Self {
        let table = HalfVectorTable::build(brdf, HalfVectorSettings::default()).unwrap();
        let pair = |i| {
            let pixel = PointSet::Random.point(3, i / 64, 0).as_dvec2();
            let u = PointSet::Random.point4(4, i, 0);
            let wo = spherical(
                pixel.x * 1.47 + f64::from(u[0]) * 0.01,
                pixel.y * TAU + f64::from(u[1]) * 0.01,
            );
            (
                wo.as_vec3(),
                table
                    .sample(wo.as_vec3(), Vec2::new(u[2], u[3]))
                    .unwrap()
                    .wi,
            )
        };
        let (wo, wi) = (0..count).map(pair).unzip();
        Self {
            place: "drawn",
            wo,
            wi,
        }
    }

    fn iter(&self) -> impl Iterator<Item = (Vec3, Vec3)> {
        self.wo.iter().copied().zip(self.wi.iter().copied())
    }
}

fn sum(brdf: &MerlBrdf, pairs: &Pairs) -> Rgb {
    pairs.iter().map(|(wo, wi)| brdf.eval(wo, wi)).sum()
}

/// Sum of the positions of all pairs' bins in the table.
fn bins(table: &MerlTable, pairs: &Pairs) -> usize {
    let index = |b: BinIndex| table.index(b.theta_h, b.theta_d, b.phi_d);
    pairs
        .iter()
        .filter_map(|(wo, wi)| BinIndex::find(wo, wi, 180))
        .map(index)
        .sum()
}

/// Values of all pairs in batches of `count`.
fn eval_in_batches(brdf: &dyn Brdf, pairs: &Pairs, count: usize, out: &mut [Rgb]) {
    let lanes = pairs.wo.chunks(count).zip(pairs.wi.chunks(count));
    for ((wo, wi), out) in lanes.zip(out.chunks_mut(count)) {
        brdf.eval_batch(Wo::Each(black_box(wo)), wi, out);
    }
}

/// Values of all pairs, each waiting for the one before.
fn eval_in_a_chain(brdf: &MerlBrdf, pairs: &Pairs) -> f32 {
    let mut nothing = 0.0;
    for (wo, wi) in black_box(pairs).iter() {
        let value = brdf.eval(wo + Vec3::splat(nothing), wi).x;
        nothing = value.min(1.0) * f32::MIN_POSITIVE * 0.0;
    }
    nothing
}

/// Batches give the values of single calls.
fn assert_batches(brdf: &dyn Brdf, pairs: &Pairs) {
    let mut out = vec![Rgb::ZERO; pairs.wi.len()];
    brdf.eval_batch(Wo::Each(&pairs.wo), &pairs.wi, &mut out);
    for ((wo, wi), &f) in pairs.iter().zip(&out) {
        assert_eq!(f, brdf.eval(wo, wi));
    }
    let wo = pairs.wo[7];
    brdf.eval_batch(Wo::One(wo), &pairs.wi, &mut out);
    for (&wi, &f) in pairs.wi.iter().zip(&out) {
        assert_eq!(f, brdf.eval(wo, wi));
    }
}

/// One rule: many pairs at once first, since renderers ask so.
fn add_rule<'a>(group: &mut Group<'a>, brdf: &'a MerlBrdf, pairs: &'a Pairs) {
    assert_batches(brdf, pairs);
    let rule = brdf.rule().name();
    let calls = pairs.wi.len();
    let (wo, mut out) = (pairs.wo[7], vec![Rgb::ZERO; calls]);
    group.add(format!("{rule} pairs"), calls, move || {
        brdf.eval_batch(Wo::Each(black_box(&pairs.wo)), &pairs.wi, &mut out);
    });
    for count in [16, 32, 64] {
        let mut out = vec![Rgb::ZERO; calls];
        group.add(format!("{rule} pairs of {count}"), calls, move || {
            eval_in_batches(brdf, pairs, count, &mut out);
        });
    }
    let mut out = vec![Rgb::ZERO; calls];
    group.add(format!("{rule} many wi"), calls, move || {
        brdf.eval_batch(Wo::One(black_box(wo)), &pairs.wi, &mut out);
    });
    group.add(format!("{rule} one"), calls, move || {
        sum(brdf, black_box(pairs))
    });
    group.add(format!("{rule} chain"), calls, move || {
        eval_in_a_chain(brdf, pairs)
    });
}

fn lookups(harness: &mut Harness) {
    let table = Arc::new(decode_embedded("nickel").unwrap());
    let rules = LookupRule::ALL.map(|rule| MerlBrdf::new(table.clone(), rule));
    let floor = MerlBrdf::new(table.clone(), LookupRule::Floor);
    for pairs in [
        Pairs::anywhere(PAIRS),
        Pairs::near_the_mirror(),
        Pairs::drawn(&floor, PAIRS),
    ] {
        let mut group = Group::new(format!("lookup, {}", pairs.place), "pair");
        for brdf in &rules {
            let ratio = sum(brdf, &pairs) / sum(&floor, &pairs);
            assert!(
                ratio.min_element() > 0.5 && ratio.max_element() < 2.0,
                "{:?} {}: {ratio}",
                brdf.rule(),
                pairs.place
            );
            add_rule(&mut group, brdf, &pairs);
        }
        group.add("bins alone", pairs.wi.len(), || {
            bins(&table, black_box(&pairs))
        });
        harness.run(group);
    }
}

/// A file of 3 MB made of nickel: many more polar angles than the eight of the RGL database, and tables of like size for each.
fn measured_file() -> RglBrdf {
    let table = Arc::new(decode_embedded("nickel").unwrap());
    let nickel = MerlBrdf::new(table, LookupRule::Linear);
    let size = BsdfSize::ALL.into_iter().find(|s| s.name == "3MB").unwrap();
    RglBrdf::new(tabulate(
        |wo, wi| nickel.eval(wo, wi),
        size,
        "nickel".into(),
    ))
}

fn measured(harness: &mut Harness) {
    let rgl = measured_file();
    for pairs in [Pairs::anywhere(PAIRS), Pairs::near_the_mirror()] {
        assert_batches(&rgl, &pairs);
        let mut group = Group::new(format!("measured file, {}", pairs.place), "pair");
        add_evaluation(&mut group, &rgl, &pairs);
        add_own_sampler(&mut group, &rgl, &pairs);
        harness.run(group);
    }
}

fn add_evaluation<'a>(group: &mut Group<'a>, rgl: &'a RglBrdf, pairs: &'a Pairs) {
    let calls = pairs.wi.len();
    let (wo, mut out) = (pairs.wo[7], vec![Rgb::ZERO; calls]);
    group.add("eval pairs", calls, move || {
        rgl.eval_batch(Wo::Each(black_box(&pairs.wo)), &pairs.wi, &mut out);
    });
    let mut out = vec![Rgb::ZERO; calls];
    group.add("eval many wi", calls, move || {
        rgl.eval_batch(Wo::One(black_box(wo)), &pairs.wi, &mut out);
    });
    group.add("eval one", calls, move || {
        let pairs = black_box(pairs);
        pairs.iter().map(|(wo, wi)| rgl.eval(wo, wi)).sum::<Rgb>()
    });
}

fn add_own_sampler<'a>(group: &mut Group<'a>, rgl: &'a RglBrdf, pairs: &'a Pairs) {
    let points: Vec<Vec2> = (0..PAIRS)
        .map(|i| PointSet::Random.point(3, i, 0))
        .collect();
    let (mut drawn, mut pdfs) = (vec![None; points.len()], vec![0.0; points.len()]);
    let wo = pairs.wo[7];
    rgl.sample_batch(Wo::One(wo), &points, &mut drawn);
    // Some draws end below the horizon.
    assert!(drawn.iter().flatten().count() > points.len() / 2);
    group.add("sample many", points.len(), move || {
        rgl.sample_batch(Wo::One(black_box(wo)), &points, &mut drawn);
    });
    group.add("pdf pairs", pairs.wi.len(), move || {
        rgl.pdf_batch(Wo::Each(black_box(&pairs.wo)), &pairs.wi, &mut pdfs);
    });
}

/// Each format of cells in turn, so that all meet the same caches.
fn cell_formats(harness: &mut Harness) {
    for name in ["nickel", "red-plastic"] {
        let exact = decode_embedded(name).unwrap();
        let tables =
            CellFormat::ALL.map(|format| Arc::new(exact.clone().with_cell_format(format).unwrap()));
        let floor = MerlBrdf::new(tables[0].clone(), LookupRule::Floor);
        for (heat, count) in [("warm", PAIRS), ("cold", MANY_PAIRS)] {
            for pairs in [Pairs::anywhere(count), Pairs::drawn(&floor, count)] {
                let mut group = Group::new(format!("{name} {heat}, {}", pairs.place), "pair");
                for rule in [LookupRule::Linear, LookupRule::Floor] {
                    for table in &tables {
                        add_format(&mut group, MerlBrdf::new(table.clone(), rule), &pairs);
                    }
                }
                harness.run(group);
            }
        }
    }
}

fn add_format<'a>(group: &mut Group<'a>, brdf: MerlBrdf, pairs: &'a Pairs) {
    assert_batches(&brdf, pairs);
    let mut out = vec![Rgb::ZERO; pairs.wi.len()];
    let format = brdf.table().cell_format().name();
    let name = format!("{} {format}", brdf.rule().name());
    group.add(name, pairs.wi.len(), move || {
        brdf.eval_batch(Wo::Each(black_box(&pairs.wo)), &pairs.wi, &mut out);
    });
}

fn main() {
    let mut harness = Harness::new("lookup");
    lookups(&mut harness);
    cell_formats(&mut harness);
    measured(&mut harness);
}
