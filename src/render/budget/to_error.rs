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

//!
//! Tiles are refined one after another by each thread, each to its end. A picture that is stopped before has tiles that are
//! finished, tiles in between, and tiles that wait; the last show the fewest paths. A stop comes between two pixels, since what
//! a pixel has collected is all that its next paths go on from.

use std::mem::take;

use glam::DVec2;
use rayon::prelude::*;

use super::rendered::{Refinement, Rendered, Tile};
use super::rounds::Watch;
use super::tiles::{HalfTile, OpenTile, REPLICATES, RefinedTile, Replicates, TileState};
use super::words::{WordReader, WordWriter};
use crate::points::mix;
use crate::render::bundle::Bundle;
use crate::render::film::{Film, Pixel};
use crate::render::path_numbers::PathRun;
use crate::render::rays::{NOTHING, Rays};
use crate::render::settings::RenderSettings;
use crate::render::tracer::Tracer;

/// Rows and columns of a tile.
const TILE: usize = 16;
/// A tile that has fewer pixels of objects than this is put together with the next.
const FEW: usize = 32;

/// A picture with as many paths in each tile as its estimated relative error needs to come down to a target, as far as it has
/// come.
pub(super) struct ErrorPicture {
    target: f64,
    /// Most paths per pixel.
    most: u64,
    /// Which pixels show an object; the others are no part of a tile and get the fewest paths.
    shown: Vec<bool>,
    /// Those others once they are traced; empty pixels for objects.
    backgrounds: Option<Vec<Pixel>>,
    tiles: Vec<Vec<usize>>,
    states: Vec<TileState>,
}

impl ErrorPicture {
    /// No path is traced. The settings are checked.
    pub(super) fn new(tracer: &Tracer<'_>, target: f64, most: u64) -> Self {
        let settings = &tracer.settings;
        let count = settings.width * settings.height;
        let mut shown = vec![false; count];
        shown
            .par_iter_mut()
            .enumerate()
            .for_each(|(i, shown)| *shown = shows_object(tracer, i));
        let tiles = group_tiles(&shown, settings);
        let mut states = Vec::new();
        states.resize_with(tiles.len(), || TileState::Waiting);
        Self {
            target,
            most,
            shown,
            backgrounds: None,
            tiles,
            states,
        }
    }

    pub(super) fn is_finished(&self) -> bool {
        self.backgrounds.is_some() && self.count_finished() == self.tiles.len()
    }

    fn count_finished(&self) -> usize {
        let mut count = 0;
        for state in &self.states {
            if matches!(state, TileState::Finished(_)) {
                count += 1;
            }
        }
        count
    }

    pub(super) fn describe_progress(&self) -> String {
        format!("{} of {} tiles", self.count_finished(), self.tiles.len())
    }

    fn refiner<'a>(&self, tracer: &'a Tracer<'a>) -> Refiner<'a> {
        Refiner {
            tracer,
            target: self.target,
            most: self.most,
        }
    }

    /// Refines the tiles until all are finished or the caller wants to stop.
    pub(super) fn advance(&mut self, tracer: &Tracer<'_>, watch: Watch<'_>) {
        let refiner = self.refiner(tracer);
        // Step 1: pixels that show no object get the fewest paths.
        let shown = &self.shown;
        self.backgrounds
            .get_or_insert_with(|| refiner.render_backgrounds(shown));
        let in_tiles: usize = self.tiles.iter().map(Vec::len).sum();
        (watch.progress)(self.shown.len() - in_tiles);
        // Step 2: the others are refined tile by tile.
        let tiles = self.tiles.par_iter().zip(&mut self.states);
        tiles.for_each(|(tile, state)| {
            if refiner.refine(tile, state, watch.should_stop) {
                (watch.progress)(tile.len());
            }
        });
    }

    /// The picture and its figures. Where a picture was stopped, pixels that have no path yet get the fewest.
    pub(super) fn into_rendered(self, tracer: &Tracer<'_>) -> Rendered {
        let refiner = self.refiner(tracer);
        let mut pixels = match self.backgrounds {
            Some(pixels) => pixels,
            None => refiner.render_backgrounds(&self.shown),
        };
        let refined: Vec<RefinedTile> = self
            .tiles
            .par_iter()
            .zip(self.states)
            .map(|(tile, state)| refiner.settle(tile, state))
            .collect();
        let in_tiles: usize = self.tiles.iter().map(Vec::len).sum();
        let fewest = (self.shown.len() - in_tiles) as u64 * Replicates::FEWEST_PATHS;
        let mut refinement = Refinement {
            tiles: Vec::with_capacity(self.tiles.len()),
            paths: fewest,
            traced: fewest,
        };
        for (tile, refined) in self.tiles.into_iter().zip(refined) {
            for (i, pixel) in refined.pixels {
                pixels[i] = pixel;
            }
            refinement.paths = refinement.paths.saturating_add(refined.paths);
            refinement.traced = refinement.traced.saturating_add(refined.traced);
            refinement.tiles.push(Tile {
                pixels: tile,
                error: refined.error,
                reached: refined.reached,
            });
        }
        Rendered {
            film: Film::new(tracer.settings.width, tracer.settings.height, pixels),
            refinement: Some(refinement),
        }
    }

