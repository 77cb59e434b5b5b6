use glam::*;
use merlkit::brdf::*;
use merlkit::geom::*;
use merlkit::merl::*;
use merlkit::points::*;
use merlkit::sampler::*;
use std::sync::Arc;
use std::time::Instant;
const ANG: [f64; 7] = [0.76, 14.5, 29.75, 45., 60.25, 75.5, 84.7];
pub fn relstd(s: &dyn DirectionSampler, b: &Measured, deg: f64) -> (f64, f64, f64) {
    let wo = spherical(deg.to_radians(), 0.3).as_vec3();
    let q = HalfVectorQuadrature { phi_points: 512, parts: 2 };
    let (mut m1, mut m2, mut tot, mut pi) = (0., 0., 0., 0.);
    q.for_each(wo, |wi, ds| {
        let f = Importance::Mean.of(b.eval(wo, wi)) as f64 * wi.z as f64;
        let p = s.pdf(wo, wi) as f64;
        pi += p * ds;
        tot += f * ds;
        if p > 0. {
            m1 += f * ds;
            m2 += f * f / p * ds;
        }
    });
    ((m2 / (m1 * m1) - 1.).max(0.).sqrt(), 1. - m1 / tot, pi)
}
pub fn stats(name: &str, s: &dyn DirectionSampler, b: &Measured) {
    let mut r = vec![];
    let mut holes = 0f64;
    let mut pe = 0f64;
    for d in ANG {
        let (x, h, p) = relstd(s, b, d);
        r.push(x);
        holes = holes.max(h);
        pe = pe.max((p - 1.).abs());
    }
    let mean = r.iter().sum::<f64>() / 7.;
    let wo = spherical(45.2f64.to_radians(), 0.3).as_vec3();
    let n = 1_000_000u64;
    let us: Vec<Vec2> = (0..n).map(|i| PointSet::Random.point(1, i, 0)).collect();
    let t = Instant::now();
    let mut acc = 0.;
    let mut lost = 0;
    let mut wis = vec![];
    for &u in &us {
        if let Some(x) = s.sample(wo, u) {
            acc += x.pdf;
            wis.push(x.wi)
        } else {
            lost += 1
        }
    }
    let ts = t.elapsed().as_secs_f64() / n as f64 * 1e9;
    let t = Instant::now();
    for &w in &wis {
        acc += s.pdf(wo, w);
    }
    let tp = t.elapsed().as_secs_f64() / wis.len() as f64 * 1e9;
    let q = HalfVectorQuadrature { phi_points: 512, parts: 2 };
    let alb = q.integrate(wo, |wi| Importance::Mean.of(b.eval(wo, wi)) as f64 * wi.z as f64);
    let mc = us
        .iter()
        .filter_map(|&u| s.sample(wo, u))
        .map(|x| (Importance::Mean.of(b.eval(wo, x.wi)) * x.wi.z / x.pdf) as f64)
        .sum::<f64>()
        / n as f64;
    println!(
        "{name}: KB {:.0} relstd mean {:.3} {:?} holes {:.1e} pdf-1 {:.1e} sample {ts:.0} ns pdf {tp:.0} ns lost {lost} albedo {alb:.5} mc-rel {:.5} {}",
        s.bytes() as f64 / 1024.,
        mean,
        r.iter().map(|x| (x * 1000.).round() / 1000.).collect::<Vec<_>>(),
        holes,
        pe,
        mc / alb - 1.,
        acc > 0.
    );
}
fn main() {
    for m in std::env::args().skip(1) {
        let t = Instant::now();
        let table = Arc::new(decode_embedded(&m).unwrap());
        let dt = t.elapsed();
        let b = Arc::new(Measured::new(table, LookupRule::Floor));
        println!("== {m} decode {dt:?}");
        let t = Instant::now();
        let mut acc = 0f32;
        let wo = spherical(0.7, 0.1).as_vec3();
        for i in 0..1000000 {
            let w = cosine_hemisphere(PointSet::Random.point(2, i, 0)).as_vec3();
            acc += b.eval(wo, w).x;
        }
        println!("eval+point {:?} {}", t.elapsed() / 1000000, acc);
        for one in [true, false] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(if one { 1 } else { 2 }).build().unwrap();
            let t = Instant::now();
            let a = pool.install(|| AdaptiveDisc::build(b.clone(), AdaptiveDiscSettings::default())).unwrap();
            println!("disc build {:?} leaves/tree {}", t.elapsed(), a.leaves() / 60);
            if !one {
                stats("disc", &a, &b);
            }
        }

        let base = CascadeCdfSettings::default();
        for (n, c) in [
            ("uniform", CascadeCdfSettings::uniform()),
            ("default", base),
            ("tol1e-2", CascadeCdfSettings { tolerance: Some(1e-2), ..base }),
            ("uni-spacing", CascadeCdfSettings { spacing: ThetaSpacing::Uniform, ..base }),
            ("pub-uni", CascadeCdfSettings::as_published(false)),
            ("pub-comp", CascadeCdfSettings::as_published(true)),
            ("360x64", CascadeCdfSettings { theta_h: 360, phi_h: 64, ..base }),
            ("180x64 1e-2", CascadeCdfSettings { theta_h: 180, phi_h: 64, tolerance: Some(1e-2), ..base }),
            ("32tables", CascadeCdfSettings { tables: 32, ..base }),
        ] {
            let t = Instant::now();
            let a = CascadeCdf::build(&*b, c).unwrap();
            println!("build {:?}", t.elapsed());
            stats(n, &a, &b);
        }
    }
}
