//! OpenEXR: 32-bit linear RGB out, any colours or luminance in.

use std::io::{BufReader, Cursor, Read, Seek, Write};
use std::path::Path;

use ::exr::error::Error as ExrError;
use ::exr::image::Image as ExrImage;
use ::exr::image::write::channels::WritableChannels;
use ::exr::meta::BlockDescription;
use ::exr::meta::attribute::Text;
use ::exr::meta::header::Header;
use ::exr::prelude::{
    Layer, ReadChannels, ReadLayers, ReadSpecificChannel, SpecificChannels, Vec2, WritableImage,
};

use super::{Image, MAX_PIXELS};
use crate::color::Rgb;
use crate::files::{Overwrite, RegularFile, write_new};
use crate::{Error, Result};

/// Writes `image` as an OpenEXR file of 32-bit channels, three or with alpha four; equal pictures give equal bytes.
///
/// The example of [`Image`](crate::image::Image) makes a picture and the bytes of its PNG.
///
/// # Errors
/// [`Error::Argument`] if `path` exists and `overwrite` refuses; [`Error::Io`] if it can't be written.
pub fn write_exr(path: &Path, image: &Image, overwrite: Overwrite) -> Result<()> {
    let (width, size) = (image.width, (image.width, image.height));
    write_new(path, overwrite, |out| match image.file_alpha() {
        None => {
            let channels = SpecificChannels::rgb(|Vec2(x, y)| {
                let c = image.composite(y * width + x);
                (c.x, c.y, c.z)
            });
            let file = describe_file(ExrImage::from_channels(size, channels), image);
            write_file(out, &file, path)
        }
        Some(alpha) => {
            let channels = SpecificChannels::rgba(|Vec2(x, y)| {
                let c: Rgb = image.pixels[y * width + x];
                (c.x, c.y, c.z, alpha[y * width + x])
            });
            let file = describe_file(ExrImage::from_channels(size, channels), image);
            write_file(out, &file, path)
        }
    })
}

/// A file of one layer, with the comment of `image`.
fn describe_file<C>(mut file: ExrImage<Layer<C>>, image: &Image) -> ExrImage<Layer<C>> {
    // UTF-8, as readers of today take it; the bytes of a string are not limited.
    if let Some(comment) = &image.comment {
        let text = Text::from_slice_unchecked(comment.as_bytes());
        file.layer_data.attributes.comments = Some(text);
    }
    file
}

fn write_file<'f, C: WritableChannels<'f>>(
    out: impl Write + Seek,
    file: &'f ExrImage<Layer<C>>,
    path: &Path,
) -> Result<()> {
    // Parallel compression writes its blocks in the order in which they finish.
    file.write()
        .non_parallel()
        .to_buffered(out)
        .map_err(|e| write_error(path, e))
}

/// Reads the colours of an OpenEXR file, at its largest resolution: channels R, G and B of the first layer that has them, else
/// luminance Y, which is grey, else the only channels whose names end in `.R`, `.G` and `.B`, as Blender's
/// `ViewLayer.Combined.R`. Values are as the file has them: they may be negative, infinite or NaN. Alpha is read beside R, G and B.
///
/// See [`Image`](crate::image::Image) for an example of what is returned.
///
/// # Errors
/// [`Error::Io`] if the file can't be read; [`Error::Invalid`] if it is not OpenEXR or is damaged; [`Error::Unsupported`] for
/// files without such channels or with several sets of them, of deep data or of more than [`MAX_PIXELS`] pixels.
pub fn read_exr(path: &Path) -> Result<Image> {
    decode_exr_file(RegularFile::open(path)?)
}

/// [`read_exr`] from an open file, read from its start.
pub(super) fn decode_exr_file(file: RegularFile) -> Result<Image> {
    let (path, len) = (file.path().to_owned(), file.len());
    decode(BufReader::with_capacity(1 << 16, file), len, &path)
}

/// [`read_exr`] from a file's bytes; `path` is for messages.
///
/// See [`Image`](crate::image::Image) for an example of what is returned.
///
/// # Errors
/// As [`read_exr`].
pub fn decode_exr(bytes: &[u8], path: &Path) -> Result<Image> {
    decode(Cursor::new(bytes), bytes.len() as u64, path)
}

