//! Microfacets as today's renderers have them: GGX with Smith's masking, of a conductor, and of a coat over a diffuse base.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::DVec3;

use super::fresnel::{dielectric, diffuse_dielectric, exact_conductor};
use super::model::{Formula, Model, Properties};
use super::pair::UpperPair;
use super::parameters::{Parameters, declare};
use crate::Result;

pub(super) const MODEL: Model = Model {
    name: "ggx",
    summary: "GGX microfacets of a conductor, anisotropic",
    source: "Walter et al. 2007; Heitz 2014",
    build: build_metal,
};

pub(super) const COATED: Model = Model {
    name: "coated",
    summary: "a dielectric coat of GGX microfacets over a diffuse base",
    source: "Walter et al. 2007; Jakob 2010",
    build: build_coated,
};

/// GGX's ellipsoid of facets: its roughness along x and y.
#[derive(Clone, Copy)]
pub(super) struct Facets {
    pub(super) ax: f64,
    pub(super) ay: f64,
}

struct Metal {
    facets: Facets,
    eta: f64,
    kappa: f64,
}

struct Coated {
    facets: Facets,
    eta: f64,
    kd: f64,
    /// Reflectance of the coat for diffuse light from inside.
    inside: f64,
}

fn build_metal(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let eta = declare(
        "nreal",
        "real part of the refractive index; copper's by default",
    );
    let kappa = declare("nimag", "imaginary part of the refractive index");
    Ok(Arc::new(Metal {
        facets: read_facets(parameters)?,
        eta: parameters.number(eta, 0.01..=100.0, 0.617)?,
        kappa: parameters.number(kappa, -100.0..=100.0, 2.63)?,
    }))
}

fn build_coated(parameters: &mut Parameters) -> Result<Arc<dyn Formula>> {
    let facets = read_facets(parameters)?;
    let eta = declare("eta", "refractive index of the coat");
    let eta = parameters.number(eta, 1.0..=10.0, 1.5)?;
    let kd = declare("kd", "reflectance of the base, of which rgb is the colour");
    let kd = parameters.number(kd, 0.0..=1.0, 0.5)?;
    // What leaves a base of reflectance 1 again must be what entered it: 1 − inside = (1 − outside)/η².
    let inside = 1.0 - (1.0 - diffuse_dielectric(eta)) / (eta * eta);
    Ok(Arc::new(Coated {
        facets,
        eta,
        kd,
        inside,
    }))
}

fn read_facets(parameters: &mut Parameters) -> Result<Facets> {
    Ok(Facets {
        ax: parameters.number(declare("ax|alphax", "roughness along x"), 1e-3..=1.0, 0.2)?,
        ay: parameters.number(declare("ay|alphay", "roughness along y"), 1e-3..=1.0, 0.2)?,
    })
}

impl Facets {
    /// D = 1/(π·ax·ay·(hx²/ax² + hy²/ay² + hz²)²).
    pub(super) fn density(self, h: DVec3) -> f64 {
        let scaled = (h / DVec3::new(self.ax, self.ay, 1.0)).length_squared();
        1.0 / (PI * self.ax * self.ay * scaled * scaled)
    }

    /// √(ax²·wx² + ay²·wy² + wz²), of which Smith's masking is made.
    pub(super) fn projected(self, w: DVec3) -> f64 {
        (w * DVec3::new(self.ax, self.ay, 1.0)).length()
    }

    /// D·G/(4·cosθo·cosθi) with Smith's masking of correlated heights: G/(4·cosθo·cosθi) = ½/(cosθi·|o| + cosθo·|i|), |w| being
    /// [`Self::projected`].
    fn lobe(self, pair: &UpperPair) -> f64 {
        let (o, i) = (self.projected(pair.wo), self.projected(pair.wi));
        self.density(pair.h) * 0.5 / (pair.cos_i * o + pair.cos_o * i)
    }

    fn properties(self) -> Properties {
        Properties {
            bounded: false,
            symmetry: Properties::axes(self.ax == self.ay),
            ..Properties::PLAIN
        }
    }
}

impl Formula for Metal {
    fn value(&self, pair: &UpperPair, rgb: DVec3) -> DVec3 {
        rgb * (exact_conductor(self.eta, self.kappa, pair.cos_d) * self.facets.lobe(pair))
    }

    fn properties(&self) -> Properties {
        Properties {
            albedo_bound: Some(1.0),
            ..self.facets.properties()
        }
    }
}

impl Formula for Coated {
    /// F·D·G/(4·cosθo·cosθi) + (1−F(cosθo))(1−F(cosθi))·R/(π·η²·(1−R·F_inside)), R = kd·rgb. The base sees a smooth coat.
    fn value(&self, pair: &UpperPair, rgb: DVec3) -> DVec3 {
        let coat = dielectric(self.eta, pair.cos_d) * self.facets.lobe(pair);
        let [o, i] = [pair.cos_o, pair.cos_i].map(|c| 1.0 - dielectric(self.eta, c));
        let base = self.kd * rgb;
        let diffuse = base / (1.0 - self.inside * base) * (o * i / (PI * self.eta * self.eta));
        diffuse + DVec3::splat(coat)
    }

    fn properties(&self) -> Properties {
        self.facets.properties()
    }
}
