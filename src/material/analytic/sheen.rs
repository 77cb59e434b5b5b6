//! The sheen of cloth: fibres that reflect at grazing angles.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec3;

use super::model::{Formula, Model, Properties};
use super::pair::UpperPair;
use super::parameters::{Parameters, declare};
use crate::Result;

pub(super) const MODEL: Model = Model {
    name: "sheen",
    summary: "the sheen of cloth at grazing angles, with nothing below it",
    source: "Estevez and Kulla 2017; Neubelt and Pettineo 2013",
    build,
};

/// ks·(2 + 1/α)·sin^(1/α) θh/(2π) over 4(cosθo + cosθi − cosθo·cosθi).
struct Sheen {
    alpha: f64,
    ks: f64,
}

fn build(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let alpha = declare("alpha", "how far the fibres lean from the normal");
    Ok(Arc::new(Sheen {
        alpha: parameters.number(alpha, 0.01..=1.0, 0.3)?,
        ks: parameters.number(declare("ks", "weight of the sheen"), 0.0..=1.0, 0.5)?,
    }))
}

impl Formula for Sheen {
    fn value(&self, pair: &UpperPair, rgb: DVec3) -> DVec3 {
        let exponent = 1.0 / self.alpha;
        let sin_h = pair.h.x.hypot(pair.h.y).min(1.0);
        let density = (2.0 + exponent) * sin_h.powf(exponent) / TAU;
        let masked = 4.0 * (pair.cos_o + pair.cos_i - pair.cos_o * pair.cos_i);
        rgb * (self.ks * density / masked)
    }

    fn properties(&self) -> Properties {
        Properties {
            bounded: self.ks == 0.0,
            ..Properties::PLAIN
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use glam::Vec3;

    /// At 60° on both sides of the normal, apart by a right angle in azimuth, sin²θh = 0.6: (2 + 2)·0.6/2π over 3.
    #[test]
    fn a_value_by_hand() {
        let (sine, cosine) = 60f32.to_radians().sin_cos();
        let (wo, wi) = (Vec3::new(sine, 0.0, cosine), Vec3::new(0.0, sine, cosine));
        let brdf = parse("sheen:alpha=0.5,ks=1,rgb=1/0.5/0").unwrap().brdf();
        let value = brdf.eval(wo, wi);
        assert!((value.x - 0.127_324).abs() < 1e-6, "{value}");
        assert_eq!(value.y, 0.5 * value.x);
        assert_eq!(brdf.eval(Vec3::Z, Vec3::Z), Vec3::ZERO);
    }
}
