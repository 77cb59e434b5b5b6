//! Directions and the points of an equirectangular map.

use std::f64::consts::FRAC_1_PI;

use glam::{DVec2, DVec3};

use crate::geometry::approx::{fine_atan2, fine_sin_cos_turns};

/// Unit vector, to 10⁻¹², of a longitude in turns and the cosine of a polar angle.
#[inline(always)]
pub(super) fn direction_of(longitude: f64, cos: f64) -> DVec3 {
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
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
