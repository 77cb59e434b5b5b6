fn cpu()->f64{ cpu_time::ThreadTime::now().as_duration().as_secs_f64() }
    let mut t = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &mut t) };
    t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9
}
fn time(name: &str, f: impl Fn(f64) -> f64) {
    let n = 1_000_000;
    let xs: Vec<f64> = (0..n).map(|i| (i as f64 * 0.618033).fract() + 1e-3).collect();
    let mut best = f64::MAX;
    let mut acc = 0.;
    for _ in 0..5 {
        let t = cpu();
        for &x in &xs {
            acc += f(x);
        }
        best = best.min((cpu() - t) / n as f64 * 1e9);
    }
    println!("{name:20} {best:6.1} ns ({acc:.3})");
}
fn main() {
    time("nop", |x| x);
    time("sqrt64", |x| x.sqrt());
    time("div64", |x| 1. / x);
    time("atan2_64", |x| x.atan2(0.5));
    time("atan2_32", |x| (x as f32).atan2(0.5) as f64);
    time("sincos64", |x| {
        let (s, c) = (x * 6.).sin_cos();
        s + c
    });
    time("sincos32", |x| {
        let (s, c) = (x as f32 * 6.).sin_cos();
        (s + c) as f64
    });
    time("sin64", |x| x.sin());
    time("asin64", |x| (x * 0.99).asin());
    time("acos approx f32", |x| glam::Vec2::new(x as f32, 0.1).normalize().x as f64);
}
