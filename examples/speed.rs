use glam::*;
use merlkit::brdf::*;
use merlkit::geom::*;
use merlkit::merl::*;
use merlkit::points::*;
use merlkit::sampler::*;
use std::sync::Arc;
fn cpu()->f64{ cpu_time::ThreadTime::now().as_duration().as_secs_f64() }
    let mut t = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &mut t) };
    t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9
}
fn time(name: &str, n: usize, mut f: impl FnMut(usize) -> f32) {
    let mut best = f64::MAX;
    let mut acc = 0.;
    for _ in 0..5 {
        let t = cpu();
        for i in 0..n {
            acc += f(i);
        }
        best = best.min((cpu() - t) / n as f64 * 1e9);
    }
    println!("{name:30} {best:7.1} ns  ({acc})");
}
fn main() {
    let b = Arc::new(Measured::new(Arc::new(decode_embedded("nickel").unwrap()), LookupRule::Floor));
    let n = 200_000;
    let us: Vec<Vec2> = (0..n).map(|i| PointSet::Random.point(1, i as u64, 0)).collect();
    let wo = spherical(45.2f64.to_radians(), 0.3).as_vec3();
    let ws: Vec<Vec3> = us.iter().map(|&u| cosine_hemisphere(u).as_vec3()).collect();
    time("bins cosine", n, |i| BinIndex::of(wo, ws[i], 180).map_or(0., |b| b.theta_h as f32));
    time("eval cosine", n, |i| b.eval(wo, ws[i]).x);
    let l = Measured::new(b.table().clone(), LookupRule::Linear);
    time("eval linear cosine", n, |i| l.eval(wo, ws[i]).x);
    time("cosine sample", n, |i| Cosine.sample(wo, us[i]).map_or(0., |s| s.pdf));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().unwrap();
    let mut d = None;
    let t = cpu();
    pool.install(|| d = Some(AdaptiveDisc::build(b.clone(), AdaptiveDiscSettings::default()).unwrap()));
    println!("disc build {:.0} ms cpu", (cpu() - t) * 1e3);
    let d = d.unwrap();
    let mut c = None;
    let t = cpu();
    pool.install(|| c = Some(CascadeCdf::build(&*b, CascadeCdfSettings::default()).unwrap()));
    println!("cdf build {:.0} ms cpu", (cpu() - t) * 1e3);
    let c = c.unwrap();
    let cn =
        CascadeCdf::build(&*b, CascadeCdfSettings { choice: TableChoice::Nearest, ..Default::default() })
            .unwrap();
    let dn = AdaptiveDisc::build(
        b.clone(),
        AdaptiveDiscSettings { choice: TableChoice::Nearest, ..Default::default() },
    )
    .unwrap();
    for (name, s) in
        [("disc", &d as &dyn DirectionSampler), ("cdf", &c), ("cdf nearest", &cn), ("disc nearest", &dn)]
    {
        let wis: Vec<Vec3> = us.iter().filter_map(|&u| s.sample(wo, u)).map(|s| s.wi).collect();
        if name == "disc" {
            time("bins near mirror", wis.len(), |i| {
                BinIndex::of(wo, wis[i], 180).map_or(0., |b| b.theta_h as f32)
            });
            time("eval near mirror", wis.len(), |i| b.eval(wo, wis[i]).x);
        }
        time(&format!("{name} sample"), n, |i| s.sample(wo, us[i]).map_or(0., |s| s.pdf));
        time(&format!("{name} pdf"), wis.len(), |i| s.pdf(wo, wis[i]));
    }
}
