//! Tiles on their way to a target error, and how they are stored.

use glam::DVec3;

use super::rendered::relative_rmse;
use super::words::{WordReader, WordWriter};
use crate::render::film::Pixel;

/// Independent estimates of each pixel.
pub(super) const REPLICATES: usize = 8;

/// How far a tile is.
pub(super) enum TileState {
    /// No path is traced.
    Waiting,
    /// A half at least goes on.
    Open(OpenTile),
    /// Both halves have stopped.
    Finished(RefinedTile),
}

/// A tile that is being refined.
pub(super) struct OpenTile {
    pub(super) halves: [HalfTile; 2],
    /// Paths a replicate of the round that is being traced; some pixels have them already.
    pub(super) count: u64,
}

/// What a tile shows, and its figures.
pub(super) struct RefinedTile {
    pub(super) pixels: Vec<(usize, Pixel)>,
    pub(super) error: f64,
    pub(super) reached: bool,
    pub(super) paths: u64,
    pub(super) traced: u64,
}

/// Every other pixel of a tile.
#[derive(Default)]
pub(super) struct HalfTile {
    pub(super) pixels: Vec<(usize, Replicates)>,
    /// What goes into the picture, once it has stopped.
    kept: Vec<(usize, Pixel)>,
    paths: u64,
    pub(super) reached: bool,
}

/// Independent sums of a pixel's radiance.
#[derive(Clone, Copy, Default)]
pub(super) struct Replicates {
    pub(super) sums: [DVec3; REPLICATES],
    /// Paths in each.
    pub(super) count: u64,
}

impl Replicates {
    /// Paths a replicate before the first decision; the number doubles before each other one.
    pub(super) const FEWEST: u64 = 2;
    /// Paths per pixel of that.
    pub(super) const FEWEST_PATHS: u64 = Self::FEWEST * REPLICATES as u64;

