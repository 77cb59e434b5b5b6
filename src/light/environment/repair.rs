//! Pixels of a file that are no radiance: small negative ones are raised, too bright ones lowered on request, others refused.

use std::path::Path;

use crate::color::{Rgb, luminance};
use crate::{Error, Result};

/// What becomes of pixels that are too bright.
///
/// The example of [`LightSpec`](crate::light::LightSpec) describes a light and loads it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RadianceClamp {
    /// Infinite channels are lowered to 65,504, the largest half float, or to the picture's largest finite channel if that is
    /// more. Half floats overflow to infinity, mostly in the sun.
    Infinite,
    /// Channels above this radiance are lowered to it; finite and > 0.
    Above(f32),
}

/// The largest finite half float.
const LARGEST_HALF: f32 = 65_504.0;

/// A negative channel up to this fraction of the map's mean luminance is a residue: raising all pixels by so much would
/// move the map's light by no more than that.
const RESIDUE_OF_MEAN: f64 = 0.01;

/// A negative channel up to this fraction of the brightest channel nearby is a residue too: the first lobe of Lanczos's
/// filter of order 3 undershoots an isolated bright pixel by at most 0.22 of what it leaves of it, and lossy compression errs
/// by less.
const RESIDUE_OF_NEIGHBOUR: f32 = 0.25;

/// How far a neighbour may be, columns and rows: the width of Lanczos's filter, and a block of B44.
const NEIGHBOURS: usize = 4;

/// What was changed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Repairs {
    pub(super) raised: usize,
    pub(super) lowest: f32,
    pub(super) clamped: usize,
    pub(super) clamped_to: Option<f32>,
}

/// Makes radiance, finite and ≥ 0, of the pixels of a map that is `width` wide.
///
/// # Errors
/// [`Error::Unsupported`] with the first place, for NaN, for infinite channels without `clamp`, and for negative channels that
/// are no residues.
pub(super) fn repair(
    pixels: &mut [Rgb],
    width: usize,
    clamp: Option<RadianceClamp>,
    path: &Path,
) -> Result<Repairs> {
    refuse_nan(pixels, width, path)?;
    let mut repairs = Repairs::default();
    match clamp {
        None => refuse_infinite(pixels, width, path)?,
        Some(clamp) => lower(pixels, clamp, &mut repairs),
    }
    raise(pixels, width, path, &mut repairs)?;
    Ok(repairs)
}

/// "1 pixel", "2 pixels".
pub(super) fn count_pixels(count: usize) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} pixel{plural}")
}

/// The first pixel that `is_bad` and how many are.
fn find(pixels: &[Rgb], is_bad: impl Fn(&Rgb) -> bool) -> Option<(usize, usize)> {
    let first = pixels.iter().position(&is_bad)?;
    let count = pixels[first..].iter().filter(|c| is_bad(c)).count();
    Some((first, count))
}

fn refusal(
    what: &str,
    (first, count): (usize, usize),
    width: usize,
    path: &Path,
    fix: String,
) -> Error {
    let (column, row) = (first % width, first / width);
    let all = count_pixels(count);
    let first = if count == 1 { "" } else { "the first " };
    Error::Unsupported {
        path: path.to_owned(),
        what: format!("{what} in {all} ({first}in column {column}, row {row})"),
        fix,
    }
}

fn refuse_nan(pixels: &[Rgb], width: usize, path: &Path) -> Result<()> {
    let Some(found) = find(pixels, |c| c.is_nan()) else {
        return Ok(());
    };
    let fix = "the light in these pixels is unknown: paint over them".into();
    Err(refusal("NaN", found, width, path, fix))
}

fn refuse_infinite(pixels: &[Rgb], width: usize, path: &Path) -> Result<()> {
    let Some(found) = find(pixels, |c| c.max_element() == f32::INFINITY) else {
        return Ok(());
    };
    let name = path.display();
    let fix = format!(
        "half floats overflow, most often in the sun: name the light {name}:clamp to lower it to {LARGEST_HALF}, or \
         {name}:clamp=MAX to lower all that is brighter to MAX"
    );
    Err(refusal("infinite radiance", found, width, path, fix))
}

