//! A watchdog: an input that takes for ever ends the test, with the input named.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::thread;
use std::time::{Duration, Instant};

/// Far beyond what the longest input takes on a busy machine.
const LIMIT: Duration = Duration::from_secs(60);

/// What each thread of the pool is at, and since when.
pub struct Watch {
    start: Instant,
    limit: Duration,
    slots: Vec<[AtomicU64; 2]>,
    done: AtomicBool,
}

impl Watch {
    pub fn new() -> Self {
        Self::with_limit(LIMIT)
    }

    pub fn with_limit(limit: Duration) -> Self {
        let slots = (0..rayon::current_num_threads())
            .map(|_| Default::default())
            .collect();
        Self {
            start: Instant::now(),
            limit,
            slots,
            done: AtomicBool::new(false),
        }
    }

    /// Milliseconds since the start, never 0.
    fn now(&self) -> u64 {
        self.start.elapsed().as_millis() as u64 + 1
    }

    /// Runs `work` on input `number` under watch.
    pub fn during<T>(&self, number: u64, work: impl FnOnce() -> T) -> T {
        let [input, since] = &self.slots[rayon::current_thread_index().unwrap_or(0)];
        // A thread that waits inside one input may take another meanwhile.
        let before = (input.swap(number, Relaxed), since.swap(self.now(), Relaxed));
        let result = work();
        input.store(before.0, Relaxed);
        since.store(before.1, Relaxed);
        result
    }

    /// An input that has been at it beyond the limit.
    pub fn stuck(&self) -> Option<u64> {
        let (now, limit) = (self.now(), self.limit.as_millis() as u64);
        let stuck =
            |s: &&[AtomicU64; 2]| s[1].load(Relaxed) > 0 && now > s[1].load(Relaxed) + limit;
        self.slots.iter().find(stuck).map(|s| s[0].load(Relaxed))
    }

    /// Runs `work`, and ends the process if an input hangs; `keep` writes such an input and says where.
    pub fn guard<T>(&self, keep: impl Fn(u64) -> PathBuf + Sync, work: impl FnOnce() -> T) -> T {
        thread::scope(|scope| {
            let dog = scope.spawn(|| {
                while !self.done.load(Relaxed) {
                    if let Some(number) = self.stuck() {
                        eprintln!("{}: no end after {:?}", keep(number).display(), self.limit);
                        std::process::abort();
                    }
                    thread::park_timeout(Duration::from_secs(1));
                }
            });
            let result = work();
            self.done.store(true, Relaxed);
            dog.thread().unpark();
            result
        })
    }
}
