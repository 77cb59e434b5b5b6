//! The one way in which benches time calls, so that results hold on a machine that does other work.
//!
//! A group has contenders, which are timed in turn, round after round, by the CPU time of this thread. Work that would be spread
//! over threads runs on this thread too. Short work is done once, uncounted, before each timing. A line shows the lower quartile of the rounds with its 95 % confidence interval, and the
//! ratio to the group's first contender: the median over rounds of the ratio within a round, with its interval. A slow minute
//! meets both sides of such a ratio, which is why it is steadier than the nanoseconds.
//!
//! `cargo bench --bench NAME -- [WORD…] [--rounds N] [--json FILE] [--against BINARY]`. Words choose lines that contain one of
//! them. `--against` takes the same bench of another build, runs it in the same rounds and prints the ratio of this build to it.
//! `MERLKIT_BENCH_JSON=FOLDER` writes `FOLDER/NAME.json`.

mod options;
mod other_build;
mod result;

use std::cell::RefCell;
use std::hint::black_box;

use merlkit_evaluate::measure::cost::{CallCost, TimedBatch, time, time_round};
use rayon::{ThreadPool, ThreadPoolBuilder};

use options::Options;
use other_build::{OtherBuild, answer_rounds};
use result::{BenchResult, GroupResult, LineResult, Ratio};

/// CPU seconds of a batch, about: longer than the clock's step, shorter than a turn of the scheduler.
const BATCH_SECONDS: f64 = 0.5e-3;
/// Work of fewer seconds is done once before each timing.
const SHORT_SECONDS: f64 = 5e-3;
/// CPU seconds of a group's rounds, about.
const GROUP_SECONDS: f64 = 6.0;
/// Fewer rounds than this leave the quartile's interval wide; more narrow it little.
const ROUNDS: [f64; 2] = [16.0, 96.0];

/// All groups of one bench.
pub struct Harness {
    options: Options,
    other: Option<OtherBuild>,
    result: BenchResult,
    /// Holds this thread alone, so that parallel work is counted.
    _pool: ThreadPool,
}

impl Harness {
    /// For the bench of this name, with the options of the command line.
    pub fn new(bench: &str) -> Self {
        let options = Options::from_command_line();
        let pool = ThreadPoolBuilder::new()
            .num_threads(1)
            .use_current_thread()
            .build()
            .expect("a pool of this thread");
        let other = options.against.as_ref().map(|binary| {
            OtherBuild::start(binary, &options.words).expect("the bench of another build")
        });
        if !options.follows {
            println!(
                "{bench}: CPU time of one thread, lower quartile over rounds with its 95 % interval; ratios: median within rounds"
            );
        }
        Self {
            result: BenchResult::new(bench),
            options,
            other,
            _pool: pool,
        }
    }

    /// Times the contenders of a group and prints them. Those that no word chooses are left out.
    pub fn run(&mut self, mut group: Group<'_>) {
        group
            .contenders
            .retain(|c| self.options.chooses(&group.name, &c.name));
        if group.contenders.is_empty() {
            return;
        }
        let seconds: f64 = group.contenders.iter_mut().map(Contender::calibrate).sum();
        let contenders = &group.contenders;
        let names: Vec<&str> = contenders.iter().map(|c| c.name.as_str()).collect();
        if self.options.follows {
            answer_rounds(&group.name, &names, |round| time_warm(contenders, round));
            return;
        }
        if let Some(other) = &mut self.other {
            other.enter(&group.name, &names);
        }
        let rounds = self
            .options
            .rounds
            .unwrap_or_else(|| (GROUP_SECONDS / seconds).clamp(ROUNDS[0], ROUNDS[1]) as u64);
        let (mut ours, mut others) = (Vec::new(), Vec::new());
        for round in 0..rounds {
            ours.push(time_warm(contenders, round));
            if let Some(other) = &mut self.other {
                others.push(other.time_round());
            }
        }
        if let Some(other) = &mut self.other {
            other.leave();
        }
        let result = group_result(&group.name, group.call, &names, &ours, &others);
        result.print();
        self.result.groups.push(result);
        // After each group, so that a run that is stopped leaves what it has.
        if let Some(path) = self.options.json_path(&self.result.bench) {
            self.result.write(&path);
        }
    }
}

