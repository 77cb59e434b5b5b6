//! Pictures of a given number of paths, most of them where they matter.
//!
//! A few paths in every pixel measure how far single paths are apart there, and the rest are distributed by that. A pixel
//! whose number of paths depended on its own paths would bias the picture, as a decision to stop does (see
//! [`super::to_error`]). So pixels are of two colours, like the squares of a chessboard, and a pixel's number of paths depends
//! on paths of the other colour alone.

use rayon::prelude::*;

use super::rounds::{Watch, part_done, paths_a_round, restore_moments, store_moments, trace_round};
use super::words::{WordReader, WordWriter};
use crate::points::mix;
use crate::render::film::{Film, Pixel, RunningMoments};
use crate::render::path_numbers::PathRun;
use crate::render::settings::RenderSettings;
use crate::render::tracer::Tracer;

/// Of all paths, one in so many looks ahead.
const AHEAD: u64 = 8;
/// Paths per pixel of the first look are at least so many: fewer say too little.
const FEWEST: u64 = 4;
/// Pixels on each side whose first looks decide about a pixel's number of paths.
const REACH: usize = 2;
/// Squared errors of well-spread points fall as n^−1.5 or so, see `docs/performance.md`; their sum is least if numbers of paths go
/// with the power 1/2.5 of their factors.
const POWER: f64 = 0.4;
/// Where a pixel is darker than this fraction of the picture's mean, its error is measured relative to that brightness.
const DARK: f64 = 0.1;
/// No pixel gets more than so many times the mean.
const MOST: f64 = 256.0;
/// No pixel gets fewer: one path has no spread to estimate an error from.
const LEAST: f64 = 2.0;
/// Sets the first look's numbers apart from all others of a pixel.
const LOOK: u64 = 0x6c6f_6f6b;

/// A picture with `paths` paths per pixel on average, as far as it has come.
pub(super) struct AdaptivePicture {
    width: usize,
    /// Paths per pixel of the first look, and those that have been traced.
    ahead: u64,
    looked: u64,
    looks: Vec<RunningMoments>,
    /// The other paths, on average, and how many each pixel gets; none before the first look is complete.
    rest: u64,
    numbers: Vec<u64>,
    /// Rounds in which these are traced, and those that have been.
    rounds: u64,
    done: u64,
    moments: Vec<RunningMoments>,
}

impl AdaptivePicture {
    /// Nothing is traced. The settings are checked: `paths` is ≥ 16.
    pub(super) fn new(settings: &RenderSettings, paths: u64) -> Self {
        let pixels = settings.width * settings.height;
        let ahead = (paths / AHEAD).max(FEWEST);
        let rest = paths - ahead;
        Self {
            width: settings.width,
            ahead,
            looked: 0,
            looks: vec![RunningMoments::default(); pixels],
            rest,
            numbers: Vec::new(),
            rounds: rest.div_ceil(paths_a_round(pixels)),
            done: 0,
            moments: vec![RunningMoments::default(); pixels],
        }
    }

    pub(super) fn is_finished(&self) -> bool {
        self.done == self.rounds
    }

    pub(super) fn describe_progress(&self) -> String {
        let paths = self.looked + part_done(self.rest, self.done, self.rounds);
        let all = self.ahead + self.rest;
        format!("about {paths} of {all} paths per pixel")
    }

    /// Traces round after round, at least one if any is missing, until all are done or the caller wants to stop.
    pub(super) fn advance(&mut self, tracer: &Tracer<'_>, watch: Watch<'_>) {
        // Step 1: a first look with an eighth of the paths, from numbers of its own.
        let is_stopped = self.look_ahead(tracer, watch);
        if is_stopped {
            return;
        }
        // Step 2: decide how many of the others each pixel gets.
        if self.numbers.is_empty() {
            self.numbers = distribute(&self.looks, self.width, self.rest);
        }
        // Step 3: trace these.
        self.trace_rest(tracer, watch);
    }

    /// Whether the caller wanted to stop.
    fn look_ahead(&mut self, tracer: &Tracer<'_>, watch: Watch<'_>) -> bool {
        let settings = &tracer.settings;
        let ahead = self.ahead;
        let round = paths_a_round(self.looks.len());
        while self.looked < ahead {
            let from = self.looked;
            let to = (from + round).min(ahead);
            let paths_of = |pixel| PathRun {
                pixel,
                seed: mix(settings.pixel_seed(pixel) ^ mix(LOOK)),
                from,
                to,
                count: ahead,
            };
            trace_round(tracer, &mut self.looks, paths_of, || {});
            self.looked = to;
            if (watch.should_stop)() {
                return true;
            }
        }
        false
    }

