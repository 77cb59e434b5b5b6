//! From a pair of directions to MERL's bins without trigonometry.
//!
//! Every bin edge is an angle whose squared tangent is known beforehand. A look-up table keyed by the leading bits of a
//! squared tangent gives the bin to within one, and one comparison with the edge decides. Computed in f64, the result
//! differs from arctangents in f64 only where an angle lies within rounding of an edge.

use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

use glam::Vec3;

use super::half_diff_tan2::Tangents;
use super::tan2_cells::{self, CELLS};
use crate::material::merl::THETA_H_BINS;

/// Bin indices of a pair of directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BinIndex {
    /// 0..90, spaced as √θh.
    pub theta_h: usize,
    /// 0..90, one a degree.
    pub theta_d: usize,
    /// 0..180 (φd and φd + π are one, by reciprocity) or 0..360.
    pub phi_d: usize,
}

impl BinIndex {
    /// Bins of a pair for a table of `phi_d_bins` (180 or 360); `None` unless both directions are above the horizon.
    #[inline(always)]
    pub fn of(wo: Vec3, wi: Vec3, phi_d_bins: usize) -> Option<Self> {
        BinTables::get().bins(Tangents::of(wo, wi), wi, phi_d_bins)
    }

    /// Bin of θh by its squared tangent, 0 to infinity.
    #[inline]
    pub fn theta_h_of_tan2(tan2: f64) -> usize {
        BinTables::get().theta_h.bin(tan2)
    }

    /// Bin of θd by its squared tangent, 0 to infinity.
    #[inline]
    pub fn theta_d_of_tan2(tan2: f64) -> usize {
        BinTables::get().degrees.bin(tan2)
    }
}

/// The bins of MERL's axes by squared tangents: θh, and degrees for θd and each quarter turn of φd. 32 KB.
pub(super) struct BinTables {
    theta_h: TanSquared,
    degrees: TanSquared,
}

impl BinTables {
    /// The tables, filled at the first call.
    #[inline(always)]
    pub fn get() -> &'static Self {
        static TABLES: LazyLock<BinTables> = LazyLock::new(|| BinTables {
            theta_h: TanSquared::new((1..THETA_H_BINS).map(theta_h_edge)),
            degrees: TanSquared::new((1..90).map(|i| f64::from(i).to_radians())),
        });
        &TABLES
    }

    /// Bins of a pair from its squared tangents and `wi`.
    #[inline(always)]
    pub fn bins(&self, tan2: Tangents, wi: Vec3, phi_d_bins: usize) -> Option<BinIndex> {
        if tan2.theta_h.is_nan() {
            return None;
        }
        let phi_d = if tan2.theta_h > 0.0 {
            let quarter = self.degrees.bin(tan2.phi_d.abs());
            // φd and φd + π share a bin of 180. Either quarter comes as often, so it is chosen without a branch: q or 179 − q.
            let falling = usize::from(tan2.phi_d < 0.0);
            let half = (quarter ^ falling.wrapping_neg()).wrapping_add(180 * falling);
            half + 180 * usize::from((phi_d_bins == 360) & (tan2.half_turn < 0.0))
        } else {
            azimuth_bin(wi.x, wi.y, phi_d_bins)
        };
        Some(BinIndex {
            theta_h: self.theta_h.bin(tan2.theta_h),
            theta_d: self.degrees.bin(tan2.theta_d),
            phi_d,
        })
    }
}

/// Bin of φd where the half vector is the normal: it is the azimuth of `wi`.
#[cold]
fn azimuth_bin(x: f32, y: f32, phi_d_bins: usize) -> usize {
    (azimuth(x, y, phi_d_bins) as usize).min(phi_d_bins - 1)
}

/// Azimuth in degrees from 0 to `phi_d_bins`; π is 0 for a table of 180.
pub(super) fn azimuth(x: f32, y: f32, phi_d_bins: usize) -> f64 {
    // Opposite azimuths are one in a table of 180: rounding must not tell them apart.
    let sign = if phi_d_bins == 180 && (y < 0.0 || (y == 0.0 && x < 0.0)) {
        -1.0
    } else {
        1.0
    };
    let degrees = (sign * f64::from(y))
        .atan2(sign * f64::from(x))
        .to_degrees();
    let positive = if degrees < 0.0 {
        degrees + phi_d_bins as f64
    } else {
        degrees
    };
    if phi_d_bins == 180 && positive == 180.0 {
        0.0
    } else {
        positive
    }
}

/// Lower edge of a bin of θh, radians.
fn theta_h_edge(bin: usize) -> f64 {
    (bin as f64 / THETA_H_BINS as f64).powi(2) * FRAC_PI_2
}

/// Bins of an angle in [0, π/2] by its squared tangent.
struct TanSquared {
    cells: Box<[Cell; CELLS]>,
}

/// The bin in which a cell starts, and where in the cell the next one does; infinity where it doesn't.
#[derive(Clone, Copy)]
struct Cell {
    edge: f64,
    below: usize,
}

impl TanSquared {
    fn new(angles: impl Iterator<Item = f64>) -> Self {
        let edges: Vec<f64> = angles.map(|a| a.tan().powi(2)).collect();
        let cell = |k: usize| {
            let (start, end) = tan2_cells::bounds(k);
            let below = edges.partition_point(|&e| e <= start);
            let edge = edges
                .get(below)
                .copied()
                .filter(|&e| e < end)
                .unwrap_or(f64::INFINITY);
            Cell { edge, below }
        };
        Self {
            cells: Box::new(std::array::from_fn(cell)),
        }
    }

    /// Bin of a squared tangent ≥ 0; infinity is in the last bin, NaN in the first.
    #[inline(always)]
    fn bin(&self, t: f64) -> usize {
        match self.cells.get(tan2_cells::cell(t)) {
            Some(cell) => cell.below + usize::from(t >= cell.edge),
            None => self.beyond(t),
        }
    }

    #[cold]
    fn beyond(&self, t: f64) -> usize {
        if t >= tan2_cells::HIGH {
            self.cells[CELLS - 1].below
        } else {
            0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_cell_holds_at_most_one_edge() {
        let tables = BinTables::get();
        for (table, bins) in [(&tables.theta_h, THETA_H_BINS), (&tables.degrees, 90)] {
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
        for i in 1..90 {
            let t = f64::from(i).to_radians().tan().powi(2);
            assert_eq!(BinIndex::theta_d_of_tan2(t), i as usize);
            assert_eq!(BinIndex::theta_d_of_tan2(t.next_down()), i as usize - 1);
            let t = theta_h_edge(i as usize).tan().powi(2);
            assert_eq!(BinIndex::theta_h_of_tan2(t), i as usize);
            assert_eq!(BinIndex::theta_h_of_tan2(t.next_down()), i as usize - 1);
        }
    }
}
