//! What can be said of a material without a sampler.

use serde::Serialize;

use super::{AlbedoEstimate, albedo_by_degree, directional_albedo_with_error};
use merlkit::brdf::Importance;
use merlkit::color::Rgb;
use merlkit::geometry::Symmetry;
use merlkit::geometry::merl_axes::{theta_d, theta_h_edge};
use merlkit::material::merl::{CellFormat, Census, RoundingError, THETA_D_BINS, THETA_H_BINS};
use merlkit::material::{Loaded, LookupRule, MerlTable};

/// Angles of `wo`, in degrees, at which [`facts`] gives the albedo.
const ALBEDO_ANGLES: [f64; 4] = [0.0, 30.0, 60.0, 80.0];

/// A material as a BRDF and, where it is one, as a table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Facts {
    /// How the values of the figures below were come by, as [`Loaded::reading`].
    pub reading: String,
    /// How a table was read for the figures below; `None` without a table.
    pub lookup: Option<LookupRule>,
    /// What users should know of it, as [`Loaded::notes`].
    pub notes: Vec<String>,
    /// Which azimuths of `wo` represent all others.
    pub symmetry: Symmetry,
    /// Bytes of the loaded tables in memory, counted; 0 for a formula.
    pub bytes: usize,
    /// The table alone, if there is one.
    pub table: Option<TableFacts>,
    /// Directional albedo at 0, 30, 60 and 80°, of `wo` at azimuth 0.
    pub albedo: Vec<Albedo>,
    /// Where the material returns more than it receives, for `wo` at azimuth 0.
    pub albedo_above_one: AlbedoAboveOne,
    /// How far a table is from its mirror image in φd; `None` without a table.
    pub asymmetry: Option<Asymmetry>,
}

/// A table's size, gaps and range.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TableFacts {
    /// Bins `[theta_h, theta_d, phi_d]`.
    pub dimensions: [usize; 3],
    /// Bytes of the decoded table in memory, counted.
    pub table_bytes: usize,
    /// How the cells are kept in memory.
    pub cell_format: CellFormat,
    /// How far red, green and blue are from the values that were read; `None` for cells that are as they were read.
    pub rounding_errors: Option<[RoundingError; 3]>,
    /// Bytes of a MERL binary of these dimensions.
    pub file_bytes: u64,
    /// Invalid cells by kind.
    pub invalid: Census,
    /// Cells of which some channels are usable and some are not.
    pub mixed_cells: u64,
    /// Whether these are invalid in the channels alone that are not usable, rather than as a whole and among `invalid`.
    pub channels_apart: bool,
    /// Invalid cells whose lower corner stands for two directions above the horizon, so that a value would be expected.
    pub invalid_above_horizon: u64,
    /// Least valid value of each channel, sr⁻¹; 0 if no cell is valid.
    pub min: [f32; 3],
    /// Greatest valid value of each channel, sr⁻¹; 0 if no cell is valid.
    pub max: [f32; 3],
    /// Greatest mean of the channels over its mean over all pairs of directions with a valid cell, in solid angle; 0 for
    /// a black table.
    pub peak_to_mean: f64,
}

/// Directional albedo at one angle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Albedo {
    /// Polar angle of `wo`.
    pub theta_o_degrees: f64,
    /// Fraction reflected, by channel.
    pub rgb: [f32; 3],
    /// How far the quadrature may be off, as [`super::AlbedoEstimate::error`].
    pub error: f32,
}

/// Angles at which a channel's directional albedo exceeds 1 by more than its own error, of 0°, 1° … 89°.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AlbedoAboveOne {
    /// First and last degree of each run.
    pub ranges_degrees: Vec<[usize; 2]>,
    /// The greatest albedo of a channel at any of the angles.
    pub greatest: f32,
    /// Where it is.
    pub greatest_at_degrees: usize,
}

/// Difference of the table, as its lookup rule reads it, from its mirror image about the plane of incidence (φd to −φd,
/// which a table of 180 bins cannot tell from π − φd). f is the mean of the channels; only cells that are valid together
/// with their mirror image count.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Asymmetry {
    /// Mean of |f(φd) − f(−φd)| over mean of f, over all cells.
    pub mean: f64,
    /// The greatest such ratio of one row of φd.
    pub greatest: f64,
    /// That row's bins `[theta_h, theta_d]`.
    pub greatest_at: [usize; 2],
}

