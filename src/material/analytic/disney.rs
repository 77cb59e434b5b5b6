//! The base of Disney's principled model: diffuse, metal, specular and sheen.

use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

use glam::DVec3;

use super::ggx::Facets;
use super::model::{Formula, Model, Properties};
use super::pair::{UpperPair, schlick_weight};
use super::parameters::{Parameters, declare};
use crate::Result;

pub(super) const MODEL: Model = Model {
    name: "disney",
    summary: "the base of Disney's principled model, of which rgb is the base colour",
    source: "Burley 2012, with the masking of Burley 2015",
    build,
};

struct Disney {
    facets: Facets,
    roughness: f64,
    anisotropic: f64,
    metallic: f64,
    specular: f64,
    specular_tint: f64,
    sheen: f64,
    sheen_tint: f64,
}

fn build(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let metallic = declare("metallic", "0 is a dielectric, 1 a metal");
    let roughness = declare(
        "roughness",
        "roughness as artists see it; its square is GGX's",
    );
    let anisotropic = declare("anisotropic", "how much longer highlights are along x");
    let specular = declare(
        "specular",
        "reflectance of a dielectric along the normal, over 0.08",
    );
    let specular_tint = declare("speculartint", "how far the base colours the highlight");
    let sheen = declare("sheen", "weight of the sheen of cloth at grazing angles");
    let sheen_tint = declare("sheentint", "how far the base colours the sheen");
    let metallic = parameters.number(metallic, 0.0..=1.0, 0.0)?;
    let roughness = parameters.number(roughness, 0.0..=1.0, 0.5)?;
    let anisotropic = parameters.number(anisotropic, 0.0..=1.0, 0.0)?;
    // ax, ay = roughness² over and times √(1 − 0.9·anisotropic), not below 0.001.
    let aspect = (1.0 - 0.9 * anisotropic).sqrt();
    let square = roughness * roughness;
    Ok(Arc::new(Disney {
        facets: Facets {
            ax: (square / aspect).max(1e-3),
            ay: (square * aspect).max(1e-3),
        },
        roughness,
        anisotropic,
        metallic,
        specular: parameters.number(specular, 0.0..=1.0, 0.5)?,
        specular_tint: parameters.number(specular_tint, 0.0..=1.0, 0.0)?,
        sheen: parameters.number(sheen, 0.0..=1.0, 0.0)?,
        sheen_tint: parameters.number(sheen_tint, 0.0..=1.0, 0.5)?,
    }))
}

/// The colour's hue at luminance 1; white for black.
fn tint(rgb: DVec3) -> DVec3 {
    let luminance = rgb.dot(DVec3::new(0.3, 0.6, 0.1));
    if luminance > 0.0 {
        rgb / luminance
    } else {
        DVec3::ONE
    }
}

impl Disney {
    /// The factor of the diffuse part that retroreflects where the surface is rough: (1 + (F90−1)·wo)(1 + (F90−1)·wi),
    /// F90 = ½ + 2·roughness·(u·h)², with (1−cosθ)⁵ for wo and wi.
    fn diffuse(&self, pair: &UpperPair) -> f64 {
        let excess = 2.0 * self.roughness * pair.cos_d * pair.cos_d - 0.5;
        let [o, i] = [pair.cos_o, pair.cos_i].map(schlick_weight);
        (1.0 + excess * o) * (1.0 + excess * i)
    }

    /// D·G/(4·cosθo·cosθi) with Smith's masking of both directions apart: 1/((cosθo + |o|)(cosθi + |i|)).
    fn lobe(&self, pair: &UpperPair) -> f64 {
        let o = pair.cos_o + self.facets.projected(pair.wo);
        let i = pair.cos_i + self.facets.projected(pair.wi);
        self.facets.density(pair.h) / (o * i)
    }
}

impl Formula for Disney {
    fn value(&self, pair: &UpperPair, rgb: DVec3) -> DVec3 {
        let hue = tint(rgb);
        let fresnel = schlick_weight(pair.cos_d);
        // The highlight's colour along the normal: white or tinted for a dielectric, the base colour for a metal.
        let dielectric = 0.08 * self.specular * DVec3::ONE.lerp(hue, self.specular_tint);
        let along_normal = dielectric.lerp(rgb, self.metallic);
        let highlight = along_normal.lerp(DVec3::ONE, fresnel) * self.lobe(pair);
        let sheen = fresnel * self.sheen * DVec3::ONE.lerp(hue, self.sheen_tint);
        let base = rgb * (FRAC_1_PI * self.diffuse(pair)) + sheen;
        base * (1.0 - self.metallic) + highlight
    }

    fn properties(&self) -> Properties {
        Properties {
            bounded: true,
            symmetry: Properties::axes(self.anisotropic == 0.0 || self.facets.ax == self.facets.ay),
            ..Properties::PLAIN
        }
    }
}