fn lower(pixels: &mut [Rgb], clamp: RadianceClamp, repairs: &mut Repairs) {
    let limit = match clamp {
        RadianceClamp::Above(limit) => limit,
        RadianceClamp::Infinite => {
            let channels = pixels.iter().flat_map(|c| c.to_array());
            channels
                .filter(|c| c.is_finite())
                .fold(LARGEST_HALF, f32::max)
        }
    };
    for pixel in pixels {
        if pixel.max_element() > limit {
            *pixel = pixel.min(Rgb::splat(limit));
            repairs.clamped += 1;
            repairs.clamped_to = Some(limit);
        }
    }
}

/// Raises residues to 0, see [`RESIDUE_OF_MEAN`] and [`RESIDUE_OF_NEIGHBOUR`]; nothing is raised if a pixel is none.
fn raise(pixels: &mut [Rgb], width: usize, path: &Path, repairs: &mut Repairs) -> Result<()> {
    if pixels.iter().all(|c| c.min_element() >= 0.0) {
        return Ok(());
    }
    // Step 1: the mean luminance, to which residues are compared. Negative channels count as 0.
    let mut sum = 0.0;
    for c in pixels.iter() {
        sum += f64::from(luminance(c.max(Rgb::ZERO)));
    }
    let most = (RESIDUE_OF_MEAN * (sum / pixels.len() as f64)) as f32;
    // Step 2: pixels that are too far below 0, against the mean and against their neighbours, are no residues.
    let mut bad = Vec::new();
    let mut lowest = 0f32;
    for i in 0..pixels.len() {
        let value = pixels[i].min_element();
        let is_residue =
            -value <= most || -value <= RESIDUE_OF_NEIGHBOUR * brightest_nearby(pixels, width, i);
        if !is_residue {
            bad.push(i);
            lowest = lowest.min(value);
        }
    }
    if let Some(&first) = bad.first() {
        let what = format!("negative radiance, down to {lowest},");
        let fix = format!(
            "that is more than compression or resampling leaves, which would be raised to 0 (up to {most} here, 1 % of the mean, \
             or a quarter of the brightest within {NEIGHBOURS} pixels): make the map again, or paint over those pixels"
        );
        return Err(refusal(&what, (first, bad.len()), width, path, fix));
    }
    // Step 3: raise the residues.
    for pixel in pixels {
        if pixel.min_element() < 0.0 {
            repairs.raised += 1;
            repairs.lowest = repairs.lowest.min(pixel.min_element());
            *pixel = pixel.max(Rgb::ZERO);
        }
    }
    Ok(())
}

