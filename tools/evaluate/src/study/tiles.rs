//! Pixels of tiles as text, and the pictures that tiles make.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use merlkit::color::Rgb;
use merlkit::image::Image;
use merlkit::{Error, Result};

use super::task::TileTask;

/// Pixels row after row from the top left, as base64 of 32-bit floats with the lowest byte first, three for each pixel.
pub(super) fn encode_pixels(image: &Image) -> String {
    let mut bytes = Vec::with_capacity(12 * image.pixels().len());
    for pixel in image.pixels() {
        for channel in pixel.to_array() {
            bytes.extend_from_slice(&channel.to_le_bytes());
        }
    }
    STANDARD.encode(bytes)
}

/// The pixels of [`encode_pixels`]; `None` if they are not `count` pixels.
pub(super) fn decode_pixels(text: &str, count: usize) -> Option<Vec<Rgb>> {
    let bytes = STANDARD.decode(text).ok()?;
    if bytes.len() != 12 * count {
        return None;
    }
    let mut pixels = Vec::with_capacity(count);
    for pixel in bytes.chunks_exact(12) {
        let mut channels = [0.0; 3];
        for (channel, bytes) in channels.iter_mut().zip(pixel.chunks_exact(4)) {
            *channel = f32::from_le_bytes(bytes.try_into().ok()?);
        }
        pixels.push(Rgb::from_array(channels));
    }
    Some(pixels)
}

/// A picture that tiles are put into.
pub(super) struct TiledPicture {
    /// The whole picture as one tile.
    pub(super) task: TileTask,
    pixels: Vec<Option<Rgb>>,
    left: usize,
}

impl TiledPicture {
    /// The picture of a tile, without a pixel.
    pub(super) fn new(tile: &TileTask) -> Self {
        let [width, height] = tile.picture;
        Self {
            task: tile.whole_picture(),
            pixels: vec![None; width * height],
            left: width * height,
        }
    }

    /// Puts a tile's pixels in their place, and returns whether that was the last one.
    ///
    /// # Errors
    /// [`Error::Argument`] for a pixel that is there.
    pub(super) fn paste(&mut self, tile: &TileTask, pixels: &[Rgb]) -> Result<bool> {
        for (number, pixel) in pixels.iter().enumerate() {
            let x = tile.corner[0] + number % tile.size[0];
            let y = tile.corner[1] + number / tile.size[0];
            let place = &mut self.pixels[y * tile.picture[0] + x];
            if place.replace(*pixel).is_some() {
                let what = format!("two tiles of a picture have its pixel {x}, {y}");
                return Err(Error::argument(
                    what,
                    "make the plan again with `merlkit study plan`",
                ));
            }
        }
        self.left -= pixels.len();
        Ok(self.left == 0)
    }

    /// The picture, all of whose pixels are there.
    ///
    /// # Errors
    /// As [`Image::new`].
    pub(super) fn into_image(self) -> Result<Image> {
        let [width, height] = self.task.picture;
        let mut pixels = Vec::with_capacity(self.pixels.len());
        for pixel in self.pixels {
            pixels.push(pixel.unwrap_or_default());
        }
        Image::new(width, height, pixels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_come_back_with_every_bit() {
        let odd = [f32::MIN_POSITIVE / 3.0, f32::MAX, -0.0];
        let image = Image::from_fn(3, 2, |x, y| Rgb::from_array(odd) * (x + 3 * y) as f32).unwrap();
        let pixels = decode_pixels(&encode_pixels(&image), 6).unwrap();
        for (pixel, expected) in pixels.iter().zip(image.pixels()) {
            assert_eq!(
                pixel.to_array().map(f32::to_bits),
                expected.to_array().map(f32::to_bits)
            );
        }
        assert_eq!(decode_pixels(&encode_pixels(&image), 5), None);
        assert_eq!(decode_pixels("%", 1), None);
    }
}
