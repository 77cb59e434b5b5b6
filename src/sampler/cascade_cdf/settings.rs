//! Settings of the cascade CDF.

use super::{CascadeCdf, ThetaSpacing};
use crate::brdf::Importance;
use crate::sampler::settings::{floor, importance, table_choice};
use crate::sampler::{Field, Preset, Settings, TableChoice};
use crate::{Error, Result};

/// Settings of the cascade CDF.
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
    /// What serves a `wo` between two tables.
    pub choice: TableChoice,
    /// Share of draws that ignore the tables and follow the cosine, so that no direction is left out; 0 to 1.
    pub floor: f64,
    /// The scalar that draws are proportional to.
    pub importance: Importance,
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
        }
    }
}

impl CascadeCdfSettings {
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

/// Cells over one angle.
const CELLS: std::ops::RangeInclusive<usize> = 1..=8192;

impl Settings for CascadeCdfSettings {
    type Method = CascadeCdf;

    fn fields() -> Vec<Field<Self>> {
        vec![
            Field::count(
                "tables",
                1..=4096,
                "tables over the polar angle of wo",
                |s| s.tables,
                |s, value| s.tables = value,
            ),
            Field::form(
                "cells",
                "cells over θh x cells over φh, each 1 to 8192, such as 1024x512",
                "cells before compression",
                |s: &Self| format!("{}x{}", s.theta_h, s.phi_h),
                |s, text| match parse_cells(text) {
                    Some([theta_h, phi_h]) => {
                        (s.theta_h, s.phi_h) = (theta_h, phi_h);
                        true
                    }
                    None => false,
                },
            ),
            Field::optional_real(
                "tolerance",
                "none",
                0.0..,
                "largest error of a compressed CDF, in probability; none stores every knot",
                |s| s.tolerance,
                |s, value| s.tolerance = value,
            ),
            Field::choice(
                "spacing",
                &[
                    ("merl", ThetaSpacing::Merl),
                    ("uniform", ThetaSpacing::Uniform),
                ],
                "spacing of cells over θh, by its root as MERL's bins, or uniform",
                |s| s.spacing,
                |s, value| s.spacing = value,
            ),
            table_choice(|s: &Self| s.choice, |s, value| s.choice = value),
            floor(|s: &Self| s.floor, |s, value| s.floor = value),
            importance(|s: &Self| s.importance, |s, value| s.importance = value),
        ]
    }

    fn presets() -> Vec<Preset<Self>> {
        vec![
            Preset::new("uniform", "every knot of 256x32 cells", Self::uniform()),
            Preset::new(
                "published",
                "the compressed settings of the 2008 thesis, with the flaws that `merlkit check` shows",
                Self::as_published(true),
            ),
            Preset::new(
                "published-uniform",
                "the settings of the 2008 thesis with every knot of 256x32 cells",
                Self::as_published(false),
            ),
        ]
    }

    /// Knots are numbered in 32 bits, and without compression there is one at every edge of a cell.
    fn check_together(&self) -> Result<()> {
        let knots = self
            .tables
            .saturating_mul((self.theta_h + 1) * (self.phi_h + 2));
        if u32::try_from(knots).is_err() {
            return Err(Error::argument(
                format!(
                    "{} tables of {} × {} cells",
                    self.tables, self.theta_h, self.phi_h
                ),
                "choose fewer: at most 4·10⁹ cells in all",
            ));
        }
        Ok(())
    }
}

/// "1024x512" as numbers of cells within their domain.
fn parse_cells(text: &str) -> Option<[usize; 2]> {
    let (theta_h, phi_h) = text.split_once(['x', 'X', '×'])?;
    let cells = [theta_h.parse().ok()?, phi_h.parse().ok()?];
    cells.iter().all(|n| CELLS.contains(n)).then_some(cells)
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
