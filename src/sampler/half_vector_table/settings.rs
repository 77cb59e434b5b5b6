//! Settings of half-vector tables.

use super::tables;
use crate::brdf::Importance;
use crate::sampler::azimuth_knots::DEFAULT_AZIMUTHS;

/// Settings of half-vector tables.
///
/// See [`SamplerSpec`](crate::SamplerSpec) for an example that builds a sampler.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct HalfVectorSettings {
    /// Tables over the polar angle of `wo`, dense towards the horizon, 1 to 1024.
    pub tables: usize,
    /// Rows over θh, 2 to 79. They are put where the material asks for them; with 79, every bin of MERL below 44° has its own.
    pub rows: usize,
    /// Segments over the azimuth, each linear, 1 to 256.
    pub segments: usize,
    /// Whether one side of the plane of incidence is stored for both. That halves the size and loses any asymmetry.
    pub fold: bool,
    /// The scalar that draws are proportional to.
    pub importance: Importance,
    /// Azimuths of `wo` that have tables, 2 to 256, equally spaced over those that the material's symmetry leaves; `None`
    /// for isotropic materials, which need one azimuth only, and for 8 of anisotropic ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub azimuths: Option<usize>,
}

impl Default for HalfVectorSettings {
    fn default() -> Self {
        Self::PRESETS[5].1
    }
}

impl HalfVectorSettings {
    /// Settings by the size of their tables, smallest first: name and settings.
    pub const PRESETS: [(&str, Self); 8] = [
        ("2KB", Self::sized(7, 22, 3, true)),
        ("4KB", Self::sized(9, 31, 4, true)),
        ("8KB", Self::sized(14, 41, 4, true)),
        ("16KB", Self::sized(16, 42, 8, false)),
        ("32KB", Self::sized(20, 48, 12, false)),
        ("64KB", Self::sized(28, 53, 16, false)),
        ("256KB", Self::sized(64, 64, 24, false)),
        ("1MB", Self::sized(128, 64, 48, false)),
    ];

    const fn sized(tables: usize, rows: usize, segments: usize, fold: bool) -> Self {
        Self {
            tables,
            rows,
            segments,
            fold,
            importance: Importance::Mean,
            azimuths: None,
        }
    }

    /// Bytes of the tables of one azimuth in memory; a file holds some 7 to 18 % less, and a header.
    pub fn bytes(&self) -> usize {
        tables::bytes(self.tables, self.rows, self.segments)
    }

    /// What is built for anisotropic materials: 8 azimuths unless a number is given, and for the size that these settings are
    /// the preset of, other tables.
    ///
    /// Streaks ask for other tables than lobes: azimuths of half vectors three times as fine, both sides of `wo` told apart,
    /// and for the same bytes fewer polar angles. On a brushed metal of roughness 0.06 by 0.4 that halves the spread of weights.
    #[must_use]
    pub fn for_anisotropic(self) -> Self {
        let plain = Self {
            importance: Importance::Mean,
            azimuths: None,
            ..self
        };
        let table = if Self::PRESETS.iter().any(|preset| preset.1 == plain) {
            self.finer_in_azimuth()
        } else {
            self
        };
        Self {
            azimuths: Some(self.azimuths.unwrap_or(DEFAULT_AZIMUTHS)),
            ..table
        }
    }

    /// About the same bytes with three times the segments, and no fold.
    fn finer_in_azimuth(self) -> Self {
        Self {
            tables: (self.tables * 3).div_ceil(7),
            rows: self.rows * 5 / 6,
            segments: self.segments * 3,
            fold: false,
            ..self
        }
    }
}
