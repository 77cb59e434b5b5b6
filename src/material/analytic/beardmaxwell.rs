//! Beard and Maxwell's paint: a first surface with shadowing, and light from within.

use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

use glam::DVec3;

use super::fresnel::conductor;
use super::model::{Formula, Model, Properties};
use super::pair::UpperPair;
use super::parameters::{Parameters, declare};
use super::torrance::beckmann;
use crate::Result;

pub(super) const MODEL: Model = Model {
    name: "beardmaxwell",
    summary: "paint: a first surface with shadowing, a diffuse part and light from the volume",
    source: "Maxwell et al. 1973",
    build,
};

struct BeardMaxwell {
    omega: f64,
    tau: f64,
    eta: f64,
    kappa: f64,
    /// Rs, Rd and Rv.
    weights: [f64; 3],
    m: f64,
    printed: bool,
}

fn build(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let omega = declare("omega", "angle at which shadowing sets in, radians");
    let tau = declare("tau", "angle over which shadowing vanishes, radians");
    let eta = declare("nreal", "real part of the refractive index");
    let kappa = declare("nimag", "imaginary part of the refractive index");
    Ok(Arc::new(BeardMaxwell {
        omega: parameters.number(omega, 0.01..=100.0, 0.4)?,
        tau: parameters.number(tau, 0.0..=100.0, 0.15)?,
        eta: parameters.number(eta, 0.01..=100.0, 3.5)?,
        kappa: parameters.number(kappa, -100.0..=100.0, -0.2)?,
        weights: [
            parameters.number(declare("Rs", "weight of the first surface"), 0.0..=1.0, 0.8)?,
            parameters.number(declare("Rd", "weight of the diffuse part"), 0.0..=1.0, 0.1)?,
            parameters.number(declare("Rv", "weight of the volume"), 0.0..=1.0, 0.1)?,
        ],
        m: parameters.number(
            declare(
                "m",
                "slope of Beckmann's facets, which the thesis leaves open",
            ),
            1e-3..=10.0,
            0.3,
        )?,
        printed: parameters.is_printed()?,
    }))
}

impl BeardMaxwell {
    /// (1 + (δ/Ω)·e^(−2β/τ))/(1 + δ/Ω), with δ between half vector and normal and β between half vector and direction.
    fn shadowing(&self, pair: &UpperPair) -> f64 {
        let delta = pair.tan2_h().sqrt().atan() / self.omega;
        let beta = pair.cos_d.acos();
        let decay = if self.tau > 0.0 {
            (-2.0 * beta / self.tau).exp()
        } else {
            0.0
        };
        (1.0 + delta * decay) / (1.0 + delta)
    }
}

impl Formula for BeardMaxwell {
    /// Rs·F(β)·D(h)·SO/(4·cosθo·cosθi) + Rd/π + 2Rv/(π(cosθo + cosθi)). The thesis prints the product of the cosines for
    /// their sum, and a minus sign in front of all, which is not repeated.
    fn value(&self, pair: &UpperPair, rgb: DVec3) -> DVec3 {
        let [rs, rd, rv] = self.weights;
        let fresnel = conductor(self.eta, self.kappa, pair.cos_d);
        let product = pair.cos_o * pair.cos_i;
        let surface = fresnel * beckmann(pair, self.m) * self.shadowing(pair) / (4.0 * product);
        let cosines = if self.printed {
            product
        } else {
            pair.cos_o + pair.cos_i
        };
        rgb * (rs * surface + rd * FRAC_1_PI + 2.0 * rv / (PI * cosines))
    }

    /// Nothing hides the facets at grazing angles, so both values and albedo grow without bound.
    fn properties(&self) -> Properties {
        Properties {
            bounded: false,
            ..Properties::PLAIN
        }
    }
}
