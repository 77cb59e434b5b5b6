//! The axes of MERL's tables: which angles of the half and difference vectors lie between the edges of a bin.
//!
//! A table has 90 bins of θh, whose edges are spaced as the square root of the angle, 90 bins of θd, one a degree, and 180
//! or 360 bins of φd, one a degree:
//!
//! ```text
//! θh(c) = (c/90)²·π/2      c = 90·√(θh/(π/2)),   c in [0, 90]; bin i is i ≤ c < i + 1
//! θd(c) = (c/90)·π/2       c = 90·θd/(π/2)
//! ```
//!
//! All code that needs an edge takes it from here. Where two places used to round differently there are two functions, since
//! a value that jumps at an edge must jump at the same f64 everywhere: edges of θd in a *table* are [`theta_d`], edges that
//! *lookups* compare with are [`degree_edge`].

use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

use super::tan2_cells::{self, CELLS};

/// Bins of θh, spaced as the square root of the angle.
///
/// See [`theta_h`] for an example.
pub const THETA_H_BINS: usize = 90;
/// Bins of θd, one a degree.
///
/// See [`theta_h`] for an example.
pub const THETA_D_BINS: usize = 90;

/// θh in radians at a fraction of its axis, 0 to 1: fraction²·π/2.
///
/// See [`theta_h`] for an example.
#[inline]
pub fn theta_h_at_fraction(fraction: f64) -> f64 {
    fraction * fraction * FRAC_PI_2
}

/// θh in degrees at a fraction of its axis, 0 to 1: 90·fraction².
///
/// See [`theta_h`] for an example.
pub fn theta_h_degrees(fraction: f64) -> f64 {
    90.0 * (fraction * fraction)
}

/// The fraction of the axis of θh at which an angle of 0 to π/2 lies, 0 to 1: √(θh/(π/2)).
///
/// See [`theta_h`] for an example.
#[inline]
pub fn theta_h_fraction(theta_h: f64) -> f64 {
    (theta_h / FRAC_PI_2).sqrt()
}

/// θh in radians at a coordinate in units of bins, 0 to 90; the lower edge of bin i is at i.
///
/// # Examples
/// ```
/// use merlkit::geometry::merl_axes::{theta_h, theta_h_coordinate, theta_h_edge};
///
/// // Bins are narrow near the normal: the first edges lie at 0°, 1/90° and 4/90°.
/// assert_eq!(theta_h(1.0), theta_h_edge(1));
/// assert!((theta_h_edge(1).to_degrees() - 1.0 / 90.0).abs() < 1e-12);
/// let coordinate = theta_h_coordinate(theta_h(30.5).tan().powi(2));
/// assert!((coordinate - 30.5).abs() < 1e-9);
/// ```
#[inline]
pub fn theta_h(coordinate: f64) -> f64 {
    theta_h_at_fraction(coordinate / THETA_H_BINS as f64)
}

/// Lower edge of a bin of θh in radians; that of bin 90 is the end of the axis.
///
/// See [`theta_h`] for an example.
#[inline]
pub fn theta_h_edge(bin: usize) -> f64 {
    theta_h(bin as f64)
}

/// The cap of an edge of θh: sin²(θh/2), the fraction of the sphere that lies within θh of the normal.
///
/// See [`theta_h`] for an example.
pub fn theta_h_edge_cap(bin: usize) -> f64 {
    (0.5 * theta_h_edge(bin)).sin().powi(2)
}

/// The coordinate of θh in units of bins, 0 to 90, from its squared tangent, 0 to infinity.
///
/// See [`theta_h`] for an example.
pub fn theta_h_coordinate(tan2: f64) -> f64 {
    theta_h_fraction(tan2.sqrt().atan()) * THETA_H_BINS as f64
}

/// θd in radians at a coordinate in units of bins, 0 to 90, as tables are filled.
///
/// See [`theta_h`] for an example.
#[inline]
pub fn theta_d(coordinate: f64) -> f64 {
    coordinate / THETA_D_BINS as f64 * FRAC_PI_2
}

/// The coordinate of an angle in degrees, 0 to 90, from its squared tangent, 0 to infinity: θd, and φd within a quarter turn.
///
/// See [`theta_h`] for an example.
pub fn degree_coordinate(tan2: f64) -> f64 {
    tan2.sqrt().atan() / FRAC_PI_2 * THETA_D_BINS as f64
}

/// A whole number of degrees in radians, as lookups compare angles with it. It may differ from [`theta_d`] in the last bit.
///
/// See [`theta_h`] for an example.
#[inline]
pub fn degree_edge(degree: usize) -> f64 {
    (degree as f64).to_radians()
}

/// The bins of both kinds of axes by squared tangents: θh, and degrees for θd and each quarter turn of φd. 32 KB.
pub(crate) struct AxisBins {
    pub(crate) theta_h: Tan2Bins,
    pub(crate) degrees: Tan2Bins,
}

impl AxisBins {
    /// The tables, filled at the first call.
    #[inline(always)]
    pub(crate) fn get() -> &'static Self {
        static BINS: LazyLock<AxisBins> = LazyLock::new(|| AxisBins {
            theta_h: Tan2Bins::new((1..THETA_H_BINS).map(theta_h_edge)),
            degrees: Tan2Bins::new((1..THETA_D_BINS).map(degree_edge)),
        });
        &BINS
    }
}

