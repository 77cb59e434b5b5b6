//! Clouds of values in the thesis's FIT format (7.10): a BRDF at directions `wi` for one `wo`.
//!
//! ```text
//! ward sx = 0.2 sy = 0.2 ks = 0.5 kd = 0.5
//! viewer (1.33763, 344.888)
//! begin
//!   (0.1,0.2,0.974679) 0.159
//! end
//! ```
//!
//! The example in the thesis has the polar angle of the viewer in radians and its azimuth in degrees. Files of other programs, and this
//! one's by default, have both in degrees. A polar angle up to π/2 may be either.

use std::f64::consts::FRAC_PI_2;
use std::fmt::Write as _;
use std::path::Path;

use glam::DVec3;
use merlkit::files::RegularFile;
use merlkit::{Error, Result};

/// What the viewer's angles are in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CloudUnits {
    /// Both in degrees.
    #[default]
    Degrees,
    /// As in the thesis's example: the polar angle in radians, the azimuth in degrees.
    Thesis,
}

/// A BRDF's values at directions for one viewer.
#[derive(Clone, Debug, PartialEq)]
pub struct PointCloud {
    /// The BRDF, as the first line has it.
    pub brdf: String,
    /// The viewer's two numbers, as the file has them.
    pub viewer: [f64; 2],
    /// Unit vectors above the surface.
    pub directions: Vec<DVec3>,
    /// The BRDF's value at each, sr⁻¹.
    pub values: Vec<f64>,
}

/// Bytes of the longest file that is read.
const LONGEST: u64 = 1 << 28;
/// How far the length of a direction may be from 1: files have six digits, or fewer.
const LENGTH_TOLERANCE: f64 = 1e-3;
/// Longest first line.
const LONGEST_NAME: usize = 1000;

impl PointCloud {
    /// Reads a file.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Argument`] with the line of what is not as expected.
    pub fn open(path: &Path) -> Result<Self> {
        let bytes = RegularFile::open(path)?.read_all(LONGEST)?;
        let name = path.display().to_string();
        let text = String::from_utf8(bytes).map_err(|e| {
            let line = count_lines(&e.as_bytes()[..e.utf8_error().valid_up_to()]);
            unexpected(&name, line, "text in UTF-8", "other bytes")
        })?;
        Self::parse(&text, &name)
    }

    /// Reads a text; `name` is for messages.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn parse(text: &str, name: &str) -> Result<Self> {
        let mut lines = CloudLines {
            name,
            lines: text.lines().enumerate(),
            number: 1,
        };
        let brdf = lines.next("a BRDF, such as: measured \"nickel\"")?;
        if brdf.len() > LONGEST_NAME {
            let found = format!("{} bytes", brdf.len());
            return Err(lines.unexpected("a BRDF in at most 1000 bytes", &found));
        }
        let viewer = read_viewer(&mut lines)?;
        let begin = lines.next("begin")?;
        if begin != "begin" {
            return Err(lines.unexpected("begin", begin));
        }
        let mut cloud = Self {
            brdf: brdf.to_owned(),
            viewer,
            directions: Vec::new(),
            values: Vec::new(),
        };
        loop {
            let line = lines.next("(x,y,z) f, or end")?;
            if line == "end" {
                break;
            }
            let (direction, value) = read_point(line, &lines)?;
            cloud.directions.push(direction);
            cloud.values.push(value);
        }
        match lines.next("") {
            Ok(more) => Err(lines.unexpected("nothing after end", more)),
            Err(_) => Ok(cloud),
        }
    }

    /// Polar angle and azimuth of the viewer in degrees; without units they must follow from the numbers.
    ///
    /// # Errors
    /// [`Error::Argument`] if the polar angle may be in either unit, or is none.
    pub fn viewer_degrees(&self, units: Option<CloudUnits>) -> Result<[f64; 2]> {
        let [theta, phi] = self.viewer;
        let is_ambiguous = theta > 0.0 && theta <= FRAC_PI_2;
        let degrees = match units {
            Some(CloudUnits::Thesis) => theta.to_degrees(),
            None if is_ambiguous => {
                return Err(Error::argument(
                    format!("the viewer's polar angle {theta} may be in radians or in degrees"),
                    "pass --fit-units thesis (radians, as in the thesis's example) or --fit-units degrees",
                ));
            }
            Some(CloudUnits::Degrees) | None => theta,
        };
        if !(0.0..=90.0 + 1e-9).contains(&degrees) {
            return Err(Error::argument(
                format!("a viewer at the polar angle {degrees}°"),
                "give an angle from 0 to 90°, or the other --fit-units",
            ));
        }
        Ok([degrees, phi])
    }

    /// The smallest and the largest value; `None` without points.
    pub fn value_range(&self) -> Option<[f64; 2]> {
        let first = *self.values.first()?;
        let mut range = [first; 2];
        for &value in &self.values {
            range = [range[0].min(value), range[1].max(value)];
        }
        Some(range)
    }

    /// The smallest and the largest polar angle of the directions in degrees; `None` without points.
    pub fn theta_range(&self) -> Option<[f64; 2]> {
        let mut range: Option<[f64; 2]> = None;
        for direction in &self.directions {
            let across = direction.x.hypot(direction.y);
            let theta = across.atan2(direction.z).to_degrees();
            let [low, high] = range.unwrap_or([theta; 2]);
            range = Some([low.min(theta), high.max(theta)]);
        }
        range
    }
}

