//! What a sampler costs: bytes, seconds to build, nanoseconds a draw.

use std::hint::black_box;
use std::time::Instant;

use cpu_time::ProcessTime;
use glam::{Vec2, Vec3};

use super::accuracy::LIMIT_ANGLES_DEG;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::geometry::spherical;
use merlkit::points::PointSet;

/// Seconds by the clock on the wall and by the processors.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Seconds {
    /// Elapsed.
    pub wall: f64,
    /// Spent by all threads of the process.
    pub cpu: f64,
}

/// Runs `work` and times it. Whatever else the process does meanwhile counts as `cpu`.
pub fn time<T>(work: impl FnOnce() -> T) -> (T, Seconds) {
    let (started, before) = (Instant::now(), ProcessTime::now());
    let result = work();
    let seconds = Seconds {
        wall: started.elapsed().as_secs_f64(),
        cpu: before.elapsed().as_secs_f64(),
    };
    (result, seconds)
}

/// Time of single calls on one thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct CallTimes {
    /// Nanoseconds a `sample`, failed draws included.
    pub sample_ns: f64,
    /// Nanoseconds a `pdf` of a drawn direction.
    pub pdf_ns: f64,
    /// Share of draws that failed.
    pub failed: f64,
}

/// Times `sample` and `pdf` over `draws` random points, in turn at each of [`LIMIT_ANGLES_DEG`]: the median of five runs.
pub fn call_times(sampler: &dyn DirectionSampler, draws: usize, seed: u64) -> CallTimes {
    let wos = LIMIT_ANGLES_DEG.map(|t| spherical(t.to_radians(), 0.4).as_vec3());
    let jobs: Vec<(Vec3, Vec2)> = (0..draws.max(1))
        .map(|i| {
            (
                wos[i % wos.len()],
                PointSet::Random.point(seed, i as u64, 0),
            )
        })
        .collect();
    let drawn: Vec<(Vec3, Vec3)> = jobs
        .iter()
        .filter_map(|&(wo, u)| sampler.sample(wo, u).map(|s| (wo, s.wi)))
        .collect();
    let sample_ns = nanoseconds(&jobs, |&(wo, u)| {
        sampler.sample(wo, u).map_or(0.0, |s| s.pdf)
    });
    let pdf_ns = nanoseconds(&drawn, |&(wo, wi)| sampler.pdf(wo, wi));
    CallTimes {
        sample_ns,
        pdf_ns,
        failed: 1.0 - drawn.len() as f64 / jobs.len() as f64,
    }
}

/// Median over five runs of the time of one `call`; 0 without jobs.
fn nanoseconds<T>(jobs: &[T], mut call: impl FnMut(&T) -> f32) -> f64 {
    let mut runs: Vec<f64> = (0..5)
        .map(|_| {
            let started = Instant::now();
            for job in jobs {
                black_box(call(job));
            }
            started.elapsed().as_secs_f64() * 1e9 / jobs.len().max(1) as f64
        })
        .collect();
    runs.sort_by(f64::total_cmp);
    runs[runs.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use merlkit::sampler::Cosine;

    #[test]
    fn times_are_positive_and_work_counts() {
        let (sum, seconds) =
            time(|| (0..20_000_000u64).fold(0u64, |a, b| black_box(a ^ b.wrapping_mul(a | 1))));
        assert!(sum != 1 && seconds.wall > 0.0);
        assert!(seconds.cpu > 0.0);
        let times = call_times(&Cosine, 1000, 1);
        assert!(times.sample_ns > 0.0 && times.pdf_ns > 0.0 && times.failed == 0.0);
    }
}