fn decode<R: Read + Seek>(mut source: R, len: u64, path: &Path) -> Result<Image> {
    let headers = read_headers(&mut source, len, path)?;
    let channels = choose_channels(&headers, path)?;
    source.rewind().map_err(|e| Error::io(path, "read", e))?;
    match channels {
        ExrChannels::Luminance => read_luminance(source, len, path),
        ExrChannels::Colours(prefix) => {
            let has_alpha = has_alpha(&headers, &prefix);
            read_colours(source, &prefix, has_alpha, len, path)
        }
    }
}

/// Where a file's colours are.
#[derive(Debug, PartialEq)]
enum ExrChannels {
    /// Channel Y.
    Luminance,
    /// Channels R, G and B with a prefix: none, or a layer's name and a dot.
    Colours(String),
}

fn contains(names: &[String], name: &str) -> bool {
    names.iter().any(|n| n == name)
}

/// The channels to read; their names decide, not their order.
fn choose_channels(headers: &[Header], path: &Path) -> Result<ExrChannels> {
    let mut prefixes: Vec<String> = Vec::new();
    let mut has_luminance = false;
    for header in headers {
        let mut names = Vec::new();
        for channel in &header.channels.list {
            names.push(channel.name.to_string());
        }
        // Channels RY and BY are differences of colours, which luminance alone leaves out.
        has_luminance |=
            contains(&names, "Y") && !contains(&names, "RY") && !contains(&names, "BY");
        for name in &names {
            let Some(prefix) = name.strip_suffix('R') else {
                continue;
            };
            let is_layer = prefix.is_empty() || prefix.ends_with('.');
            let (green, blue) = (format!("{prefix}G"), format!("{prefix}B"));
            let is_whole = contains(&names, &green) && contains(&names, &blue);
            if is_layer && is_whole && !prefixes.iter().any(|p| p == prefix) {
                prefixes.push(prefix.to_owned());
            }
        }
    }
    if prefixes.iter().any(String::is_empty) {
        return Ok(ExrChannels::Colours(String::new()));
    }
    match (has_luminance, &prefixes[..]) {
        (true, _) => Ok(ExrChannels::Luminance),
        (false, [prefix]) => Ok(ExrChannels::Colours(prefix.clone())),
        (false, prefixes) => Err(no_channels(prefixes, headers, path)),
    }
}

/// Names what there is instead of one set of colours.
fn no_channels(prefixes: &[String], headers: &[Header], path: &Path) -> Error {
    let (what, fix) = if prefixes.is_empty() {
        let mut names: Vec<String> = Vec::new();
        for channel in headers.iter().flat_map(|h| &h.channels.list).take(8) {
            names.push(channel.name.to_string().escape_debug().to_string());
        }
        (
            format!(
                "an OpenEXR file with channels {}, not R, G and B or Y alone",
                names.join(", ")
            ),
            "save it with channels named R, G and B",
        )
    } else {
        let mut layers: Vec<String> = Vec::new();
        for prefix in prefixes.iter().take(8) {
            layers.push(prefix.trim_end_matches('.').escape_debug().to_string());
        }
        (
            format!(
                "an OpenEXR file with several layers of colours ({})",
                layers.join(", ")
            ),
            "save only the layer that you want, with channels named R, G and B",
        )
    };
    Error::Unsupported {
        path: path.to_owned(),
        what,
        fix: fix.into(),
    }
}

/// Pixels on their way from a file.
struct ColourPixels {
    width: usize,
    colours: Vec<Rgb>,
    /// Empty where the file has no alpha.
    alpha: Vec<f32>,
}