/// The line of the viewer for a direction by its polar angle and azimuth in degrees.
pub fn viewer_line(theta: f64, phi: f64, units: CloudUnits) -> String {
    let mut line = String::new();
    let shown = match units {
        CloudUnits::Degrees => theta,
        CloudUnits::Thesis => theta.to_radians(),
    };
    // Writing to a string can't fail.
    let _ = write!(line, "viewer ({shown}, {phi})");
    line
}

/// The lines that hold something.
struct CloudLines<'a> {
    name: &'a str,
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    /// Of the line that was read last, from 1.
    number: usize,
}

impl<'a> CloudLines<'a> {
    fn next(&mut self, expected: &str) -> Result<&'a str> {
        for (index, line) in self.lines.by_ref() {
            self.number = index + 1;
            let line = line.trim();
            if !line.is_empty() {
                return Ok(line);
            }
        }
        Err(unexpected(
            self.name,
            self.number,
            expected,
            "the end of the file",
        ))
    }

    fn unexpected(&self, expected: &str, found: &str) -> Error {
        unexpected(self.name, self.number, expected, found)
    }
}

fn unexpected(name: &str, line: usize, expected: &str, found: &str) -> Error {
    let mut shown: String = found.chars().take(60).collect();
    if shown.len() < found.len() {
        shown.push('…');
    }
    Error::argument(
        format!("{name}, line {line}: expected {expected}, found {shown}"),
        "correct the line, or write the file again with `merlkit sample --fit`",
    )
}

fn count_lines(bytes: &[u8]) -> usize {
    1 + bytes.iter().filter(|byte| **byte == b'\n').count()
}

/// `viewer (θ, φ)`.
fn read_viewer(lines: &mut CloudLines<'_>) -> Result<[f64; 2]> {
    let expected = "viewer (theta, phi)";
    let line = lines.next(expected)?;
    let numbers = line.strip_prefix("viewer").and_then(read_bracket);
    match numbers {
        Some((numbers, "")) => match numbers[..] {
            [theta, phi] => Ok([theta, phi]),
            _ => Err(lines.unexpected(expected, line)),
        },
        _ => Err(lines.unexpected(expected, line)),
    }
}

/// `(x,y,z) f`.
fn read_point(line: &str, lines: &CloudLines<'_>) -> Result<(DVec3, f64)> {
    let expected = "(x,y,z) f with finite numbers";
    let Some((numbers, rest)) = read_bracket(line) else {
        return Err(lines.unexpected(expected, line));
    };
    let value = rest.parse().ok().filter(|f: &f64| f.is_finite());
    let (&[x, y, z], Some(value)) = (&numbers[..], value) else {
        return Err(lines.unexpected(expected, line));
    };
    let direction = DVec3::new(x, y, z);
    let length = direction.length();
    // NaN fails the comparison, too.
    let is_unit = (length - 1.0).abs() <= LENGTH_TOLERANCE;
    if !is_unit {
        let found = format!("the length {length} in {line}");
        return Err(lines.unexpected("a direction of length 1", &found));
    }
    if z < 0.0 {
        return Err(lines.unexpected("a direction above the surface, z ≥ 0", line));
    }
    if value < 0.0 {
        return Err(lines.unexpected("a value ≥ 0", line));
    }
    Ok((direction / length, value))
}

