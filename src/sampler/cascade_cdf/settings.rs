//! Settings of the cascade CDF.

use super::axis::ThetaSpacing;
use crate::brdf::Importance;
use crate::sampler::TableChoice;

/// Settings of the cascade CDF.
///
/// The example of [`SamplerSpec`](crate::sampler::SamplerSpec) reads settings from text and lists them.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CascadeCdfSettings {
    /// Tables over the polar angle of `wo`, 1 to 4096.
    pub tables: usize,
    /// Cells over θh, 1 to 8192.
    pub theta_h: usize,
    /// Cells over φh, 1 to 8192.
    pub phi_h: usize,
    /// How cells are spaced over θh.
    pub spacing: ThetaSpacing,
    /// Largest error of a compressed curve, in probability; `None` stores every knot.
    #[serde(with = "tolerance_json")]
    pub tolerance: Option<f64>,
    /// What is used for a `wo` between two tables.
    pub choice: TableChoice,
    /// Fraction of draws that ignore the tables and follow the cosine, so that no direction is left out; 0 to 1.
    pub floor: f64,
    /// The scalar that draws are proportional to.
    pub importance: Importance,
    /// Azimuths of `wo` that have tables, 2 to 256, equally spaced over those that the material's symmetry leaves; `None` for
    /// isotropic materials, which need one azimuth only, and for 8 of anisotropic ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub azimuths: Option<usize>,
}

impl Default for CascadeCdfSettings {
    fn default() -> Self {
        Self {
            tables: 16,
            theta_h: 1024,
            phi_h: 512,
            spacing: ThetaSpacing::Merl,
            tolerance: Some(1e-3),
            choice: TableChoice::Mixture,
            floor: 1e-3,
            importance: Importance::Mean,
            azimuths: None,
        }
    }
}

impl CascadeCdfSettings {
    /// Tables over both angles of `wo`.
    pub(super) fn count(&self) -> usize {
        self.tables.saturating_mul(self.azimuths.unwrap_or(1))
    }

    /// Every knot of 256 × 32 cells a table.
    pub fn uniform() -> Self {
        Self {
            theta_h: 256,
            phi_h: 32,
            tolerance: None,
            ..Self::default()
        }
    }

    /// What the thesis used for its tables 6.23 and 6.24; `compressed` starts from 1024 × 512 cells.
    pub fn as_published(compressed: bool) -> Self {
        let published = Self {
            tables: 32,
            spacing: ThetaSpacing::Uniform,
            choice: TableChoice::Nearest,
            floor: 0.0,
            ..Self::default()
        };
        if compressed {
            published
        } else {
            Self {
                theta_h: 256,
                phi_h: 32,
                tolerance: None,
                ..published
            }
        }
    }
}

/// A tolerance in JSON, which has no infinity: a number, "inf" or null.
mod tolerance_json {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    const INFINITE: &str = "inf";

    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Tolerance {
        Number(f64),
        Word(String),
    }

    pub(super) fn serialize<S: Serializer>(
        tolerance: &Option<f64>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        match tolerance {
            Some(error) if error.is_infinite() => INFINITE.serialize(serializer),
            other => other.serialize(serializer),
        }
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<f64>, D::Error> {
        match Option::<Tolerance>::deserialize(deserializer)? {
            None => Ok(None),
            Some(Tolerance::Number(error)) => Ok(Some(error)),
            Some(Tolerance::Word(word)) if word == INFINITE => Ok(Some(f64::INFINITY)),
            Some(Tolerance::Word(word)) => Err(serde::de::Error::custom(format!(
                "no tolerance is {word:?}"
            ))),
        }
    }
}
