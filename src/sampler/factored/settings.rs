//! Settings of the factored BRDF.

use crate::brdf::Importance;

/// How many factors there are, and over what.
///
/// See [`SamplerSpec`](crate::sampler::SamplerSpec) for an example that builds a sampler.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Factors {
    /// Products of a function of `wo` and one of w (J), 1 to 64.
    pub outer: usize,
    /// Products of a function of θw and one of φw in each (K), 1 to 64.
    pub inner: usize,
    /// Cells over θw, 2 to 1024, spaced by its root.
    pub theta: usize,
    /// Cells over φw, 2 to 1024.
    pub phi: usize,
    /// Whether w is the half vector, or else `wi` itself.
    pub half: bool,
    /// Fraction of draws that follow the cosine, so that no direction is left out; 0 to 1.
    pub floor: f64,
}

impl Factors {
    /// Terms of the sum.
    pub fn terms(&self) -> usize {
        self.outer * self.inner
    }
}

/// Settings of the factored BRDF.
///
/// The example of [`SamplerSpec`](crate::sampler::SamplerSpec) reads settings from text and lists them.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FactoredSettings {
    /// Tables over the polar angle of `wo`, 1 to 256.
    pub tables: usize,
    /// The factors; `None` chooses those that make the weights of the material most even.
    pub factors: Option<Factors>,
    /// The scalar that draws are proportional to.
    pub importance: Importance,
    /// Azimuths of `wo` that have tables, 2 to 256, equally spaced over those that the material's symmetry leaves; `None` for
    /// isotropic materials, which need one azimuth only, and for 8 of anisotropic ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub azimuths: Option<usize>,
}

impl FactoredSettings {
    /// Tables over both angles of `wo`.
    pub(super) fn count(&self) -> usize {
        self.tables.saturating_mul(self.azimuths.unwrap_or(1))
    }
}

impl Default for FactoredSettings {
    fn default() -> Self {
        Self {
            tables: 32,
            factors: None,
            importance: Importance::Mean,
            azimuths: None,
        }
    }
}
