//! All differences of two pictures.

use merlkit::Result;
use merlkit::color::luminance;
use merlkit::image::Image;
use serde::Serialize;

use super::errors::luminance_errors;
use super::flip::{FlipMap, PIXELS_A_DEGREE, flip_display, flip_radiance};

/// How pictures of a file are seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Viewing {
    /// As they are, values from 0 to 1.
    Display,
    /// Through a film's curve at several exposures.
    Radiance,
}

/// How far a picture is from its reference.
#[derive(Clone, Debug, Serialize)]
pub struct PictureDifference {
    /// Columns and rows of both.
    pub size: [usize; 2],
    /// Mean relative error of luminance over lit pixels.
    pub mean_relative: f64,
    /// Relative squared error of luminance.
    pub rel_mse: f64,
    /// Mean of FLIP, 0 to 1.
    pub flip: f64,
    /// Its greatest pixel.
    pub flip_greatest: f64,
    /// How the pictures were seen.
    pub viewing: Viewing,
    /// Exposures that FLIP compared.
    pub exposures: usize,
    /// Pixels a degree at the observer's distance.
    pub pixels_a_degree: f64,
    /// FLIP of each pixel.
    #[serde(skip)]
    pub map: FlipMap,
}

impl PictureDifference {
    /// Measures a picture against a reference.
    ///
    /// # Errors
    /// As [`flip_display`] and [`flip_radiance`].
    pub fn measure(picture: &Image, reference: &Image, viewing: Viewing) -> Result<Self> {
        let map = match viewing {
            Viewing::Display => flip_display(picture, reference)?,
            Viewing::Radiance => flip_radiance(picture, reference)?,
        };
        let errors = luminance_errors(&luminances(picture), &luminances(reference));
        Ok(Self {
            size: [picture.width(), picture.height()],
            mean_relative: errors.mean_relative,
            rel_mse: errors.rel_mse,
            flip: map.mean(),
            flip_greatest: map.errors.iter().copied().fold(0.0, f64::max),
            viewing,
            exposures: map.exposures,
            pixels_a_degree: PIXELS_A_DEGREE,
            map,
        })
    }
}

fn luminances(image: &Image) -> Vec<f64> {
    let pixels = image.pixels().iter();
    pixels.map(|pixel| f64::from(luminance(*pixel))).collect()
}
