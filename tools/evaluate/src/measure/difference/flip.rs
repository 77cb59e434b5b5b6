//! FLIP: the difference that a person sees who alternates between two pictures (Andersson et al. 2020; of high dynamic range:
//! Andersson et al. 2021).

use glam::DVec3;
use merlkit::color::luminance;
use merlkit::image::Image;
use merlkit::{Error, Result};
use rayon::prelude::*;

use super::errors::mean;
use super::flip_color::{hunt_lab_from_rgb, hyab, opponent_from_rgb, rgb_from_opponent};
use super::flip_filters::{Plane, detect_features, filter_by_sensitivity};

/// Pixels a degree of a monitor of 3840 pixels over 0.7 m, seen from 0.7 m: the authors' default.
pub(super) const PIXELS_A_DEGREE: f64 = 0.7 * (3840.0 / 0.7) * std::f64::consts::PI / 180.0;

/// The exponent of distances of colours.
const COLOUR_EXPONENT: f64 = 0.7;
/// Distances up to this fraction of the greatest fill the error up to [`COMMON_ERROR`].
const COMMON_DISTANCE: f64 = 0.4;
const COMMON_ERROR: f64 = 0.95;
/// The exponent of differences of features.
const FEATURE_EXPONENT: f64 = 0.5;

/// A picture of errors from 0 to 1.
#[derive(Clone, Debug)]
pub struct FlipMap {
    /// Pixels of a row.
    pub width: usize,
    /// The errors, rows from the top.
    pub errors: Vec<f64>,
    /// How many exposures were compared; 1 of pictures for a display.
    pub exposures: usize,
}

impl FlipMap {
    /// Mean error: 0 where no difference is seen, 1 at most.
    pub fn mean(&self) -> f64 {
        mean(self.errors.iter().copied())
    }
}

/// FLIP of two pictures for a display, linear RGB from 0 to 1; what is beyond is shown as the nearest.
///
/// # Errors
/// [`Error::Argument`] for pictures of different sizes.
pub fn flip_display(picture: &Image, reference: &Image) -> Result<FlipMap> {
    check_sizes(picture, reference)?;
    Ok(FlipMap {
        width: picture.width(),
        errors: compare_planes(&shown(picture, |c| c), &shown(reference, |c| c)),
        exposures: 1,
    })
}

/// FLIP of two pictures of radiance: the greatest error over exposures, from one that makes the brightest pixel of the reference
/// nearly white to one that does so to its median.
///
/// # Errors
/// [`Error::Argument`] for pictures of different sizes, and for a reference that is black.
pub fn flip_radiance(picture: &Image, reference: &Image) -> Result<FlipMap> {
    check_sizes(picture, reference)?;
    let exposures = choose_exposures(reference).ok_or_else(|| {
        Error::argument(
            "a reference without light has no exposures",
            "name a reference that is not black",
        )
    })?;
    let mut errors = vec![0.0f64; picture.pixels().len()];
    for exposure in &exposures {
        let scale = exposure.exp2();
        let found = shown(picture, |c| film_curve(c * scale));
        let right = shown(reference, |c| film_curve(c * scale));
        for (worst, error) in errors.iter_mut().zip(compare_planes(&found, &right)) {
            *worst = worst.max(error);
        }
    }
    Ok(FlipMap {
        width: picture.width(),
        errors,
        exposures: exposures.len(),
    })
}

fn check_sizes(picture: &Image, reference: &Image) -> Result<()> {
    let size = |image: &Image| (image.width(), image.height());
    let ((w, h), (rw, rh)) = (size(picture), size(reference));
    if (w, h) == (rw, rh) {
        return Ok(());
    }
    Err(Error::argument(
        format!("pictures of {w}×{h} and {rw}×{rh} pixels"),
        "compare pictures of one size",
    ))
}

/// A picture as a display shows it after `curve`; what is not a number is black.
fn shown(image: &Image, curve: impl Fn(f64) -> f64) -> Plane {
    let mut values = Vec::with_capacity(image.pixels().len());
    for pixel in image.pixels() {
        let mut value = pixel.as_dvec3();
        for channel in 0..3 {
            let seen = curve(value[channel]);
            value[channel] = if seen.is_nan() {
                0.0
            } else {
                seen.clamp(0.0, 1.0)
            };
        }
        values.push(value);
    }
    Plane {
        width: image.width(),
        height: image.height(),
        values,
    }
}

