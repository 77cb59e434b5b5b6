//! In which format a plot is written, and how large.

use std::ffi::OsStr;

use merlkit::Error;
use merlkit_evaluate::plot::{ChartSize, Viewpoint};

use super::kind::Kind;
use crate::output::Destination;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Svg,
    Csv,
    Png,
    Pdf,
    /// The pixels of a slice.
    PixelsPng,
    PixelsExr,
}

impl Format {
    /// By the extension.
    pub fn from_extension(destination: &Destination, kind: Kind) -> Result<Self, Error> {
        let Destination::File(path) = destination else {
            return Ok(Self::Svg);
        };
        match path.extension().and_then(OsStr::to_str) {
            Some("svg") => Ok(Self::Svg),
            Some("csv") => Ok(Self::Csv),
            Some("png") if kind.is_slice() => Ok(Self::PixelsPng),
            Some("png") => Ok(Self::Png),
            Some("pdf") => Ok(Self::Pdf),
            Some("exr") if kind == Kind::SliceRgb => Ok(Self::PixelsExr),
            Some("exr") => Err(Error::argument(
                format!("{}: OpenEXR is for slice-rgb alone", path.display()),
                "name a file that ends in .svg, .pdf, .png or .csv, or choose --kind slice-rgb",
            )),
            _ => Err(Error::argument(
                format!("{}: plots are SVG, PDF, PNG or CSV", path.display()),
                "name a file that ends in .svg",
            )),
        }
    }
}

/// Pixels of a PNG for each of the drawing's, unless so many would leave the drawing no room.
const DENSITY: f64 = 2.0;
/// The least sides that a drawing is laid out for.
const LEAST: [f64; 2] = [320.0, 240.0];

/// The size of the drawing, and how many pixels each of its own has, so that a PNG has the sides that are asked for.
pub fn png_layout(width: Option<u16>, height: Option<u16>) -> (ChartSize, f64) {
    let mut density = DENSITY;
    for (side, least) in [width, height].into_iter().zip(LEAST) {
        density = density.min(side.map_or(DENSITY, |side| f64::from(side) / least));
    }
    let usual = ChartSize::default();
    let size = ChartSize {
        width: width.map_or(usual.width, |side| f64::from(side) / density),
        height: height.map(|side| f64::from(side) / density),
    };
    (size, density)
}

/// Refuses a size for what has none.
///
/// # Errors
/// [`Error::Argument`] for one.
pub fn check_size(format: Format, width: Option<u16>, height: Option<u16>) -> Result<(), Error> {
    let file = match format {
        Format::Csv => "a CSV file",
        Format::PixelsExr => "an OpenEXR file, whose pixels are bins",
        _ => return Ok(()),
    };
    let given = [("--width", width), ("--height", height)];
    match given.iter().find(|(_, side)| side.is_some()) {
        Some((option, _)) => Err(Error::argument(
            format!("{option} has no effect on {file}"),
            "omit it",
        )),
        None => Ok(()),
    }
}

/// From where solids are seen.
///
/// # Errors
/// [`Error::Argument`] for angles outside their domains.
pub fn read_viewpoint(elevation: Option<f64>, azimuth: Option<f64>) -> Result<Viewpoint, Error> {
    let usual = Viewpoint::default();
    let elevation = elevation.unwrap_or(usual.elevation);
    if !(0.0..=90.0).contains(&elevation) {
        let what = format!("a lobe seen from an elevation of {elevation}°");
        return Err(Error::argument(what, "choose --elevation from 0 to 90"));
    }
    let azimuth = azimuth.unwrap_or(usual.azimuth);
    if !(-360.0..=360.0).contains(&azimuth) {
        let what = format!("a lobe seen from an azimuth of {azimuth}°");
        return Err(Error::argument(what, "choose --azimuth from -360 to 360"));
    }
    Ok(Viewpoint { elevation, azimuth })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_png_has_the_sides_that_are_asked_for() {
        for (width, height) in [(1280, 700), (320, 240), (500, 10_000), (3000, 240)] {
            let (size, density) = png_layout(Some(width), Some(height));
            let sides = [size.width, size.height.unwrap()].map(|s| (s * density).round());
            assert_eq!(sides, [f64::from(width), f64::from(height)]);
            assert!(size.width >= 320.0 && size.height.unwrap() >= 240.0);
        }
        assert_eq!(png_layout(None, None), (ChartSize::default(), 2.0));
    }
}