    fn trace_rest(&mut self, tracer: &Tracer<'_>, watch: Watch<'_>) {
        let settings = &tracer.settings;
        let width = self.width;
        let rounds = self.rounds;
        let numbers = &self.numbers;
        let pixels_done = |round| part_done(width as u64, round, rounds) as usize;
        (watch.progress)(settings.height * pixels_done(self.done));
        while self.done < rounds {
            let round = self.done;
            let paths_of = |[x, y]: [usize; 2]| {
                let count = numbers[y * width + x];
                PathRun {
                    pixel: [x, y],
                    seed: settings.pixel_seed([x, y]),
                    from: part_done(count, round, rounds),
                    to: part_done(count, round + 1, rounds),
                    count,
                }
            };
            trace_round(tracer, &mut self.moments, paths_of, || {
                (watch.progress)(pixels_done(round + 1) - pixels_done(round));
            });
            self.done += 1;
            if (watch.should_stop)() {
                break;
            }
        }
    }

    /// Puts both estimates of each pixel together.
    pub(super) fn into_film(self, settings: &RenderSettings) -> Film {
        let estimates = self.looks.into_iter().zip(&self.moments);
        let pixels = estimates.map(|(look, rest)| combine(&look, rest));
        Film::new(settings.width, settings.height, pixels.collect())
    }

    pub(super) fn store(&self) -> WordWriter {
        let mut out = WordWriter::with_capacity(2 + 12 * self.looks.len());
        out.count(self.looked);
        out.count(self.done);
        store_moments(&self.looks, &mut out);
        store_moments(&self.moments, &mut out);
        out
    }

    /// Takes over what [`Self::store`] gave; `None` if it is nothing that paths can have left.
    pub(super) fn restore(&mut self, from: &mut WordReader<'_>) -> Option<()> {
        let looked = from.count().filter(|looked| *looked <= self.ahead)?;
        let done = from.count().filter(|done| *done <= self.rounds)?;
        restore_moments(from, &mut self.looks, |_| looked)?;
        // The first look decides how many of the other paths each pixel gets, so these numbers are not stored.
        let mut numbers = Vec::new();
        if looked == self.ahead {
            numbers = distribute(&self.looks, self.width, self.rest);
        } else if done > 0 {
            return None;
        }
        let rounds = self.rounds;
        restore_moments(from, &mut self.moments, |i| {
            numbers
                .get(i)
                .map_or(0, |&count| part_done(count, done, rounds))
        })?;
        (self.looked, self.done, self.numbers) = (looked, done, numbers);
        Some(())
    }
}

/// Mean of two means, each weighing as its squared error is expected to fall with its number of paths.
fn combine(look: &RunningMoments, rest: &RunningMoments) -> Pixel {
    // The weights a and b are n^(1/p − 1) for n paths; the mean is (a x + b y)/(a + b), and its error √(a² δx² + b² δy²)/(a + b).
    let [a, b] = [look, rest].map(|moments| moments.count().powf(1.0 / POWER - 1.0));
    let (x, y) = (look.pixel(), rest.pixel());
    let error = (x.error * a).powf(2.0) + (y.error * b).powf(2.0);
    Pixel {
        mean: (x.mean * a + y.mean * b) / (a + b),
        error: error.map(f64::sqrt) / (a + b),
    }
}

/// Numbers of paths, `mean` on average over each colour as far as [`LEAST`] and [`MOST`] allow.
fn distribute(looks: &[RunningMoments], width: usize, mean: u64) -> Vec<u64> {
    let mut numbers = vec![0; looks.len()];
    for colour in [0, 1] {
        // A picture of one pixel has no other colour.
        let other = if pixels_of_colour(1 - colour, width, looks.len()).is_empty() {
            colour
        } else {
            1 - colour
        };
        // Brightness below which errors are not relative to the pixel's own.
        let (mut sum, mut count) = (0.0, 0.0);
        for pixel in pixels_of_colour(other, width, looks.len()) {
            sum += brightness(&looks[pixel]);
            count += 1.0;
        }
        let dark = DARK * sum / count;
        // Numbers of paths in proportion to the noise that the other colour shows around each pixel.
        let pixels = pixels_of_colour(colour, width, looks.len());
        let scores: Vec<f64> = pixels
            .par_iter()
            .map(|&pixel| noise_score(looks, width, pixel, dark, other))
            .collect();
        for (pixel, number) in pixels.iter().zip(in_proportion(&scores, mean as f64)) {
            numbers[*pixel] = number.round() as u64;
        }
    }
    numbers
}

/// The pixels of one colour of the chessboard.
fn pixels_of_colour(colour: usize, width: usize, count: usize) -> Vec<usize> {
    (0..count)
        .filter(|i| (i % width + i / width) % 2 == colour)
        .collect()
}

