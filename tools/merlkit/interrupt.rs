//! Ctrl-C and SIGTERM: what was finished is kept, nothing is left half-written, and the exit status is 130 or 143.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use merlkit::files::abandon_unfinished;

use crate::failure::Failure;
use crate::output;

type Ending = Box<dyn FnOnce() -> Result<(), Failure> + Send>;

static ENDING: Mutex<Option<Ending>> = Mutex::new(None);
static STOPPING: AtomicBool = AtomicBool::new(false);

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

/// The exit status is 128 and the number of the signal, as shells have it.
#[cfg(unix)]
fn end(signal: i32) -> ! {
    abandon_unfinished();
    output::message("merlkit: interrupted");
    std::process::exit(128 + signal)
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
