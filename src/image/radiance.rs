//! Radiance pictures (.hdr, .pic): RGBE, flat or run-length encoded in the old or the new way.
//!
//! Ward, "Real Pixels", Graphics Gems II, 1991, and the file-format chapter of the Radiance documentation. A channel is
//! m · 2^(e − 136) as other renderers read it, without the half step that Radiance itself adds.

use std::path::Path;

use super::{Image, check_size};
use crate::color::Rgb;
use crate::{Error, Result};

/// Three mantissas and their exponent.
type Rgbe = [u8; 4];

/// Most pixels for each byte of a file: a black row of 8192 in the old encoding is 12 bytes.
const PIXELS_PER_BYTE: u64 = 1024;

/// Widths that rows of the new encoding may have.
const NEW_WIDTHS: std::ops::Range<usize> = 8..0x8000;

/// The picture, divided by the exposure that its header states, and that exposure.
///
/// # Errors
/// [`Error::Invalid`] with the byte where the file contradicts its format; [`Error::Unsupported`] for XYZE, for pictures that
/// are stored by columns, and for too large ones.
pub(super) fn decode_radiance(bytes: &[u8], path: &Path) -> Result<(Image, f64)> {
    let mut reader = RadianceReader { bytes, at: 0, path };
    let exposure = reader.header()?;
    let size = reader.resolution()?;
    let (width, height) = (size.width, size.height);
    let mut rows: Vec<Vec<Rgb>> = Vec::new();
    let mut row = vec![[0; 4]; width];
    for _ in 0..height {
        reader.fill_row(&mut row)?;
        let mut colours: Vec<Rgb> = row.iter().map(|&c| radiance(c, exposure)).collect();
        if size.right_to_left {
            colours.reverse();
        }
        rows.push(colours);
    }
    if size.bottom_up {
        rows.reverse();
    }
    Ok((Image::new(width, height, rows.concat())?, exposure))
}

/// m · 2^(e − 136) / exposure.
fn radiance([r, g, b, e]: Rgbe, exposure: f64) -> Rgb {
    if e == 0 {
        return Rgb::ZERO;
    }
    let scale = 2f64.powi(i32::from(e) - 136) / exposure;
    let [r, g, b] = [r, g, b].map(|mantissa| (f64::from(mantissa) * scale) as f32);
    Rgb::new(r, g, b)
}

/// What the line of the resolution says.
struct Resolution {
    width: usize,
    height: usize,
    bottom_up: bool,
    right_to_left: bool,
}

/// A file, and how far it was read.
struct RadianceReader<'a> {
    bytes: &'a [u8],
    at: usize,
    path: &'a Path,
}

