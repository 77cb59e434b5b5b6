//! Strauss's model for artists: smoothness and metalness.

use std::f64::consts::{FRAC_1_PI, FRAC_2_PI, PI};
use std::sync::Arc;

use glam::DVec3;

use super::model::{Formula, Model, Properties};
use super::pair::UpperPair;
use super::parameters::{Parameters, declare};
use crate::Result;

pub(super) const MODEL: Model = Model {
    name: "strauss",
    summary: "smoothness and metalness, where a metal's highlight takes its colour",
    source: "Strauss 1990",
    build,
};

struct Strauss {
    s: f64,
    m: f64,
    ks: f64,
    kd: f64,
    printed: bool,
}

fn build(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let s = declare("s", "smoothness; 1 is a mirror");
    let m = declare(
        "m",
        "metalness: whether the highlight has the model's colour",
    );
    Ok(Arc::new(Strauss {
        s: parameters.number(s, 0.0..=1.0, 0.81)?,
        m: parameters.number(m, 0.0..=1.0, 0.26)?,
        ks: parameters.number(declare("ks", "weight of the lobe"), 0.0..=1.0, 0.5)?,
        kd: parameters.number(declare("kd", "weight of the diffuse part"), 0.0..=1.0, 0.5)?,
        printed: parameters.is_printed()?,
    }))
}

/// F(x) = (1/(x−1.12)² − 1/1.12²)/(1/0.12² − 1/1.12²): rises from 0 to 1.
fn fresnel_fit(x: f64) -> f64 {
    let lowest = 1.12f64.powi(-2);
    ((x - 1.12).powi(-2) - lowest) / (0.12f64.powi(-2) - lowest)
}

/// G(x) = (1/0.01² − 1/(x−1.01)²)/(1/0.01² − 1/1.01²): falls from 1 to 0.
fn shadowing_fit(x: f64) -> f64 {
    let highest = 0.01f64.powi(-2);
    (highest - (x - 1.01).powi(-2)) / (highest - 1.01f64.powi(-2))
}

impl Strauss {
    /// What F and G are functions of: the angle over 90°. The thesis says that it is the cosine.
    fn abscissa(&self, cosine: f64) -> f64 {
        if self.printed {
            cosine
        } else {
            FRAC_2_PI * cosine.min(1.0).acos()
        }
    }

    /// rj·Cs: rj = min(1, rn + (rn + 0.1)j), rn = 1 − rd, j = F·G·G, Cs = 1 + m(1−F)(C−1).
    /// Strauss takes F of the light's angle, which is why the formula is not reciprocal.
    fn highlight(&self, [cos_o, cos_i]: [f64; 2], rgb: DVec3) -> DVec3 {
        let fresnel = fresnel_fit(self.abscissa(cos_i));
        let [g, h] = [cos_o, cos_i].map(|c| shadowing_fit(self.abscissa(c)));
        let rn = self.s.powi(3);
        let rj = (rn + (rn + 0.1) * fresnel * g * h).min(1.0);
        rj * (DVec3::ONE + self.m * (1.0 - fresnel) * (rgb - 1.0))
    }

    /// The diffuse factor d·rd, d = 1 − ms, rd = 1 − s³.
    fn diffuse(&self) -> f64 {
        self.kd * (1.0 - self.m * self.s) * (1.0 - self.s.powi(3))
    }

    /// The exponent of the lobe, 3/(1−s); infinite for a mirror.
    fn exponent(&self) -> f64 {
        3.0 / (1.0 - self.s)
    }
}

impl Formula for Strauss {
    fn value(&self, pair: &UpperPair, rgb: DVec3) -> DVec3 {
        let shading = if self.printed { pair.cos_o } else { FRAC_1_PI };
        let diffuse = self.diffuse() * shading * rgb;
        if self.s == 1.0 {
            return diffuse;
        }
        let highlight = self.highlight([pair.cos_o, pair.cos_i], rgb);
        diffuse + self.ks * pair.cos_mirror_power(self.exponent()) * highlight
    }

    /// At smoothness 1 the lobe is the mirror direction alone.
    fn mirror(&self, cos_o: f64, rgb: DVec3) -> Option<DVec3> {
        let highlight = self.highlight([cos_o; 2], rgb);
        (self.s == 1.0).then_some(self.ks * highlight)
    }

    /// The lobe reflects at most ∫ cosⁿα dσ over α, 2π/(n+1) — 2π/(n+2) along the normal.
    fn properties(&self) -> Properties {
        let lobe = if self.s == 1.0 {
            self.ks
        } else {
            self.ks * 2.0 * PI / (self.exponent() + 2.0)
        };
        let diffuse = if self.printed { PI } else { 1.0 };
        Properties {
            reciprocal: self.ks == 0.0 && !self.printed || self.s == 1.0,
            albedo_bound: Some(self.diffuse() * diffuse + lobe),
            ..Properties::PLAIN
        }
    }
}
