//! Pictures of a given number of paths, most of them where they matter.
//!
//! A few paths in every pixel tell how far single paths are apart there, and the rest are shared out by that. A pixel's share
//! that looked at its own paths would bias the picture, as a decision to stop does (see [`super::render_to_error`]). So pixels
//! are of two colours, like a chessboard's fields, and a pixel's share depends on paths of the other colour alone.

use rayon::prelude::*;

use super::film::{Pixel, Tally};
use super::path::{PathId, Tracer};
use super::{EffectPlan, Film, Scene, Settings};
use crate::points::mix;
use crate::{Error, Result};

/// Of all paths, one in so many looks ahead.
const AHEAD: u64 = 8;
/// Fewer paths that look ahead tell too little.
const FEWEST: u64 = 4;
/// Fewer samples a pixel than this are not shared out.
pub const LEAST_ALLOCATED: u64 = 4 * FEWEST;
/// Pixels on each side that a pixel's share looks at.
const REACH: usize = 2;
/// Squared errors of well-spread points fall as n^−1.5 or so, see `docs/performance.md`; their sum is least if numbers of paths go
/// with the power 1/2.5 of their factors.
const POWER: f64 = 0.4;
/// Darker than this share of the picture's mean, a pixel's error is told by this in place of its own brightness.
const DARK: f64 = 0.1;
/// No pixel gets more than so many times the mean.
const MOST: f64 = 256.0;
/// None gets fewer: one path has no spread to tell an error by.
const LEAST: f64 = 2.0;
/// Sets the first look's numbers apart from all others of a pixel.
const LOOK: u64 = 0x6c6f_6f6b;

/// Renders `scene`, which was built for `plan`, as [`super::render()`] does, with about as many paths, but shared out so that the
/// mean over the pixels of their relative squared errors is small: more go where the paths of a first look around are far apart,
/// beside the brightness there; at most 256 times the mean, so that there are fewer where nearly nothing is noisy.
///
/// The picture is as unbiased as with a number of paths chosen beforehand. Where the first look sees nothing of a light that
/// is rarely hit, its pixels get few paths.
///
/// # Errors
/// [`Error::Argument`] for less than [`LEAST_ALLOCATED`] samples, and as [`super::render()`].
pub fn render_allocated(
    scene: &Scene,
    plan: &EffectPlan,
    settings: &Settings,
    progress: &(dyn Fn(usize) + Sync),
) -> Result<Film> {
    let Settings {
        width,
        height,
        samples,
        ..
    } = *settings;
    let count = settings.pixels()?;
    if samples < LEAST_ALLOCATED {
        let fix =
            format!("give {LEAST_ALLOCATED} or more: some of them look where to send the rest");
        return Err(Error::argument(
            format!("{samples} samples a pixel to share out"),
            fix,
        ));
    }
    let tracer = Tracer::new(scene, plan, settings);
    let ahead = (samples / AHEAD).max(FEWEST);
    let mut looks = vec![Tally::default(); count];
    looks
        .par_chunks_mut(width)
        .enumerate()
        .for_each(|(y, row)| {
            let seed = |x| mix(settings.pixel_seed([x, y]) ^ mix(LOOK));
            tally(&tracer, y, row, |x| (seed(x), ahead));
        });
    let numbers = share_out(&looks, width, samples - ahead);
    let mut pixels = vec![Pixel::default(); count];
    pixels
        .par_chunks_mut(width)
        .enumerate()
        .for_each(|(y, row)| {
            let mut tallies = vec![Tally::default(); row.len()];
            tally(&tracer, y, &mut tallies, |x| {
                (settings.pixel_seed([x, y]), numbers[y * width + x])
            });
            for (pixel, (tally, look)) in
                row.iter_mut().zip(tallies.iter().zip(&looks[y * width..]))
            {
                *pixel = together(look, tally);
            }
            progress(width);
        });
    Ok(Film::new(width, height, pixels))
}

/// Adds the paths of a row's pixels, of each as many as `plan` says and from its seed.
fn tally(tracer: &Tracer<'_>, y: usize, row: &mut [Tally], plan: impl Fn(usize) -> (u64, u64)) {
    let paths = (0..row.len()).flat_map(|x| {
        let (seed, count) = plan(x);
        (0..count).map(move |index| PathId {
            pixel: [x, y],
            seed,
            index,
            count,
        })
    });
    tracer.trace(paths, |path, radiance| row[path.pixel[0]].add(radiance));
}

/// Mean of two means, each weighing as its squared error is expected to fall with its number of paths.
fn together(look: &Tally, rest: &Tally) -> Pixel {
    let weight = |tally: &Tally| tally.count().powf(1.0 / POWER - 1.0);
    let (a, b) = (weight(look), weight(rest));
    let (x, y) = (look.pixel(), rest.pixel());
    let error = (x.error * a).powf(2.0) + (y.error * b).powf(2.0);
    Pixel {
        mean: (x.mean * a + y.mean * b) / (a + b),
        error: error.map(f64::sqrt) / (a + b),
    }
}

