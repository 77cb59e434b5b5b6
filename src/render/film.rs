//! Means and standard errors of pixels.

use glam::DVec3;

use crate::Result;
use crate::color::Rgb;
use crate::image::Image;

/// A rendered picture: for each pixel the mean radiance and its standard error, linear RGB in f64.
///
/// The example of [`render`](fn@crate::render::render) plans, builds and renders a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: usize,
    height: usize,
    pixels: Vec<Pixel>,
    /// How much of each pixel objects cover, where the background is left out.
    coverage: Option<Vec<f32>>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Pixel {
    pub(super) mean: DVec3,
    pub(super) error: DVec3,
}

impl Film {
    pub(super) fn new(width: usize, height: usize, pixels: Vec<Pixel>) -> Self {
        debug_assert_eq!(pixels.len(), width * height);
        Self {
            width,
            height,
            pixels,
            coverage: None,
        }
    }

    /// The same picture, with the fraction of each pixel that objects cover.
    pub(super) fn with_coverage(self, coverage: Vec<f32>) -> Self {
        Self {
            coverage: Some(coverage),
            ..self
        }
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Mean radiance of the pixel in column `x` and row `y`; 0 outside.
    pub fn mean(&self, x: usize, y: usize) -> DVec3 {
        self.pixel(x, y).map_or(DVec3::ZERO, |p| p.mean)
    }

    /// Standard error of that mean. [`super::Budget::Even`] and [`super::Budget::Adaptive`] compute it as if samples were
    /// independent: too large for lattices and Sobol points, right for random ones. [`super::Budget::ToError`] computes it
    /// from replicates: right for both of its sets of points. 0 for a single sample and outside.
    pub fn standard_error(&self, x: usize, y: usize) -> DVec3 {
        self.pixel(x, y).map_or(DVec3::ZERO, |p| p.error)
    }

    /// The means as 32-bit pixels; what exceeds f32 becomes its largest value. With alpha, if the scene's background is left out.
    ///
    /// # Errors
    /// None for a film that [`super::render()`] returned.
    pub fn to_image(&self) -> Result<Image> {
        let mut pixels = Vec::with_capacity(self.pixels.len());
        for pixel in &self.pixels {
            pixels.push(pixel.mean.as_vec3().min(Rgb::splat(f32::MAX)));
        }
        let image = Image::new(self.width, self.height, pixels)?;
        match &self.coverage {
            Some(coverage) => image.with_alpha(coverage.clone()),
            None => Ok(image),
        }
    }

    fn pixel(&self, x: usize, y: usize) -> Option<&Pixel> {
        (x < self.width)
            .then(|| self.pixels.get(y * self.width + x))
            .flatten()
    }
}

/// Mean and variance of a pixel's samples, in f64 and in the samples' order.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RunningMoments {
    count: f64,
    mean: DVec3,
    /// Sum of squared deviations from the mean (Welford 1962).
    squares: DVec3,
}

impl RunningMoments {
    pub(super) fn add(&mut self, radiance: DVec3) {
        // m ← m + (x − m)/n and S ← S + (x − m before)(x − m after): no difference of large sums, as in Σx² − n m².
        self.count += 1.0;
        let before = radiance - self.mean;
        self.mean += before / self.count;
        self.squares += before * (radiance - self.mean);
    }

    pub(super) fn count(&self) -> f64 {
        self.count
    }

    pub(super) fn mean(&self) -> DVec3 {
        self.mean
    }

    /// Variance of single samples.
    pub(super) fn variance(&self) -> DVec3 {
        self.squares / (self.count - 1.0).max(1.0)
    }

    /// Sum of squared deviations from the mean.
    pub(super) fn squares(&self) -> DVec3 {
        self.squares
    }

    /// The moments of `count` samples whose mean and sum of squared deviations are known.
    pub(super) fn new(count: u64, mean: DVec3, squares: DVec3) -> Self {
        Self {
            count: count as f64,
            mean,
            squares,
        }
    }

    pub(super) fn pixel(&self) -> Pixel {
        // δ² = S/(n(n − 1)), and 0 for a single sample.
        let error2 = self.squares / (self.count * (self.count - 1.0)).max(1.0);
        Pixel {
            mean: self.mean,
            error: error2.max(DVec3::ZERO).map(f64::sqrt),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_standard_error_are_the_textbook_ones() {
        let mut moments = RunningMoments::default();
        for x in [1.0, 2.0, 4.0, 9.0] {
            moments.add(DVec3::new(x, 3.0, 0.0));
        }
        let p = moments.pixel();
        assert!(p.mean.abs_diff_eq(DVec3::new(4.0, 3.0, 0.0), 1e-15));
        // Variance 38/3, over four samples.
        assert!(
            p.error
                .abs_diff_eq(DVec3::new((38.0f64 / 12.0).sqrt(), 0.0, 0.0), 1e-15)
        );
        let film = Film::new(1, 1, vec![p]);
        assert_eq!(film.mean(1, 0), DVec3::ZERO);
        assert_eq!(
            film.to_image().unwrap().pixel(0, 0),
            Rgb::new(4.0, 3.0, 0.0)
        );
    }
}
