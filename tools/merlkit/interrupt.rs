//! Ctrl-C and SIGTERM: what was finished is kept, nothing is left half-written, and the exit status is 130 or 143; of a command that
//! runs until it is stopped, 0.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};

use merlkit::files::abandon_unfinished;

use crate::failure::Failure;
use crate::output;

type Ending = Box<dyn FnOnce() -> Result<(), Failure> + Send>;

static ENDING: Mutex<Option<Ending>> = Mutex::new(None);
static STOPPING: AtomicBool = AtomicBool::new(false);
/// Whether a signal is the usual end.
static RUNS_UNTIL_STOPPED: AtomicBool = AtomicBool::new(false);

/// From here on, Ctrl-C and SIGTERM run what [`at_end`] was given, and end the process; a second one does not wait for that.
/// Elsewhere than on Unix the system ends the process; only temporary files are left.
#[cfg(unix)]
pub fn install() {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    let Ok(mut signals) = Signals::new([SIGINT, SIGTERM]) else {
        return;
    };
    // Without a thread to wait in, a signal does nothing; the system would have refused the others as well.
    let _ = std::thread::Builder::new().spawn(move || {
        for signal in signals.forever() {
            let work = move || {
                if let Err(Failure::Error(error)) = finish() {
                    output::message(&format!("merlkit: {error}"));
                }
                end(signal)
            };
            if STOPPING.swap(true, Ordering::SeqCst)
                || std::thread::Builder::new().spawn(work).is_err()
            {
                end(signal);
            }
        }
    });
}

/// See the other.
#[cfg(not(unix))]
pub fn install() {}

/// The exit status is 128 and the number of the signal, as shells have it, or 0 if a signal is the usual end.
#[cfg(unix)]
fn end(signal: i32) -> ! {
    abandon_unfinished();
    if RUNS_UNTIL_STOPPED.load(Ordering::SeqCst) {
        std::process::exit(0)
    }
    output::message("merlkit: interrupted");
    std::process::exit(128 + signal)
}

/// From here on a signal is the usual end of the command, and its exit status 0; `ending` runs before it.
pub fn run_until_stopped(ending: impl FnOnce() -> Result<(), Failure> + Send + 'static) {
    RUNS_UNTIL_STOPPED.store(true, Ordering::SeqCst);
    at_end(ending);
}

/// `ending` writes what is finished: once, when the command calls [`finish`], or before that on Ctrl-C.
pub fn at_end(ending: impl FnOnce() -> Result<(), Failure> + Send + 'static) {
    *ENDING.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(ending));
}

/// Runs what [`at_end`] was given, unless that was done; a signal waits until it is done.
pub fn finish() -> Result<(), Failure> {
    let mut ending = ENDING.lock().unwrap_or_else(PoisonError::into_inner);
    ending.take().map_or(Ok(()), |write| write())
}

/// An interrupted command does not end as if it were complete.
pub fn wait_if_stopping() {
    while STOPPING.load(Ordering::SeqCst) {
        std::thread::park();
    }
}

/// Work that stops by itself soon after a signal, and then keeps what it has.
pub struct StoppableWork {
    requested: Arc<AtomicBool>,
    kept: Sender<Result<(), Failure>>,
}

impl StoppableWork {
    /// From here on a signal lets [`Self::should_stop`] say so, shows `message`, and waits for [`Self::end`].
    pub fn begin(message: &'static str) -> Self {
        let requested = Arc::new(AtomicBool::new(false));
        let (kept, outcome) = channel();
        let request = requested.clone();
        at_end(move || {
            request.store(true, Ordering::Relaxed);
            output::message(message);
            // Work that ended without a word has said by itself how it ended.
            outcome.recv().unwrap_or(Ok(()))
        });
        Self { requested, kept }
    }

    /// Whether a signal has come. Costs next to nothing.
    pub fn should_stop(&self) -> bool {
        self.requested.load(Ordering::Relaxed)
    }

    /// The work has ended with `outcome`, which comes back unless a signal has come: then the process ends, and says why it
    /// failed if it did.
    pub fn end(self, outcome: Result<(), Failure>) -> Result<(), Failure> {
        // Whoever answers a signal holds the lock until the work has ended.
        if let Ok(mut ending) = ENDING.try_lock()
            && ending.take().is_some()
        {
            return outcome;
        }
        if self.kept.send(outcome).is_ok() {
            wait_if_stopping();
        }
        Ok(())
    }
}
