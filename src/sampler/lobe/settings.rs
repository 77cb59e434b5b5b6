//! Settings of lobes.

use crate::brdf::Importance;

/// Which lobe.
///
/// See [`SamplerSpec`](crate::sampler::SamplerSpec) for an example that builds a sampler.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LobeKind {
    /// (n+1)/2π·cosⁿα about the mirror direction, over its half space: what ends below the horizon is lost (thesis 5.2.1, "sphere").
    CosineLobe,
    /// The same, drawn again until it ends above the horizon, and divided by its mass there (thesis 5.2.1, "hemisphere").
    CosineLobeHemisphere,
    /// (n+1)/4π·((1+cosα)/2)ⁿ about the mirror direction, over the whole sphere.
    CosineLobeSphere,
    /// Half vectors of density (n+1)/2π·cosⁿθh (Blinn 1977; thesis 5.2.2.1).
    Blinn,
    /// Half vectors whose slope is Gaussian: exp(−tan²θh/α²)/(πα²cos³θh) (Ward 1992, Walter 2005; thesis 5.2.2.2), or elliptic
    /// with a roughness along each axis.
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
    pub const ALL: [Self; 7] = [
        Self::CosineLobe,
        Self::CosineLobeHemisphere,
        Self::CosineLobeSphere,
        Self::Blinn,
        Self::Ward,
        Self::AshikhminShirley,
        Self::Ggx,
    ];

    /// The name in the settings' text.
    pub fn name(self) -> &'static str {
        let named = KINDS.iter().find(|kind| kind.1 == self);
        named.map_or("", |kind| kind.0)
    }

    /// Domain of the shape: exponents, or for Ward and GGX roughness.
    pub fn domain(self) -> [f32; 2] {
        match self {
            Self::Ward | Self::Ggx => [1e-4, 2.0],
            // Below 1 the mass above the horizon bends too sharply at the normal for its table.
            Self::CosineLobeHemisphere => [1.0, 1e7],
            Self::CosineLobe | Self::CosineLobeSphere | Self::Blinn | Self::AshikhminShirley => {
                [0.1, 1e7]
            }
        }
    }
}

/// Least fraction of draws that follow the cosine where it is fitted.
///
/// The example of [`SamplerSpec`](crate::sampler::SamplerSpec) reads settings from text and lists them.
pub const LEAST_DIFFUSE: f32 = 1e-3;

/// The numbers that a lobe is fitted by.
///
/// The example of [`SamplerSpec`](crate::sampler::SamplerSpec) reads settings from text and lists them.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct LobeParameters {
    /// Exponent or roughness, along the plane of incidence, within [`LobeKind::domain`].
    pub along: f32,
    /// The same across that plane. Only Ward's lobe and Ashikhmin and Shirley's have both; for all others it equals `along`.
    pub across: f32,
    /// Fraction of draws that follow the cosine: 0 to 1, and at least [`LEAST_DIFFUSE`] where it is fitted.
    pub diffuse: f32,
}

/// Settings of a lobe.
///
/// The example of [`SamplerSpec`](crate::sampler::SamplerSpec) reads settings from text and lists them.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct LobeSettings {
    /// Which lobe.
    pub kind: LobeKind,
    /// Its parameters; `None` fits them to the material.
    pub parameters: Option<LobeParameters>,
    /// The scalar whose weights the fit makes even.
    pub importance: Importance,
    /// Whether shapes are along the surface's x and y instead of along and across the plane of incidence.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub surface_axes: bool,
}

impl LobeSettings {
    /// A lobe to be fitted.
    pub fn fitted(kind: LobeKind) -> Self {
        Self {
            kind,
            parameters: None,
            importance: Importance::default(),
            surface_axes: false,
        }
    }
}

impl Default for LobeSettings {
    fn default() -> Self {
        Self::fitted(LobeKind::Ggx)
    }
}

/// Kinds of lobe by name.
pub(super) const KINDS: &[(&str, LobeKind)] = &[
    ("cosine", LobeKind::CosineLobe),
    ("cosine-hemisphere", LobeKind::CosineLobeHemisphere),
    ("cosine-sphere", LobeKind::CosineLobeSphere),
    ("blinn", LobeKind::Blinn),
    ("ward", LobeKind::Ward),
    ("ashikhmin-shirley", LobeKind::AshikhminShirley),
    ("ggx", LobeKind::Ggx),
];
