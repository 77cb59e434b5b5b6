//! Directions and the points of an equirectangular map.

use std::f64::consts::FRAC_1_PI;

use glam::{DVec2, DVec3};

use crate::geometry::approx::{fine_atan2, fine_sin_cos_turns};

/// Unit vector, to 10⁻¹², of a longitude in turns and the cosine of a polar angle.
#[inline(always)]
pub(super) fn direction_of(longitude: f64, cos: f64) -> DVec3 {
    let sin = sine(cos);
    // Half a turn, the middle of the map, is −z. A quarter more is +x.
    let (s, c) = fine_sin_cos_turns(longitude - 0.5);
    DVec3::new(sin * s, cos, -sin * c)
}

/// Longitude and latitude of a unit vector as fractions in [0, 1], to 10⁻¹².
#[inline(always)]
pub(super) fn square_of(direction: DVec3) -> DVec2 {
    let longitude = fine_atan2(direction.x, -direction.z) * (0.5 * FRAC_1_PI) + 0.5;
    let horizontal = (direction.x * direction.x + direction.z * direction.z).sqrt();
    DVec2::new(longitude, fine_atan2(horizontal, direction.y) * FRAC_1_PI)
}

/// Latitude of the cosine of a polar angle, as [`square_of`] counts it.
#[inline(always)]
pub(super) fn latitude_of(cos: f64) -> f64 {
    fine_atan2(sine(cos), cos) * FRAC_1_PI
}

/// Sine of a polar angle: √((1 − cos)(1 + cos)), without loss near the poles, where 1 − cos² would cancel.
#[inline(always)]
fn sine(cos: f64) -> f64 {
    ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt()
}

/// A point of a map between the centres of four pixels, whose rows are padded by a pixel at either end.
#[derive(Clone, Copy, Debug)]
pub(super) struct MapPoint {
    /// Index of the upper left pixel.
    pub(super) corner: u32,
    /// Index of the nearest pixel, which is the one that holds the point.
    pub(super) nearest: u32,
    /// How far it is from the left ones to the right ones, [0, 1].
    pub(super) s: f32,
    /// How far it is from the upper ones to the lower ones, [0, 1].
    pub(super) t: f32,
}

impl MapPoint {
    /// The point `p` of a map, in pixels from its upper left corner; `extent` is the map's.
    #[inline(always)]
    pub(super) fn new(p: DVec2, extent: DVec2) -> Self {
        // Centres are half a pixel from the edges, and there is a pixel to the left of the map. What is not a number becomes 0.
        let x = p.x.max(0.0).min(extent.x) + 0.5;
        // Radiance is constant beyond the first and the last row of centres.
        let y = (p.y - 0.5).max(0.0).min(extent.y - 1.0);
        // Coordinates of a padded map are whole at the centres of pixels, and half way between them at the edges.
        let (column, row) = (round(x - 0.5), round(y - 0.5));
        let stride = extent.x + 2.0;
        Self {
            corner: index(row * stride + column),
            nearest: index(round(y) * stride + round(x)),
            s: (x - column) as f32,
            t: (y - row) as f32,
        }
    }
}

/// To this, numbers are added as integers: rounding without a call, and conversion by the low bits, in vector code.
const ROUND: f64 = 1.5 * (1u64 << 52) as f64;

/// The nearest whole number; either of two.
#[inline(always)]
fn round(v: f64) -> f64 {
    (v + ROUND) - ROUND
}

/// A whole number below 2³².
#[inline(always)]
fn index(v: f64) -> u32 {
    (v + ROUND).to_bits() as u32
}
