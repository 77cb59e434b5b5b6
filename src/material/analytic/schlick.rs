//! Schlick's model of one or two layers, rational approximations throughout.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::DVec3;

use super::model::{Formula, Model, Properties};
use super::pair::UpperPair;
use super::parameters::{Declaration, Parameters, declare};
use crate::Result;

pub(super) const MODEL: Model = Model {
    name: "schlick",
    summary: "one layer, or two with Ly=T, between diffuse and specular, anisotropic",
    source: "Schlick 1993, 1994",
    build,
};

/// One layer: its reflectance C along the normal, roughness r and isotropy p.
#[derive(Clone, Copy)]
struct Layer {
    c: f64,
    r: f64,
    p: f64,
}

struct Schlick {
    first: Layer,
    second: Option<Layer>,
    printed: bool,
}

/// sin²δ below which h is the normal: its azimuth is rounding alone.
const POLE: f64 = 1e-24;

/// The declarations of a layer's C, r and p.
const FIRST: [Declaration; 3] = [
    declare("SC", "reflectance of the first layer along the normal"),
    declare(
        "Sr",
        "roughness of the first layer: 0 is a mirror, 1 diffuse",
    ),
    declare("Sp", "isotropy of the first layer; 1 is isotropic"),
];
const SECOND: [Declaration; 3] = [
    declare("DC", "reflectance of the second layer along the normal"),
    declare("Dr", "roughness of the second layer"),
    declare("Dp", "isotropy of the second layer"),
];

fn build(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let first = read_layer(parameters, FIRST, [0.24, 0.09, 0.34])?;
    let double = parameters.flag(declare("Ly", "whether there is a second layer"), false)?;
    let second = read_layer(parameters, SECOND, [0.07, 0.67, 0.61])?;
    Ok(Arc::new(Schlick {
        first,
        second: double.then_some(second),
        printed: parameters.is_printed()?,
    }))
}

fn read_layer(
    parameters: &mut Parameters,
    declared: [Declaration; 3],
    defaults: [f64; 3],
) -> Result<Layer> {
    let mut values = defaults;
    for (value, parameter) in values.iter_mut().zip(declared) {
        *value = parameters.number(parameter, 0.0..=1.0, *value)?;
    }
    let [c, r, p] = values;
    Ok(Layer { c, r, p })
}

impl Layer {
    /// S = C + (1−C)(1−x)⁵ of x = u·h; as printed (1−x)¹.
    fn reflectance(self, x: f64, printed: bool) -> f64 {
        let power = if printed { 1 } else { 5 };
        self.c + (1.0 - self.c) * (1.0 - x).clamp(0.0, 1.0).powi(power)
    }

    /// D of the directions, as a sum of a lobe and a diffuse remainder.
    fn density(self, pair: &UpperPair, printed: bool) -> f64 {
        let r = self.r;
        // G(c)/c = 1/(r − rc + c), finite for c > 0. As printed its root.
        let mut g = [pair.cos_o, pair.cos_i].map(|c| 1.0 / (r - r * c + c));
        if printed {
            g = g.map(f64::sqrt);
        }
        let ratio = g[0] * g[1];
        // Z = r/(1 + rt² − t²)², t = n·h, with 1 − t² = sin²δ. As printed its root. At r = 0 it is a delta function.
        let sine2 = pair.h.x * pair.h.x + pair.h.y * pair.h.y;
        let base = sine2 + r * (1.0 - sine2);
        let zenith = match (r == 0.0, printed) {
            (true, _) => 0.0,
            (false, false) => r / (base * base),
            (false, true) => r / base.sqrt(),
        };
        let lobe = ratio * zenith * self.azimuth(pair, sine2, printed) / (4.0 * PI);
        // What the grooves hide is reflected diffusely.
        let hidden = (1.0 - ratio * pair.cos_o * pair.cos_i).max(0.0);
        let remainder = if printed {
            hidden / (4.0 * PI * pair.cos_o * pair.cos_i)
        } else {
            hidden / PI
        };
        lobe + remainder
    }

    /// A = √(p/(p² − p²w² + w²)), w the cosine of h's azimuth, 1 where it has none; as printed the angle itself.
    fn azimuth(self, pair: &UpperPair, sine2: f64, printed: bool) -> f64 {
        let p = self.p;
        let w = match (sine2 > POLE, printed) {
            (false, false) => 1.0,
            (true, false) => (pair.h.x * pair.h.x / sine2).sqrt(),
            (_, true) => pair.h.y.atan2(pair.h.x),
        };
        let square = p * p * (1.0 - w * w) + w * w;
        if square > 0.0 {
            (p / square).sqrt()
        } else {
            0.0
        }
    }
}

impl Formula for Schlick {
    fn value(&self, pair: &UpperPair, rgb: DVec3) -> DVec3 {
        let printed = self.printed;
        let s = self.first.reflectance(pair.cos_d, printed);
        let mut value = s * self.first.density(pair, printed);
        if let Some(second) = self.second {
            // What the first layer lets through; the printed formula takes the second layer's reflectance here.
            let below = second.reflectance(pair.cos_d, printed);
            let through = if printed { 1.0 - below } else { 1.0 - s };
            value += through * below * second.density(pair, printed);
        }
        rgb * value
    }

    /// A layer of roughness 0 is a mirror, which the printed formula draws nowhere.
    fn mirror(&self, cos_o: f64, rgb: DVec3) -> Option<DVec3> {
        if self.printed {
            return None;
        }
        let mut mirror = None;
        let s = self.first.reflectance(cos_o, false);
        if self.first.r == 0.0 {
            mirror = Some(s);
        }
        if let Some(second) = self.second
            && second.r == 0.0
        {
            let below = (1.0 - s) * second.reflectance(cos_o, false);
            mirror = Some(mirror.unwrap_or(0.0) + below);
        }
        mirror.map(|mirror| mirror * rgb)
    }

    fn properties(&self) -> Properties {
        let isotropic = self.first.p == 1.0 && self.second.is_none_or(|second| second.p == 1.0);
        let symmetry = match (isotropic, self.printed) {
            (true, _) => crate::geometry::Symmetry::Isotropic,
            (false, false) => crate::geometry::Symmetry::Quarter,
            // The angle itself has its cut along −x.
            (false, true) => crate::geometry::Symmetry::Whole,
        };
        Properties {
            bounded: !self.printed,
            symmetry,
            ..Properties::PLAIN
        }
    }
}
