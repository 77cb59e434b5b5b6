//! Shirley's coupled model: a smooth coat reflects as a mirror, and what it lets through is reflected diffusely.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::DVec3;

use super::model::{Formula, Model, Properties};
use super::pair::{UpperPair, schlick_weight};
use super::parameters::{Parameters, declare};
use crate::Result;

pub(super) const MODEL: Model = Model {
    name: "coupled",
    summary: "a smooth coat with its mirror image over a matte base",
    source: "Shirley et al. 1997",
    build,
};

struct Coupled {
    rm: f64,
    ro: f64,
    printed: bool,
}

fn build(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let rm = declare("Rm", "reflectance of the matte base");
    let ro = declare("Ro", "reflectance of the coat along the normal");
    Ok(Arc::new(Coupled {
        rm: parameters.number(rm, 0.0..=1.0, 1.0)?,
        ro: parameters.number(ro, 0.0..=0.99, 0.05)?,
        printed: parameters.is_printed()?,
    }))
}

impl Formula for Coupled {
    /// k·Rm·(1 − (1−cosθo)⁵)(1 − (1−cosθi)⁵). With k = 21(1−Ro)/(20π) the base reflects Rm of what the coat lets through,
    /// because ∫ (1 − (1−c)⁵)·c dω = 20π/21. The thesis prints k = 21/(20π(1−Ro)).
    fn value(&self, pair: &UpperPair, rgb: DVec3) -> DVec3 {
        let through = 1.0 - self.ro;
        let scale = if self.printed { 1.0 / through } else { through };
        let k = 21.0 * scale / (20.0 * PI);
        let [o, i] = [pair.cos_o, pair.cos_i].map(|c| 1.0 - schlick_weight(c));
        rgb * (k * self.rm * o * i)
    }

    fn mirror(&self, cos_o: f64, rgb: DVec3) -> Option<DVec3> {
        Some(rgb * (self.ro + (1.0 - self.ro) * schlick_weight(cos_o)))
    }

    /// Coat and base together reflect Ro + (1−Ro)·Rm along the normal and all light at the horizon.
    fn properties(&self) -> Properties {
        let bound = if self.printed {
            self.rm / (1.0 - self.ro) + 1.0
        } else {
            1.0
        };
        Properties {
            albedo_bound: Some(bound),
            ..Properties::PLAIN
        }
    }
}