/// Nanoseconds a call of each contender in one round, whose order begins with another contender each time. Each does its work
/// once uncounted, so that the caches hold its own data and not those of the contender before.
fn time_warm(contenders: &[Contender<'_>], round: u64) -> Vec<f64> {
    let mut found = vec![0.0; contenders.len()];
    for turn in 0..contenders.len() {
        let who = (turn + round as usize) % contenders.len();
        let contender = &contenders[who];
        contender.warm_up();
        let ns = time_round(&[contender as &dyn TimedBatch], round);
        found[who] = ns[0].unwrap_or_default();
    }
    found
}

/// Lines of a group, from nanoseconds a call by round and contender.
fn group_result(
    name: &str,
    call: &'static str,
    names: &[&str],
    ours: &[Vec<f64>],
    others: &[Vec<f64>],
) -> GroupResult {
    let mut lines = Vec::new();
    for (i, name) in names.iter().enumerate() {
        let column: Vec<f64> = ours.iter().map(|round| round[i]).collect();
        let to_first = ours.iter().map(|round| round[i] / round[0]).collect();
        let to_other = ours.iter().zip(others).map(|(a, b)| a[i] / b[i]).collect();
        lines.push(LineResult {
            name: (*name).to_owned(),
            cost: CallCost::from_rounds(column),
            to_first: Ratio::from_rounds(to_first),
            to_other: (!others.is_empty()).then(|| Ratio::from_rounds(to_other)),
        });
    }
    GroupResult {
        name: name.to_owned(),
        call,
        rounds: ours.len(),
        lines,
    }
}

/// Contenders that are timed in turn. The first is what the others are compared with.
pub struct Group<'a> {
    name: String,
    call: &'static str,
    contenders: Vec<Contender<'a>>,
}

impl<'a> Group<'a> {
    /// An empty group; `call` is the noun of what is counted, as in "ns a draw".
    pub fn new(name: impl Into<String>, call: &'static str) -> Self {
        Self {
            name: name.into(),
            call,
            contenders: Vec::new(),
        }
    }

    /// Adds a contender whose `work` makes `calls` calls.
    pub fn add<T>(
        &mut self,
        name: impl Into<String>,
        calls: usize,
        mut work: impl FnMut() -> T + 'a,
    ) {
        self.contenders.push(Contender {
            name: name.into(),
            calls,
            repeats: 1,
            is_short: true,
            work: RefCell::new(Box::new(move || {
                black_box(work());
            })),
        });
    }
}

/// Work of a known number of calls, repeated to a batch.
struct Contender<'a> {
    name: String,
    calls: usize,
    repeats: usize,
    is_short: bool,
    work: RefCell<Box<dyn FnMut() + 'a>>,
}

impl Contender<'_> {
    /// Finds how often the work goes into a batch. Returns the CPU seconds of a batch, about.
    fn calibrate(&mut self) -> f64 {
        // Once for the caches, and once to be timed.
        self.run(0);
        let seconds = time(|| self.run(0)).1.cpu.max(1e-7);
        self.repeats = (BATCH_SECONDS / seconds).ceil() as usize;
        self.is_short = seconds < SHORT_SECONDS;
        seconds * self.repeats as f64
    }

    /// Does the work once, unless it is so long that it hardly matters what the caches held before.
    fn warm_up(&self) {
        if self.is_short {
            self.work.borrow_mut()();
        }
    }
}

impl TimedBatch for Contender<'_> {
    fn run(&self, _: u64) -> usize {
        let mut work = self.work.borrow_mut();
        for _ in 0..self.repeats {
            work();
        }
        self.repeats * self.calls
    }
}
