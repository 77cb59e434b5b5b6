//! The scalar that samplers are built proportional to.

use crate::color::{self, Rgb};

/// Reduction of RGB to the scalar a sampler follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Importance {
    /// Mean of the channels: the lowest spread of RGB weights on most measured materials.
    #[default]
    Mean,
    /// Relative luminance.
    Luminance,
}

impl Importance {
    /// The scalar's name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mean => "mean",
            Self::Luminance => "luminance",
        }
    }

    /// The scalar of a value.
    #[inline]
    pub fn of(self, value: Rgb) -> f32 {
        match self {
            Self::Mean => color::mean(value),
            Self::Luminance => color::luminance(value),
        }
    }
}
