//! Scattered measurements: pairs of directions with values, and the table that they fill in part.

use std::path::Path;

use glam::{DVec3, Vec3};

use super::columns::AngleUnit;
use super::text::{List, read_list};
use crate::brdf::Brdf;
use crate::files::RegularFile;
use crate::material::merl::{BinIndex, Header, MerlTable, THETA_D_BINS};
use crate::{Error, Result};

/// Lists beyond this many bytes are refused.
const LONGEST: u64 = 1 << 30;
const HEADER: Header = Header { phi_d_bins: 180 };

/// Measured pairs of directions of an isotropic material.
#[derive(Clone, Debug, Default)]
pub struct Measurements {
    pairs: Vec<(Vec3, Vec3, DVec3)>,
    notes: Vec<String>,
}

impl Measurements {
    /// Reads a list: CSV with named columns, ASTM E1392, or Cornell's spectra at scattered angles. `unit` overrides the unit
    /// of angles that the file states or its kind has.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::Unsupported`] for what is no regular file or of more than 1 GiB, [`Error::Invalid`] with the
    /// place where the grammar is broken or angles are out of the range of their unit.
    pub fn read(path: &Path, unit: Option<AngleUnit>) -> Result<Self> {
        let bytes = RegularFile::open(path)?.read_all(LONGEST)?;
        let text = match std::str::from_utf8(&bytes) {
            Ok(text) => text.trim_start_matches('\u{feff}'),
            Err(error) => {
                return Err(Error::invalid(
                    path,
                    error.valid_up_to() as u64,
                    "text",
                    "bytes that are no UTF-8",
                    "name a list of measurements, a .bsdf file or a formula",
                ));
            }
        };
        let list = read_list(text, path)?;
        let unit = unit.unwrap_or(list.unit);
        check_unit(&list, unit, path)?;
        Ok(Self::collect(&list, unit))
    }

    fn collect(list: &List, unit: AngleUnit) -> Self {
        let to_radians = match unit {
            AngleUnit::Degrees => std::f64::consts::PI / 180.0,
            AngleUnit::Radians => 1.0,
        };
        let mut out = Self {
            pairs: Vec::new(),
            notes: list.columns.notes.clone(),
        };
        let (mut below, mut not_finite) = (0, 0);
        for row in list.numbers.chunks_exact(list.columns.count) {
            let rgb = list.columns.rgb(row);
            match list.columns.pair(row, to_radians) {
                None => below += 1,
                Some(_) if !rgb.is_finite() => not_finite += 1,
                Some((wo, wi)) => out.pairs.push((wo, wi, rgb)),
            }
        }
        for (count, what) in [
            (below, "with a direction at or below the horizon"),
            (not_finite, "without a finite value"),
        ] {
            if count > 0 {
                out.notes
                    .push(format!("measurements left out {what}: {count}"));
            }
        }
        out
    }

    /// Measured pairs that are used.
    pub fn count(&self) -> usize {
        self.pairs.len()
    }

    /// What reading took for granted or left out, in words.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Median of the relative difference of a BRDF's values from those measured, Σ|Δ| over Σ of the channels; pairs where
    /// nothing was measured are left out. NaN if nothing was measured anywhere.
    pub fn median_error(&self, brdf: &dyn Brdf) -> f64 {
        let mut errors = Vec::new();
        for &(wo, wi, rgb) in &self.pairs {
            let sum = rgb.element_sum();
            if sum > 0.0 {
                let difference = brdf.eval(wo, wi).as_dvec3() - rgb;
                errors.push(difference.abs().element_sum() / sum);
            }
        }
        errors.sort_by(f64::total_cmp);
        errors.get(errors.len() / 2).copied().unwrap_or(f64::NAN)
    }

    /// The table on MERL's axes: a cell is the mean of the measurements in its bin, invalid without any. Means below 0, which
    /// noise may leave, are 0. Says in words how much is there.
    pub fn to_table(&self) -> (MerlTable, Vec<String>) {
        let mut sums = vec![(DVec3::ZERO, 0u32); HEADER.cells()];
        for &(wo, wi, rgb) in &self.pairs {
            if let Some(bin) = BinIndex::find(wo, wi, HEADER.phi_d_bins) {
                let row = bin.theta_d + THETA_D_BINS * bin.theta_h;
                let cell = &mut sums[bin.phi_d + HEADER.phi_d_bins * row];
                cell.0 += rgb;
                cell.1 += 1;
            }
        }
        let (mut measured, mut raised) = (0u64, 0u64);
        let mut cells = sums.iter();
        let table = MerlTable::from_fn(HEADER, |_, _, _| match cells.next() {
            Some(&(sum, count)) if count > 0 => {
                let mean = sum / f64::from(count);
                measured += 1;
                raised += u64::from(mean.min_element() < 0.0);
                mean.max(DVec3::ZERO).to_array()
            }
            _ => [-1.0; 3],
        });
        let mut notes = vec![format!(
            "measurements: {}, in {measured} of {} cells",
            self.pairs.len(),
            HEADER.cells()
        )];
        if raised > 0 {
            notes.push(format!(
                "cells whose mean is negative, which counts as 0: {raised}"
            ));
        }
        (table, notes)
    }
}

/// Angles that can't be of their unit: radians beyond 2π, or "degrees" that never leave the range of radians.
fn check_unit(list: &List, unit: AngleUnit, path: &Path) -> Result<()> {
    let mut largest = 0.0f64;
    for row in list.numbers.chunks_exact(list.columns.count) {
        for angle in list.columns.angles(row) {
            if !angle.is_finite() {
                let fix = "remove the row";
                return Err(Error::invalid(
                    path,
                    0,
                    "finite angles",
                    angle.to_string(),
                    fix,
                ));
            }
            largest = largest.max(angle.abs());
        }
    }
    let (expected, fix) = match unit {
        AngleUnit::Radians if largest > 6.3 => ("angles in radians", "say --angles degrees"),
        AngleUnit::Degrees if largest <= 6.3 && list.numbers.len() > 16 * list.columns.count => (
            "angles in degrees",
            "say --angles radians, or --angles degrees if they are that small",
        ),
        _ => return Ok(()),
    };
    Err(Error::invalid(
        path,
        0,
        expected,
        format!("none above {largest}"),
        fix,
    ))
}