/// Coefficients of the curve (k0·x² + k1·x)/(k3·x² + k4·x + k5), a fit of ACES by Narkowicz (2015) with x scaled by 0.6.
const FILM: [f64; 5] = [0.36 * 2.51, 0.6 * 0.03, 0.36 * 2.43, 0.6 * 0.59, 0.14];

fn film_curve(x: f64) -> f64 {
    let [k0, k1, k3, k4, k5] = FILM;
    if x.is_infinite() {
        return k0 / k3;
    }
    (k0 * x * x + k1 * x) / (k3 * x * x + k4 * x + k5)
}

/// The exposures of [`flip_radiance`], as powers of 2; `None` of a reference without light.
fn choose_exposures(reference: &Image) -> Option<Vec<f64>> {
    let mut luminances: Vec<f64> = Vec::with_capacity(reference.pixels().len());
    for pixel in reference.pixels() {
        luminances.push(f64::from(luminance(*pixel)));
    }
    luminances.retain(|y| y.is_finite());
    luminances.sort_by(f64::total_cmp);
    let brightest = *luminances.last()?;
    let median = middle(&luminances);
    if brightest <= 0.0 {
        return None;
    }
    // Where the curve reaches 0.85: a·x² + b·x + c = 0.
    let [k0, k1, k3, k4, k5] = FILM;
    let (a, b, c) = (k0 - 0.85 * k3, k1 - 0.85 * k4, -0.85 * k5);
    let half = -b / (2.0 * a);
    let white = half + (half * half - c / a).sqrt();
    let first = (white / brightest).log2();
    // A median of 0 would ask for an endless exposure.
    let last = (white / median.max(1e-9 * brightest)).log2();
    let count = ((last - first).ceil() as usize).max(2);
    let step = (last - first) / (count - 1) as f64;
    Some((0..count).map(|i| first + step * i as f64).collect())
}

/// Median of rising numbers.
fn middle(rising: &[f64]) -> f64 {
    let half = rising.len() / 2;
    if rising.len() % 2 == 1 {
        rising[half]
    } else {
        0.5 * (rising[half - 1] + rising[half])
    }
}

/// The errors of two pictures of one size, linear RGB from 0 to 1.
fn compare_planes(found: &Plane, right: &Plane) -> Vec<f64> {
    let (seen, features) = perceive(found);
    let (right_seen, right_features) = perceive(right);
    let greatest =
        hyab(hunt_lab_from_rgb(DVec3::Y), hunt_lab_from_rgb(DVec3::Z)).powf(COLOUR_EXPONENT);
    let mut errors = Vec::with_capacity(seen.len());
    for k in 0..seen.len() {
        // The colours' distance, with the upper part of its range compressed.
        let distance = hyab(seen[k], right_seen[k]).powf(COLOUR_EXPONENT);
        let common = COMMON_DISTANCE * greatest;
        let colour = if distance < common {
            distance * COMMON_ERROR / common
        } else {
            COMMON_ERROR + (distance - common) / (greatest - common) * (1.0 - COMMON_ERROR)
        };
        // The greater of the differences of edges and points raises it: colour^(1 − feature).
        let [edge, point] = features[k];
        let [right_edge, right_point] = right_features[k];
        let difference = (edge - right_edge).abs().max((point - right_point).abs());
        let feature = (difference / 2f64.sqrt())
            .powf(FEATURE_EXPONENT)
            .clamp(0.0, 1.0);
        errors.push(colour.clamp(0.0, 1.0).powf(1.0 - feature));
    }
    errors
}

