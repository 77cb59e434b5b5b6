//! Cook and Torrance's microfacets: Beckmann's distribution, V-shaped grooves and Fresnel's reflectance of a conductor.

use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

use glam::DVec3;

use super::fresnel::conductor;
use super::model::{Formula, Model, Properties};
use super::pair::UpperPair;
use super::parameters::{Parameters, declare};
use crate::Result;

pub(super) const MODEL: Model = Model {
    name: "torrance",
    summary: "microfacets of a conductor over a diffuse part",
    source: "Torrance and Sparrow 1967; Cook and Torrance 1982",
    build,
};

/// kd/π + ks·F(β)·D·G/(4·cosθo·cosθi). As printed the lobe is four times as bright: π is missing in D, and 4 is π.
struct CookTorrance {
    rough: f64,
    eta: f64,
    kappa: f64,
    ks: f64,
    kd: f64,
    printed: bool,
}

fn build(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let rough = declare("rough", "root mean square slope of the facets");
    let eta = declare("nreal", "real part of the refractive index");
    let kappa = declare("nimag", "imaginary part of the refractive index");
    Ok(Arc::new(CookTorrance {
        rough: parameters.number(rough, 1e-3..=10.0, 0.13)?,
        eta: parameters.number(eta, 0.01..=100.0, 13.22)?,
        kappa: parameters.number(kappa, -100.0..=100.0, -0.78)?,
        ks: parameters.number(declare("ks", "weight of the lobe"), 0.0..=1.0, 0.19)?,
        kd: parameters.number(declare("kd", "weight of the diffuse part"), 0.0..=1.0, 0.98)?,
        printed: parameters.is_printed()?,
    }))
}

/// Beckmann's density of facets, D = exp(−tan²δ/m²)/(π·m²·cos⁴δ), normalised by ∫ D·cosδ dω = 1.
pub(super) fn beckmann(pair: &UpperPair, m: f64) -> f64 {
    let tan2 = pair.tan2_h();
    // 1/cos⁴δ = (1 + tan²δ)², which overflows no earlier than the exponential vanishes.
    let secant = 1.0 + tan2;
    (2.0 * secant.ln() - tan2 / (m * m)).exp() / (PI * m * m)
}

impl CookTorrance {
    /// G/(4·cosθo·cosθi) of V-shaped grooves, G = min(1, 2(n·h)cosθo/(u·h), 2(n·h)cosθi/(u·h)).
    fn masking(pair: &UpperPair) -> f64 {
        let groove = 2.0 * pair.h.z * pair.cos_o.min(pair.cos_i) / pair.cos_d;
        groove.min(1.0) / (4.0 * pair.cos_o * pair.cos_i)
    }
}

impl Formula for CookTorrance {
    fn value(&self, pair: &UpperPair, rgb: DVec3) -> DVec3 {
        let fresnel = conductor(self.eta, self.kappa, pair.cos_d);
        let lobe = fresnel * beckmann(pair, self.rough) * Self::masking(pair);
        let scale = if self.printed { 4.0 } else { 1.0 };
        rgb * (self.kd * FRAC_1_PI + self.ks * scale * lobe)
    }

    /// Grooves that hide each other reflect no more than they receive.
    fn properties(&self) -> Properties {
        let scale = if self.printed { 4.0 } else { 1.0 };
        Properties {
            bounded: self.ks == 0.0,
            albedo_bound: Some(self.kd + scale * self.ks),
            ..Properties::PLAIN
        }
    }
}
