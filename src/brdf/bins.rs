//! From a pair of directions to MERL's bins without trigonometry.
//!
//! Every bin edge is an angle whose squared tangent is known beforehand, and the squared tangents of θh, θd and φd are
//! ratios of polynomials in the directions' components (see [`crate::geom::HalfDiff::of`]). A look-up table keyed by the
//! leading bits of the ratio gives the bin to within one, and one comparison with the edge decides. Computed in f64, the
//! result differs from arctangents in f64 only where an angle lies within rounding of an edge.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::LazyLock;

use glam::{DVec3, Vec3};

use crate::geom::is_upper;
use crate::merl::THETA_H_BINS;

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
    #[inline]
    pub fn of(wo: Vec3, wi: Vec3, phi_d_bins: usize) -> Option<Self> {
        if !is_upper(wo) || !is_upper(wi) {
            return None;
        }
        let (o, i) = (wo.as_dvec3(), wi.as_dvec3());
        let (sum, difference) = (o + i, o - i);
        let across = o.x * i.y - o.y * i.x;
        let length2 = sum.length_squared();
        let rho2 = sum.x * sum.x + sum.y * sum.y;
        let phi_d = if across != 0.0 {
            let tan2 = 4.0 * across * across / (length2 * difference.z * difference.z);
            let quarter = DEGREES.bin(tan2);
            // φd and φd + π share a bin of 180; across and along the plane agree in sign in the first half of it.
            let half = if across * difference.z > 0.0 { quarter } else { 179 - quarter };
            if across < 0.0 && phi_d_bins == 360 { half + 180 } else { half }
        } else if rho2 == 0.0 {
            azimuth_bin(i, phi_d_bins)
        } else {
            // In one plane with the normal: φd is 0, or π, which is 0 in a table of 180.
            if phi_d_bins == 360 && difference.z < 0.0 { 180 } else { 0 }
        };
        Some(Self {
            theta_h: THETA_H.bin(rho2 / (sum.z * sum.z)),
            theta_d: DEGREES.bin(difference.length_squared() / length2),
            phi_d,
        })
    }

    /// Bin of θh by its squared tangent, 0 to infinity.
    #[inline]
    pub fn theta_h_of_tan2(tan2: f64) -> usize {
        THETA_H.bin(tan2)
    }

    /// Bin of θd by its squared tangent, 0 to infinity.
    #[inline]
    pub fn theta_d_of_tan2(tan2: f64) -> usize {
        DEGREES.bin(tan2)
    }
}

/// Bin of φd where the half vector is the normal: it is the azimuth of `wi`.
#[cold]
fn azimuth_bin(wi: DVec3, phi_d_bins: usize) -> usize {
    (fold_phi_d(wi.y.atan2(wi.x), phi_d_bins) as usize).min(phi_d_bins - 1)
}

/// φd in (−π, π] as a coordinate in [0, `phi_d_bins`] in units of bins; ±π is 0 for a table of 180.
pub(super) fn fold_phi_d(phi_d: f64, phi_d_bins: usize) -> f64 {
    let period = if phi_d_bins == 360 { 2.0 * PI } else { PI };
    let phi = if phi_d < 0.0 { phi_d + period } else { phi_d };
    let phi = if phi_d_bins != 360 && phi_d == PI { 0.0 } else { phi };
    phi / PI * 180.0
}

static THETA_H: LazyLock<TanSquared> = LazyLock::new(|| {
    let edge = |i: usize| (i as f64 / THETA_H_BINS as f64).powi(2) * FRAC_PI_2;
    TanSquared::new((1..THETA_H_BINS).map(edge))
});

static DEGREES: LazyLock<TanSquared> =
    LazyLock::new(|| TanSquared::new((1..90).map(|i| f64::from(i).to_radians())));

/// Bins of an angle in [0, π/2] by its squared tangent.
struct TanSquared {
    /// Key of the first cell: leading bits of an f64.
    first: u64,
    cells: Vec<Cell>,
}

#[derive(Clone, Copy)]
struct Cell {
    edge: f64,
    below: usize,
}

/// Exponent and four bits of mantissa: cells grow by at most 1/16, less than any two neighbouring edges are apart.
const KEY_SHIFT: u32 = 48;

impl TanSquared {
    fn new(angles: impl Iterator<Item = f64>) -> Self {
        let edges: Vec<f64> = angles.map(|a| a.tan().powi(2)).collect();
        let (low, high) = (edges[0], edges[edges.len() - 1]);
        let first = key(low) - 1;
        let cells = (first..=key(high) + 1)
            .map(|k| {
                let (start, end) = (f64::from_bits(k << KEY_SHIFT), f64::from_bits((k + 1) << KEY_SHIFT));
                let below = edges.partition_point(|&e| e <= start);
                let edge = edges.get(below).copied().filter(|&e| e < end).unwrap_or(f64::INFINITY);
                Cell { edge, below }
            })
            .collect();
        Self { first, cells }
    }

    /// Bin of a squared tangent ≥ 0; infinity is the last bin.
    #[inline]
    fn bin(&self, t: f64) -> usize {
        let k = key(t).saturating_sub(self.first).min(self.cells.len() as u64 - 1) as usize;
        let cell = self.cells[k];
        cell.below + usize::from(t >= cell.edge && cell.edge.is_finite())
    }
}

#[inline]
fn key(t: f64) -> u64 {
    t.to_bits() >> KEY_SHIFT
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_cell_holds_at_most_one_edge() {
        for (table, bins) in [(&*THETA_H, THETA_H_BINS), (&*DEGREES, 90)] {
            for pair in table.cells.windows(2) {
                assert!(pair[1].below - pair[0].below <= 1);
            }
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
            assert_eq!(DEGREES.bin(t), i as usize);
            assert_eq!(DEGREES.bin(t.next_down()), i as usize - 1);
        }
    }
}
