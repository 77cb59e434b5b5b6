//! PNG files as linear light.

use std::io::{BufRead, Cursor, Seek};
use std::path::Path;

use ::png::{BitDepth, ColorType, Decoder, DecodingError, Info, Transformations};

use super::{Image, check_size};
use crate::color::Rgb;
use crate::{Error, Result};

/// Keyword of the text that is read back.
const COMMENT: &str = "Comment";

/// Bytes that deflate makes of one at most.
const INFLATION: u64 = 1032;

/// The exponent that sRGB's predecessors wrote into files, 1/2.2: it means sRGB as good as always.
const SRGB_GAMMA: f32 = 0.454_55;

/// The picture, of 1 to 16 bits a channel, made linear: by sRGB's transfer function, or by the exponent that the file states.
///
/// # Errors
/// [`Error::Invalid`] for damaged files; [`Error::Unsupported`] for pictures with transparent pixels, with PQ, HLG or another
/// transfer function, and for too large ones.
pub(super) fn decode_png(bytes: &[u8], path: &Path) -> Result<Image> {
    let mut source = Cursor::new(bytes);
    let decoded = decode_samples(&mut source, path);
    let stopped = source.position();
    match decoded {
        Ok(samples) => samples.into_image(path),
        Err(Failed::Explained(error)) => Err(error),
        Err(Failed::Decoder(error)) => Err(Error::invalid(
            path,
            stopped,
            "a PNG picture",
            format!("one that can't be decoded ({error})"),
            "fetch the file again: it is damaged or cut off",
        )),
    }
}

/// The text of a file's chunk "Comment" before the pixels, if it is not compressed.
///
/// # Errors
/// [`Error::Invalid`] for a damaged header.
pub(super) fn read_png_comment(source: impl BufRead + Seek, path: &Path) -> Result<Option<String>> {
    // All chunks before the pixels, for which no memory is taken yet.
    let reader = Decoder::new(source).read_info().map_err(|error| {
        Error::invalid(
            path,
            0,
            "a PNG picture",
            format!("one that can't be decoded ({error})"),
            "fetch the file again: it is damaged or cut off",
        )
    })?;
    for chunk in &reader.info().utf8_text {
        if chunk.keyword == COMMENT && !chunk.compressed {
            return Ok(chunk.get_text().ok());
        }
    }
    Ok(None)
}

/// Why a picture was not decoded.
enum Failed {
    Explained(Error),
    Decoder(DecodingError),
}

impl From<DecodingError> for Failed {
    fn from(error: DecodingError) -> Self {
        Self::Decoder(error)
    }
}

impl From<Error> for Failed {
    fn from(error: Error) -> Self {
        Self::Explained(error)
    }
}

/// A picture as the file has it.
struct PngSamples {
    width: usize,
    height: usize,
    color: ColorType,
    depth: BitDepth,
    bytes: Vec<u8>,
    /// The exponent that makes values linear; `None` for sRGB.
    exponent: Option<f64>,
}

fn decode_samples(
    source: &mut Cursor<&[u8]>,
    path: &Path,
) -> std::result::Result<PngSamples, Failed> {
    let len = source.get_ref().len() as u64;
    let mut decoder = Decoder::new(source);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    // Palettes become colours, and less than eight bits eight.
    decoder.set_transformations(Transformations::EXPAND);
    let info = decoder.read_header_info()?;
    let (width, height) = (info.width as usize, info.height as usize);
    check_size(width, height, path)?;
    let raw = info.raw_row_length() as u64 * height as u64;
    if raw / INFLATION > len {
        let what = format!("a picture of {width} × {height}");
        let found = format!("a file of {len} bytes, which can't hold it");
        let fix = "fetch the file again: it is damaged or cut off";
        return Err(Error::invalid(path, len, what, found, fix).into());
    }
    let mut reader = decoder.read_info()?;
    let exponent = transfer(reader.info(), path)?;
    let room = reader
        .output_buffer_size()
        .ok_or(DecodingError::LimitsExceeded)?;
    let mut bytes = vec![0; room];
    let frame = reader.next_frame(&mut bytes)?;
    // Checks that the file ends as it should.
    reader.finish()?;
    bytes.truncate(frame.buffer_size());
    Ok(PngSamples {
        width,
        height,
        color: frame.color_type,
        depth: frame.bit_depth,
        bytes,
        exponent,
    })
}

