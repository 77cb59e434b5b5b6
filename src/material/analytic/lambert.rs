//! Ideal diffuse reflection: `lambert:reflectance=0.5`.

use std::f32::consts::FRAC_1_PI;
use std::sync::Arc;

use glam::Vec3;

use super::model::Model;
use super::parameters::Parameters;
use crate::Result;
use crate::brdf::Brdf;
use crate::color::Rgb;
use crate::geometry::unit_upper;

pub(super) const MODEL: Model = Model {
    name: "lambert",
    build,
};

/// Equal radiance in all directions: f_r = reflectance/π.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lambert {
    /// Fraction of the light that is reflected, in [0, 1] per channel.
    pub reflectance: Rgb,
}

fn build(parameters: &mut Parameters) -> Result<Arc<dyn Brdf>> {
    let reflectance = parameters.colour("reflectance", 0.0..=1.0, 0.5)?;
    Ok(Arc::new(Lambert { reflectance }))
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
