//! Pictures in memory, linear RGB in OpenEXR files, tone-mapped sRGB in PNG files; in from OpenEXR, Radiance, PFM and PNG.

mod exr;
mod format;
mod origin;
mod pfm;
#[cfg(feature = "png")]
mod png;
#[cfg(feature = "png")]
mod png_input;
mod radiance;
mod read;
mod screen;

pub use exr::{decode_exr, read_exr, write_exr};
#[cfg(feature = "png")]
pub use png::{encode_png, write_png};
pub use read::{decode_image, read_image};
pub use screen::{encode_srgb, tone_map};

pub(crate) use format::PictureFormat;
pub(crate) use read::read_picture;

use std::path::Path;

use crate::color::Rgb;
use crate::{Error, Result};

/// The largest picture that is read or rendered, in pixels: 16,384 × 8,192.
///
/// The example of [`Image`] makes a picture and the bytes of its PNG.
pub const MAX_PIXELS: usize = 1 << 27;

/// Linear RGB pixels, row after row from the top left: `[y][x]`.
///
/// # Examples
/// ```
/// use merlkit::color::Rgb;
/// use merlkit::image::{Image, encode_png, encode_srgb};
///
/// let image = Image::from_fn(4, 2, |x, y| Rgb::new(x as f32, y as f32, 0.5))?;
/// assert_eq!(image.pixel(3, 1), Rgb::new(3.0, 1.0, 0.5));
///
/// // `write_exr` and `write_png` write files; these are the bytes of a PNG, at an exposure of 0 stops.
/// let png = encode_png(4, 2, &encode_srgb(&image, 0.0))?;
/// assert_eq!(&png[1..4], b"PNG");
/// # Ok::<(), merlkit::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: usize,
    height: usize,
    pixels: Vec<Rgb>,
    /// `[y][x]`
    alpha: Option<Vec<f32>>,
    backdrop: Option<Rgb>,
    comment: Option<String>,
}

impl Image {
    /// A picture of `width` × `height` pixels.
    ///
    /// # Errors
    /// [`Error::Argument`] if a side is 0, the number of pixels is not `width · height`, or it exceeds [`MAX_PIXELS`].
    pub fn new(width: usize, height: usize, pixels: Vec<Rgb>) -> Result<Self> {
        let count = width
            .checked_mul(height)
            .filter(|&n| n > 0 && n <= MAX_PIXELS);
        if count != Some(pixels.len()) {
            return Err(Error::argument(
                format!(
                    "{} pixels for a picture of {width} × {height}",
                    pixels.len()
                ),
                format!("give one value per pixel, at most {MAX_PIXELS} pixels"),
            ));
        }
        Ok(Self {
            width,
            height,
            pixels,
            alpha: None,
            backdrop: None,
            comment: None,
        })
    }

    /// The same picture with the fraction of each pixel that is covered, `[y][x]`; the colours are those of what covers it, times
    /// that fraction. [`write_exr`] writes both as they are; [`write_png`] divides the colours by it.
    ///
    /// # Errors
    /// [`Error::Argument`] if there is not one number for each pixel.
    pub fn with_alpha(self, alpha: Vec<f32>) -> Result<Self> {
        if alpha.len() != self.pixels.len() {
            return Err(Error::argument(
                format!("{} alphas for {} pixels", alpha.len(), self.pixels.len()),
                "give one for each pixel",
            ));
        }
        Ok(Self {
            alpha: Some(alpha),
            ..self
        })
    }

    /// The fraction of each pixel that is covered, `[y][x]`; `None` of a picture without transparency.
    pub fn alpha(&self) -> Option<&[f32]> {
        self.alpha.as_deref()
    }

    /// The same picture, in whose files a colour takes the place of transparency: linear, from 0 to 1, as it is to be seen on the
    /// screen at any exposure.
    pub fn with_backdrop(self, colour: Rgb) -> Self {
        Self {
            backdrop: Some(colour),
            ..self
        }
    }

    /// The alphas that a file is to have.
    fn file_alpha(&self) -> Option<&[f32]> {
        match self.backdrop {
            Some(_) => None,
            None => self.alpha(),
        }
    }

    /// Linear light of a pixel with what shows through it: c + (1 − α)·backdrop.
    fn composite(&self, i: usize) -> Rgb {
        match (&self.alpha, self.backdrop) {
            (Some(alpha), Some(backdrop)) => self.pixels[i] + (1.0 - alpha[i]) * backdrop,
            _ => self.pixels[i],
        }
    }

    /// The same picture, of which the headers of [`write_exr`] (`comments`) and [`write_png`] (`Comment`) will say `comment`.
    /// [`Self::read_comment`] reads it back, and readers of pictures leave it out.
    pub fn with_comment(self, comment: impl Into<String>) -> Self {
        Self {
            comment: Some(comment.into()),
            ..self
        }
    }

    /// A picture whose pixel in column `x` and row `y` is `value(x, y)`.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn from_fn(
        width: usize,
        height: usize,
        mut value: impl FnMut(usize, usize) -> Rgb,
    ) -> Result<Self> {
        if width.checked_mul(height).is_none_or(|n| n > MAX_PIXELS) {
            return Self::new(width, height, Vec::new());
        }
        let pixels = (0..width * height)
            .map(|i| value(i % width, i / width))
            .collect();
        Self::new(width, height, pixels)
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All pixels, `[y][x]`.
    pub fn pixels(&self) -> &[Rgb] {
        &self.pixels
    }

    /// Gives the pixels away, `[y][x]`.
    pub fn into_pixels(self) -> Vec<Rgb> {
        self.pixels
    }

    /// The pixel in column `x` and row `y`; 0 outside.
    pub fn pixel(&self, x: usize, y: usize) -> Rgb {
        if x < self.width && y < self.height {
            self.pixels[y * self.width + x]
        } else {
            Rgb::ZERO
        }
    }
}

/// Refuses a picture without pixels or of more than [`MAX_PIXELS`], before memory is taken for it.
fn check_size(width: usize, height: usize, path: &Path) -> Result<()> {
    if width > 0 && height > 0 && width.checked_mul(height).is_some_and(|n| n <= MAX_PIXELS) {
        return Ok(());
    }
    Err(Error::Unsupported {
        path: path.to_owned(),
        what: format!("a picture of {width} × {height}"),
        fix: format!("give one of at least 1 pixel and at most {MAX_PIXELS}"),
    })
}
