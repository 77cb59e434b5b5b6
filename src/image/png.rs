//! Pictures for the screen as PNG files.

use std::io::Write;
use std::path::Path;

use super::{Image, encode_srgb};
use crate::files::{Overwrite, write_new};
use crate::{Error, Result};

/// Writes `image` as an 8-bit sRGB PNG, with alpha if it has any: each channel is multiplied by 2^`exposure`, passes [`super::tone_map`] and is encoded by
/// the sRGB transfer function (IEC 61966-2-1).
///
/// The example of [`Image`](crate::image::Image) makes a picture and the bytes of its PNG.
///
/// # Errors
/// [`Error::Argument`] if `path` exists and `overwrite` refuses; [`Error::Io`] if it can't be written.
pub fn write_png(path: &Path, image: &Image, exposure: f32, overwrite: Overwrite) -> Result<()> {
    let bytes = encode_srgb(image, exposure);
    let color = match image.file_alpha() {
        None => ::png::ColorType::Rgb,
        Some(_) => ::png::ColorType::Rgba,
    };
    let size = [image.width(), image.height()];
    write_new(path, overwrite, |out| {
        let comment = image.comment.as_deref();
        write_bytes(out, size, color, &bytes, comment).map_err(|e| write_error(path, e))
    })
}

/// The bytes of a PNG file whose pixels are `bytes`: sRGB, three per pixel, row after row from the top.
///
/// The example of [`Image`](crate::image::Image) makes a picture and the bytes of its PNG.
///
/// # Errors
/// [`Error::Argument`] if a side is 0 or `bytes` are not three per pixel.
pub fn encode_png(width: usize, height: usize, bytes: &[u8]) -> Result<Vec<u8>> {
    let mut out = Vec::new();
    let color = ::png::ColorType::Rgb;
    write_bytes(&mut out, [width, height], color, bytes, None).map_err(|e| {
        Error::argument(
            format!(
                "a PNG of {width} × {height} from {} bytes: {e}",
                bytes.len()
            ),
            "give three bytes per pixel",
        )
    })?;
    Ok(out)
}

fn write_bytes(
    out: impl Write,
    size: [usize; 2],
    color: ::png::ColorType,
    bytes: &[u8],
    comment: Option<&str>,
) -> std::result::Result<(), ::png::EncodingError> {
    // A side that has no room in 32 bits has none in the file, and is refused as 0 is.
    let [width, height] = size.map(|side| u32::try_from(side).unwrap_or(0));
    let mut encoder = ::png::Encoder::new(out, width, height);
    encoder.set_color(color);
    encoder.set_depth(::png::BitDepth::Eight);
    encoder.set_source_srgb(::png::SrgbRenderingIntent::Perceptual);
    if let Some(comment) = comment {
        encoder.add_itxt_chunk("Comment".into(), comment.into())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(bytes)?;
    writer.finish()
}

fn write_error(path: &Path, error: ::png::EncodingError) -> Error {
    match error {
        ::png::EncodingError::IoError(source) => Error::io(path, "write", source),
        other => Error::io(path, "write", std::io::Error::other(other)),
    }
}