/// Bins of an angle in [0, π/2] by its squared tangent.
///
/// A table keyed by the leading bits of the squared tangent gives the bin to within one, and one comparison decides.
pub(crate) struct Tan2Bins {
    cells: Box<[Tan2Cell; CELLS]>,
}

/// The bin in which a cell starts, and where in the cell the next bin does; infinity if it doesn't.
#[derive(Clone, Copy)]
struct Tan2Cell {
    edge: f64,
    below: usize,
}

impl Tan2Cell {
    /// Cell `k` between rising edges, each a squared tangent.
    fn find(k: usize, edges: &[f64]) -> Self {
        let (start, end) = tan2_cells::bounds(k);
        // Every number of the cell is beyond the edges up to its start. At most one more edge lies within the cell.
        let below = edges.partition_point(|&e| e <= start);
        debug_assert!(edges.get(below + 1).is_none_or(|&next| next >= end));
        let edge = match edges.get(below) {
            Some(&edge) if edge < end => edge,
            _ => f64::INFINITY,
        };
        Self { edge, below }
    }
}

impl Tan2Bins {
    /// Bins between rising edges in radians; those at 0 and π/2 are left out.
    fn new(edges: impl Iterator<Item = f64>) -> Self {
        // tan² rises with the angle, so its values are compared instead of angles and lookups need no arctangent.
        let edges: Vec<f64> = edges.map(|angle| angle.tan().powi(2)).collect();
        Self {
            cells: Box::new(std::array::from_fn(|k| Tan2Cell::find(k, &edges))),
        }
    }

    /// Bin of a squared tangent ≥ 0; infinity is in the last bin, NaN in the first.
    #[inline(always)]
    pub(crate) fn bin(&self, tan2: f64) -> usize {
        match self.cells.get(tan2_cells::cell(tan2)) {
            Some(cell) => cell.below + usize::from(tan2 >= cell.edge),
            None => self.beyond(tan2),
        }
    }

    #[cold]
    fn beyond(&self, tan2: f64) -> usize {
        // No edge lies beyond the last cell, and none below the first, where NaN ends up too.
        if tan2 >= tan2_cells::HIGH {
            self.cells[CELLS - 1].below
        } else {
            0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_4;

    /// The ways in which the edges of θh were computed before there was this module: all the same bits.
    #[test]
    fn every_form_of_an_edge_of_theta_h_is_the_same_to_the_bit() {
        for bin in 0..=THETA_H_BINS {
            let squared = (bin as f64 / 90.0).powi(2);
            assert_eq!(theta_h_edge(bin), squared * FRAC_PI_2);
            assert_eq!(theta_h_edge_cap(bin), (FRAC_PI_4 * squared).sin().powi(2));
        }
        for step in 0..=270 {
            let fraction = f64::from(step) / 270.0;
            assert_eq!(
                theta_h_at_fraction(fraction),
                fraction.powi(2) * FRAC_PI_2,
                "{step}"
            );
            assert_eq!(
                2.0 * theta_h_degrees(fraction),
                2.0 * 90.0 * fraction.powi(2),
                "{step}"
            );
        }
    }

    #[test]
    fn coordinates_invert_angles() {
        for step in 0..900 {
            let c = f64::from(step) * 0.1;
            let tan2 = |angle: f64| angle.tan().powi(2);
            assert!((theta_h_coordinate(tan2(theta_h(c))) - c).abs() < 1e-9);
            assert!((degree_coordinate(tan2(theta_d(c))) - c).abs() < 1e-9);
            assert!((theta_h_fraction(theta_h(c)) * 90.0 - c).abs() < 1e-12);
        }
        assert_eq!(theta_h(90.0), FRAC_PI_2);
        assert_eq!(theta_d(90.0), FRAC_PI_2);
    }

    /// Why there are two functions for a degree.
    #[test]
    fn degrees_of_tables_and_of_lookups_differ_in_the_last_bit() {
        let apart = |degree: &usize| theta_d(*degree as f64) != degree_edge(*degree);
        assert!((0..=90).filter(apart).count() > 0);
        for degree in 0..=90 {
            let difference = theta_d(degree as f64) - degree_edge(degree);
            assert!(difference.abs() < 1e-15, "{degree}");
        }
    }

    #[test]
    fn each_cell_holds_at_most_one_edge() {
        let tables = AxisBins::get();
        for (table, bins) in [
            (&tables.theta_h, THETA_H_BINS),
            (&tables.degrees, THETA_D_BINS),
        ] {
            for pair in table.cells.windows(2) {
                assert!(pair[1].below - pair[0].below <= 1);
            }
            assert_eq!(table.bin(f64::NAN), 0);
            assert_eq!(table.cells[0].below, 0);
            assert_eq!(table.cells[table.cells.len() - 1].below, bins - 1);
            assert_eq!(table.bin(0.0), 0);
            assert_eq!(table.bin(f64::INFINITY), bins - 1);
        }
    }

    #[test]
    fn edges_belong_to_the_bin_above() {
        let tables = AxisBins::get();
        for bin in 1..90 {
            let tan2 = degree_edge(bin).tan().powi(2);
            assert_eq!(tables.degrees.bin(tan2), bin);
            assert_eq!(tables.degrees.bin(tan2.next_down()), bin - 1);
            let tan2 = theta_h_edge(bin).tan().powi(2);
            assert_eq!(tables.theta_h.bin(tan2), bin);
            assert_eq!(tables.theta_h.bin(tan2.next_down()), bin - 1);
        }
    }
}
