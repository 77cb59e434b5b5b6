//! Analytic lobes whose parameters are fitted to the material: what a renderer uses that has no tables.
//!
//! Each is mixed with a share of cosine, of at least [`LEAST_DIFFUSE`]: a lobe alone has densities of 0, or so near to 0 that
//! the variance of weights is infinite, where measured materials still reflect. The density is that of the mixture (one-sample
//! MIS with the balance heuristic; Veach 1997, 9.2.4). Draws that end below the horizon fail.

mod fit;
mod shape;

pub(super) use fit::Nodes;

use std::f64::consts::FRAC_1_PI;

use glam::{DVec2, Vec2, Vec3};

use super::knots::split_unit;
use super::{DirectionSample, DirectionSampler, with_density};
use crate::brdf::{Brdf, Importance};
use crate::geometry::{cosine_hemisphere, unit_upper};
use crate::{Error, Result};

/// Which lobe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LobeKind {
    /// (n+1)/2π·cosⁿα about the mirror direction, over its half space (thesis 5.2.1, "hemisphere").
    CosineLobe,
    /// (n+1)/4π·((1+cosα)/2)ⁿ about the mirror direction, over the whole sphere (thesis 5.2.1, "sphere").
    CosineLobeSphere,
    /// Half vectors of density (n+1)/2π·cosⁿθh (Blinn 1977; thesis 5.2.2.1).
    Blinn,
    /// Half vectors whose slope is Gaussian: exp(−tan²θh/α²)/(πα²cos³θh) (Ward 1992, Walter 2005; thesis 5.2.2.2).
    Ward,
    /// Half vectors of density √((ex+1)(ey+1))/2π·cosθh^(ex·cos²φh + ey·sin²φh), with φh from the plane of incidence
    /// (Ashikhmin and Shirley 2000; thesis 5.4).
    AshikhminShirley,
    /// Normals of the GGX distribution visible from `wo` (Walter 2007, Heitz 2018), drawn by spherical caps (Dupuy and
    /// Benyoub 2023).
    Ggx,
}

impl LobeKind {
    /// All of them, in the order of the thesis.
    pub const ALL: [Self; 6] = [
        Self::CosineLobe,
        Self::CosineLobeSphere,
        Self::Blinn,
        Self::Ward,
        Self::AshikhminShirley,
        Self::Ggx,
    ];

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::CosineLobe => "cosine-lobe",
            Self::CosineLobeSphere => "cosine-lobe-sphere",
            Self::Blinn => "blinn",
            Self::Ward => "ward",
            Self::AshikhminShirley => "ashikhmin-shirley",
            Self::Ggx => "ggx",
        }
    }

    /// Domain of the shape: exponents, or for Ward and GGX roughness.
    pub fn domain(self) -> [f32; 2] {
        match self {
            Self::Ward | Self::Ggx => [1e-4, 2.0],
            Self::CosineLobe | Self::CosineLobeSphere | Self::Blinn | Self::AshikhminShirley => {
                [0.1, 1e7]
            }
        }
    }
}

/// Least share of draws that follow the cosine.
pub const LEAST_DIFFUSE: f32 = 1e-3;

/// The numbers that a lobe is fitted by.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct LobeParameters {
    /// Exponent or roughness, along the plane of incidence, within [`LobeKind::domain`].
    pub along: f32,
    /// The same across that plane. Only Ashikhmin and Shirley's lobe tells them apart; for all others it equals `along`.
    pub across: f32,
    /// Share of draws that follow the cosine, [`LEAST_DIFFUSE`] to 1.
    pub diffuse: f32,
}

/// Settings of [`Lobe::build`].
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct LobeSettings {
    /// Which lobe.
    pub kind: LobeKind,
    /// Its parameters; `None` fits them to the material.
    pub parameters: Option<LobeParameters>,
    /// The scalar whose weights the fit makes even.
    pub importance: Importance,
}

