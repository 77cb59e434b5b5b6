//! Measurements of pairs of directions, scattered or on a grid, and the table that they fill in part.

use std::fmt;
use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::columns::AngleUnit;
use super::grid::{MeasuredGrid, probe_pairs, reciprocal_value, tabulate_grid};
use super::kind::MeasurementKind;
use super::polarised::read_polarised;
use super::text::{List, read_list};
use super::utia::read_utia;
use crate::brdf::Brdf;
use crate::files::RegularFile;
use crate::material::merl::{BinIndex, BinPoint, Header, MerlTable, THETA_D_BINS};
use crate::material::rgl::looks_like_bsdf;
use crate::{Error, Result};

/// Lists beyond this many bytes are refused.
const LONGEST: u64 = 1 << 30;
const HEADER: Header = Header { phi_d_bins: 180 };

/// Measured pairs of directions of an isotropic material.
///
/// # Examples
/// ```
/// use merlkit::Error;
/// use merlkit::material::measurements::{Measurements, fill_gaps};
///
/// let path = std::env::temp_dir().join(format!("merlkit-example-{}.csv", std::process::id()));
/// let list = "theta_h,theta_d,phi_d,value\n0,10,90,0.3\n20,10,90,0.2\n";
/// std::fs::write(&path, list).map_err(|e| Error::io(&path, "write", e))?;
///
/// // `None`: degrees, since a list with named columns has them unless it says otherwise.
/// let measured = Measurements::read(&path, None)?;
/// assert_eq!(measured.count(), 2);
/// let (table, notes) = measured.to_table();
/// println!("{}", notes.join("; "));
///
/// // Two measurements leave most of the table empty. This fills it from its neighbours.
/// let filled = fill_gaps(&table);
/// assert!(filled.count_gaps() < table.count_gaps());
/// # std::fs::remove_file(&path).map_err(|e| Error::io(&path, "remove", e))?;
/// # Ok::<(), merlkit::Error>(())
/// ```
#[derive(Clone, Default)]
pub struct Measurements {
    /// All that were measured; of a grid, some that follow the cosine, to compare with.
    pairs: Vec<(Vec3, Vec3, DVec3)>,
    notes: Vec<String>,
    grid: Option<Arc<dyn MeasuredGrid>>,
}

impl Measurements {
    /// Reads a list (CSV with named columns, ASTM E1392, or Cornell's spectra at scattered angles) or a grid of directions (the
    /// unpolarised part of a `.pbsdf` file, or the mean over rotations of a file of the UTIA database). `unit` overrides the
    /// unit of angles that a list states or its kind has.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::Unsupported`] for what is no regular file and for lists of more than 1 GiB, [`Error::Invalid`] with
    /// the place where the grammar is broken or angles are out of the range of their unit.
    pub fn read(path: &Path, unit: Option<AngleUnit>) -> Result<Self> {
        match MeasurementKind::detect(path) {
            Some(MeasurementKind::Polarised) => Self::read_polarised(path),
            Some(MeasurementKind::Utia) => {
                let (grid, notes) = read_utia(path)?;
                Ok(Self::from_grid(Arc::new(grid), notes))
            }
            // A damaged one, of which the reader says where.
            None if looks_like_bsdf(path) => Self::read_polarised(path),
            _ => Self::read_list(path, unit),
        }
    }

    fn read_polarised(path: &Path) -> Result<Self> {
        let (grid, notes) = read_polarised(path)?;
        Ok(Self::from_grid(Arc::new(grid), notes))
    }

    fn from_grid(grid: Arc<dyn MeasuredGrid>, notes: Vec<String>) -> Self {
        Self {
            pairs: probe_pairs(&*grid),
            notes,
            grid: Some(grid),
        }
    }

    fn read_list(path: &Path, unit: Option<AngleUnit>) -> Result<Self> {
        let bytes = RegularFile::open(path)?.read_all(LONGEST)?;
        let text = match std::str::from_utf8(&bytes) {
            Ok(text) => text.trim_start_matches('\u{feff}'),
            Err(error) => {
                return Err(Error::invalid(
                    path,
                    error.valid_up_to() as u64,
                    "text",
                    "bytes that are not UTF-8",
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
            grid: None,
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
        self.grid
            .as_ref()
            .map_or(self.pairs.len(), |grid| grid.count())
    }

    /// What reading took for granted or left out, in words.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Median of the relative difference of a BRDF's values from those measured, Σ|Δ| over Σ of the channels; pairs where
    /// nothing was measured are left out. NaN if nothing was measured anywhere. Of a grid, pairs that follow the cosine, with its
    /// values linear between its points.
    pub fn median_error(&self, brdf: &dyn Brdf) -> f64 {
        self.median_difference(|wo, wi| Some(brdf.eval(wo, wi).as_dvec3()))
    }

    fn median_difference(&self, value: impl Fn(Vec3, Vec3) -> Option<DVec3>) -> f64 {
        let mut errors = Vec::new();
        for &(wo, wi, rgb) in &self.pairs {
            let sum = rgb.element_sum();
            if sum > 0.0
                && let Some(value) = value(wo, wi)
            {
                errors.push((value - rgb).abs().element_sum() / sum);
            }
        }
        errors.sort_by(f64::total_cmp);
        errors.get(errors.len() / 2).copied().unwrap_or(f64::NAN)
    }

    /// [`Self::tabulate`] with values at the centres of bins.
    pub fn to_table(&self) -> (MerlTable, Vec<String>) {
        self.tabulate(BinPoint::Centre)
    }

    /// The table on MERL's axes. Of a list, a cell is the mean of the measurements in its bin; of a grid, the mean of its values,
    /// linear between its points, for both orders of the pair at the `point` of its bin, each weighted by the cosine of the
    /// incident direction. A cell without measurements is invalid. Channels below 0, which noise may leave, are 0. Says in words
    /// how much is there.
    pub fn tabulate(&self, point: BinPoint) -> (MerlTable, Vec<String>) {
        let Some(grid) = &self.grid else {
            return self.tabulate_list();
        };
        let (table, mut notes) = tabulate_grid(&**grid, point);
        let cost = self.median_difference(|wo, wi| reciprocal_value(&**grid, wo, wi));
        notes.push(format!(
            "a table is reciprocal, and this alone changes f_r by {:.3} % (median)",
            100.0 * cost
        ));
        (table, notes)
    }

    fn tabulate_list(&self) -> (MerlTable, Vec<String>) {
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

impl fmt::Debug for Measurements {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Measurements")
            .field("count", &self.count())
            .field("notes", &self.notes)
            .finish_non_exhaustive()
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
        AngleUnit::Radians if largest > 6.3 => ("angles in radians", "pass --angles degrees"),
        AngleUnit::Degrees if largest <= 6.3 && list.numbers.len() > 16 * list.columns.count => (
            "angles in degrees",
            "pass --angles radians, or --angles degrees if they are that small",
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
