//! Pictures of a given error: paths until the estimated error of each tile is small enough.
//!
//! Each pixel's paths are 8 replicates under independent scrambles. How far their means are apart estimates the error of a
//! pixel's mean, for Sobol points as for random ones, where the spread of single paths would overestimate it.
//!
//! A decision to stop that looks at the paths it is about biases the picture: it stops where, by chance, few bright paths
//! have been met, and it believes the error that looks small by chance (Kirk and Arvo 1991). So the pixels of a tile are dealt
//! to two halves, and each half stops when the error *of the other half* has come down to the target. A half's number of paths
//! then doesn't depend on its own, and its mean, and the error that is reported for it, are as unbiased as with a number chosen
//! beforehand. Where one half has stopped and the other has not, paths of the first go on being traced, for the decision
//! only.

use std::mem::take;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::rendered::{Refinement, Rendered, Tile, relative_rmse};
use crate::points::{PointSet, mix};
use crate::render::film::{Film, Pixel};
use crate::render::path_numbers::PathId;
use crate::render::scene::Scene;
use crate::render::settings::RenderSettings;
use crate::render::tracer::Tracer;

/// Rows and columns of a tile.
const TILE: usize = 16;
/// A tile that has fewer pixels of objects than this is put together with the next.
const FEW: usize = 32;
/// Independent estimates of each pixel.
const REPLICATES: usize = 8;
/// Paths a replicate before the first decision; the number doubles before each other one.
const FIRST: u64 = 2;

/// Renders `scene` with as many paths in each tile as its estimated relative error needs to come down to `error`, at most
/// `most` a pixel. The settings are checked.
pub(super) fn render_to_error(
    scene: &Scene,
    settings: &RenderSettings,
    error: f64,
    most: u64,
    progress: &(dyn Fn(usize) + Sync),
) -> Rendered {
    // Lattices are for numbers of paths that are known beforehand.
    let points = if settings.points == PointSet::Lattice {
        PointSet::Sobol
    } else {
        settings.points
    };
    let settings = &RenderSettings {
        points,
        ..*settings
    };
    let refiner = Refiner {
        tracer: Tracer::new(scene, settings),
        settings,
        target: error,
        most,
    };
    // Step 1: pixels that show no object get the fewest paths.
    let count = settings.width * settings.height;
    let shown: Vec<bool> = (0..count)
        .into_par_iter()
        .map(|i| refiner.shows_object(i))
        .collect();
    let pixels = refiner.render_backgrounds(&shown);
    // Step 2: the others are refined tile by tile.
    let tiles = group_tiles(&shown, settings);
    let background = count - tiles.iter().map(Vec::len).sum::<usize>();
    progress(background);
    let refined: Vec<RefinedTile> = tiles
        .par_iter()
        .map(|tile| {
            let refined = refiner.refine(tile);
            progress(tile.len());
            refined
        })
        .collect();
    put_together(settings, pixels, background as u64, tiles, refined)
}

/// The picture and its figures, from the pixels without an object and the refined tiles.
fn put_together(
    settings: &RenderSettings,
    mut pixels: Vec<Pixel>,
    background: u64,
    tiles: Vec<Vec<usize>>,
    refined: Vec<RefinedTile>,
) -> Rendered {
    let fewest = background * FIRST * REPLICATES as u64;
    let mut refinement = Refinement {
        tiles: Vec::with_capacity(tiles.len()),
        paths: fewest,
        traced: fewest,
    };
    for (tile, refined) in tiles.into_iter().zip(refined) {
        for (i, pixel) in refined.pixels {
            pixels[i] = pixel;
        }
        refinement.paths += refined.paths;
        refinement.traced += refined.traced;
        refinement.tiles.push(Tile {
            pixels: tile,
            error: refined.error,
            reached: refined.reached,
        });
    }
    Rendered {
        film: Film::new(settings.width, settings.height, pixels),
        refinement: Some(refinement),
    }
}

