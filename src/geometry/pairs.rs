//! Pairs of directions as text.

use std::io::{BufRead, Read};
use std::path::Path;

use glam::{DVec3, Vec3};

use crate::{Error, Result};

const HEADING: &str = "wo_x,wo_y,wo_z,wi_x,wi_y,wi_z";
/// Bytes of a line that are read before it is refused; six numbers need some hundred.
const LONGEST_LINE: u64 = 4096;
/// How far a direction's length may be from 1; files with three decimals pass.
const UNIT_SLACK: f64 = 1e-3;

/// Pairs `(wo, wi)` of unit vectors from lines of comma-separated numbers, with or without the heading
/// `wo_x,wo_y,wo_z,wi_x,wi_y,wi_z`; blank lines are skipped.
///
/// A line of other than six numbers, with a direction whose length is off 1 by more than 10⁻³, or of more than 4096 bytes
/// is an [`Error::Argument`] with its number, and the lines after it can still be read. One line is held at a time.
///
/// # Examples
/// ```
/// use std::path::Path;
///
/// use merlkit::geometry::DirectionPairs;
///
/// let text = "wo_x,wo_y,wo_z,wi_x,wi_y,wi_z\n0,0,1,0.6,0,0.8\n";
/// for pair in DirectionPairs::new(text.as_bytes(), Path::new("standard input")) {
///     let (wo, wi) = pair?;
///     println!("{wo} {wi}");
/// }
/// # Ok::<(), merlkit::Error>(())
/// ```
pub struct DirectionPairs<'a, R> {
    input: R,
    /// For messages.
    name: &'a Path,
    number: usize,
    line: Vec<u8>,
    heading_possible: bool,
}

impl<'a, R: BufRead> DirectionPairs<'a, R> {
    /// Reads from `input`, which messages call `name`.
    pub fn new(input: R, name: &'a Path) -> Self {
        Self {
            input,
            name,
            number: 0,
            line: Vec::new(),
            heading_possible: true,
        }
    }

    /// The next line with anything on it, trimmed.
    fn next_line(&mut self) -> Option<Result<String>> {
        loop {
            self.line.clear();
            match self
                .input
                .by_ref()
                .take(LONGEST_LINE)
                .read_until(b'\n', &mut self.line)
            {
                Ok(0) => return None,
                Ok(_) => self.number += 1,
                Err(e) => return Some(Err(Error::io(self.name, "read", e))),
            }
            if self.line.len() as u64 == LONGEST_LINE {
                return Some(Err(Error::argument(
                    format!(
                        "{}, line {}: {LONGEST_LINE} bytes without a line break",
                        self.name.display(),
                        self.number
                    ),
                    "write one pair of directions a line",
                )));
            }
            let text = String::from_utf8_lossy(&self.line);
            let text = text.trim_start_matches('\u{feff}').trim();
            if !text.is_empty() {
                return Some(Ok(text.to_owned()));
            }
        }
    }

    fn is_heading(&mut self, line: &str) -> bool {
        let bare: String = line.chars().filter(|c| !c.is_whitespace()).collect();
        std::mem::take(&mut self.heading_possible) && bare.eq_ignore_ascii_case(HEADING)
    }
}

impl<R: BufRead> Iterator for DirectionPairs<'_, R> {
    type Item = Result<(Vec3, Vec3)>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            match self.next_line()? {
                Ok(line) if self.is_heading(&line) => {}
                Ok(line) => return Some(parse(&line, self.name, self.number)),
                Err(error) => return Some(Err(error)),
            }
        }
    }
}

fn parse(line: &str, name: &Path, number: usize) -> Result<(Vec3, Vec3)> {
    let place = LinePlace { name, number };
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    if fields.len() != 6 {
        let expected = format!("6 numbers {HEADING}");
        return Err(place.refuse(&expected, line, "separate them by commas"));
    }
    let mut v = [0.0f64; 6];
    for (x, field) in v.iter_mut().zip(&fields) {
        *x = field.parse().map_err(|_| {
            let fix = format!("the columns are {HEADING}");
            place.refuse("a number", field, &fix)
        })?;
    }
    Ok((
        place.normalise("wo", DVec3::new(v[0], v[1], v[2]))?,
        place.normalise("wi", DVec3::new(v[3], v[4], v[5]))?,
    ))
}

/// A line of the input, for messages.
struct LinePlace<'a> {
    name: &'a Path,
    number: usize,
}

impl LinePlace<'_> {
    fn refuse(&self, expected: &str, found: &str, fix: &str) -> Error {
        let (name, number) = (self.name.display(), self.number);
        // A long line would hide the rest of the message.
        let found: String = found.chars().take(80).collect();
        let what = format!("{name}, line {number}: expected {expected}, found \"{found}\"");
        Error::argument(what, fix.to_owned())
    }

    /// The direction `w` to the precision of f32, if its length is 1 within [`UNIT_SLACK`].
    fn normalise(&self, direction: &str, w: DVec3) -> Result<Vec3> {
        let length = w.length();
        if (length - 1.0).abs() <= UNIT_SLACK {
            return Ok((w / length).as_vec3());
        }
        Err(self.refuse(
            &format!("{direction} of length 1 within {UNIT_SLACK}"),
            &format!("length {length}"),
            "normalise the directions",
        ))
    }
}
