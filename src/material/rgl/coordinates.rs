//! Where directions lie among a file's tables: on the square of half vectors, and among the tabulated given directions.
//!
//! Single pairs and blocks of lanes go through the same operations in the same order, so they get the same bits. Angles are
//! good to 4·10⁻¹² rad.

use std::f64::consts::{FRAC_1_PI, FRAC_2_PI};

use glam::{DVec3, Vec3};

use crate::geometry::Symmetry;
use crate::geometry::approx::fine_atan2;
use crate::lanes::Columns;

/// Lanes of a batch that go through a step together.
pub(super) const LANES: usize = 32;

/// `wo` among the azimuths that a file tabulates.
#[derive(Clone, Copy, Debug)]
pub(super) struct FoldedView {
    /// The folded direction, unit length.
    pub wo: DVec3,
    /// Signs of x and y that fold `wo`; the same signs take every other direction along, and back.
    pub signs: DVec3,
}

impl FoldedView {
    /// Folds a unit `wo` by the material's symmetry, which leaves f_r as it is.
    #[inline(always)]
    pub fn new(wo: Vec3, symmetry: Symmetry) -> Self {
        let signs = symmetry.signs(wo).as_dvec3();
        Self {
            wo: wo.as_dvec3() * signs,
            signs,
        }
    }

    /// wo + wi, the half vector before it is brought to unit length; `wi` goes along with the fold.
    #[inline(always)]
    pub fn half_vector(&self, wi: Vec3) -> DVec3 {
        self.wo + wi.as_dvec3() * self.signs
    }
}

/// Polar angle and azimuth in [−π, π] of a direction of any length, radians.
#[inline(always)]
pub(super) fn polar_angles([x, y, z]: [f64; 3]) -> [f64; 2] {
    [fine_atan2((x * x + y * y).sqrt(), z), fine_atan2(y, x)]
}

/// The point of a file's square for a polar angle and an azimuth in (−2π, 2π): (√(2θ/π), φ/2π + ½ modulo 1).
#[inline(always)]
pub(super) fn square_point([theta, phi]: [f64; 2]) -> [f64; 2] {
    let turns = 0.5 * FRAC_1_PI * phi + 0.5;
    // The whole turns of a number in (−½, 3/2), without a call and without a branch.
    let whole = f64::from(u8::from(turns >= 1.0)) - f64::from(u8::from(turns < 0.0));
    [(theta * FRAC_2_PI).sqrt(), turns - whole]
}

/// Writes [`polar_angles`] of the first `count` lanes.
#[inline(always)]
pub(super) fn lane_angles(
    directions: &Columns<f64, 3, LANES>,
    count: usize,
    angles: &mut Columns<f64, 2, LANES>,
) {
    for lane in 0..count.min(LANES) {
        angles.set(lane, polar_angles(directions.get(lane)));
    }
}

/// Turns the angles of the first `count` lanes into [`square_point`], azimuths counted from those of `origins`.
#[inline(always)]
pub(super) fn angles_to_points(
    angles: &mut Columns<f64, 2, LANES>,
    origins: &Columns<f64, 1, LANES>,
    count: usize,
) {
    for lane in 0..count.min(LANES) {
        let ([theta, phi], [origin]) = (angles.get(lane), origins.get(lane));
        angles.set(lane, square_point([theta, phi - origin]));
    }
}