/// The pixels of each tile, from which of them show an object.
fn group_tiles(shown: &[bool], settings: &RenderSettings) -> Vec<Vec<usize>> {
    let RenderSettings { width, height, .. } = *settings;
    let (mut all, mut open) = (Vec::new(), Vec::new());
    for top in (0..height).step_by(TILE) {
        let mut row: Vec<Vec<usize>> = Vec::new();
        for left in (0..width).step_by(TILE) {
            let columns = left..(left + TILE).min(width);
            let lines = top..(top + TILE).min(height);
            let pixels = lines.flat_map(|y| columns.clone().map(move |x| y * width + x));
            open.extend(pixels.filter(|&i| shown[i]));
            if open.len() >= FEW {
                row.push(take(&mut open));
            }
        }
        // What is left over at a row's end joins its last tile, or else the first of the next row.
        if let Some(last) = row.last_mut() {
            last.append(&mut open);
        }
        all.append(&mut row);
    }
    match all.last_mut() {
        Some(last) => last.append(&mut open),
        None if open.is_empty() => {}
        None => all.push(open),
    }
    all
}

struct Refiner<'a> {
    tracer: Tracer<'a>,
    settings: &'a RenderSettings,
    target: f64,
    most: u64,
}

/// A tile whose two halves have stopped.
struct RefinedTile {
    pixels: Vec<(usize, Pixel)>,
    error: f64,
    reached: bool,
    paths: u64,
    traced: u64,
}

/// Every other pixel of a tile.
#[derive(Default)]
struct HalfTile {
    pixels: Vec<(usize, Replicates)>,
    /// What goes into the picture, once it has stopped.
    kept: Vec<(usize, Pixel)>,
    paths: u64,
    reached: bool,
}

impl HalfTile {
    /// Every other pixel of `tile`, from the one at position `first` on.
    fn new(tile: &[usize], first: usize) -> Self {
        let pixels = tile
            .iter()
            .skip(first)
            .step_by(2)
            .map(|&i| (i, Replicates::default()));
        Self {
            pixels: pixels.collect(),
            ..Self::default()
        }
    }

    fn has_stopped(&self) -> bool {
        self.kept.len() == self.pixels.len()
    }

    fn error(&self) -> f64 {
        relative_rmse(
            self.pixels
                .iter()
                .map(|(_, r)| r.pixel())
                .map(|p| (p.mean, p.error.powf(2.0))),
        )
    }

    fn stop(&mut self, reached: bool) {
        self.kept = self.pixels.iter().map(|(i, r)| (*i, r.pixel())).collect();
        self.paths = self.traced();
        self.reached = reached;
    }

    fn traced(&self) -> u64 {
        self.pixels
            .iter()
            .map(|(_, r)| r.count * REPLICATES as u64)
            .sum()
    }
}

impl Refiner<'_> {
    fn column_and_row(&self, pixel: usize) -> [usize; 2] {
        [pixel % self.settings.width, pixel / self.settings.width]
    }

    fn shows_object(&self, pixel: usize) -> bool {
        (0..9u32).any(|i| {
            let within = DVec2::new(f64::from(i % 3), f64::from(i / 3)) / 2.0;
            self.tracer
                .scene
                .hit(&self.tracer.ray(self.column_and_row(pixel), within), None)
                .is_some()
        })
    }

    /// The pixels that show no object; the others are empty.
    fn render_backgrounds(&self, shown: &[bool]) -> Vec<Pixel> {
        let pixel = |i: usize| {
            if shown[i] {
                Pixel::default()
            } else {
                self.render_background(i)
            }
        };
        (0..shown.len()).into_par_iter().map(pixel).collect()
    }

    fn render_background(&self, pixel: usize) -> Pixel {
        let mut replicates = Replicates::default();
        self.extend(pixel, &mut replicates, FIRST);
        replicates.pixel()
    }

    fn refine(&self, tile: &[usize]) -> RefinedTile {
        let mut halves = [0, 1].map(|first| HalfTile::new(tile, first));
        let mut count = FIRST;
        while halves.iter().any(|h| !h.has_stopped()) {
            for (pixel, replicates) in halves.iter_mut().flat_map(|h| &mut h.pixels) {
                self.extend(*pixel, replicates, count);
            }
            let last = count > self.most / (2 * REPLICATES as u64);
            self.decide(&mut halves, last);
            count *= 2;
        }
        let pixels: Vec<(usize, Pixel)> = halves.iter().flat_map(|h| &h.kept).copied().collect();
        RefinedTile {
            error: relative_rmse(pixels.iter().map(|(_, p)| (p.mean, p.error.powf(2.0)))),
            pixels,
            reached: halves.iter().all(|h| h.reached),
            paths: halves.iter().map(|h| h.paths).sum(),
            traced: halves.iter().map(HalfTile::traced).sum(),
        }
    }

    /// Stops each half by the other's error. A tile of one pixel has no other half: that one stops by its own.
    fn decide(&self, halves: &mut [HalfTile; 2], last: bool) {
        let errors = [&halves[0], &halves[1]].map(HalfTile::error);
        let alone = halves[1].pixels.is_empty();
        for (i, half) in halves
            .iter_mut()
            .enumerate()
            .filter(|(_, h)| !h.has_stopped())
        {
            let reached = errors[if alone { i } else { 1 - i }] <= self.target;
            if reached || last {
                half.stop(reached);
            }
        }
        halves[1].reached |= alone;
    }

    /// Traces paths until each replicate has `count`.
    fn extend(&self, pixel: usize, replicates: &mut Replicates, count: u64) {
        let pixel = self.column_and_row(pixel);
        let seed = self.settings.pixel_seed(pixel);
        let (sums, from) = (&mut replicates.sums, replicates.count);
        let paths = (0..REPLICATES as u64).flat_map(|r| {
            let seed = mix(seed ^ mix(1 + r));
            (from..count).map(move |index| {
                (
                    r,
                    PathId {
                        pixel,
                        seed,
                        index,
                        count,
                    },
                )
            })
        });
        let mut owners = paths.clone().map(|(r, _)| r as usize);
        self.tracer
            .trace(paths.map(|(_, path)| path), |_, radiance| {
                if let Some(r) = owners.next() {
                    sums[r] += radiance;
                }
            });
        replicates.count = count;
    }
}