/// Finite numbers between brackets, and what follows them.
fn read_bracket(text: &str) -> Option<(Vec<f64>, &str)> {
    let (inside, rest) = text.trim().strip_prefix('(')?.split_once(')')?;
    let mut numbers = Vec::new();
    for word in inside.split(',') {
        let number: f64 = word.trim().parse().ok()?;
        if !number.is_finite() || numbers.len() == 3 {
            return None;
        }
        numbers.push(number);
    }
    Some((numbers, rest.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "ashikhmin nu = 25 nv = 25 ks = 0.39 kd = 0.6\nviewer (1.33763, 344.888)\nbegin\n  (0.6,0,0.8) 0.5\n (0,0,1) 2\nend\n";

    #[test]
    fn the_example_of_the_thesis_is_read() {
        let cloud = PointCloud::parse(GOOD, "a.fit").unwrap();
        assert_eq!(cloud.brdf, "ashikhmin nu = 25 nv = 25 ks = 0.39 kd = 0.6");
        assert_eq!(cloud.viewer, [1.33763, 344.888]);
        assert_eq!(cloud.value_range(), Some([0.5, 2.0]));
        let [low, high] = cloud.theta_range().unwrap();
        assert!(low.abs() < 1e-9 && (high - 36.869_897_6).abs() < 1e-6);
        // 1.33763 may be either, until somebody says which.
        assert!(cloud.viewer_degrees(None).is_err());
        let [theta, phi] = cloud.viewer_degrees(Some(CloudUnits::Thesis)).unwrap();
        assert!((theta - 76.640_55).abs() < 1e-4 && phi == 344.888);
        let degrees = cloud.viewer_degrees(Some(CloudUnits::Degrees)).unwrap();
        assert_eq!(degrees, cloud.viewer);
        let line = viewer_line(76.0, 344.0, CloudUnits::Thesis);
        assert!(line.starts_with("viewer (1.3264502") && line.ends_with(", 344)"));
    }

    #[test]
    fn large_angles_are_degrees() {
        let text = GOOD.replace("1.33763", "60");
        let cloud = PointCloud::parse(&text, "a.fit").unwrap();
        assert_eq!(cloud.viewer_degrees(None).unwrap(), [60.0, 344.888]);
        assert!(cloud.viewer_degrees(Some(CloudUnits::Thesis)).is_err());
    }

    #[test]
    fn damaged_files_are_refused_with_the_line() {
        for (from, to, expected) in [
            (
                "(0.6,0,0.8) 0.5",
                "(0.6,0,0.7) 0.5",
                "line 4: expected a direction of length 1",
            ),
            ("(0.6,0,0.8) 0.5", "(0.6,0,-0.8) 0.5", "above the surface"),
            ("(0.6,0,0.8) 0.5", "(0.6,0,0.8) -1", "a value ≥ 0"),
            ("(0.6,0,0.8) 0.5", "(0.6,0,0.8) nan", "finite numbers"),
            ("(0.6,0,0.8) 0.5", "(0.6,0,inf) 1", "finite numbers"),
            ("(0.6,0,0.8) 0.5", "(0.6,0,0.8", "finite numbers"),
            ("(0.6,0,0.8) 0.5", "(0.6,0,0.8,0,0,0,0) 1", "finite numbers"),
            ("(1.33763, 344.888)", "(1.33763)", "line 2: expected viewer"),
            ("begin", "beg", "line 3: expected begin"),
            ("end\n", "", "found the end of the file"),
            ("end\n", "end\nend\n", "line 7: expected nothing after end"),
        ] {
            let error = PointCloud::parse(&GOOD.replacen(from, to, 1), "a.fit").unwrap_err();
            let error = error.to_string();
            assert!(error.contains(expected), "{to}: {error}");
        }
        assert!(PointCloud::parse("", "a.fit").is_err());
    }

    /// Changes bytes of a good file: whatever becomes of it, nothing panics and no invalid point is let through.
    #[test]
    fn mutations_never_panic() {
        let mut state = 1u64;
        for _ in 0..2000 {
            let mut bytes = GOOD.as_bytes().to_vec();
            for _ in 0..3 {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                let place = (state >> 33) as usize % bytes.len();
                bytes[place] = b"0123456789.-e(),\n nafi"[(state >> 20) as usize % 22];
            }
            let text = String::from_utf8_lossy(&bytes);
            let Ok(cloud) = PointCloud::parse(&text, "a.fit") else {
                continue;
            };
            for (direction, value) in cloud.directions.iter().zip(&cloud.values) {
                assert!(direction.is_normalized() && direction.z >= 0.0);
                assert!(value.is_finite() && *value >= 0.0);
            }
        }
    }
}
