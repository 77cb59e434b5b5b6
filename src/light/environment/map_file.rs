//! Environments from files.

use std::path::Path;

use super::notes::MapNotes;
use super::repair::{RadianceClamp, repair};
use super::{Environment, SkySampling};
use crate::image::{Image, PictureFormat, read_picture};
use crate::{Error, Result};

/// Loads the latitude-longitude map at `path`.
pub(super) fn load_map_file(
    path: &Path,
    clamp: Option<RadianceClamp>,
    sampling: SkySampling,
) -> Result<Environment> {
    let file = read_picture(path)?;
    check_aspect(&file.image, path)?;
    let (width, height) = (file.image.width(), file.image.height());
    let mut pixels = file.image.into_pixels();
    let repairs = repair(&mut pixels, width, clamp, path)?;
    let map = Environment::new(width, height, pixels, sampling)?;
    Ok(map.with_notes(MapNotes {
        path: path.to_owned(),
        size: [width, height],
        exposure: file.exposure,
        holds_no_light_above_one: file.format == PictureFormat::Png,
        raised_pixels: repairs.raised,
        lowest: repairs.lowest,
        clamped_pixels: repairs.clamped,
        clamped_to: repairs.clamped_to,
    }))
}

/// A map of all directions by latitude and longitude is twice as wide as high; any other picture would be stretched over the
/// sphere without a word.
fn check_aspect(image: &Image, path: &Path) -> Result<()> {
    let (width, height) = (image.width(), image.height());
    if width == 2 * height {
        return Ok(());
    }
    // Within a twentieth it is a map that lost or gained some pixels when it was resized.
    let ratio = width as f64 / height as f64;
    let fix = if (ratio - 2.0).abs() <= 0.1 {
        let (w, h) = (2 * height, height);
        format!("if it is such a map, resize it to {w} × {h}")
    } else if ratio > 2.0 {
        format!(
            "if it is a panorama without its top and bottom, extend it to {width} × {}",
            width.div_ceil(2)
        )
    } else if width == height {
        "if it is a mirror ball, an angular or an octahedral map, convert it to latitude and longitude".into()
    } else {
        "if it is a cross or a strip of a cube's faces, convert it to latitude and longitude".into()
    };
    Err(Error::Unsupported {
        path: path.to_owned(),
        what: format!("an environment of {width} × {height} pixels"),
        fix: format!(
            "it must be a map by latitude and longitude, which is twice as wide as high: {fix}"
        ),
    })
}