impl LobeSettings {
    /// A lobe to be fitted.
    pub fn fitted(kind: LobeKind) -> Self {
        Self {
            kind,
            parameters: None,
            importance: Importance::default(),
        }
    }
}

/// A lobe and its share of cosine.
#[derive(Clone, Debug)]
pub struct Lobe {
    settings: LobeSettings,
    kind: LobeKind,
    parameters: LobeParameters,
}

impl Lobe {
    /// The lobe with the parameters given, or else those that make the weights f_r·cosθ/pdf most even: the least mean over
    /// six angles of `wo` of ln(E\[w²\]/E\[w\]²), by quadrature. A black material is given
    /// the cosine alone.
    ///
    /// # Errors
    /// [`Error::Argument`] for parameters outside their domains.
    pub fn build(brdf: &dyn Brdf, settings: LobeSettings) -> Result<Self> {
        let parameters = match settings.parameters {
            Some(given) => given,
            None => fit::fit(settings.kind, &Nodes::of(brdf, settings.importance)),
        };
        Self::with(settings, parameters)
    }

    /// The lobe with these parameters, whatever the settings say.
    ///
    /// # Errors
    /// [`Error::Argument`] for parameters outside their domains.
    pub(super) fn with(settings: LobeSettings, parameters: LobeParameters) -> Result<Self> {
        let (
            kind,
            LobeParameters {
                along,
                across,
                diffuse,
            },
        ) = (settings.kind, parameters);
        let [low, high] = kind.domain();
        let inside = |v: f32| (low..=high).contains(&v);
        if !inside(along) || !inside(across) || !(LEAST_DIFFUSE..=1.0).contains(&diffuse) {
            return Err(Error::argument(
                format!(
                    "{} with parameters {along}, {across} and {diffuse}",
                    kind.name()
                ),
                format!(
                    "choose shapes from {low} to {high} and a diffuse share from {LEAST_DIFFUSE} to 1"
                ),
            ));
        }
        if along != across && kind != LobeKind::AshikhminShirley {
            return Err(Error::argument(
                format!("{} with shapes {along} and {across}", kind.name()),
                "give the same shape along and across the plane of incidence",
            ));
        }
        let settings = LobeSettings {
            parameters: Some(parameters),
            ..settings
        };
        Ok(Self {
            settings,
            kind,
            parameters,
        })
    }

    /// The settings it was built with, and the parameters fitted.
    pub fn settings(&self) -> &LobeSettings {
        &self.settings
    }

    /// The parameters drawn with.
    pub fn parameters(&self) -> &LobeParameters {
        &self.parameters
    }
}

/// Density of the mixture at `wi`, both unit and above the horizon.
#[inline]
fn density(kind: LobeKind, parameters: &LobeParameters, wo: Vec3, wi: Vec3) -> f64 {
    let diffuse = f64::from(parameters.diffuse);
    let shape = [parameters.along, parameters.across].map(f64::from);
    let lobe = shape::density(kind, shape, wo.as_dvec3(), wi.as_dvec3());
    (1.0 - diffuse) * lobe + diffuse * f64::from(wi.z) * FRAC_1_PI
}

impl DirectionSampler for Lobe {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        let wo = unit_upper(wo)?;
        let LobeParameters {
            along,
            across,
            diffuse,
        } = self.parameters;
        let (cosine, x) = split_unit(f64::from(u.x), f64::from(diffuse));
        let point = DVec2::new(x, f64::from(u.y));
        let wi = if cosine {
            cosine_hemisphere(point)
        } else {
            shape::draw(
                self.kind,
                [along, across].map(f64::from),
                wo.as_dvec3(),
                point,
            )
        }
        .as_vec3();
        with_density(self, wo, wi)
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let (Some(wo), Some(wi)) = (unit_upper(wo), unit_upper(wi)) else {
            return 0.0;
        };
        density(self.kind, &self.parameters, wo, wi).min(f64::from(f32::MAX)) as f32
    }

    fn bytes(&self) -> usize {
        size_of::<LobeParameters>()
    }
}
