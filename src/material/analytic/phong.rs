//! Phong's lobe about the mirror direction, normalised as by Lafortune and Willems.

use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

use glam::DVec3;

use super::model::{Formula, Model, Properties};
use super::pair::UpperPair;
use super::parameters::{Parameters, declare};
use crate::Result;

pub(super) const MODEL: Model = Model {
    name: "phong",
    summary: "a lobe about the mirror direction over a diffuse part",
    source: "Phong 1975; Lafortune and Willems 1994",
    build,
};

/// kd/π + ks(n+2)/(2π)·cosⁿα with α from the mirror direction. As printed: kd·cosθi + ks·cosⁿα.
pub(super) struct Phong {
    pub(super) n: f64,
    pub(super) ks: f64,
    pub(super) kd: f64,
    pub(super) printed: bool,
}

fn build(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    Ok(Arc::new(Phong {
        n: parameters.number(declare("n", "exponent of the lobe"), 0.0..=1e6, 50.0)?,
        ks: parameters.number(declare("ks", "weight of the lobe"), 0.0..=1.0, 0.4)?,
        kd: parameters.number(declare("kd", "weight of the diffuse part"), 0.0..=1.0, 0.6)?,
        printed: parameters.is_printed()?,
    }))
}

impl Phong {
    /// The sound value, by cosα.
    pub(super) fn sound(&self, lobe: f64) -> f64 {
        self.kd * FRAC_1_PI + self.ks * (self.n + 2.0) / (2.0 * PI) * lobe
    }
}

impl Formula for Phong {
    fn value(&self, pair: &UpperPair, rgb: DVec3) -> DVec3 {
        let lobe = pair.cos_mirror_power(self.n);
        let value = if self.printed {
            self.kd * pair.cos_i + self.ks * lobe
        } else {
            self.sound(lobe)
        };
        rgb * value
    }

    /// Both albedos are largest along the normal, where the horizon cuts nothing off the lobe.
    fn properties(&self) -> Properties {
        let albedo = if self.printed {
            2.0 * PI * (self.kd / 3.0 + self.ks / (self.n + 2.0))
        } else {
            self.kd + self.ks
        };
        Properties {
            reciprocal: !self.printed || self.kd == 0.0,
            albedo_bound: Some(albedo),
            ..Properties::PLAIN
        }
    }
}