    pub(super) fn pixel(&self) -> Pixel {
        // With the mean x_r of each of n replicates: δ² = Σ (x_r − mean)²/(n(n − 1)). The paths within a replicate may
        // depend on one another, as Sobol points do, since only the replicates need to be independent.
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

impl OpenTile {
    pub(super) fn new(tile: &[usize]) -> Self {
        Self {
            halves: [0, 1].map(|first| HalfTile::new(tile, first)),
            count: Replicates::FEWEST,
        }
    }

    /// What it shows; of a half that goes on, what it has now.
    pub(super) fn refined(&self) -> RefinedTile {
        let pixels: Vec<(usize, Pixel)> = self.halves.iter().flat_map(HalfTile::shown).collect();
        RefinedTile {
            error: relative_rmse(pixels.iter().map(|(_, p)| (p.mean, p.error.powf(2.0)))),
            pixels,
            reached: self.halves.iter().all(|h| h.reached),
            paths: self.halves.iter().map(HalfTile::paths).sum(),
            traced: self.halves.iter().map(HalfTile::traced).sum(),
        }
    }
}

impl HalfTile {
    /// Every other pixel of `tile`, from the one at position `first` on.
    fn new(tile: &[usize], first: usize) -> Self {
        let mut pixels = Vec::with_capacity(tile.len().div_ceil(2));
        for &i in tile.iter().skip(first).step_by(2) {
            pixels.push((i, Replicates::default()));
        }
        Self {
            pixels,
            ..Self::default()
        }
    }

    pub(super) fn has_stopped(&self) -> bool {
        self.kept.len() == self.pixels.len()
    }

    pub(super) fn error(&self) -> f64 {
        relative_rmse(
            self.pixels
                .iter()
                .map(|(_, r)| r.pixel())
                .map(|p| (p.mean, p.error.powf(2.0))),
        )
    }

    pub(super) fn stop(&mut self, reached: bool) {
        self.kept = self.pixels.iter().map(|(i, r)| (*i, r.pixel())).collect();
        self.paths = self.traced();
        self.reached = reached;
    }

    fn shown(&self) -> Vec<(usize, Pixel)> {
        if self.has_stopped() {
            self.kept.clone()
        } else {
            self.pixels.iter().map(|(i, r)| (*i, r.pixel())).collect()
        }
    }

    /// Paths of what it shows.
    fn paths(&self) -> u64 {
        if self.has_stopped() {
            self.paths
        } else {
            self.traced()
        }
    }

    fn traced(&self) -> u64 {
        self.pixels
            .iter()
            .map(|(_, r)| r.count * REPLICATES as u64)
            .sum()
    }
}

/// What begins a tile in storage.
const WAITING: u64 = 0;
const OPEN: u64 = 1;
const FINISHED: u64 = 2;

impl TileState {
    pub(super) fn store(&self, out: &mut WordWriter) {
        match self {
            Self::Waiting => out.count(WAITING),
            Self::Open(open) => {
                out.count(OPEN);
                out.count(open.count);
                for half in &open.halves {
                    half.store(out);
                }
            }
            Self::Finished(refined) => {
                out.count(FINISHED);
                refined.store(out);
            }
        }
    }

    /// The state of a tile with these pixels, of at most `most` paths each; `None` if it is none that paths can have left.
    pub(super) fn restore(tile: &[usize], most: u64, from: &mut WordReader<'_>) -> Option<Self> {
        match from.count()? {
            WAITING => Some(Self::Waiting),
            OPEN => {
                let count = from.count()?;
                let rounds = count / Replicates::FEWEST;
                let is_round = rounds.is_power_of_two() && count == rounds * Replicates::FEWEST;
                if !is_round || count > most / REPLICATES as u64 {
                    return None;
                }
                let mut open = OpenTile::new(tile);
                open.count = count;
                for half in &mut open.halves {
                    half.restore(count, from)?;
                }
                let goes_on = !open.halves.iter().all(HalfTile::has_stopped);
                goes_on.then_some(Self::Open(open))
            }
            FINISHED => RefinedTile::restore(tile, most, from).map(Self::Finished),
            _ => None,
        }
    }
}

impl HalfTile {
    fn store(&self, out: &mut WordWriter) {
        out.count(u64::from(self.has_stopped()));
        out.count(u64::from(self.reached));
        out.count(self.paths);
        for (_, replicates) in &self.pixels {
            out.count(replicates.count);
            for sum in replicates.sums {
                out.vector(sum);
            }
        }
        for (_, pixel) in &self.kept {
            store_pixel(pixel, out);
        }
    }

    fn restore(&mut self, count: u64, from: &mut WordReader<'_>) -> Option<()> {
        let has_stopped = restore_flag(from)?;
        self.reached = restore_flag(from)?;
        self.paths = from.count()?;
        // Before the round a pixel had half of its paths, or none before the first.
        let before = if count == Replicates::FEWEST {
            0
        } else {
            count / 2
        };
        for (_, replicates) in &mut self.pixels {
            replicates.count = from.count().filter(|n| *n == before || *n == count)?;
            for sum in &mut replicates.sums {
                *sum = from.vector()?;
            }
        }
        if has_stopped {
            for (i, _) in &self.pixels {
                self.kept.push((*i, restore_pixel(from)?));
            }
        }
        (self.paths <= self.traced()).then_some(())
    }
}

impl RefinedTile {
    fn store(&self, out: &mut WordWriter) {
        out.number(self.error);
        out.count(u64::from(self.reached));
        out.count(self.paths);
        out.count(self.traced);
        for (_, pixel) in &self.pixels {
            store_pixel(pixel, out);
        }
    }

    fn restore(tile: &[usize], most: u64, from: &mut WordReader<'_>) -> Option<Self> {
        let error = from.number().filter(|error| *error >= 0.0)?;
        let reached = restore_flag(from)?;
        let (paths, traced) = (from.count()?, from.count()?);
        if paths > traced || traced > most.saturating_mul(tile.len() as u64) {
            return None;
        }
        // Half after half, as they were put together.
        let mut pixels = Vec::with_capacity(tile.len());
        for first in [0, 1] {
            for &i in tile.iter().skip(first).step_by(2) {
                pixels.push((i, restore_pixel(from)?));
            }
        }
        Some(Self {
            pixels,
            error,
            reached,
            paths,
            traced,
        })
    }
}

fn store_pixel(pixel: &Pixel, out: &mut WordWriter) {
    out.vector(pixel.mean);
    out.vector(pixel.error);
}

fn restore_pixel(from: &mut WordReader<'_>) -> Option<Pixel> {
    let (mean, error) = (from.vector()?, from.vector()?);
    Some(Pixel { mean, error })
}

fn restore_flag(from: &mut WordReader<'_>) -> Option<bool> {
    match from.count()? {
        0 => Some(false),
        1 => Some(true),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replicates_give_the_textbook_error() {
        let sums = std::array::from_fn(|i| DVec3::splat(2.0 * i as f64));
        let pixel = Replicates { sums, count: 2 }.pixel();
        // The numbers 0 to 7: mean 3.5, variance 6.
        assert_eq!(pixel.mean, DVec3::splat(3.5));
        assert!((pixel.error.x - (6.0f64 / 8.0).sqrt()).abs() < 1e-15);
    }
}
