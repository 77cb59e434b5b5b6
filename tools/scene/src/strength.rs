//! How strong a light is: one number for all channels, or three.

use merlkit::color::Rgb;
use serde::Deserialize;

/// One number for all channels, or three.
#[derive(Clone, Copy, Deserialize)]
#[serde(untagged)]
pub(crate) enum Strength {
    Grey(f32),
    Colour([f32; 3]),
}

impl Strength {
    pub(crate) fn rgb(self) -> Rgb {
        match self {
            Self::Grey(value) => Rgb::splat(value),
            Self::Colour(channels) => Rgb::from_array(channels),
        }
    }
}
