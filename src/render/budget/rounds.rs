//! Rounds: the pieces in which a picture is traced, after each of which it can be stopped.

use glam::DVec3;
use rayon::prelude::*;

use super::words::{WordReader, WordWriter};
use crate::render::bundle::{BUNDLE, Bundle};
use crate::render::film::RunningMoments;
use crate::render::path_numbers::PathRun;
use crate::render::tracer::Tracer;

/// Paths of a round, about, where pixels are few: a second of work or less.
const ROUND_PATHS: u64 = 1 << 20;
/// Paths of a round, at most, where that leaves each pixel one: ten seconds of work or so.
const MOST_PATHS: u64 = 1 << 24;

/// What a picture's caller hears of it, and decides, while it is traced.
#[derive(Clone, Copy)]
pub(super) struct Watch<'a> {
    /// Whether to stop as soon as the picture can go on from there with the same bits.
    pub(super) should_stop: &'a (dyn Fn() -> bool + Sync),
    /// Called with a number of pixels that have been done meanwhile, from any thread.
    pub(super) progress: &'a (dyn Fn(usize) + Sync),
}

/// Paths of a round in each of `pixels` pixels. Whole bundles, so that one round costs as much as all at once; where these would be
/// too many, a power of two, so that a bundle has whole pixels.
pub(super) fn paths_a_round(pixels: usize) -> u64 {
    let (pixels, bundle) = (pixels.max(1) as u64, BUNDLE as u64);
    if pixels * bundle > MOST_PATHS {
        let most = (MOST_PATHS / pixels).max(1);
        return 1 << most.ilog2();
    }
    (ROUND_PATHS / pixels / bundle).max(1) * bundle
}

/// How many of `whole` are done when `round` of `rounds` rounds are: ⌊whole · round / rounds⌋.
pub(super) fn part_done(whole: u64, round: u64, rounds: u64) -> u64 {
    // Not above `whole`, since `round` is not above `rounds`.
    (u128::from(whole) * u128::from(round) / u128::from(rounds.max(1))) as u64
}

/// Traces one round: for each pixel of the tracer's region the paths that `paths_of([x, y])` returns. Each pixel's paths are added in
/// order, so that the moments have the same bits for any rounds and any number of threads. `row_done` is called after each row.
pub(super) fn trace_round(
    tracer: &Tracer<'_>,
    moments: &mut [RunningMoments],
    paths_of: impl Fn([usize; 2]) -> PathRun + Sync,
    row_done: impl Fn() + Sync,
) {
    let rows = moments.par_chunks_mut(tracer.region.size[0]).enumerate();
    rows.for_each_init(Bundle::default, |bundle, (y, row)| {
        let runs = (0..row.len()).map(|x| paths_of(tracer.region.pixel(x, y)));
        tracer.trace(runs, bundle, |x, radiance| row[x].add(radiance));
        row_done();
    });
}

/// Stores what moments hold apart from their counts.
pub(super) fn store_moments(moments: &[RunningMoments], out: &mut WordWriter) {
    for pixel in moments {
        out.vector(pixel.mean());
        out.vector(pixel.squares());
    }
}

/// Restores moments, `count(i)` samples in the i-th; `None` if they are none that paths can have.
pub(super) fn restore_moments(
    from: &mut WordReader<'_>,
    moments: &mut [RunningMoments],
    count: impl Fn(usize) -> u64,
) -> Option<()> {
    for (i, pixel) in moments.iter_mut().enumerate() {
        let mean = from.vector()?;
        let squares = from.vector()?;
        if squares.cmplt(DVec3::ZERO).any() {
            return None;
        }
        *pixel = RunningMoments::new(count(i), mean, squares);
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_are_of_whole_bundles_and_cover_everything() {
        assert_eq!(paths_a_round(1), 1 << 20);
        assert_eq!(paths_a_round(2000), 512);
        assert_eq!(paths_a_round(640 * 400), 64);
        assert_eq!(paths_a_round(1920 * 1080), 8);
        assert_eq!(paths_a_round(1 << 27), 1);
        assert_eq!(part_done(u64::MAX, 7, 7), u64::MAX);
        let parts: Vec<u64> = (0..=4).map(|round| part_done(10, round, 4)).collect();
        assert_eq!(parts, [0, 2, 5, 7, 10]);
    }
}
