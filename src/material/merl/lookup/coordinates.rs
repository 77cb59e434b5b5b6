//! From squared tangents to coordinates in bins, by cubics.

use std::sync::LazyLock;

use super::half_diff_tan2::HalfDiffTan2;
use crate::geometry::merl_axes::{degree_coordinate, theta_h_coordinate};
use crate::geometry::tan2_cells::{self, CELLS};

/// A pair's place in a table, in units of bins from the lower edge of bin 0 on each axis.
#[derive(Clone, Copy, Debug)]
pub(in crate::material::merl) struct Coordinates {
    /// 0 to 90, as √θh.
    pub theta_h: f64,
    /// 0 to 90, in degrees.
    pub theta_d: f64,
    /// −90 to 360, in degrees; the table's bins of φd are its period.
    pub phi_d: f64,
}

/// Coordinates by squared tangents: within 7·10⁻⁷ bins of arctangents, continuous and exact at the ends of cells. 64 KB.
pub(in crate::material::merl) struct CoordinateTables {
    theta_h: Cubics,
    degrees: Cubics,
}

impl CoordinateTables {
    /// The tables, filled at the first call.
    #[inline(always)]
    pub fn get() -> &'static Self {
        static TABLES: LazyLock<CoordinateTables> = LazyLock::new(|| CoordinateTables {
            theta_h: Cubics::new(theta_h_coordinate),
            degrees: Cubics::new(degree_coordinate),
        });
        &TABLES
    }

    /// Coordinates of a valid pair. `azimuth` gives the azimuth of wi in degrees, wanted where it is φd.
    #[inline(always)]
    pub fn compute(
        &self,
        tan2: HalfDiffTan2,
        phi_d_bins: usize,
        azimuth: impl FnOnce() -> f64,
    ) -> Coordinates {
        let phi_d = if tan2.theta_h > 0.0 {
            // Degrees on either side of φd = 0 or, in a table of 360, of φd = π.
            let opposite = (phi_d_bins == 360) & ((tan2.half_turn < 0.0) != (tan2.phi_d < 0.0));
            self.degrees
                .interpolate(tan2.phi_d.abs())
                .copysign(tan2.phi_d)
                + 180.0 * f64::from(u8::from(opposite))
        } else {
            azimuth()
        };
        Coordinates {
            theta_h: self.theta_h.interpolate(tan2.theta_h),
            theta_d: self.degrees.interpolate(tan2.theta_d),
            phi_d,
        }
    }
}

/// A function of a squared tangent, as a cubic in each cell.
struct Cubics {
    exact: fn(f64) -> f64,
    cells: Box<[[f64; 4]; CELLS]>,
}

impl Cubics {
    fn new(exact: fn(f64) -> f64) -> Self {
        Self {
            exact,
            cells: Box::new(std::array::from_fn(|k| cubic(exact, k))),
        }
    }

    /// The function at a squared tangent ≥ 0; its value at 0 for NaN.
    #[inline(always)]
    fn interpolate(&self, t: f64) -> f64 {
        let Some(c) = self.cells.get(tan2_cells::cell(t)) else {
            return self.beyond(t);
        };
        let x = t - tan2_cells::start(t);
        (c[0] + c[1] * x) + (c[2] + c[3] * x) * (x * x)
    }

    #[cold]
    fn beyond(&self, t: f64) -> f64 {
        (self.exact)(if t > 0.0 { t } else { 0.0 })
    }
}

/// Coefficients of the cubic through four values in a cell, by powers of the distance from its start. With nodes at
/// (1 ± 1)/2 and (1 ± (√2 − 1))/2 of the cell it is continuous, and its error the least that a continuous one can have.
fn cubic(f: fn(f64) -> f64, cell: usize) -> [f64; 4] {
    let (start, end) = tan2_cells::bounds(cell);
    let inner = (std::f64::consts::SQRT_2 - 1.0) * 0.5;
    let x = [0.0, 0.5 - inner, 0.5 + inner, 1.0].map(|s| s * (end - start));
    let mut d = x.map(|x| f(start + x));
    // Newton's divided differences, then Horner's scheme on polynomials.
    for order in 1..4 {
        for i in (order..4).rev() {
            d[i] = (d[i] - d[i - 1]) / (x[i] - x[i - order]);
        }
    }
    let mut c = [d[3], 0.0, 0.0, 0.0];
    for i in (0..3).rev() {
        for k in (1..4).rev() {
            c[k] = c[k - 1] - x[i] * c[k];
        }
        c[0] = d[i] - x[i] * c[0];
    }
    c
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_those_of_arctangents() {
        let tables = CoordinateTables::get();
        let mut worst = [0.0f64; 2];
        for i in 0..=400_000 {
            // Squared tangents from 2⁻⁶⁰ to 2²⁰, past both ends of the tables.
            let t = (f64::from(i) / 5000.0 - 60.0).exp2();
            worst[0] = worst[0].max((tables.theta_h.interpolate(t) - theta_h_coordinate(t)).abs());
            worst[1] = worst[1].max((tables.degrees.interpolate(t) - degree_coordinate(t)).abs());
        }
        assert!(worst.iter().all(|&e| e < 7e-7), "{worst:?}");
    }

    #[test]
    fn ends_are_exact() {
        let tables = CoordinateTables::get();
        for table in [&tables.theta_h, &tables.degrees] {
            assert_eq!(
                [0.0, f64::NAN, f64::INFINITY].map(|t| table.interpolate(t)),
                [0.0, 0.0, 90.0]
            );
            for k in 0..CELLS {
                let (start, end) = tan2_cells::bounds(k);
                assert!(
                    (table.interpolate(start) - (table.exact)(start)).abs() < 1e-12,
                    "{start}"
                );
                assert!(
                    (table.interpolate(end.next_down()) - (table.exact)(end)).abs() < 1e-11,
                    "{end}"
                );
            }
        }
    }
}
