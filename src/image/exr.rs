//! OpenEXR: 32-bit linear RGB out, any RGB layer in.

use std::io::{BufReader, Cursor, Read, Seek};
use std::path::Path;

use ::exr::error::Error as ExrError;
use ::exr::image::Image as ExrImage;
use ::exr::meta::BlockDescription;
use ::exr::meta::header::Header;
use ::exr::prelude::{ReadChannels, ReadLayers, SpecificChannels, Vec2, WritableImage};

use super::{Image, MAX_PIXELS};
use crate::color::Rgb;
use crate::files::{Overwrite, RegularFile, write_new};
use crate::{Error, Result};

/// Writes `image` as an OpenEXR file of three 32-bit channels; equal pictures give equal bytes.
///
/// # Errors
/// [`Error::Argument`] if `path` exists and `overwrite` refuses; [`Error::Io`] if it can't be written.
pub fn write_exr(path: &Path, image: &Image, overwrite: Overwrite) -> Result<()> {
    write_new(path, overwrite, |out| {
        let channels = SpecificChannels::rgb(|Vec2(x, y)| {
            let c = image.pixel(x, y);
            (c.x, c.y, c.z)
        });
        // Parallel compression writes its blocks in the order in which they finish.
        ExrImage::from_channels((image.width, image.height), channels)
            .write()
            .non_parallel()
            .to_buffered(out)
            .map_err(|e| write_error(path, e))
    })
}

/// Reads the first layer of an OpenEXR file that has channels R, G and B, at its largest resolution.
///
/// # Errors
/// [`Error::Io`] if the file can't be read; [`Error::Invalid`] if it is not OpenEXR, is damaged, or holds pixels that are
/// negative, NaN or infinite, which are counted; [`Error::Unsupported`] for files without RGB, of deep data or of more than
/// [`MAX_PIXELS`] pixels.
pub fn read_exr(path: &Path) -> Result<Image> {
    let file = RegularFile::open(path)?;
    let len = file.len();
    decode(BufReader::with_capacity(1 << 16, file), len, path)
}

/// [`read_exr`] from a file's bytes; `path` is for messages.
///
/// # Errors
/// As [`read_exr`].
pub fn decode_exr(bytes: &[u8], path: &Path) -> Result<Image> {
    decode(Cursor::new(bytes), bytes.len() as u64, path)
}

fn decode<R: Read + Seek>(mut source: R, len: u64, path: &Path) -> Result<Image> {
    check_headers(&mut source, len, path)?;
    source.rewind().map_err(|e| Error::io(path, "read", e))?;
    let read = ::exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| (size.width(), vec![Rgb::ZERO; size.width() * size.height()]),
            |(width, pixels): &mut (usize, Vec<Rgb>), at, (r, g, b): (f32, f32, f32)| {
                if let Some(pixel) = pixels.get_mut(at.y() * *width + at.x()) {
                    *pixel = Rgb::new(r, g, b);
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(source)
        .map_err(|e| read_error(path, e))?;
    let size = read.layer_data.size;
    let (_, pixels) = read.layer_data.channel_data.pixels;
    check_pixels(path, size.width(), &pixels)?;
    Image::new(size.width(), size.height(), pixels)
}

/// Pixels that a byte of a file can stand for: three channels of two bytes, deflated 1032 to 1 with a byte of each three left
/// out (PXR24), are 229.
const PIXELS_PER_BYTE: u64 = 256;

/// Reads the headers alone, so that no picture's memory is taken on the word of a damaged file.
fn check_headers<R: Read>(source: R, len: u64, path: &Path) -> Result<()> {
    let meta = ::exr::meta::MetaData::read_from_buffered(source, false)
        .map_err(|e| read_error(path, e))?;
    for header in &meta.headers {
        let Vec2(width, height) = header.layer_size;
        let pixels = width.checked_mul(height);
        if pixels.is_none_or(|n| n > MAX_PIXELS) {
            return Err(Error::Unsupported {
                path: path.to_owned(),
                what: format!("a picture of {width} × {height}"),
                fix: format!("scale it to at most {MAX_PIXELS} pixels"),
            });
        }
        if pixels.is_some_and(|n| n as u64 / PIXELS_PER_BYTE > len) {
            return Err(Error::invalid(
                path,
                len,
                format!("a picture of {width} × {height}"),
                format!("a file of {len} bytes, which can't hold it"),
                "fetch the file again: it is damaged or cut off",
            ));
        }
        check_block(header, len, path)?;
    }
    Ok(())
}

/// Bytes that a block of pixels may always have: a tile of 1024 × 1024 RGB at 32 bits.
const ANY_BLOCK: u64 = 12 << 20;

/// The reader takes a block's memory before it reads the block, and a tile may be larger than the picture.
fn check_block(header: &Header, len: u64, path: &Path) -> Result<()> {
    let Vec2(width, height) = match header.blocks {
        BlockDescription::Tiles(tiles) => tiles.tile_size,
        BlockDescription::ScanLines => Vec2(
            header.layer_size.0,
            header.compression.scan_lines_per_block(),
        ),
    };
    let bytes = (width as u64)
        .checked_mul(height as u64)
        .and_then(|pixels| pixels.checked_mul(header.channels.bytes_per_pixel as u64));
    let most = ANY_BLOCK.max(len.saturating_mul(12 * PIXELS_PER_BYTE));
    if bytes.is_some_and(|b| b <= most) {
        return Ok(());
    }
    Err(Error::invalid(
        path,
        len,
        format!(
            "blocks of {width} × {height} pixels in {} channels",
            header.channels.list.len()
        ),
        format!("a file of {len} bytes, which can't hold one"),
        "fetch the file again: it is damaged or cut off",
    ))
}

fn check_pixels(path: &Path, width: usize, pixels: &[Rgb]) -> Result<()> {
    let usable = |c: &Rgb| c.is_finite() && c.min_element() >= 0.0;
    let Some(first) = pixels.iter().position(|c| !usable(c)) else {
        return Ok(());
    };
    let not_finite = pixels.iter().filter(|c| !c.is_finite()).count();
    let negative = pixels
        .iter()
        .filter(|c| c.is_finite() && c.min_element() < 0.0)
        .count();
    Err(Error::invalid(
        path,
        0,
        "finite radiance ≥ 0 in every pixel",
        format!(
            "{negative} pixels with a negative channel and {not_finite} with NaN or infinity, the first in column {}, row {}",
            first % width,
            first / width
        ),
        "repair the picture, for example by setting those pixels to 0",
    ))
}

fn read_error(path: &Path, error: ExrError) -> Error {
    match error {
        ExrError::Io(source) if source.kind() != std::io::ErrorKind::UnexpectedEof => {
            Error::io(path, "read", source)
        }
        ExrError::NotSupported(what) => Error::Unsupported {
            path: path.to_owned(),
            what: what.into_owned(),
            fix: "save it as a flat OpenEXR file with channels R, G and B".into(),
        },
        ExrError::Invalid(what) if what.contains("layer") => Error::Unsupported {
            path: path.to_owned(),
            what: "an OpenEXR file without channels R, G and B".into(),
            fix: "save it with channels named R, G and B".into(),
        },
        other => Error::invalid(
            path,
            0,
            "an OpenEXR file",
            format!("one that can't be decoded ({other})"),
            "name an OpenEXR picture, or fetch the file again",
        ),
    }
}

fn write_error(path: &Path, error: ExrError) -> Error {
    match error {
        ExrError::Io(source) => Error::io(path, "write", source),
        other => Error::io(path, "write", std::io::Error::other(other.to_string())),
    }
}
