//! A perfect mirror: f_r = ks·δ(wi − mirror of wo)/cosθᵢ.

use std::sync::Arc;

use glam::DVec3;

use super::model::{Formula, Model, Properties};
use super::pair::UpperPair;
use super::parameters::{Parameters, declare};
use crate::Result;

pub(super) const MODEL: Model = Model {
    name: "specular",
    summary: "a perfect mirror, which has no values but the mirror direction",
    source: "Montes 2008, eq. 3.1",
    build,
};

struct PerfectMirror {
    ks: f64,
    printed: bool,
}

fn build(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let ks = declare("ks", "fraction of the light that is reflected");
    Ok(Arc::new(PerfectMirror {
        ks: parameters.number(ks, 0.0..=1.0, 0.54)?,
        printed: parameters.is_printed()?,
    }))
}

impl Formula for PerfectMirror {
    fn value(&self, _: &UpperPair, _: DVec3) -> DVec3 {
        DVec3::ZERO
    }

    /// The printed formula lacks 1/cosθᵢ.
    fn mirror(&self, cos_o: f64, rgb: DVec3) -> Option<DVec3> {
        let cosine = if self.printed { cos_o } else { 1.0 };
        Some(self.ks * cosine * rgb)
    }

    fn properties(&self) -> Properties {
        Properties {
            albedo_bound: Some(self.ks),
            ..Properties::PLAIN
        }
    }
}
