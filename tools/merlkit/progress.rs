//! A bar on standard error for work that takes longer than a second.

use std::fmt::Write;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

/// Counts finished parts; draws nothing before the first second is over or where standard error is no terminal. From then on
/// it is drawn anew several times a second, whether a part is finished or not.
pub struct Progress {
    bar: ProgressBar,
    /// Ends the watcher when it is dropped.
    end: Option<Sender<()>>,
    watcher: Option<JoinHandle<()>>,
}

/// A command that is done sooner shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);
/// Time between two drawings.
const REDRAW: Duration = Duration::from_millis(250);

/// The bar that is on the terminal, if one is: messages are printed above it.
static SHOWN: Mutex<Option<ProgressBar>> = Mutex::new(None);

fn shown() -> MutexGuard<'static, Option<ProgressBar>> {
    SHOWN.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Progress {
    /// A bar of `parts` under the given verb.
    pub fn new(verb: &'static str, parts: usize) -> Self {
        let bar = ProgressBar::with_draw_target(Some(parts as u64), ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{msg} {bar:30} {pos}/{len}, {rest}") {
            let style = style.with_key("rest", write_rest);
            bar.set_style(style.progress_chars("##-"));
        }
        bar.set_message(verb);
        let (end, ended) = channel();
        let watched = bar.clone();
        // Work in one part, or whose first part is long, would otherwise show nothing until it is done.
        let watcher = thread::spawn(move || {
            if ended.recv_timeout(PATIENCE) != Err(RecvTimeoutError::Timeout) {
                return;
            }
            watched.set_draw_target(ProgressDrawTarget::stderr());
            *shown() = Some(watched.clone());
            while ended.recv_timeout(REDRAW) == Err(RecvTimeoutError::Timeout) {
                watched.tick();
            }
        });
        Self {
            bar,
            end: Some(end),
            watcher: Some(watcher),
        }
    }

    /// One part is done. May be called from any thread.
    pub fn advance(&self) {
        self.advance_by(1);
    }

    /// Some parts are done. May be called from any thread.
    pub fn advance_by(&self, parts: usize) {
        self.bar.inc(parts as u64);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        drop(self.end.take());
        if let Some(watcher) = self.watcher.take() {
            let _ = watcher.join();
        }
        *shown() = None;
        self.bar.finish_and_clear();
    }
}

/// Prints something to the terminal with the bar out of the way, should there be one. `print` advances no bar.
pub fn print_above<T>(print: impl FnOnce() -> T) -> T {
    let bar = shown().clone();
    match bar {
        Some(bar) => bar.suspend(print),
        None => print(),
    }
}

/// How long it takes from now on, as far as finished parts tell; before the first one, and after the last, how long it has
/// taken.
fn write_rest(state: &ProgressState, out: &mut dyn Write) {
    let is_known = state.pos() > 0 && Some(state.pos()) < state.len();
    let written = if is_known {
        write!(out, "{} left", HumanDuration(state.eta()))
    } else {
        write!(out, "{} so far", HumanDuration(state.elapsed()))
    };
    // A bar that can't be drawn is no reason to stop the work.
    let _ = written;
}
