//! Size and quality of a picture, and the one place that checks them.

use crate::image::MAX_PIXELS;
use crate::points::{PointSet, mix};
use crate::{Error, Result};

/// Size and quality of a picture.
///
/// The example of [`render`](fn@crate::render::render) plans, builds and renders a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderSettings {
    /// Columns, ≥ 1.
    pub width: usize,
    /// Rows, ≥ 1.
    pub height: usize,
    /// Another seed gives another, equally good picture.
    pub seed: u64,
    /// How the numbers behind a pixel's paths are spread. Lattices need to know how many there will be:
    /// [`Budget::ToError`] takes Sobol points in their place.
    pub points: PointSet,
    /// How many paths are traced, and where.
    pub budget: Budget,
}

/// Pixels of a picture that are traced: a rectangle within it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PixelRegion {
    /// Column and row of its upper left pixel.
    pub(super) corner: [usize; 2],
    /// Columns and rows, each ≥ 1.
    pub(super) size: [usize; 2],
}

impl PixelRegion {
    /// How many pixels it has.
    pub(super) fn pixel_count(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// The pixel of the picture in column `x` and row `y` of the region.
    #[inline]
    pub(super) fn pixel(&self, x: usize, y: usize) -> [usize; 2] {
        [self.corner[0] + x, self.corner[1] + y]
    }
}

/// How many paths are traced, and where. They are spread uniformly over each pixel (a box filter).
///
/// The example of [`render`](fn@crate::render::render) plans, builds and renders a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// So many paths in every pixel, ≥ 1.
    Even(u64),
    /// About so many paths per pixel on average, ≥ 16; more of them where the picture is noisy.
    ///
    /// They are distributed so that the mean over the pixels of their relative squared errors is small: a first look
    /// measures how far single paths are apart, relative to the brightness there, and no pixel gets more than 256 times the
    /// mean. The picture is as unbiased as with [`Self::Even`]. Where the first look misses a light that is rarely hit, its
    /// pixels get few paths.
    Adaptive(u64),
    /// As many paths in each tile, see [`super::Tile`], as its estimated relative error needs to come down to a target.
    ///
    /// Pixels that show no object get 16. The estimate knows only what the paths have met: light that they hit once in a
    /// million, as with a sampler that misses a bright lobe, is not in it.
    ToError {
        /// Target for the relative error of each tile, > 0: 0.05 for 5 %.
        error: f64,
        /// Most paths per pixel, ≥ 16; counts down to 16 times a power of two.
        most: u64,
    },
}

/// Fewest paths per pixel, on average, of [`Budget::Adaptive`]: with fewer, the first look would take most of them.
const LEAST_ADAPTIVE: u64 = 16;

/// Fewest paths per pixel of [`Budget::ToError`]: 8 replicates of 2 paths; with fewer there is no error to estimate.
const LEAST_TO_ERROR: u64 = 16;

impl RenderSettings {
    /// Checks the settings, as [`super::render()`] does before it begins.
    ///
    /// # Errors
    /// [`Error::Argument`] for a picture without pixels, or of more than [`MAX_PIXELS`] pixels, or for a budget outside its
    /// domain.
    pub fn check(&self) -> Result<()> {
        let Self { width, height, .. } = *self;
        let count = width.checked_mul(height);
        if !count.is_some_and(|n| n > 0 && n <= MAX_PIXELS) {
            return Err(Error::argument(
                format!("a picture of {width} × {height} pixels"),
                format!("give at least 1 × 1 and at most {MAX_PIXELS} pixels"),
            ));
        }
        self.budget.check()
    }

    /// All pixels.
    pub(super) fn whole_region(&self) -> PixelRegion {
        PixelRegion {
            corner: [0, 0],
            size: [self.width, self.height],
        }
    }

