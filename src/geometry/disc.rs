//! Equal-area maps from the unit square to the disc, and from the disc to the hemisphere.

use glam::{DVec2, DVec3};

use super::approx;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Shirley and Chiu's concentric map: [0,1)² to the unit disc, area preserving and continuous.
///
/// See [`cosine_hemisphere`](crate::geometry::cosine_hemisphere) for an example.
pub fn concentric_disc(u: DVec2) -> DVec2 {
    // Step 1: the square [−1, 1]², whose centre has no azimuth.
    let p = 2.0 * u - DVec2::ONE;
    if p == DVec2::ZERO {
        return DVec2::ZERO;
    }
    // Step 2: squares about the centre become circles. The larger coordinate is the radius and φ = π/4·y/x from the
    // x axis, or π/2 − π/4·x/y near the y axis. A negative radius reaches the opposite quarter with the same φ.
    let (r, phi) = if p.x.abs() > p.y.abs() {
        (p.x, FRAC_PI_4 * (p.y / p.x))
    } else {
        (p.y, FRAC_PI_2 - FRAC_PI_4 * (p.x / p.y))
    };
    r * DVec2::new(phi.cos(), phi.sin())
}

/// The point of the unit square that [`concentric_disc`] maps to `p`, to some 10⁻⁸; the rim and beyond go to the edge.
///
/// See [`cosine_hemisphere`](crate::geometry::cosine_hemisphere) for an example.
pub fn concentric_square(p: DVec2) -> DVec2 {
    // Step 1: the nearer axis, and the angle from it as a fraction of π/4, in [−1, 1].
    let r = p.length();
    let steep = p.y.abs() >= p.x.abs();
    let (along, across) = if steep { (p.y, p.x) } else { (p.x, p.y) };
    let share = approx::atan2(across * along.signum(), along.abs()) * (1.0 / FRAC_PI_4);
    // Step 2: ±r along that axis, and this fraction of it across.
    let (along, across) = (r.copysign(along), r.copysign(along) * share);
    let q = if steep {
        DVec2::new(across, along)
    } else {
        DVec2::new(along, across)
    };
    (0.5 * (q + DVec2::ONE)).clamp(DVec2::ZERO, DVec2::ONE)
}

/// [0,1)² to the hemisphere with density cosθ/π per solid angle (Malley). `z` is 0 only on the rim of the disc.
///
/// # Examples
/// ```
/// use merlkit::geometry::{concentric_disc, concentric_square, cosine_hemisphere};
/// use merlkit::glam::DVec2;
///
/// let u = DVec2::new(0.3, 0.7);
/// let p = concentric_disc(u);
/// assert!(concentric_square(p).abs_diff_eq(u, 1e-7));
///
/// // Malley's method lifts the point of the disc to the hemisphere.
/// assert!(cosine_hemisphere(u).truncate().abs_diff_eq(p, 1e-12));
/// ```
pub fn cosine_hemisphere(u: DVec2) -> DVec3 {
    // dx dy = cosθ dσ: what is uniform on the disc, of density 1/π, has the density cosθ/π on the hemisphere.
    let d = concentric_disc(u);
    d.extend((1.0 - d.length_squared()).max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::FibonacciLattice;

    #[test]
    fn the_square_gives_back_what_the_disc_was_given() {
        for (x, y) in FibonacciLattice::at_least(5000).points() {
            let back = concentric_square(concentric_disc(DVec2::new(x, y)));
            assert!(
                back.abs_diff_eq(DVec2::new(x, y), 5e-8),
                "({x}, {y}): {back}"
            );
        }
        assert_eq!(concentric_square(DVec2::ZERO), DVec2::splat(0.5));
        assert_eq!(concentric_square(DVec2::new(2.0, 0.0)).x, 1.0);
    }
}
