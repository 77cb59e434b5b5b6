//! What a budget gives: a picture, and how far it came.

use glam::DVec3;

use crate::render::film::Film;
use crate::{Error, Result};

/// A rendered picture, and how it came to be.
///
/// The example of [`render`](fn@crate::render::render) plans, builds and renders a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendered {
    /// The picture.
    pub film: Film,
    /// How far [`Budget::ToError`](crate::render::Budget::ToError) came; `None` for other budgets.
    pub refinement: Option<Refinement>,
}

/// How far a picture of a target error came.
///
/// The example of [`render`](fn@crate::render::render) plans, builds and renders a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Refinement {
    /// The tiles, in the picture's order.
    pub tiles: Vec<Tile>,
    /// Paths in the picture.
    pub paths: u64,
    /// All paths traced: those in the picture, and those that only served a decision.
    pub traced: u64,
}

/// Pixels that are refined together: those of a square of 16 × 16 that show an object, which is met by one of nine rays
/// through the pixel, on a grid that takes in its corners. Where these are fewer than 32, those of the next square are with
/// them.
///
/// A tile's error is its relative RMSE: the root of the mean squared error of its pixels and channels over their mean.
///
/// The example of [`render`](fn@crate::render::render) plans, builds and renders a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    /// Its pixels, as row · width + column.
    pub pixels: Vec<usize>,
    /// Its error, estimated.
    pub error: f64,
    /// Whether both halves were stopped by the target, not by the largest number of paths.
    pub reached: bool,
}

impl From<Film> for Rendered {
    fn from(film: Film) -> Self {
        Self {
            film,
            refinement: None,
        }
    }
}

impl Refinement {
    /// The picture's error, estimated: root of the mean square of its tiles' errors, each weighing as many as it has pixels.
    /// Pixels that show no object don't count. 0 for a picture without objects.
    pub fn error(&self) -> f64 {
        self.mean_error(self.tiles.iter().map(|t| t.error))
    }

    /// The same error by its definition: that of the picture `film` against one that is taken for the truth.
    ///
    /// # Errors
    /// [`Error::Argument`] if the two differ in size.
    pub fn error_against(&self, film: &Film, truth: &Film) -> Result<f64> {
        let errors = self.tile_errors_against(film, truth)?;
        Ok(self.mean_error(errors.into_iter()))
    }

    /// The error of each tile by its definition: that of the picture `film` against one that is taken for the truth.
    ///
    /// # Errors
    /// [`Error::Argument`] if the two differ in size.
    pub fn tile_errors_against(&self, film: &Film, truth: &Film) -> Result<Vec<f64>> {
        let (width, height) = (film.width(), film.height());
        if (truth.width(), truth.height()) != (width, height) {
            let what = format!(
                "a reference of {} × {} pixels",
                truth.width(),
                truth.height()
            );
            return Err(Error::argument(
                what,
                format!("give one of {width} × {height}"),
            ));
        }
        let mut errors = Vec::with_capacity(self.tiles.len());
        for tile in &self.tiles {
            errors.push(relative_rmse(tile.pixels.iter().map(|i| {
                let (x, y) = (i % width, i / width);
                let mean = truth.mean(x, y);
                (mean, (film.mean(x, y) - mean).powf(2.0))
            })));
        }
        Ok(errors)
    }

    /// √(Σ n e² / Σ n) over tiles of n pixels and error e.
    fn mean_error(&self, errors: impl Iterator<Item = f64>) -> f64 {
        let (mut squares, mut pixels) = (0.0, 0.0);
        for (tile, error) in self.tiles.iter().zip(errors) {
            let count = tile.pixels.len() as f64;
            squares += count * error * error;
            pixels += count;
        }
        (squares / f64::max(pixels, 1.0)).sqrt()
    }
}

/// Root of the mean of `squares` over the mean of `means`, for pairs of these; 0 where all is black.
pub(super) fn relative_rmse(pairs: impl Iterator<Item = (DVec3, DVec3)>) -> f64 {
    let (mut mean, mut square, mut count) = (0.0, 0.0, 0.0);
    for (m, s) in pairs {
        mean += m.element_sum();
        square += s.element_sum();
        count += 3.0;
    }
    // √(Σs/n)/(Σm/n) = √(n·Σs)/Σm, over n channels of pixels.
    if mean > 0.0 {
        (square * count).sqrt() / mean
    } else {
        0.0
    }
}
