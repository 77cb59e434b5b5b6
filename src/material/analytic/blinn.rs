//! Lobes of half vectors, cosⁿδ: Blinn's and Lewis's. Their sound forms are the same, and have the albedo ks along the normal.

use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

use glam::DVec3;

use super::model::{Formula, Model, Properties};
use super::pair::UpperPair;
use super::parameters::{Parameters, declare};
use crate::Result;

pub(super) const MODEL: Model = Model {
    name: "blinn",
    summary: "a lobe of half vectors over a diffuse part",
    source: "Blinn 1977",
    build: build_blinn,
};

pub(super) const LEWIS: Model = Model {
    name: "lewis",
    summary: "Blinn's lobe; its printed form has another weight",
    source: "Lewis 1994",
    build: build_lewis,
};

/// kd/π + ks·N·cosⁿδ, N = (n+2)(n+4)/(8π(2^(−n/2) + n)). As printed: kd·cosθo + ks·`printed_scale`·cosⁿδ.
struct HalfVectorLobe {
    n: f64,
    ks: f64,
    kd: f64,
    /// The weight of the printed lobe; `None` for the sound form.
    printed_scale: Option<f64>,
}

fn build_blinn(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let mut lobe = read_lobe(parameters, [17.5, 0.17, 0.35])?;
    lobe.printed_scale = parameters.is_printed()?.then_some(1.0);
    Ok(Arc::new(lobe))
}

fn build_lewis(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let mut lobe = read_lobe(parameters, [17.5, 0.34, 0.72])?;
    let scale = (lobe.n + 2.0) / (2.0 * PI);
    lobe.printed_scale = parameters.is_printed()?.then_some(scale);
    Ok(Arc::new(lobe))
}

/// The parameters of both, with their defaults.
fn read_lobe(parameters: &mut Parameters, [n, ks, kd]: [f64; 3]) -> Result<HalfVectorLobe> {
    Ok(HalfVectorLobe {
        n: parameters.number(declare("n", "exponent of the lobe"), 0.0..=1e6, n)?,
        ks: parameters.number(declare("ks", "weight of the lobe"), 0.0..=1.0, ks)?,
        kd: parameters.number(declare("kd", "weight of the diffuse part"), 0.0..=1.0, kd)?,
        printed_scale: None,
    })
}

impl HalfVectorLobe {
    /// 1/∫ cosⁿδ·cosθi dσ for the viewer along the normal.
    fn normaliser(&self) -> f64 {
        let n = self.n;
        (n + 2.0) * (n + 4.0) / (8.0 * PI * ((-0.5 * n).exp2() + n))
    }
}

impl Formula for HalfVectorLobe {
    fn value(&self, pair: &UpperPair, rgb: DVec3) -> DVec3 {
        let lobe = self.ks * pair.cos_h_power(self.n);
        let value = match self.printed_scale {
            Some(scale) => self.kd * pair.cos_o + scale * lobe,
            None => self.kd * FRAC_1_PI + self.normaliser() * lobe,
        };
        rgb * value
    }

    /// The albedo is largest along the normal.
    fn properties(&self) -> Properties {
        let albedo = match self.printed_scale {
            Some(scale) => self.kd * PI + self.ks * scale / self.normaliser(),
            None => self.kd + self.ks,
        };
        Properties {
            reciprocal: self.printed_scale.is_none() || self.kd == 0.0,
            albedo_bound: Some(albedo),
            ..Properties::PLAIN
        }
    }
}
