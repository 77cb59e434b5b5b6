//! The settings of the cascade CDF as text: keys, domains, presets.

use super::CascadeCdf;
use super::axis::ThetaSpacing;
use super::settings::CascadeCdfSettings;
use crate::sampler::azimuth_knots::azimuths_field;
use crate::sampler::settings::{floor, importance, table_choice};
use crate::sampler::{Field, Preset, Settings};
use crate::{Error, Result};

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
            azimuths_field(|s: &Self| s.azimuths, |s, value| s.azimuths = value),
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
            .count()
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
