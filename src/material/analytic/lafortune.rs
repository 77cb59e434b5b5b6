//! Lafortune's generalised cosine lobe.

use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

use glam::DVec3;

use super::model::{Formula, Model, Properties};
use super::pair::UpperPair;
use super::parameters::{Parameters, declare};
use crate::Result;

pub(super) const MODEL: Model = Model {
    name: "lafortune",
    summary: "a generalised cosine lobe, not normalised, over a diffuse part",
    source: "Lafortune et al. 1997",
    build,
};

/// kp/π + max(0, Cx·ux·vx + Cy·uy·vy + Cz·uz·vz)ⁿ. As printed a negative sum is not clamped, which has no power.
struct Lafortune {
    c: DVec3,
    n: f64,
    kp: f64,
}

fn build(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let n = parameters.number(declare("n", "exponent of the lobe"), 0.0..=1e6, 20.0)?;
    let kp = declare("kp", "weight of the diffuse part");
    let kp = parameters.number(kp, 0.0..=1.0, 0.74)?;
    let cx = declare(
        "Cx",
        "factor of the x components; −1 is the mirror direction",
    );
    let cy = declare("Cy", "factor of the y components");
    let cz = declare("Cz", "factor of the z components");
    let c = DVec3::new(
        parameters.number(cx, -2.0..=2.0, -1.1)?,
        parameters.number(cy, -2.0..=2.0, -0.9)?,
        parameters.number(cz, -2.0..=2.0, 1.2)?,
    );
    Ok(Arc::new(Lafortune { c, n, kp }))
}

impl Formula for Lafortune {
    fn value(&self, pair: &UpperPair, rgb: DVec3) -> DVec3 {
        let base = (self.c * pair.wo).dot(pair.wi);
        let lobe = if base > 0.0 { base.powf(self.n) } else { 0.0 };
        rgb * (self.kp * FRAC_1_PI + lobe)
    }

    fn properties(&self) -> Properties {
        Properties {
            symmetry: Properties::axes(self.c.x == self.c.y),
            ..Properties::PLAIN
        }
    }
}
