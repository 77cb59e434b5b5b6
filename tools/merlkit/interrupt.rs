//! Ctrl-C: what was finished is kept, nothing is left half-written, and the exit status is 130.

use std::process::exit;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use merlkit::files::abandon_unfinished;

use crate::failure::Failure;
use crate::output;

type Ending = Box<dyn FnOnce() -> Result<(), Failure> + Send>;

static ENDING: Mutex<Option<Ending>> = Mutex::new(None);
static STOPPING: AtomicBool = AtomicBool::new(false);

/// 128 and the number of the signal, as shells have it.
const STATUS: i32 = 130;

/// From here on, Ctrl-C runs what [`at_end`] was given, and ends the process; a second Ctrl-C does not wait for that.
pub fn install() {
    // Where there is no handler, the system ends the process; only temporary files would be left.
    let _ = ctrlc::set_handler(|| {
        let work = || {
            if let Err(Failure::Error(error)) = finish() {
                output::message(&format!("merlkit: {error}"));
            }
            end()
        };
        if STOPPING.swap(true, Ordering::SeqCst) || std::thread::Builder::new().spawn(work).is_err() {
            end();
        }
    });
}

fn end() -> ! {
    abandon_unfinished();
    output::message("merlkit: interrupted");
    exit(STATUS)
}

/// `ending` writes what is finished: once, when the command calls [`finish`], or before that on Ctrl-C.
pub fn at_end(ending: impl FnOnce() -> Result<(), Failure> + Send + 'static) {
    *ENDING.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(ending));
}

/// Runs what [`at_end`] was given, unless that was done; Ctrl-C waits until it is done.
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