impl RadianceReader<'_> {
    /// The product of all exposures that the header states; it ends with an empty line.
    fn header(&mut self) -> Result<f64> {
        let mut exposure = 1.0;
        loop {
            let start = self.at;
            let line = self.line()?;
            if line.is_empty() {
                break;
            }
            if let Some(format) = line.strip_prefix("FORMAT=") {
                self.check_format(format.trim(), start)?;
            } else if let Some(factor) = line.strip_prefix("EXPOSURE=") {
                let factor: f64 = factor.trim().parse().unwrap_or(f64::NAN);
                exposure *= factor;
                if !(exposure > 0.0 && exposure.is_finite()) {
                    let fix = "correct that line, or leave it out";
                    return Err(self.wrong(start, "an exposure above 0", &line, fix));
                }
            }
        }
        Ok(exposure)
    }

    fn check_format(&self, format: &str, start: usize) -> Result<()> {
        match format {
            "32-bit_rle_rgbe" => Ok(()),
            "32-bit_rle_xyze" => Err(Error::Unsupported {
                path: self.path.to_owned(),
                what: "a Radiance picture in XYZ colours".into(),
                fix: format!(
                    "convert it to RGB: ra_xyze -r {} rgb.hdr",
                    self.path.display()
                ),
            }),
            other => {
                let fix = "save it as 32-bit_rle_rgbe";
                Err(self.wrong(start, "FORMAT=32-bit_rle_rgbe", other, fix))
            }
        }
    }

    /// The line `-Y height +X width`; the signs say from where rows and columns run.
    fn resolution(&mut self) -> Result<Resolution> {
        let start = self.at;
        let line = self.line()?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let (rows, height, columns, width) = match words[..] {
            ["-X" | "+X", _, "-Y" | "+Y", _] => {
                return Err(Error::Unsupported {
                    path: self.path.to_owned(),
                    what: format!("a Radiance picture that is stored by columns ({line})"),
                    fix: "save it by rows, with pfilt or an image editor".into(),
                });
            }
            [rows @ ("-Y" | "+Y"), height, columns @ ("-X" | "+X"), width] => {
                (rows, height.parse().ok(), columns, width.parse().ok())
            }
            _ => ("", None, "", None),
        };
        let (Some(width), Some(height)) = (width, height) else {
            let fix = "fetch the file again: it is damaged";
            return Err(self.wrong(start, "a resolution, as -Y 512 +X 1024", &line, fix));
        };
        check_size(width, height, self.path)?;
        self.check_room(width, height)?;
        Ok(Resolution {
            width,
            height,
            bottom_up: rows == "+Y",
            right_to_left: columns == "-X",
        })
    }

    /// Refuses a size that what follows can't hold, before memory is taken for it.
    fn check_room(&self, width: usize, height: usize) -> Result<()> {
        let left = (self.bytes.len() - self.at) as u64;
        if (width * height) as u64 / PIXELS_PER_BYTE <= left {
            return Ok(());
        }
        Err(Error::invalid(
            self.path,
            self.at as u64,
            format!("a picture of {width} × {height}"),
            format!("{left} bytes, which can't hold it"),
            "fetch the file again: it is damaged or cut off",
        ))
    }

    /// The text up to the end of the line, which is passed.
    fn line(&mut self) -> Result<String> {
        let rest = &self.bytes[self.at..];
        let Some(end) = rest.iter().position(|&b| b == b'\n') else {
            return Err(self.cut_off("the end of a line of the header"));
        };
        self.at += end + 1;
        let text = String::from_utf8_lossy(&rest[..end]);
        Ok(text.trim_end().to_owned())
    }

    /// The next `N` bytes, which are passed.
    fn take<const N: usize>(&mut self) -> Result<[u8; N]> {
        let Some(&bytes) = self.bytes[self.at..].first_chunk::<N>() else {
            return Err(self.cut_off("more pixels"));
        };
        self.at += N;
        Ok(bytes)
    }

    /// One row, in whichever way it is encoded.
    fn fill_row(&mut self, row: &mut [Rgbe]) -> Result<()> {
        let start = self.at;
        let head: [u8; 4] = self.take()?;
        let is_new = NEW_WIDTHS.contains(&row.len()) && head[..2] == [2, 2] && head[2] < 128;
        if !is_new {
            self.at = start;
            return self.fill_old(row);
        }
        let width = usize::from(head[2]) << 8 | usize::from(head[3]);
        if width != row.len() {
            let expected = format!("a row of {} pixels", row.len());
            let fix = "fetch the file again: it is damaged";
            return Err(self.wrong(start, &expected, &format!("one of {width}"), fix));
        }
        for channel in 0..4 {
            self.fill_channel(row, channel)?;
        }
        Ok(())
    }

    /// New encoding: a count above 128 repeats the next byte count − 128 times, another is followed by so many bytes.
    fn fill_channel(&mut self, row: &mut [Rgbe], channel: usize) -> Result<()> {
        let mut x = 0;
        while x < row.len() {
            let start = self.at;
            let [count] = self.take()?;
            let is_run = count > 128;
            let length = usize::from(if is_run { count - 128 } else { count });
            if length == 0 || length > row.len() - x {
                let expected = format!("a run of 1 to {} bytes", row.len() - x);
                let fix = "fetch the file again: it is damaged";
                return Err(self.wrong(start, &expected, &format!("one of {length}"), fix));
            }
            let mut value = 0;
            for (i, pixel) in row[x..x + length].iter_mut().enumerate() {
                if i == 0 || !is_run {
                    [value] = self.take()?;
                }
                pixel[channel] = value;
            }
            x += length;
        }
        Ok(())
    }

    /// Flat or old encoding: a pixel (1, 1, 1, n) repeats the one before n times, the next of them in a row 256 n times, and
    /// so on.
    fn fill_old(&mut self, row: &mut [Rgbe]) -> Result<()> {
        let (mut x, mut shift) = (0, 0);
        while x < row.len() {
            let start = self.at;
            let pixel: Rgbe = self.take()?;
            if pixel[..3] != [1, 1, 1] {
                row[x] = pixel;
                (x, shift) = (x + 1, 0);
                continue;
            }
            let length = usize::from(pixel[3]).checked_shl(shift).unwrap_or(0);
            if x == 0 || shift > 24 || length > row.len() - x {
                let expected = format!("a pixel, or a run of at most {}", row.len() - x);
                let found = format!("a run of {length} in column {x}");
                let fix = "fetch the file again: it is damaged";
                return Err(self.wrong(start, &expected, &found, fix));
            }
            let previous = row[x - 1];
            row[x..x + length].fill(previous);
            (x, shift) = (x + length, shift + 8);
        }
        Ok(())
    }

    fn wrong(&self, offset: usize, expected: &str, found: &str, fix: &str) -> Error {
        let mut found: String = found.chars().take(80).collect();
        found = found.escape_debug().to_string();
        Error::invalid(self.path, offset as u64, expected, found, fix)
    }

    fn cut_off(&self, expected: &str) -> Error {
        let end = self.bytes.len();
        let fix = "fetch the file again: it is cut off";
        self.wrong(end, expected, "the end of the file", fix)
    }
}