/// Measures a material, on all threads of the current pool.
pub fn facts(material: &Loaded) -> Facts {
    let brdf = &**material.brdf();
    let albedo = |degrees: f64| {
        let a = directional_albedo_with_error(brdf, degrees.to_radians());
        Albedo {
            theta_o_degrees: degrees,
            rgb: a.value.to_array(),
            error: a.error,
        }
    };
    let table = material.table();
    Facts {
        reading: material.reading(),
        lookup: material.rule(),
        notes: material.notes().to_vec(),
        symmetry: material.symmetry(),
        bytes: material.bytes(),
        table: table.map(|measured| table_facts(measured.table())),
        albedo: ALBEDO_ANGLES.map(albedo).to_vec(),
        albedo_above_one: above_one(&albedo_by_degree(brdf)),
        asymmetry: table.map(|measured| asymmetry(measured.table(), measured.rule())),
    }
}

/// Measures a table, by itself.
pub fn table_facts(table: &MerlTable) -> TableFacts {
    let (min, max) = range(table);
    TableFacts {
        dimensions: [THETA_H_BINS, THETA_D_BINS, table.phi_d_bins()],
        table_bytes: table.bytes(),
        cell_format: table.cell_format(),
        rounding_errors: table.rounding_errors(),
        file_bytes: table.header().file_bytes(),
        invalid: table.census(),
        mixed_cells: table.mixed_cells(),
        channels_apart: table.keeps_channels_apart(),
        invalid_above_horizon: table.count_gaps(),
        min: min.to_array(),
        max: max.to_array(),
        peak_to_mean: peak_to_mean(table),
    }
}

/// Least and greatest valid value of each channel; 0 without any.
fn range(table: &MerlTable) -> (Rgb, Rgb) {
    let (mut least, mut greatest) = ([None::<f32>; 3], [0.0f32; 3]);
    for (cell, value) in table.cells().enumerate() {
        let valid = table.valid_channels(cell);
        for channel in 0..3 {
            if valid[channel] {
                let v = value[channel];
                least[channel] = Some(least[channel].map_or(v, |least| least.min(v)));
                greatest[channel] = greatest[channel].max(v);
            }
        }
    }
    (least.map(Option::unwrap_or_default).into(), greatest.into())
}

fn peak_to_mean(table: &MerlTable) -> f64 {
    let (mut peak, mut sum, mut weight) = (0.0f64, 0.0, 0.0);
    for (h, d) in rows() {
        // dω(wo) dω(wi) = 4 cosθd dω(h) dω(d), integrated over the bin.
        let share = (theta_h_edge(h).cos() - theta_h_edge(h + 1).cos())
            * (theta_d((d + 1) as f64).sin().powi(2) - theta_d(d as f64).sin().powi(2));
        for p in (0..table.phi_d_bins()).filter(|&p| table.is_valid(h, d, p)) {
            let f = scalar(table, h, d, p);
            peak = peak.max(f);
            sum += share * f;
            weight += share;
        }
    }
    if sum > 0.0 { peak * weight / sum } else { 0.0 }
}

fn asymmetry(table: &MerlTable, rule: LookupRule) -> Asymmetry {
    let mut out = Asymmetry {
        mean: 0.0,
        greatest: 0.0,
        greatest_at: [0, 0],
    };
    let (mut difference, mut total) = (0.0, 0.0);
    for (h, d) in rows() {
        let (row_difference, row_total) = row_asymmetry(table, rule, h, d);
        difference += row_difference;
        total += row_total;
        if row_difference > out.greatest * row_total {
            out.greatest = row_difference / row_total;
            out.greatest_at = [h, d];
        }
    }
    if total > 0.0 {
        out.mean = difference / total;
    }
    out
}

/// Sums over a row of |f − mirrored f| and of f.
fn row_asymmetry(table: &MerlTable, rule: LookupRule, h: usize, d: usize) -> (f64, f64) {
    let bins = table.phi_d_bins();
    let (mut difference, mut total) = (0.0, 0.0);
    for p in 0..bins {
        let mirror = match rule {
            // Values fill their bins.
            LookupRule::Floor | LookupRule::Centred => bins - 1 - p,
            // Values stand at the bins' lower edges.
            LookupRule::Linear => (bins - p) % bins,
        };
        if table.is_valid(h, d, p) && table.is_valid(h, d, mirror) {
            let f = scalar(table, h, d, p);
            difference += (f - scalar(table, h, d, mirror)).abs();
            total += f;
        }
    }
    (difference, total)
}

/// Rounding of an albedo of 1, which adds to the error of its quadrature.
const ALBEDO_ROUNDING: f32 = 1e-5;

