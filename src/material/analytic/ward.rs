//! Ward's anisotropic lobe of half vectors.

use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

use glam::DVec3;

use super::model::{Formula, Model, Properties};
use super::pair::UpperPair;
use super::parameters::{Parameters, declare};
use crate::Result;

pub(super) const MODEL: Model = Model {
    name: "ward",
    summary: "an anisotropic Gaussian lobe of half vectors over a diffuse part",
    source: "Ward 1992",
    build,
};

/// kd/π + ks·exp(−(hx²/sx² + hy²/sy²)/hz²)/(4π·sx·sy·√(cosθo·cosθi)).
struct Ward {
    sx: f64,
    sy: f64,
    ks: f64,
    kd: f64,
}

fn build(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let sx = declare("sx", "slope along x");
    let sy = declare("sy", "slope along y");
    Ok(Arc::new(Ward {
        sx: parameters.number(sx, 1e-3..=10.0, 0.3674)?,
        sy: parameters.number(sy, 1e-3..=10.0, 0.7765)?,
        ks: parameters.number(declare("ks", "weight of the lobe"), 0.0..=1.0, 0.05)?,
        kd: parameters.number(declare("kd", "weight of the diffuse part"), 0.0..=1.0, 0.4)?,
    }))
}

impl Formula for Ward {
    fn value(&self, pair: &UpperPair, rgb: DVec3) -> DVec3 {
        let (x, y) = (pair.h.x / self.sx, pair.h.y / self.sy);
        let exponent = (x * x + y * y) / (pair.h.z * pair.h.z);
        let area = 4.0 * PI * self.sx * self.sy * (pair.cos_o * pair.cos_i).sqrt();
        rgb * (self.kd * FRAC_1_PI + self.ks * (-exponent).exp() / area)
    }

    /// The albedo grows as 1/√cosθo towards the horizon.
    fn properties(&self) -> Properties {
        let plain = self.ks == 0.0;
        Properties {
            bounded: plain,
            symmetry: Properties::axes(self.sx == self.sy || plain),
            albedo_bound: plain.then_some(self.kd),
            ..Properties::PLAIN
        }
    }
}
