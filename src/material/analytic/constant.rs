//! The BRDF that is the same for all directions.

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;

use crate::brdf::Brdf;
use crate::color::Rgb;
use crate::geometry::unit_upper;

/// Equal radiance in all directions: f_r = reflectance/π.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lambert {
    /// Fraction of the light that is reflected, in [0, 1] per channel.
    pub reflectance: Rgb,
}

impl Brdf for Lambert {
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        if unit_upper(wo).is_some() && unit_upper(wi).is_some() {
            self.reflectance * FRAC_1_PI
        } else {
            Rgb::ZERO
        }
    }

    fn is_isotropic(&self) -> bool {
        true
    }
}