/// Numbers in proportion to `scores` but for those beyond the bounds, with the given mean where they can have it.
fn in_proportion(scores: &[f64], mean: f64) -> Vec<f64> {
    let (least, most) = (LEAST.min(mean), MOST * mean);
    let sum: f64 = scores.iter().sum();
    // Where no noise was seen, nothing says that one pixel needs more than another.
    if !(sum > 0.0 && sum.is_finite()) {
        return vec![mean; scores.len()];
    }
    // Each round gives what the bounds took or added to those between them.
    let mut scale = mean * scores.len() as f64 / sum;
    for _ in 0..ROUNDS {
        let mut rest = mean * scores.len() as f64;
        let mut open = 0.0;
        for &score in scores {
            let number = (score * scale).clamp(least, most);
            if number > least && number < most {
                open += score;
            } else {
                rest -= number;
            }
        }
        if open == 0.0 || rest <= 0.0 {
            break;
        }
        scale = rest / open;
    }
    let mut numbers = Vec::with_capacity(scores.len());
    for score in scores {
        numbers.push((score * scale).clamp(least, most));
    }
    numbers
}

/// After which few pixels still pass a bound.
const ROUNDS: usize = 8;

fn brightness(look: &RunningMoments) -> f64 {
    look.mean().element_sum() / 3.0
}

/// In proportion to the number of paths that a pixel should get, by the pixels of a colour about it.
fn noise_score(
    looks: &[RunningMoments],
    width: usize,
    pixel: usize,
    dark: f64,
    colour: usize,
) -> f64 {
    let x = pixel % width;
    let y = pixel / width;
    let height = looks.len() / width;
    let span =
        |middle: usize, end: usize| middle.saturating_sub(REACH)..(middle + REACH + 1).min(end);
    let (mut variance, mut level, mut count) = (0.0, 0.0, 0.0);
    for (i, j) in span(y, height).flat_map(|j| span(x, width).map(move |i| (i, j))) {
        if (i + j) % 2 == colour {
            let look = &looks[j * width + i];
            variance += look.variance().element_sum() / 3.0;
            level += brightness(look);
            count += 1.0;
        }
    }
    if count == 0.0 || variance == 0.0 {
        return 0.0;
    }
    // Σ v·n^−1.5 is least for a given Σ n if n ∝ v^(1/2.5), here with v = variance/(level² + dark²).
    // By roots: squares of what is dim would vanish.
    ((variance / count).sqrt() / (level / count).hypot(dark)).powf(2.0 * POWER)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// Looks of eight paths that are apart by `spread` about `mean`.
    fn look(mean: f64, spread: f64) -> RunningMoments {
        let mut moments = RunningMoments::default();
        (0..8).for_each(|i| {
            moments.add(DVec3::splat(
                mean + if i % 2 == 0 { spread } else { -spread },
            ))
        });
        moments
    }

    #[test]
    fn noisy_places_get_more_and_the_sum_stays() {
        let noisy = |i: usize| i % 20 >= 10;
        let looks: Vec<RunningMoments> = (0..20 * 20)
            .map(|i| look(1.0, if noisy(i) { 0.5 } else { 0.05 }))
            .collect();
        let numbers = distribute(&looks, 20, 50);
        let mean = numbers.iter().sum::<u64>() as f64 / 400.0;
        assert!((mean / 50.0 - 1.0).abs() < 0.02, "{mean}");
        // A hundred times the variance: 100^0.4.
        let ratio = numbers[19] as f64 / numbers[0] as f64;
        assert!((ratio / 6.31 - 1.0).abs() < 0.1, "{ratio}");
    }

    #[test]
    fn no_pixel_decides_for_itself() {
        let mut looks = vec![look(1.0, 0.1); 11 * 9];
        let before = distribute(&looks, 11, 50);
        looks[49] = look(9.0, 5.0);
        let after = distribute(&looks, 11, 50);
        assert_eq!(before[49], after[49]);
        assert!(after[48] > 2 * before[48]);
    }

    #[test]
    fn pictures_without_noise_or_light_are_even() {
        for looks in [
            vec![look(0.0, 0.0); 12],
            vec![look(2.0, 0.0); 12],
            vec![look(2.0, 0.0); 1],
        ] {
            assert!(
                distribute(&looks, 4.min(looks.len()), 30)
                    .iter()
                    .all(|&n| n == 30)
            );
        }
    }

    #[test]
    fn bounds_leave_the_mean_as_it_is() {
        for (noisy, mean) in [(1.0, 30.0), (1e3, 30.0), (1e6, 12.0)] {
            let scores: Vec<f64> = (0..1000)
                .map(|i| if i % 50 == 0 { noisy } else { 1.0 })
                .collect();
            let numbers = in_proportion(&scores, mean);
            assert!(
                (numbers.iter().sum::<f64>() / (1000.0 * mean) - 1.0).abs() < 1e-9,
                "{noisy}"
            );
            assert!(numbers.iter().all(|n| (LEAST..=MOST * mean).contains(n)));
        }
    }

    #[test]
    fn means_weigh_by_their_numbers_of_paths() {
        let (mut few, mut many) = (RunningMoments::default(), RunningMoments::default());
        few.add(DVec3::ZERO);
        (0..4).for_each(|_| many.add(DVec3::ONE));
        assert!((combine(&few, &many).mean.x - 8.0 / 9.0).abs() < 1e-15);
    }
}
