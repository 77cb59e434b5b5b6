//! A `.bsdf` file as a BRDF.

use glam::Vec3;

use crate::brdf::Brdf;
use crate::color::Rgb;
use crate::geometry::Symmetry;
use crate::material::rgl::RglBrdf;

impl Brdf for RglBrdf {
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        self.value(wo, wi)
    }

    fn eval_cos(&self, wo: Vec3, wi: Vec3) -> Rgb {
        self.value_cos(wo, wi)
    }

    fn is_isotropic(&self) -> bool {
        Self::is_isotropic(self)
    }

    fn symmetry(&self) -> Symmetry {
        Self::symmetry(self)
    }
}
