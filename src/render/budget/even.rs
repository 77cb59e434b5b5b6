//! Pictures with equally many paths in every pixel.

use super::rounds::{Watch, part_done, paths_a_round, restore_moments, store_moments, trace_round};
use super::words::{WordReader, WordWriter};
use crate::render::film::{Film, RunningMoments};
use crate::render::path_numbers::PathRun;
use crate::render::settings::PixelRegion;
use crate::render::tracer::Tracer;

/// A picture, or a region of one, with `done` paths in every pixel, of `paths`.
pub(super) struct EvenPicture {
    size: [usize; 2],
    paths: u64,
    done: u64,
    moments: Vec<RunningMoments>,
}

impl EvenPicture {
    /// Nothing is traced. The settings are checked.
    pub(super) fn new(region: PixelRegion, paths: u64) -> Self {
        Self {
            size: region.size,
            paths,
            done: 0,
            moments: vec![RunningMoments::default(); region.pixel_count()],
        }
    }

    pub(super) fn is_finished(&self) -> bool {
        self.done == self.paths
    }

    /// Paths that each pixel has, and will have.
    pub(super) fn paths_done(&self) -> (u64, u64) {
        (self.done, self.paths)
    }

    pub(super) fn describe_progress(&self) -> String {
        format!("{} of {} paths per pixel", self.done, self.paths)
    }

    /// Traces round after round, at least one if any is missing, until all are done or the caller wants to stop.
    pub(super) fn advance(&mut self, tracer: &Tracer<'_>, watch: Watch<'_>) {
        let settings = &tracer.settings;
        let (paths, width) = (self.paths, self.size[0] as u64);
        let round = paths_a_round(self.moments.len());
        // Progress counts pixels: of each row, the fraction that the finished rounds are of all paths.
        let pixels_done = |paths_done: u64| part_done(width, paths_done, paths) as usize;
        (watch.progress)(self.size[1] * pixels_done(self.done));
        while !self.is_finished() {
            let from = self.done;
            let to = from.saturating_add(round).min(paths);
            let paths_of = |pixel| PathRun {
                pixel,
                seed: settings.pixel_seed(pixel),
                from,
                to,
                count: paths,
            };
            trace_round(tracer, &mut self.moments, paths_of, || {
                (watch.progress)(pixels_done(to) - pixels_done(from));
            });
            self.done = to;
            if (watch.should_stop)() {
                break;
            }
        }
    }

    pub(super) fn into_film(self) -> Film {
        let [width, height] = self.size;
        let pixels = self.moments.into_iter().map(|moments| moments.pixel());
        Film::new(width, height, pixels.collect())
    }

    pub(super) fn store(&self) -> WordWriter {
        let mut out = WordWriter::with_capacity(1 + 6 * self.moments.len());
        out.count(self.done);
        store_moments(&self.moments, &mut out);
        out
    }

    /// Takes over what [`Self::store`] gave; `None` if it is nothing that paths can have left.
    pub(super) fn restore(&mut self, from: &mut WordReader<'_>) -> Option<()> {
        self.done = from.count().filter(|done| *done <= self.paths)?;
        let done = self.done;
        restore_moments(from, &mut self.moments, |_| done)
    }
}