/// What is seen of a picture: the colours that are left of it at this distance, and its edges and points.
fn perceive(plane: &Plane) -> (Vec<DVec3>, Vec<[f64; 2]>) {
    let mut opponent = plane.clone();
    opponent
        .values
        .par_iter_mut()
        .for_each(|value| *value = opponent_from_rgb(*value));
    let mut seen = filter_by_sensitivity(&opponent, PIXELS_A_DEGREE).values;
    seen.par_iter_mut().for_each(|value| {
        let rgb = rgb_from_opponent(*value).clamp(DVec3::ZERO, DVec3::ONE);
        *value = hunt_lab_from_rgb(rgb);
    });
    for value in &mut opponent.values {
        *value = DVec3::splat((value.x + 16.0) / 116.0);
    }
    (seen, detect_features(&opponent, PIXELS_A_DEGREE))
}

#[cfg(test)]
mod tests {
    use merlkit::color::Rgb;

    use super::*;

    /// Waves of red and green over a chessboard of blue.
    fn reference(x: usize, y: usize) -> Rgb {
        let (s, t) = (x as f32, y as f32);
        Rgb::new(
            0.5 + 0.45 * (0.31 * s + 0.11 * t).sin(),
            0.5 + 0.4 * (0.17 * s - 0.23 * t).cos(),
            ((x / 8 + y / 8) % 2) as f32 * 0.8 + 0.1,
        )
    }

    /// The same with noise in red, less green, and a red square.
    fn picture(x: usize, y: usize) -> Rgb {
        if x.abs_diff(40) < 4 && y.abs_diff(20) < 4 {
            return Rgb::new(0.95, 0.2, 0.1);
        }
        let c = reference(x, y);
        Rgb::new(
            (c.x + 0.12 * (1.7 * x as f32).sin()).clamp(0.0, 1.0),
            (c.y * 0.9 + 0.03).clamp(0.0, 1.0),
            c.z,
        )
    }

    fn assert_near(map: &FlipMap, mean: f64, pixels: [f64; 5]) {
        assert!((map.mean() - mean).abs() < 1e-4, "{} {mean}", map.mean());
        let places = [(0, 0), (20, 40), (10, 60), (47, 63), (30, 12)];
        for ((y, x), expected) in places.into_iter().zip(pixels) {
            let found = map.errors[y * map.width + x];
            assert!((found - expected).abs() < 5e-4, "{found} {expected}");
        }
    }

    /// Values of the authors' own evaluator, version 1.7, for the same two pictures.
    #[test]
    fn errors_are_those_of_the_authors() {
        let right = Image::from_fn(64, 48, reference).unwrap();
        let found = Image::from_fn(64, 48, picture).unwrap();
        let map = flip_display(&found, &right).unwrap();
        let pixels = [0.260_208, 0.658_661, 0.171_704, 0.240_063, 0.195_812];
        assert_near(&map, 0.185_398, pixels);

        let squared = |c: Rgb| 8.0 * c * c;
        let right = Image::from_fn(64, 48, |x, y| squared(reference(x, y))).unwrap();
        let found = Image::from_fn(64, 48, |x, y| squared(picture(x, y))).unwrap();
        let map = flip_radiance(&found, &right).unwrap();
        assert_eq!(map.exposures, 2);
        let pixels = [0.157_653, 0.795_451, 0.154_999, 0.184_788, 0.165_324];
        assert_near(&map, 0.186_189, pixels);
    }

    #[test]
    fn equal_pictures_have_no_errors_and_hostile_ones_no_panic() {
        let right = Image::from_fn(64, 48, reference).unwrap();
        assert_eq!(flip_display(&right, &right).unwrap().mean(), 0.0);
        let hostile = Image::from_fn(64, 48, |x, _| {
            Rgb::splat([f32::NAN, f32::INFINITY, -1.0, 1e30][x % 4])
        })
        .unwrap();
        for map in [
            flip_display(&hostile, &right),
            flip_radiance(&hostile, &right),
            flip_radiance(&right, &hostile),
        ] {
            let map = map.unwrap();
            assert!(map.errors.iter().all(|e| (0.0..=1.0).contains(e)));
        }
        let black = Image::from_fn(64, 48, |_, _| Rgb::ZERO).unwrap();
        assert!(flip_radiance(&right, &black).is_err());
        let small = Image::from_fn(8, 48, reference).unwrap();
        assert!(flip_display(&small, &right).is_err());
    }
}