/// Channels `prefix`R, G and B, and A if `has_alpha`.
fn read_colours<R: Read + Seek>(
    source: R,
    prefix: &str,
    has_alpha: bool,
    len: u64,
    path: &Path,
) -> Result<Image> {
    let [red, green, blue, alpha] = ["R", "G", "B", "A"].map(|name| format!("{prefix}{name}"));
    let read = ::exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required(red.as_str())
        .required(green.as_str())
        .required(blue.as_str())
        .optional(alpha.as_str(), 1.0)
        .collect_pixels(
            |size, _| ColourPixels {
                width: size.width(),
                colours: vec![Rgb::ZERO; size.width() * size.height()],
                alpha: vec![
                    1.0;
                    if has_alpha {
                        size.width() * size.height()
                    } else {
                        0
                    }
                ],
            },
            |pixels: &mut ColourPixels, at, (r, g, b, a): (f32, f32, f32, f32)| {
                let i = at.y() * pixels.width + at.x();
                if let Some(colour) = pixels.colours.get_mut(i) {
                    *colour = Rgb::new(r, g, b);
                }
                if let Some(alpha) = pixels.alpha.get_mut(i) {
                    *alpha = a;
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(source)
        .map_err(|e| read_error(path, len, e))?;
    let size = read.layer_data.size;
    let ColourPixels { colours, alpha, .. } = read.layer_data.channel_data.pixels;
    let image = Image::new(size.width(), size.height(), colours)?;
    match has_alpha {
        true => image.with_alpha(alpha),
        false => Ok(image),
    }
}

/// Whether a layer with these colours has alpha as well.
fn has_alpha(headers: &[Header], prefix: &str) -> bool {
    let name = format!("{prefix}A");
    let mut channels = headers.iter().flat_map(|header| &header.channels.list);
    channels.any(|channel| channel.name.to_string() == name)
}

/// Channel Y as grey.
fn read_luminance<R: Read + Seek>(source: R, len: u64, path: &Path) -> Result<Image> {
    let read = ::exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required("Y")
        .collect_pixels(
            |size, _| (size.width(), vec![Rgb::ZERO; size.width() * size.height()]),
            |(width, pixels): &mut (usize, Vec<Rgb>), at, (y,): (f32,)| {
                if let Some(pixel) = pixels.get_mut(at.y() * *width + at.x()) {
                    *pixel = Rgb::splat(y);
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(source)
        .map_err(|e| read_error(path, len, e))?;
    let size = read.layer_data.size;
    let (_, pixels) = read.layer_data.channel_data.pixels;
    Image::new(size.width(), size.height(), pixels)
}

/// Most pixels for each byte of a file: three channels of two bytes, deflated 1032 to 1 with a byte of each three left
/// out (PXR24), are 229.
const PIXELS_PER_BYTE: u64 = 256;

/// Reads the headers alone, so that no picture's memory is taken on the word of a damaged file.
fn read_headers<R: Read>(source: R, len: u64, path: &Path) -> Result<Vec<Header>> {
    let meta = ::exr::meta::MetaData::read_from_buffered(source, false)
        .map_err(|e| read_error(path, len, e))?;
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
    Ok(meta.headers.into_vec())
}

/// The comment in the headers of a file; pixels are not read.
///
/// # Errors
/// As [`decode_exr`].
pub(super) fn read_header_comment<R: Read>(
    source: R,
    len: u64,
    path: &Path,
) -> Result<Option<String>> {
    for header in read_headers(source, len, path)? {
        if let Some(text) = &header.own_attributes.comments {
            return Ok(Some(String::from_utf8_lossy(text.as_slice()).into_owned()));
        }
    }
    Ok(None)
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

fn read_error(path: &Path, len: u64, error: ExrError) -> Error {
    match error {
        ExrError::Io(source) if source.kind() != std::io::ErrorKind::UnexpectedEof => {
            Error::io(path, "read", source)
        }
        ExrError::NotSupported(what) => Error::Unsupported {
            path: path.to_owned(),
            what: what.into_owned(),
            fix: "save it as a flat OpenEXR file with channels R, G and B".into(),
        },
        // The decoder's words for a file that ends early.
        ExrError::Invalid(what) if what == "reference to missing bytes" => Error::invalid(
            path,
            len,
            "an OpenEXR file",
            "one that ends before its content does",
            "fetch the file again: it is cut off",
        ),
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
