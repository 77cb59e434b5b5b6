//! What a sampler costs: bytes, seconds to build, nanoseconds a draw.

use std::hint::black_box;
use std::time::Instant;

use cpu_time::{ProcessTime, ThreadTime};
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
    let started = Instant::now();
    let before = ProcessTime::now();
    let result = work();
    let seconds = Seconds {
        wall: started.elapsed().as_secs_f64(),
        cpu: before.elapsed().as_secs_f64(),
    };
    (result, seconds)
}

/// CPU seconds of this thread since it began.
pub fn thread_seconds() -> f64 {
    ThreadTime::now().as_duration().as_secs_f64()
}

/// What one call costs on one thread, from short batches in turn with the other contenders' ([`costs`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CallCost {
    /// Nanoseconds of CPU time a call: the lower quartile over the rounds, which other programs disturb least. 0 for a
    /// contender without calls.
    pub ns: f64,
    /// Where the quartile lies with 95 %, as far as the scatter of the rounds says: nanoseconds.
    pub low: f64,
    /// The interval's upper end.
    pub high: f64,
    /// By how much the middle half of the rounds scatters: upper quartile over lower quartile, minus 1.
    pub spread: f64,
}

/// Repeats that differ by more than this are worth a warning.
const UNSTEADY: f64 = 0.1;

impl CallCost {
    /// Whether the middle half of the repeats differs by more than 10 %, so that the figure deserves little trust.
    pub fn is_unsteady(&self) -> bool {
        self.spread > UNSTEADY
    }

    /// The quartiles of nanoseconds a call, one value a round, with the interval of the lower one.
    ///
    /// The number of rounds below a quartile q of their distribution is binomial, whatever that distribution is: mean n·q,
    /// variance n·q·(1 − q). So with 95 % the quartile lies between the values of ranks n·q ± 1.96 √(n·q·(1 − q)).
    pub fn from_rounds(mut rounds: Vec<f64>) -> Self {
        rounds.sort_by(f64::total_cmp);
        let count = rounds.len() as f64;
        let rank = |r: f64| {
            let last = rounds.len().saturating_sub(1);
            rounds
                .get((r.max(0.0) as usize).min(last))
                .copied()
                .unwrap_or(0.0)
        };
        let reach = 1.96 * (count * 0.25 * 0.75).sqrt();
        let (ns, upper) = (rank(0.25 * count), rank(0.75 * count));
        Self {
            ns,
            low: rank((0.25 * count - reach).floor()),
            high: rank((0.25 * count + reach).ceil()),
            spread: if ns > 0.0 { upper / ns - 1.0 } else { 0.0 },
        }
    }
}

/// A note on times whose repeats differ by more than 10 %, each with its name; `None` if all are steady.
pub fn unsteady_note<'a>(times: impl Iterator<Item = (&'a str, CallCost)>) -> Option<String> {
    let mut names: Vec<&str> = Vec::new();
    let mut most: f64 = 0.0;
    for (name, cost) in times {
        if cost.is_unsteady() {
            most = most.max(cost.spread);
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    let others = names.len().saturating_sub(NAMED);
    let named = names[..names.len() - others].join(", ");
    let and_others = match others {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    let text = format!(
        "repeated timings of {named}{and_others} differ by more than {:.0} % (by up to {:.0} %): the machine was busy",
        100.0 * UNSTEADY,
        100.0 * most
    );
    (!names.is_empty()).then_some(text)
}

/// Names that a note gives in full.
const NAMED: usize = 3;

/// Work whose calls are timed in short batches.
pub trait TimedBatch {
    /// Does one batch, the same in cost whatever `round` is, and returns how many calls that was.
    fn run(&self, round: u64) -> usize;
}

/// Rounds of [`costs`].
pub const ROUNDS: u64 = 24;

/// What a call of each contender costs, by the CPU time of this thread.
///
/// All contenders are timed once in each of [`ROUNDS`] rounds ([`time_round`]). One round before these fills the caches and is
/// not counted.
pub fn costs(contenders: &[&dyn TimedBatch]) -> Vec<CallCost> {
    let mut rounds = vec![Vec::new(); contenders.len()];
    for contender in contenders {
        contender.run(0);
    }
    for round in 0..ROUNDS {
        for (found, ns) in rounds.iter_mut().zip(time_round(contenders, round)) {
            found.extend(ns);
        }
    }
    rounds.into_iter().map(CallCost::from_rounds).collect()
}

/// Nanoseconds a call of each contender in one round, by the CPU time of this thread; `None` for a contender without calls.
///
/// The order begins with another contender in each round, so that a slow minute of the machine meets all of them alike. A batch
/// should take some tenths of a millisecond: longer than the clock's step, shorter than a turn of the scheduler.
pub fn time_round(contenders: &[&dyn TimedBatch], round: u64) -> Vec<Option<f64>> {
    let mut found = vec![None; contenders.len()];
    for turn in 0..contenders.len() {
        let who = (turn + round as usize) % contenders.len();
        let before = ThreadTime::now();
        let calls = contenders[who].run(round + 1);
        let nanoseconds = before.elapsed().as_secs_f64() * 1e9;
        if calls > 0 {
            found[who] = Some(nanoseconds / calls as f64);
        }
    }
    found
}

/// Time of single calls on one thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct CallTimes {
    /// Of a `sample`, failed draws included.
    pub sample_ns: CallCost,
    /// Of a `pdf` of a drawn direction.
    pub pdf_ns: CallCost,
    /// Fraction of draws that failed.
    pub failed: f64,
}

/// Draws of a sampler.
struct DrawBatch<'a> {
    sampler: &'a dyn DirectionSampler,
    jobs: &'a [(Vec3, Vec2)],
}

impl TimedBatch for DrawBatch<'_> {
    fn run(&self, _: u64) -> usize {
        for &(wo, u) in self.jobs {
            black_box(self.sampler.sample(wo, u));
        }
        self.jobs.len()
    }
}