/// The exponent that makes the values linear; `None` for sRGB.
fn transfer(info: &Info, path: &Path) -> Result<Option<f64>> {
    // 1, 6, 13, 14 and 15 are the transfer functions of screens (ITU-T H.273); 8 is linear.
    if let Some(points) = info.coding_independent_code_points {
        match points.transfer_function {
            8 => return Ok(Some(1.0)),
            1 | 2 | 6 | 13 | 14 | 15 => return Ok(None),
            other => {
                return Err(Error::Unsupported {
                    path: path.to_owned(),
                    what: format!("a PNG of transfer function {other} (16 is PQ, 18 is HLG)"),
                    fix: "save the picture as OpenEXR, which stores linear light".into(),
                });
            }
        }
    }
    let gamma = info
        .gama_chunk
        .map(|g| g.into_value())
        .filter(|_| info.srgb.is_none());
    match gamma {
        None => Ok(None),
        Some(gamma) if (gamma - SRGB_GAMMA).abs() < 0.005 => Ok(None),
        Some(gamma) if gamma >= 0.1 => Ok(Some(1.0 / f64::from(gamma))),
        Some(gamma) => Err(Error::Unsupported {
            path: path.to_owned(),
            what: format!("a PNG whose gamma is {gamma}"),
            fix: "save the picture as sRGB, without a chunk gAMA".into(),
        }),
    }
}

/// From encoded to linear, both in [0, 1]: IEC 61966-2-1, or a power.
fn linear(value: f64, exponent: Option<f64>) -> f64 {
    match exponent {
        Some(exponent) => value.powf(exponent),
        None if value <= 0.040_45 => value / 12.92,
        None => ((value + 0.055) / 1.055).powf(2.4),
    }
}

impl PngSamples {
    fn into_image(self, path: &Path) -> Result<Image> {
        let largest = self.largest();
        let mut table = Vec::with_capacity(largest + 1);
        for value in 0..=largest {
            table.push(linear(value as f64 / largest as f64, self.exponent) as f32);
        }
        if self.is_transparent() {
            return Err(Error::Unsupported {
                path: path.to_owned(),
                what: "a PNG with transparent pixels".into(),
                fix: format!(
                    "fill them: magick {} -background black -alpha remove -alpha off filled.png",
                    path.display()
                ),
            });
        }
        let channels = self.color.samples();
        Image::from_fn(self.width, self.height, |x, y| {
            let first = (y * self.width + x) * channels;
            match channels {
                1 | 2 => Rgb::splat(table[self.sample(first)]),
                _ => Rgb::new(
                    table[self.sample(first)],
                    table[self.sample(first + 1)],
                    table[self.sample(first + 2)],
                ),
            }
        })
    }

    /// The largest value of a sample.
    fn largest(&self) -> usize {
        match self.depth {
            BitDepth::Sixteen => 0xffff,
            _ => 0xff,
        }
    }

    /// Sample `i`; those of sixteen bits have the high byte first.
    fn sample(&self, i: usize) -> usize {
        match self.depth {
            BitDepth::Sixteen => {
                usize::from(self.bytes[2 * i]) << 8 | usize::from(self.bytes[2 * i + 1])
            }
            _ => usize::from(self.bytes[i]),
        }
    }

    /// Whether any pixel's alpha is below its largest value. Alpha is the last sample of two or four.
    fn is_transparent(&self) -> bool {
        let (channels, largest) = (self.color.samples(), self.largest());
        if !matches!(channels, 2 | 4) {
            return false;
        }
        for pixel in 0..self.width * self.height {
            if self.sample(pixel * channels + channels - 1) < largest {
                return true;
            }
        }
        false
    }
}
