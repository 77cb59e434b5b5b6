//! Ideal diffuse reflection: `lambert:reflectance=0.5`, and as the thesis writes it `diffuse:kd=0.54`.

use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

use glam::DVec3;

use super::constant::Lambert;
use super::model::{Formula, Model, Properties};
use super::pair::UpperPair;
use super::parameters::{Parameters, declare};
use crate::Result;
use crate::color::Rgb;

pub(super) const MODEL: Model = Model {
    name: "lambert",
    summary: "ideal diffuse reflection, by its reflectance in each channel",
    source: "Lambert 1760",
    build: build_lambert,
};

pub(super) const DIFFUSE: Model = Model {
    name: "diffuse",
    summary: "ideal diffuse reflection",
    source: "Lambert 1760",
    build: build_diffuse,
};

fn build_lambert(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let reflectance = declare("reflectance", "fraction of the light that is reflected");
    let reflectance = parameters.colour(reflectance, 0.0..=1.0, 0.5)?;
    Ok(Arc::new(Lambert { reflectance }))
}

fn build_diffuse(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let kd = declare("kd", "fraction of the light that is reflected");
    let kd = parameters.number(kd, 0.0..=1.0, 0.54)?;
    let reflectance = Rgb::splat(kd as f32);
    Ok(Arc::new(Lambert { reflectance }))
}

impl Formula for Lambert {
    fn value(&self, _: &UpperPair, rgb: DVec3) -> DVec3 {
        self.reflectance.as_dvec3() * rgb * FRAC_1_PI
    }

    fn lambertian(&self, rgb: DVec3) -> Option<Lambert> {
        let reflectance = self.reflectance * rgb.as_vec3();
        Some(Self { reflectance })
    }

    fn properties(&self) -> Properties {
        Properties {
            albedo_bound: Some(self.reflectance.max_element().into()),
            ..Properties::PLAIN
        }
    }
}
