//! Portable float maps: three lines of text, then f32 values, the bottom row first (Debevec).

use std::path::Path;

use super::{Image, check_size};
use crate::color::Rgb;
use crate::{Error, Result};

/// The longest word of a header: more digits than any size or scale needs.
const LONGEST_WORD: usize = 64;

/// The picture; values are multiplied by the magnitude of the header's scale.
///
/// # Errors
/// [`Error::Invalid`] with the byte where the file contradicts its format; [`Error::Unsupported`] for too large ones.
pub(super) fn decode_pfm(bytes: &[u8], path: &Path) -> Result<Image> {
    let mut at = 0;
    let channels = if next_word(bytes, &mut at) == "PF" {
        3
    } else {
        1
    };
    let width = number(bytes, &mut at, path, "a width", |n: &usize| *n > 0)?;
    let height = number(bytes, &mut at, path, "a height", |n: &usize| *n > 0)?;
    let scale = number(bytes, &mut at, path, "a scale other than 0", is_scale)?;
    check_size(width, height, path)?;
    // One white space ends the header.
    let start = bytes.len().min(at + 1);
    let samples = &bytes[start..];
    let expected = width * height * channels * 4;
    if samples.len() != expected {
        let fix = match samples.len() < expected {
            true => "fetch the file again: it is cut off",
            false => {
                "save it again with a header of lines that end in a line feed alone, and nothing behind the pixels"
            }
        };
        return Err(Error::invalid(
            path,
            start as u64,
            format!("{expected} bytes of {width} × {height} pixels"),
            format!("{} bytes", samples.len()),
            fix,
        ));
    }
    Image::from_fn(width, height, |x, y| {
        let first = ((height - 1 - y) * width + x) * channels;
        let value = sample(samples, first, scale);
        match channels {
            1 => Rgb::splat(value),
            _ => Rgb::new(
                value,
                sample(samples, first + 1, scale),
                sample(samples, first + 2, scale),
            ),
        }
    })
}

fn is_scale(scale: &f32) -> bool {
    scale.is_finite() && *scale != 0.0
}

/// Sample `i` times the magnitude of the scale; a negative scale marks little-endian samples.
fn sample(samples: &[u8], i: usize, scale: f32) -> f32 {
    let four = [0, 1, 2, 3].map(|k| samples[4 * i + k]);
    let value = if scale < 0.0 {
        f32::from_le_bytes(four)
    } else {
        f32::from_be_bytes(four)
    };
    value * scale.abs()
}

/// The next word; it and the white space before it are passed.
fn next_word<'a>(bytes: &'a [u8], at: &mut usize) -> &'a str {
    let rest = &bytes[*at..];
    let mut blank = 0;
    while blank < rest.len() && rest[blank].is_ascii_whitespace() {
        blank += 1;
    }
    let word = &rest[blank..];
    let most = word.len().min(LONGEST_WORD);
    let mut length = 0;
    while length < most && !word[length].is_ascii_whitespace() {
        length += 1;
    }
    *at += blank + length;
    std::str::from_utf8(&word[..length]).unwrap_or("")
}

/// The next word as a number that `is_valid`.
fn number<T: std::str::FromStr>(
    bytes: &[u8],
    at: &mut usize,
    path: &Path,
    expected: &str,
    is_valid: impl Fn(&T) -> bool,
) -> Result<T> {
    let start = *at as u64;
    let word = next_word(bytes, at);
    word.parse().ok().filter(is_valid).ok_or_else(|| {
        let found = format!("\"{}\"", word.escape_debug());
        let fix = "fetch the file again: it is damaged";
        Error::invalid(path, start, expected, found, fix)
    })
}