    pub(super) fn store(&self) -> WordWriter {
        let mut out = WordWriter::default();
        for state in &self.states {
            state.store(&mut out);
        }
        out
    }

    /// Takes over what [`Self::store`] gave; `None` if it is nothing that paths can have left.
    pub(super) fn restore(&mut self, from: &mut WordReader<'_>) -> Option<()> {
        for (tile, state) in self.tiles.iter().zip(&mut self.states) {
            *state = TileState::restore(tile, self.most, from)?;
        }
        Some(())
    }
}

/// The pixels of each tile, from which of them show an object.
fn group_tiles(shown: &[bool], settings: &RenderSettings) -> Vec<Vec<usize>> {
    let RenderSettings { width, height, .. } = *settings;
    let mut all = Vec::new();
    let mut open = Vec::new();
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

/// Column and row of a pixel.
fn column_and_row(tracer: &Tracer<'_>, pixel: usize) -> [usize; 2] {
    [pixel % tracer.settings.width, pixel / tracer.settings.width]
}

/// Whether one of nine rays through a pixel meets an object.
fn shows_object(tracer: &Tracer<'_>, pixel: usize) -> bool {
    let mut rays = Rays::default();
    rays.begin(9, tracer.scene.camera.eye);
    for (i, along) in rays.along.iter_mut().enumerate() {
        // The rays pass the corners, the middles of the sides and the centre, so that an object at the edge is found too.
        let within = DVec2::new((i % 3) as f64, (i / 3) as f64) / 2.0;
        *along = tracer.direction(column_and_row(tracer, pixel), within);
    }
    tracer.scene.find_hits(&mut rays);
    rays.objects.iter().any(|&object| object != NOTHING)
}

struct Refiner<'a> {
    tracer: &'a Tracer<'a>,
    target: f64,
    most: u64,
}

impl Refiner<'_> {
    /// The pixels that show no object; the others are empty.
    fn render_backgrounds(&self, shown: &[bool]) -> Vec<Pixel> {
        let pixels = shown.par_iter().enumerate();
        pixels
            .map(|(i, &is_shown)| {
                if is_shown {
                    Pixel::default()
                } else {
                    self.render_background(i)
                }
            })
            .collect()
    }

    fn render_background(&self, pixel: usize) -> Pixel {
        let mut replicates = Replicates::default();
        self.extend(pixel, &mut replicates, Replicates::FEWEST);
        replicates.pixel()
    }

    /// Refines a tile until it is finished or `should_stop`; returns whether it is finished.
    fn refine(
        &self,
        tile: &[usize],
        state: &mut TileState,
        should_stop: &(dyn Fn() -> bool + Sync),
    ) -> bool {
        loop {
            match state {
                TileState::Finished(_) => return true,
                TileState::Waiting if should_stop() => return false,
                TileState::Waiting => *state = TileState::Open(OpenTile::new(tile)),
                TileState::Open(open) => {
                    for (pixel, replicates) in open.halves.iter_mut().flat_map(|h| &mut h.pixels) {
                        if should_stop() {
                            return false;
                        }
                        self.extend(*pixel, replicates, open.count);
                    }
                    // The next round would need 2·count paths in each of the replicates, more than `most` allows.
                    let last = open.count > self.most / (2 * REPLICATES as u64);
                    self.decide(&mut open.halves, last);
                    if open.halves.iter().all(HalfTile::has_stopped) {
                        *state = TileState::Finished(open.refined());
                    } else {
                        open.count *= 2;
                    }
                }
            }
        }
    }

    /// What a tile shows, finished or not: each pixel has at least the fewest paths.
    fn settle(&self, tile: &[usize], state: TileState) -> RefinedTile {
        let mut open = match state {
            TileState::Finished(refined) => return refined,
            TileState::Open(open) => open,
            TileState::Waiting => OpenTile::new(tile),
        };
        for (pixel, replicates) in open.halves.iter_mut().flat_map(|h| &mut h.pixels) {
            if replicates.count < Replicates::FEWEST {
                self.extend(*pixel, replicates, Replicates::FEWEST);
            }
        }
        open.refined()
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
        let pixel = column_and_row(self.tracer, pixel);
        let seed = self.tracer.settings.pixel_seed(pixel);
        let (sums, from) = (&mut replicates.sums, replicates.count);
        // Each replicate has a scramble of its own, and goes on in its sequence where it was left.
        let runs = (0..REPLICATES as u64).map(|replicate| PathRun {
            pixel,
            seed: mix(seed ^ mix(1 + replicate)),
            from,
            to: count,
            count,
        });
        let mut bundle = Bundle::default();
        self.tracer.trace(runs, &mut bundle, |replicate, radiance| {
            sums[replicate] += radiance;
        });
        replicates.count = count;
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::rendered::relative_rmse;
    use super::*;
    use crate::points::PointSet;
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
    fn relative_errors_are_those_of_the_definition() {
        let pairs = [
            (DVec3::splat(1.0), DVec3::splat(0.01)),
            (DVec3::splat(3.0), DVec3::splat(0.03)),
        ];
        assert!((relative_rmse(pairs.into_iter()) - 0.02f64.sqrt() / 2.0).abs() < 1e-15);
        assert_eq!(relative_rmse([(DVec3::ZERO, DVec3::ZERO)].into_iter()), 0.0);
    }
}