/// Densities of directions that a sampler has drawn.
struct PdfBatch<'a> {
    sampler: &'a dyn DirectionSampler,
    drawn: Vec<(Vec3, Vec3)>,
}

impl TimedBatch for PdfBatch<'_> {
    fn run(&self, _: u64) -> usize {
        for &(wo, wi) in &self.drawn {
            black_box(self.sampler.pdf(wo, wi));
        }
        self.drawn.len()
    }
}

/// Times `sample` and `pdf` of each sampler, all in turn, over batches of `draws` random points at [`LIMIT_ANGLES_DEG`].
pub fn call_times(samplers: &[&dyn DirectionSampler], draws: usize, seed: u64) -> Vec<CallTimes> {
    let wos = LIMIT_ANGLES_DEG.map(|t| spherical(t.to_radians(), 0.4).as_vec3());
    let jobs: Vec<(Vec3, Vec2)> = (0..draws.max(1))
        .map(|i| {
            (
                wos[i % wos.len()],
                PointSet::Random.point(seed, i as u64, 0),
            )
        })
        .collect();
    let mut draws = Vec::new();
    let mut densities = Vec::new();
    for &sampler in samplers {
        let drawn = jobs
            .iter()
            .filter_map(|&(wo, u)| sampler.sample(wo, u).map(|s| (wo, s.wi)))
            .collect();
        draws.push(DrawBatch {
            sampler,
            jobs: &jobs,
        });
        densities.push(PdfBatch { sampler, drawn });
    }
    let mut contenders: Vec<&dyn TimedBatch> = Vec::new();
    for batch in &draws {
        contenders.push(batch);
    }
    for batch in &densities {
        contenders.push(batch);
    }
    let costs = costs(&contenders);
    let (sample_ns, pdf_ns) = costs.split_at(samplers.len());
    let mut times = Vec::new();
    for (i, batch) in densities.iter().enumerate() {
        times.push(CallTimes {
            sample_ns: sample_ns[i],
            pdf_ns: pdf_ns[i],
            failed: 1.0 - batch.drawn.len() as f64 / jobs.len() as f64,
        });
    }
    times
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
        let times = call_times(&[&Cosine], 1000, 1)[0];
        assert!(times.failed == 0.0);
        for cost in [times.sample_ns, times.pdf_ns] {
            assert!(0.0 < cost.low && cost.low <= cost.ns && cost.ns <= cost.high);
        }
        assert!(call_times(&[], 1000, 1).is_empty());
    }

    /// Ranks of 24 rounds: 24/4 ± 1.96 √(24·3/16) is 6 ± 4.16, so 1 and 11, counted from 0.
    #[test]
    fn quartiles_have_the_interval_of_their_ranks() {
        let cost = CallCost::from_rounds((0..24).rev().map(|i| 100.0 + f64::from(i)).collect());
        assert_eq!((cost.ns, cost.low, cost.high), (106.0, 101.0, 111.0));
        assert!((cost.spread - (118.0 / 106.0 - 1.0)).abs() < 1e-12 && cost.is_unsteady());
        let steady = CallCost::from_rounds(vec![100.0; 24]);
        assert!(steady.spread == 0.0 && !steady.is_unsteady());
        assert_eq!(CallCost::from_rounds(Vec::new()), CallCost::default());
    }

    #[test]
    fn unsteady_times_are_named() {
        let cost = |spread| CallCost {
            spread,
            ..CallCost::default()
        };
        let times = [
            ("a", 0.3),
            ("b", 0.05),
            ("a", 0.2),
            ("c", 0.11),
            ("d", 0.5),
            ("e", 0.2),
        ];
        let note = unsteady_note(times.into_iter().map(|(n, s)| (n, cost(s)))).unwrap();
        assert!(
            note.contains("of a, c, d and 1 more") && note.contains("up to 50 %"),
            "{note}"
        );
        assert_eq!(unsteady_note([("b", cost(0.1))].into_iter()), None);
    }

    struct Work(u64);

    impl TimedBatch for Work {
        fn run(&self, round: u64) -> usize {
            black_box((0..self.0).fold(round, |a, b| black_box(a ^ b.wrapping_mul(a | 1))));
            1
        }
    }

    /// Time that the thread sleeps is none of its own.
    struct Sleep;

    impl TimedBatch for Sleep {
        fn run(&self, _: u64) -> usize {
            std::thread::sleep(std::time::Duration::from_millis(2));
            1
        }
    }

    #[test]
    fn costs_are_those_of_the_thread_alone() {
        let found = costs(&[&Work(20_000), &Work(200_000), &Sleep]);
        assert!(found[1].ns > 4.0 * found[0].ns, "{found:?}");
        assert!(found[2].ns < 1e6, "{found:?}");
    }
}