/// Numbers of paths, `mean` on average over each colour as far as [`LEAST`] and [`MOST`] allow.
fn share_out(looks: &[Tally], width: usize, mean: u64) -> Vec<u64> {
    let mut numbers = vec![0; looks.len()];
    for colour in [0, 1] {
        let of =
            |colour: usize| (0..looks.len()).filter(move |i| (i % width + i / width) % 2 == colour);
        // A picture of one pixel has no other colour.
        let other = if of(1 - colour).next().is_some() {
            1 - colour
        } else {
            colour
        };
        let (sum, seen) = of(other).fold((0.0, 0.0), |(sum, n), i| {
            (sum + brightness(&looks[i]), n + 1.0)
        });
        let dark = DARK * sum / seen;
        let score = |pixel: usize| score(looks, width, pixel, dark, other);
        let scores: Vec<f64> = of(colour)
            .collect::<Vec<_>>()
            .into_par_iter()
            .map(score)
            .collect();
        for (pixel, number) in of(colour).zip(in_proportion(&scores, mean as f64)) {
            numbers[pixel] = number.round() as u64;
        }
    }
    numbers
}

/// Numbers in proportion to `scores` but for those beyond the bounds, with the given mean where they can have it.
fn in_proportion(scores: &[f64], mean: f64) -> Vec<f64> {
    let (least, most) = (LEAST.min(mean), MOST * mean);
    let number = |score: f64, scale: f64| (score * scale).clamp(least, most);
    let sum: f64 = scores.iter().sum();
    if !(sum > 0.0 && sum.is_finite()) {
        return vec![mean; scores.len()];
    }
    // Each round gives what the bounds took or added to those between them.
    let mut scale = mean * scores.len() as f64 / sum;
    for _ in 0..ROUNDS {
        let (mut rest, mut open) = (mean * scores.len() as f64, 0.0);
        for &score in scores {
            let number = number(score, scale);
            if number > least && number < most {
                open += score
            } else {
                rest -= number
            }
        }
        if open == 0.0 || rest <= 0.0 {
            break;
        }
        scale = rest / open;
    }
    scores.iter().map(|&score| number(score, scale)).collect()
}

/// After which few pixels still pass a bound.
const ROUNDS: usize = 8;

fn brightness(look: &Tally) -> f64 {
    look.mean().element_sum() / 3.0
}

/// In proportion to the number of paths that a pixel should get, by the pixels of a colour about it.
fn score(looks: &[Tally], width: usize, pixel: usize, dark: f64, colour: usize) -> f64 {
    let (x, y, height) = (pixel % width, pixel / width, looks.len() / width);
    let span = |at: usize, end: usize| at.saturating_sub(REACH)..(at + REACH + 1).min(end);
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
    // By roots: squares of what is dim would vanish.
    ((variance / count).sqrt() / (level / count).hypot(dark)).powf(2.0 * POWER)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// Looks of eight paths that are apart by `spread` about `mean`.
    fn look(mean: f64, spread: f64) -> Tally {
        let mut tally = Tally::default();
        (0..8).for_each(|i| {
            tally.add(DVec3::splat(
                mean + if i % 2 == 0 { spread } else { -spread },
            ))
        });
        tally
    }

    #[test]
    fn noisy_places_get_more_and_the_sum_stays() {
        let noisy = |i: usize| i % 20 >= 10;
        let looks: Vec<Tally> = (0..20 * 20)
            .map(|i| look(1.0, if noisy(i) { 0.5 } else { 0.05 }))
            .collect();
        let numbers = share_out(&looks, 20, 50);
        let mean = numbers.iter().sum::<u64>() as f64 / 400.0;
        assert!((mean / 50.0 - 1.0).abs() < 0.02, "{mean}");
        // A hundred times the variance: 100^0.4.
        let ratio = numbers[19] as f64 / numbers[0] as f64;
        assert!((ratio / 6.31 - 1.0).abs() < 0.1, "{ratio}");
    }

    #[test]
    fn no_pixel_decides_for_itself() {
        let mut looks = vec![look(1.0, 0.1); 11 * 9];
        let before = share_out(&looks, 11, 50);
        looks[49] = look(9.0, 5.0);
        let after = share_out(&looks, 11, 50);
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
                share_out(&looks, 4.min(looks.len()), 30)
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
        let (mut few, mut many) = (Tally::default(), Tally::default());
        few.add(DVec3::ZERO);
        (0..4).for_each(|_| many.add(DVec3::ONE));
        assert!((together(&few, &many).mean.x - 8.0 / 9.0).abs() < 1e-15);
    }
}
