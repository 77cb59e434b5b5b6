//! Oren and Nayar's rough diffuse surface, with interreflection.

use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

use glam::DVec3;

use super::model::{Formula, Model, Properties};
use super::pair::UpperPair;
use super::parameters::{Parameters, declare};
use crate::Result;

pub(super) const MODEL: Model = Model {
    name: "oren",
    summary: "a rough diffuse surface of V-shaped grooves, in full",
    source: "Oren and Nayar 1994",
    build,
};

struct OrenNayar {
    s: f64,
    r: f64,
}

fn build(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let s = declare(
        "s",
        "standard deviation of the grooves' angle, radians; 0 is diffuse",
    );
    let r = declare("r", "reflectance of the grooves' walls");
    Ok(Arc::new(OrenNayar {
        s: parameters.number(s, 0.0..=1.57, 0.57)?,
        r: parameters.number(r, 0.0..=1.0, 0.83)?,
    }))
}

impl OrenNayar {
    /// The direct part, r/π·(C1 + cosΔφ·C2·tan b + (1 − |cosΔφ|)·C3·tan((a+b)/2)), a and b being the larger and the smaller
    /// of the two angles.
    fn direct(&self, [a, b]: [f64; 2], cos_azimuth: f64) -> f64 {
        let s2 = self.s * self.s;
        let c1 = 1.0 - 0.5 * s2 / (s2 + 0.33);
        let mut sine = a.sin();
        if cos_azimuth < 0.0 {
            sine -= (2.0 * b / PI).powi(3);
        }
        let c2 = 0.45 * s2 / (s2 + 0.09) * sine;
        let c3 = 0.125 * s2 / (s2 + 0.09) * (4.0 * a * b / (PI * PI)).powi(2);
        let across = (1.0 - cos_azimuth.abs()) * c3 * (0.5 * (a + b)).tan();
        c1 + cos_azimuth * c2 * b.tan() + across
    }
}

impl Formula for OrenNayar {
    fn value(&self, pair: &UpperPair, rgb: DVec3) -> DVec3 {
        let [o, i] = [pair.wo, pair.wi].map(|w| w.x.hypot(w.y).atan2(w.z));
        let angles = [o.max(i), o.min(i)];
        let cos_azimuth = pair.cos_azimuth();
        let direct = self.r * FRAC_1_PI * self.direct(angles, cos_azimuth);
        // Light that two walls of a groove reflect.
        let s2 = self.s * self.s;
        let scale = 0.17 * self.r * self.r * FRAC_1_PI * s2 / (s2 + 0.13);
        let twice = scale * (1.0 - cos_azimuth * (2.0 * angles[1] / PI).powi(2));
        // The direct part falls below 0 where both directions graze on opposite sides.
        rgb * (direct + twice).max(0.0)
    }

    /// The tangents grow without bound where both directions graze.
    fn properties(&self) -> Properties {
        let lambertian = self.s == 0.0;
        Properties {
            bounded: lambertian,
            albedo_bound: lambertian.then_some(self.r),
            ..Properties::PLAIN
        }
    }
}
