//! A bar on standard error for work that takes longer than a second.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Counts finished parts; draws nothing before the first second is over or where standard error is no terminal.
pub struct Progress {
    bar: ProgressBar,
    started: Instant,
}

const PATIENCE: Duration = Duration::from_secs(1);

impl Progress {
    /// A bar of `parts` under the given verb.
    pub fn new(verb: &'static str, parts: usize) -> Self {
        let bar = ProgressBar::with_draw_target(Some(parts as u64), ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{msg} {bar:30} {pos}/{len}, {eta} left") {
            bar.set_style(style.progress_chars("##-"));
        }
        bar.set_message(verb);
        Self {
            bar,
            started: Instant::now(),
        }
    }

    /// Prints something with the bar out of the way.
    pub fn aside<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }

    /// One part is done. May be called from any thread.
    pub fn advance(&self) {
        self.advance_by(1);
    }

    /// Some parts are done. May be called from any thread.
    pub fn advance_by(&self, parts: usize) {
        if self.bar.is_hidden() && self.started.elapsed() > PATIENCE {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.bar.inc(parts as u64);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
