//! Minnaert's lunar surface: f_r = kd/π·(cosθo·cosθi)^(k−1).

use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

use glam::DVec3;

use super::model::{Formula, Model, Properties};
use super::pair::UpperPair;
use super::parameters::{Parameters, declare};
use crate::Result;

pub(super) const MODEL: Model = Model {
    name: "minnaert",
    summary: "the Moon's surface, darker or brighter towards the horizon",
    source: "Minnaert 1941",
    build,
};

struct Minnaert {
    k: f64,
    kd: f64,
}

fn build(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let k = declare("k", "darkening of the limb; 1 is diffuse");
    let kd = declare("kd", "weight");
    Ok(Arc::new(Minnaert {
        k: parameters.number(k, 0.0..=10.0, 0.5)?,
        kd: parameters.number(kd, 0.0..=1.0, 0.7)?,
    }))
}

impl Formula for Minnaert {
    fn value(&self, pair: &UpperPair, rgb: DVec3) -> DVec3 {
        let darkening = (pair.cos_o * pair.cos_i).powf(self.k - 1.0);
        rgb * (self.kd * FRAC_1_PI * darkening)
    }

    /// The albedo is 2kd·cosθo^(k−1)/(k+1).
    fn properties(&self) -> Properties {
        let bounded = self.k >= 1.0 || self.kd == 0.0;
        Properties {
            bounded,
            albedo_bound: bounded.then_some(2.0 * self.kd / (self.k + 1.0)),
            ..Properties::PLAIN
        }
    }
}