/// Independent sums of a pixel's radiance.
#[derive(Clone, Copy, Default)]
struct Replicates {
    sums: [DVec3; REPLICATES],
    /// Paths in each.
    count: u64,
}

impl Replicates {
    fn pixel(&self) -> Pixel {
        let means = self.sums.map(|sum| sum / self.count.max(1) as f64);
        let n = REPLICATES as f64;
        let mean = means.iter().sum::<DVec3>() / n;
        let squares: DVec3 = means.iter().map(|m| (m - mean).powf(2.0)).sum();
        Pixel {
            mean,
            error: (squares / (n * (n - 1.0))).map(f64::sqrt),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::settings::Budget;

    #[test]
    fn tiles_hold_every_shown_pixel_once_and_few_stand_alone() {
        let settings = RenderSettings {
            width: 70,
            height: 50,
            seed: 0,
            points: PointSet::Sobol,
            budget: Budget::Even(16),
        };
        for radius2 in [9usize, 400, 700] {
            let inside =
                |i: usize| (i % 70).abs_diff(35).pow(2) + (i / 70).abs_diff(25).pow(2) < radius2;
            let shown: Vec<bool> = (0..70 * 50).map(inside).collect();
            let tiles = group_tiles(&shown, &settings);
            let mut pixels: Vec<usize> = tiles.iter().flatten().copied().collect();
            pixels.sort_unstable();
            assert_eq!(
                pixels,
                (0..70 * 50).filter(|&i| shown[i]).collect::<Vec<_>>()
            );
            assert!(tiles.len() == 1 || tiles.iter().all(|t| t.len() >= FEW));
        }
        assert!(group_tiles(&[false; 70 * 50], &settings).is_empty());
    }

    #[test]
    fn replicates_give_the_textbook_error() {
        let sums = std::array::from_fn(|i| DVec3::splat(2.0 * i as f64));
        let pixel = Replicates { sums, count: 2 }.pixel();
        // The numbers 0 to 7: mean 3.5, variance 6.
        assert_eq!(pixel.mean, DVec3::splat(3.5));
        assert!((pixel.error.x - (6.0f64 / 8.0).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn relative_errors_are_those_of_the_definition() {
        let pairs = [
            (DVec3::splat(1.0), DVec3::splat(0.01)),
            (DVec3::splat(3.0), DVec3::splat(0.03)),
        ];
        assert!((relative_rmse(pairs.into_iter()) - 0.02f64.sqrt() / 2.0).abs() < 1e-15);
        assert_eq!(relative_rmse([(DVec3::ZERO, DVec3::ZERO)].into_iter()), 0.0);
    }
}
