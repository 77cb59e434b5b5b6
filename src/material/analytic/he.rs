//! The model of He, Torrance, Sillion and Greenberg for unpolarised light, with its errata.

use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

use glam::DVec3;

use super::fresnel::conductor;
use super::model::{Formula, Model, Properties};
use super::pair::UpperPair;
use super::parameters::{Parameters, declare};
use super::special::{erfc, ln_factorial};
use crate::Result;

pub(super) const MODEL: Model = Model {
    name: "he",
    summary: "wave optics of a rough conductor: a coherent mirror and an incoherent lobe",
    source: "He, Torrance, Sillion and Greenberg 1991",
    build,
};

/// Lengths in µm.
struct He {
    /// Root mean square height.
    sigma: f64,
    /// Correlation length.
    tau: f64,
    /// Wavelength.
    lambda: f64,
    eta: f64,
    kappa: f64,
    ks: f64,
    kd: f64,
}

fn build(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let sigma = declare("sigma", "root mean square height of the surface, µm");
    let tau = declare("tau", "correlation length of the surface, µm");
    let lambda = declare("lambda", "wavelength, nm");
    let eta = declare(
        "nreal",
        "real part of the refractive index; copper's by default",
    );
    let kappa = declare("nimag", "imaginary part of the refractive index");
    let ks = declare("ks", "weight of the mirror and the lobe");
    Ok(Arc::new(He {
        sigma: parameters.number(sigma, 0.0..=10.0, 0.4)?,
        tau: parameters.number(tau, 0.01..=1000.0, 2.4)?,
        lambda: 1e-3 * parameters.number(lambda, 100.0..=100_000.0, 577.0)?,
        eta: parameters.number(eta, 0.01..=100.0, 0.617)?,
        kappa: parameters.number(kappa, -100.0..=100.0, 2.63)?,
        ks: parameters.number(ks, 0.0..=1.0, 1.0)?,
        kd: parameters.number(declare("kd", "weight of the diffuse part"), 0.0..=1.0, 0.0)?,
    }))
}

/// The x ≥ 0 of x·e^(x²/2) = y, by eight of Newton's steps.
fn solve_height(y: f64) -> f64 {
    let mut x = if y <= 1.0 { y } else { (2.0 * y.ln()).sqrt() };
    for _ in 0..8 {
        x -= (x - y * (-0.5 * x * x).exp()) / (1.0 + x * x);
    }
    x
}

/// Σ over m ≥ 1 of g^m·e^(−g)/m! · exp(−v/m)/m: Poisson's probabilities by their ratios, from the largest one outwards, so
/// that none underflows that counts.
fn sum_orders(g: f64, v: f64) -> f64 {
    // Probabilities further than eight standard deviations from the mean g add less than 10⁻¹³.
    let reach = 8.0 * g.sqrt() + 30.0;
    let mode = g.floor().max(1.0);
    let at_mode = (mode * g.ln() - g - ln_factorial(mode as u32)).exp();
    let mut sum = 0.0;
    let (mut m, mut probability) = (mode, at_mode);
    while m <= mode + reach {
        sum += probability * (-v / m).exp() / m;
        m += 1.0;
        probability *= g / m;
    }
    (m, probability) = (mode, at_mode);
    while m > 1.0 && m >= mode - reach {
        probability *= m / g;
        m -= 1.0;
        sum += probability * (-v / m).exp() / m;
    }
    sum
}

impl He {
    /// c = τ·cotθ/(2σ), infinite for a smooth surface.
    fn slope_ratio(&self, w: DVec3) -> f64 {
        self.tau * w.z / (2.0 * self.sigma * w.x.hypot(w.y))
    }

    /// S1 = (1 − ½·erfc c)/(1 + Λ), Λ = ½(e^(−c²)/(√π·c) − erfc c): the fraction of the surface that a direction sees.
    fn visibility(&self, w: DVec3) -> f64 {
        let c = self.slope_ratio(w);
        let tail = erfc(c);
        // Where c is so small that its reciprocal overflows, nothing is seen.
        let lambda = 0.5 * ((-c * c).exp() / (PI.sqrt() * c) - tail);
        (1.0 - 0.5 * tail) / (1.0 + lambda)
    }

    /// K = tanθ·erfc c, 0 along the normal.
    fn shadow_slope(&self, w: DVec3) -> f64 {
        w.x.hypot(w.y) / w.z * erfc(self.slope_ratio(w))
    }

    /// g = (2πσe(cosθo + cosθi)/λ)², with σe the height of the part of the surface that is seen: σe = σ/√(1 + x²),
    /// x·e^(x²/2) = (K(u) + K(v))/√(8π).
    fn phase_variance(&self, wo: DVec3, wi: DVec3) -> f64 {
        let x = solve_height((self.shadow_slope(wo) + self.shadow_slope(wi)) / (8.0 * PI).sqrt());
        let seen = self.sigma / (1.0 + x * x).sqrt();
        (2.0 * PI * seen * (wo.z + wi.z) / self.lambda).powi(2)
    }

    /// The incoherent lobe, F·G·S1(u)·S1(v)·D/(π·cosθo·cosθi).
    fn lobe(&self, pair: &UpperPair) -> f64 {
        let g = self.phase_variance(pair.wo, pair.wi);
        if g == 0.0 {
            return 0.0;
        }
        // D = π²τ²/(4λ²)·Σ, with the phase across the surface vxy² = (2π/λ)²·|u_xy + v_xy|².
        let across = (pair.wo + pair.wi).truncate().length_squared();
        let v = (PI * self.tau / self.lambda).powi(2) * across;
        let scale = (0.5 * PI * self.tau / self.lambda).powi(2);
        let density = scale * sum_orders(g, v);
        // G = ((2 + 2u·v)/(cosθo + cosθi))², where 2 + 2u·v = 4(u·h)².
        let geometry = (4.0 * pair.cos_d * pair.cos_d / (pair.cos_o + pair.cos_i)).powi(2);
        let fresnel = conductor(self.eta, self.kappa, pair.cos_d);
        let seen = self.visibility(pair.wo) * self.visibility(pair.wi);
        fresnel * geometry * seen * density / (PI * pair.cos_o * pair.cos_i)
    }
}

impl Formula for He {
    fn value(&self, pair: &UpperPair, rgb: DVec3) -> DVec3 {
        rgb * (self.ks * self.lobe(pair) + self.kd * FRAC_1_PI)
    }

    /// The coherent part, F·e^(−g)·S1(u)·S1(v).
    fn mirror(&self, cos_o: f64, rgb: DVec3) -> Option<DVec3> {
        let sine = (1.0 - cos_o * cos_o).max(0.0).sqrt();
        let wo = DVec3::new(sine, 0.0, cos_o);
        let coherent = (-self.phase_variance(wo, wo)).exp() * self.visibility(wo).powi(2);
        Some(rgb * (self.ks * conductor(self.eta, self.kappa, cos_o) * coherent))
    }

    fn properties(&self) -> Properties {
        Properties {
            bounded: self.sigma == 0.0 || self.ks == 0.0,
            ..Properties::PLAIN
        }
    }
}