    /// The pixels from column and row `corner` on, `size` columns and rows of them.
    ///
    /// # Errors
    /// [`Error::Argument`] for none, for pixels outside the picture, and for a budget that compares pixels.
    pub(super) fn check_region(&self, corner: [usize; 2], size: [usize; 2]) -> Result<PixelRegion> {
        let end = [0, 1].map(|axis| corner[axis].checked_add(size[axis]));
        let is_inside = end[0].is_some_and(|x| x <= self.width)
            && end[1].is_some_and(|y| y <= self.height)
            && size[0].min(size[1]) > 0;
        if !is_inside {
            return Err(Error::argument(
                format!(
                    "a region of {} × {} pixels from column {} and row {} of a picture of {} × {}",
                    size[0], size[1], corner[0], corner[1], self.width, self.height
                ),
                "give at least one pixel, and only pixels of the picture",
            ));
        }
        if !matches!(self.budget, Budget::Even(_)) {
            return Err(Error::argument(
                "a region of a picture whose pixels get different numbers of paths",
                "give every pixel the same number, since the others depend on the whole picture",
            ));
        }
        Ok(PixelRegion { corner, size })
    }

    /// Seed of all numbers of a pixel.
    pub(super) fn pixel_seed(&self, [x, y]: [usize; 2]) -> u64 {
        mix(self.seed ^ mix((y * self.width + x) as u64))
    }
}

impl Budget {
    fn check(self) -> Result<()> {
        match self {
            Self::Even(0) => Err(Error::argument("0 paths per pixel", "give at least 1")),
            Self::Adaptive(paths) if paths < LEAST_ADAPTIVE => Err(Error::argument(
                format!("{paths} paths per pixel are too few for an adaptive picture"),
                format!(
                    "give {LEAST_ADAPTIVE} or more: the first of them decide where the others go"
                ),
            )),
            Self::ToError { error, .. } if !(error > 0.0 && error.is_finite()) => {
                Err(Error::argument(
                    format!("a target error of {error}"),
                    "give one above 0, 0.05 for 5 %",
                ))
            }
            Self::ToError { most, .. } if most < LEAST_TO_ERROR => Err(Error::argument(
                format!("a limit of {most} paths per pixel"),
                format!("allow at least {LEAST_TO_ERROR}: fewer give no estimate of the error"),
            )),
            Self::Even(_) | Self::Adaptive(_) | Self::ToError { .. } => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regions_lie_within_pictures_whose_pixels_are_independent() {
        let settings = RenderSettings {
            width: 30,
            height: 20,
            seed: 0,
            points: PointSet::Lattice,
            budget: Budget::Even(1),
        };
        let region = settings.check_region([10, 5], [20, 15]).unwrap();
        assert_eq!(region.pixel(3, 2), [13, 7]);
        assert_eq!(region.pixel_count(), 300);
        for (corner, size) in [
            ([0, 0], [31, 20]),
            ([0, 0], [30, 21]),
            ([29, 0], [2, 1]),
            ([0, 0], [0, 1]),
            ([0, 0], [1, 0]),
            ([usize::MAX, 0], [1, 1]),
            ([0, 1], [1, usize::MAX]),
        ] {
            assert!(
                settings.check_region(corner, size).is_err(),
                "{corner:?} {size:?}"
            );
        }
        let adaptive = RenderSettings {
            budget: Budget::Adaptive(16),
            ..settings
        };
        assert!(adaptive.check_region([0, 0], [1, 1]).is_err());
    }

    #[test]
    fn settings_outside_their_domain_are_refused() {
        let good = RenderSettings {
            width: 3,
            height: 2,
            seed: 0,
            points: PointSet::Random,
            budget: Budget::Even(1),
        };
        let with = |budget| RenderSettings { budget, ..good };
        let to_error = |error, most| with(Budget::ToError { error, most });
        for settings in [good, with(Budget::Adaptive(16)), to_error(1e-9, 16)] {
            assert!(settings.check().is_ok(), "{settings:?}");
        }
        for settings in [
            RenderSettings { width: 0, ..good },
            RenderSettings { height: 0, ..good },
            RenderSettings {
                width: usize::MAX,
                ..good
            },
            RenderSettings {
                width: MAX_PIXELS,
                ..good
            },
            with(Budget::Even(0)),
            with(Budget::Adaptive(15)),
            to_error(0.0, 64),
            to_error(-1.0, 64),
            to_error(f64::NAN, 64),
            to_error(f64::INFINITY, 64),
            to_error(0.1, 15),
        ] {
            assert!(settings.check().is_err(), "{settings:?}");
        }
    }
}