fn above_one(albedo: &[AlbedoEstimate]) -> AlbedoAboveOne {
    let mut out = AlbedoAboveOne {
        ranges_degrees: Vec::new(),
        greatest: 0.0,
        greatest_at_degrees: 0,
    };
    for (degree, estimate) in albedo.iter().enumerate() {
        let a = estimate.value.max_element();
        if a > out.greatest {
            (out.greatest, out.greatest_at_degrees) = (a, degree);
        }
        if a > 1.0 + estimate.error + ALBEDO_ROUNDING {
            match out.ranges_degrees.last_mut() {
                Some([_, last]) if *last + 1 == degree => *last = degree,
                _ => out.ranges_degrees.push([degree, degree]),
            }
        }
    }
    out
}

fn scalar(table: &MerlTable, h: usize, d: usize, p: usize) -> f64 {
    f64::from(Importance::Mean.reduce(table.rgb(h, d, p)))
}

fn rows() -> impl Iterator<Item = (usize, usize)> {
    (0..THETA_H_BINS).flat_map(|h| (0..THETA_D_BINS).map(move |d| (h, d)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use merlkit::material::merl::Header;

    fn table(value: impl FnMut(usize, usize, usize) -> [f64; 3]) -> MerlTable {
        MerlTable::from_fn(Header { phi_d_bins: 180 }, value)
    }

    #[test]
    fn a_flat_table_is_symmetric_and_has_no_peak() {
        let t = table(|_, _, _| [0.1, 0.2, 0.3]);
        let facts = table_facts(&t);
        assert!((facts.peak_to_mean - 1.0).abs() < 1e-6, "{facts:?}");
        assert_eq!((facts.min, facts.max), ([0.1, 0.2, 0.3], [0.1, 0.2, 0.3]));
        assert_eq!(asymmetry(&t, LookupRule::Floor).greatest, 0.0);
    }

    #[test]
    fn asymmetry_is_that_of_the_rule_and_the_row() {
        // Symmetric about 90° as bins, and not as edges; one row leans to one side.
        let lean = |h, d, p| if (h, d) == (3, 7) && p < 90 { 3.0 } else { 1.0 };
        let t = table(|h, d, p| [lean(h, d, p); 3]);
        let a = asymmetry(&t, LookupRule::Floor);
        assert_eq!(a.greatest_at, [3, 7]);
        assert!((a.greatest - 1.0).abs() < 1e-6, "{a:?}");
        assert!(
            (a.mean - 360.0 / (8100.0 * 180.0 + 180.0)).abs() < 1e-9,
            "{a:?}"
        );
        let ramp = table(|_, _, p| [1.0 + p.min(179 - p) as f64; 3]);
        assert_eq!(asymmetry(&ramp, LookupRule::Floor).mean, 0.0);
        assert!(asymmetry(&ramp, LookupRule::Linear).mean > 0.01);
    }

    #[test]
    fn gaps_above_the_horizon_are_told_from_those_below() {
        let t = table(|h, d, p| {
            if (h, d, p) == (10, 10, 0) || (h, d) == (89, 89) {
                [-1.0; 3]
            } else {
                [1.0; 3]
            }
        });
        let facts = table_facts(&t);
        assert_eq!(facts.invalid.negative, 181);
        // Of row (89, 89) only the bins about φd = 90° stand for directions above the horizon.
        let above = (0..180)
            .filter(|&p| (89f64 / 90.0).powi(2) * 90.0 < 90.0 && above_at_corner(p))
            .count();
        assert_eq!(facts.invalid_above_horizon, 1 + above as u64);
    }

    fn above_at_corner(p: u32) -> bool {
        let (h, d) = (
            ((89f64 / 90.0).powi(2) * 90.0).to_radians(),
            89f64.to_radians(),
        );
        1.0 / (h.tan() * d.tan()) >= f64::from(p).to_radians().cos().abs()
    }

    #[test]
    fn black_and_empty_tables_have_finite_facts() {
        for value in [0.0, -1.0] {
            let t = table(|_, _, _| [value; 3]);
            let facts = table_facts(&t);
            assert_eq!((facts.peak_to_mean, facts.max), (0.0, [0.0; 3]));
            assert_eq!(asymmetry(&t, LookupRule::Floor).mean, 0.0);
        }
    }

    #[test]
    fn runs_above_one_are_joined() {
        let at = |d: usize| {
            let (value, error) = match d {
                2..5 | 89 => (1.5, 0.1),
                // Above 1 by no more than its error: an albedo of 1.
                20..30 => (1.01, 0.02),
                _ => (0.5, 0.0),
            };
            AlbedoEstimate {
                value: Rgb::splat(value),
                error,
            }
        };
        let out = above_one(&(0..90).map(at).collect::<Vec<_>>());
        assert_eq!(out.ranges_degrees, [[2, 4], [89, 89]]);
        assert_eq!((out.greatest, out.greatest_at_degrees), (1.5, 2));
    }
}