/// The brightest channel within [`NEIGHBOURS`] columns and rows; the map closes on itself left and right.
fn brightest_nearby(pixels: &[Rgb], width: usize, i: usize) -> f32 {
    let (column, row) = (i % width, i / width);
    let rows = row.saturating_sub(NEIGHBOURS)..(row + NEIGHBOURS + 1).min(pixels.len() / width);
    let mut brightest = 0f32;
    for y in rows {
        for dx in 0..=2 * NEIGHBOURS {
            // Shifted by a multiple of the width, so that it stays positive.
            let x = (column + dx + NEIGHBOURS * (width - 1)) % width;
            brightest = brightest.max(pixels[y * width + x].max_element());
        }
    }
    brightest
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 64;

    /// A map of 0.2 with one pixel changed, the 4th of the 3rd row.
    fn with_pixel(value: Rgb) -> Vec<Rgb> {
        let mut pixels = vec![Rgb::splat(0.2); WIDTH * 32];
        pixels[2 * WIDTH + 3] = value;
        pixels
    }

    fn repaired(
        pixels: &mut [Rgb],
        clamp: Option<RadianceClamp>,
    ) -> std::result::Result<Repairs, String> {
        repair(pixels, WIDTH, clamp, Path::new("sky.exr")).map_err(|e| e.to_string())
    }

    #[test]
    fn residues_are_raised_and_counted() {
        let mut pixels = with_pixel(Rgb::new(-1e-5, 0.2, -1.9e-3));
        pixels[0] = Rgb::new(0.0, -1e-6, 0.0);
        let repairs = repaired(&mut pixels, None).unwrap();
        assert_eq!((repairs.raised, repairs.lowest), (2, -1.9e-3));
        assert_eq!(repairs.clamped_to, None);
        assert_eq!(pixels[2 * WIDTH + 3], Rgb::new(0.0, 0.2, 0.0));
        assert_eq!(pixels[0], Rgb::ZERO);
        assert_eq!(pixels[1], Rgb::splat(0.2));
        let untouched = repaired(&mut vec![Rgb::ONE; WIDTH], None).unwrap();
        assert_eq!(untouched, Repairs::default());
    }

    #[test]
    fn negatives_that_no_residue_explains_are_refused_with_their_place() {
        // 1 % of the mean is 0.002, a quarter of the brightest nearby 0.05.
        assert!(repaired(&mut with_pixel(Rgb::splat(-0.049)), None).is_ok());
        let before = with_pixel(Rgb::splat(-0.051));
        let mut pixels = before.clone();
        let text = repaired(&mut pixels, None).unwrap_err();
        assert!(
            text.contains("down to -0.051, in 1 pixel (in column 3, row 2)"),
            "{text}"
        );
        assert_eq!(pixels, before);
        // Undershoot beside a sun, across the edge of the map; far from it the same is wrong.
        let mut ringing = with_pixel(Rgb::splat(-2e3));
        ringing[3 * WIDTH - 1] = Rgb::splat(1e4);
        assert_eq!(repaired(&mut ringing, None).unwrap().lowest, -2e3);
        let mut far = with_pixel(Rgb::splat(-2e3));
        far[3 * WIDTH - 2] = Rgb::splat(1e4);
        assert!(repaired(&mut far, None).is_err());
        assert!(repaired(&mut with_pixel(Rgb::splat(f32::NEG_INFINITY)), None).is_err());
        let mut black = vec![Rgb::ZERO; WIDTH];
        black[5] = Rgb::splat(-1e-9);
        assert!(repaired(&mut black, None).is_err());
    }

    #[test]
    fn infinite_pixels_are_lowered_only_on_request() {
        let mut pixels = with_pixel(Rgb::splat(f32::INFINITY));
        pixels[5 * WIDTH] = Rgb::new(f32::INFINITY, 1.0, 1e5);
        let text = repaired(&mut pixels, None).unwrap_err();
        assert!(
            text.contains("2 pixels (the first in column 3, row 2)"),
            "{text}"
        );
        assert!(
            text.contains("sky.exr:clamp to lower it to 65504"),
            "{text}"
        );
        let mut copy = pixels.clone();
        let repairs = repaired(&mut copy, Some(RadianceClamp::Infinite)).unwrap();
        // 10⁵ is finite and brighter than any half float.
        assert_eq!((repairs.clamped, repairs.clamped_to), (2, Some(1e5)));
        assert_eq!(copy[5 * WIDTH], Rgb::new(1e5, 1.0, 1e5));
        let repairs = repaired(&mut pixels, Some(RadianceClamp::Above(0.5))).unwrap();
        assert_eq!((repairs.clamped, repairs.clamped_to), (2, Some(0.5)));
        assert_eq!(pixels[5 * WIDTH], Rgb::splat(0.5));
        assert_eq!(pixels[0], Rgb::splat(0.2));
        let mut half = with_pixel(Rgb::splat(f32::INFINITY));
        repaired(&mut half, Some(RadianceClamp::Infinite)).unwrap();
        assert_eq!(half[2 * WIDTH + 3], Rgb::splat(65_504.0));
        let nan = repaired(
            &mut with_pixel(Rgb::splat(f32::NAN)),
            Some(RadianceClamp::Infinite),
        );
        assert!(
            nan.unwrap_err()
                .contains("NaN in 1 pixel (in column 3, row 2)")
        );
    }
}
