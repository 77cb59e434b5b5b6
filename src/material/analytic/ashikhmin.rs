//! Ashikhmin and Shirley's anisotropic lobe with Fresnel's factor, over a diffuse part that gives way to it.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::DVec3;

use super::model::{Formula, Model, Properties};
use super::pair::{UpperPair, schlick_weight};
use super::parameters::{Parameters, declare};
use crate::Result;

pub(super) const MODEL: Model = Model {
    name: "ashikhmin",
    summary: "an anisotropic lobe of half vectors with Fresnel's factor over a diffuse part",
    source: "Ashikhmin and Shirley 2000",
    build,
};

struct Ashikhmin {
    ex: f64,
    ey: f64,
    rs: f64,
    rd: f64,
    printed: bool,
}

fn build(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let ex = declare("ex|nu", "exponent along x");
    let ey = declare("ey|nv", "exponent along y");
    let rs = declare("Rs|ks", "reflectance of the lobe along the normal");
    let rd = declare("Rd|kd", "reflectance of the diffuse part");
    Ok(Arc::new(Ashikhmin {
        ex: parameters.number(ex, 0.0..=1e6, 10.0)?,
        ey: parameters.number(ey, 0.0..=1e6, 10.0)?,
        rs: parameters.number(rs, 0.0..=1.0, 0.5)?,
        rd: parameters.number(rd, 0.0..=1.0, 0.5)?,
        printed: parameters.is_printed()?,
    }))
}

impl Ashikhmin {
    /// √((ex+1)(ey+1))/(8π)·(n·h)^((ex·hx² + ey·hy²)/(1−hz²))·F/((u·h)·max(cosθo, cosθi)), F = Rs + (1−Rs)(1−u·h)⁵. The
    /// thesis prints F of cosθi.
    fn lobe(&self, pair: &UpperPair) -> f64 {
        let (x2, y2) = (pair.h.x * pair.h.x, pair.h.y * pair.h.y);
        let sine2 = x2 + y2;
        // At h = n the power of 1 is 1 for any exponent.
        let shape = if sine2 > 0.0 {
            pair.cos_h_power((self.ex * x2 + self.ey * y2) / sine2)
        } else {
            1.0
        };
        let angle = if self.printed { pair.cos_i } else { pair.cos_d };
        let fresnel = self.rs + (1.0 - self.rs) * schlick_weight(angle);
        let scale = ((self.ex + 1.0) * (self.ey + 1.0)).sqrt() / (8.0 * PI);
        scale * shape * fresnel / (pair.cos_d * pair.cos_o.max(pair.cos_i))
    }
}

impl Formula for Ashikhmin {
    fn value(&self, pair: &UpperPair, rgb: DVec3) -> DVec3 {
        // 28Rd/(23π)·(1−Rs)(1 − (1−cosθo/2)⁵)(1 − (1−cosθi/2)⁵)
        let [o, i] = [pair.cos_o, pair.cos_i].map(|c| 1.0 - schlick_weight(0.5 * c));
        let diffuse = 28.0 * self.rd / (23.0 * PI) * (1.0 - self.rs) * o * i;
        rgb * (self.lobe(pair) + diffuse)
    }

    /// Without exponents the lobe is a uniform one, whose albedo is the largest.
    fn properties(&self) -> Properties {
        Properties {
            reciprocal: !self.printed || self.rs == 1.0,
            bounded: false,
            symmetry: Properties::axes(self.ex == self.ey),
            ..Properties::PLAIN
        }
    }
}
