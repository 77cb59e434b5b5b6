//! Half and difference angles (Rusinkiewicz 1998).

use glam::DVec3;

/// The half vector of a pair and the light direction seen from it.
///
/// `theta_h` and `theta_d` lie in [0, π/2] for directions above the horizon; `phi_d` in (−π, π].
///
/// # Examples
/// ```
/// use merlkit::geometry::{HalfDiff, half_vector, reflect_about, spherical};
///
/// let (wo, wi) = (spherical(0.4, 0.0), spherical(0.7, 2.0));
/// let h = half_vector(wo, wi).expect("not opposed");
/// assert!(reflect_about(wo, h).abs_diff_eq(wi, 1e-12));
///
/// // Exchanging the directions changes neither θh nor θd.
/// let forth = HalfDiff::from_directions(wo, wi).expect("not opposed");
/// let back = HalfDiff::from_directions(wi, wo).expect("not opposed");
/// assert!((forth.theta_h - back.theta_h).abs() < 1e-12);
/// assert!((forth.theta_d - back.theta_d).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfDiff {
    /// Angle between the normal and the half vector.
    pub theta_h: f64,
    /// Angle between the half vector and either direction.
    pub theta_d: f64,
    /// Azimuth of `wi` about the half vector, 0 in the plane of the normal, away from it.
    pub phi_d: f64,
}

impl HalfDiff {
    /// Angles of a pair of directions of equal length; `None` where they oppose each other and no half vector exists.
    ///
    /// Written without rotations. With H = wo + wi and ρ = |H.xy|: tan θh = ρ/H.z, tan θd = |wo − wi|/|H|, and the
    /// difference vector's components along and across the plane of the normal are
    /// (wo.z − wi.z)/(2 sin θh) and (wo × wi).z/ρ, so that
    /// φd = atan2((wo × wi).z, (wo.z − wi.z)·|H|/2). Arctangents keep small angles accurate where arc cosines don't. At
    /// θh = 0 the normal fixes no plane, and φd is the azimuth of `wi`.
    pub fn from_directions(wo: DVec3, wi: DVec3) -> Option<Self> {
        // Step 1: H = wo + wi, which opposed directions don't have.
        let sum = wo + wi;
        let length = sum.length();
        if length == 0.0 {
            return None;
        }
        // Step 2: φd, by both components of the difference vector times ρ, which cancels.
        let rho = sum.x.hypot(sum.y);
        let phi_d = if rho == 0.0 {
            wi.y.atan2(wi.x)
        } else {
            let across = wo.x * wi.y - wo.y * wi.x;
            let along = (wo.z - wi.z) * length * 0.5;
            across.atan2(along)
        };
        Some(Self {
            theta_h: rho.atan2(sum.z),
            theta_d: (wo - wi).length().atan2(length),
            phi_d,
        })
    }
}

/// The unit half vector, or `None` for opposed directions.
///
/// See [`HalfDiff`](crate::geometry::HalfDiff) for an example.
pub fn half_vector(wo: DVec3, wi: DVec3) -> Option<DVec3> {
    (wo + wi).try_normalize()
}

/// `w` mirrored about the unit vector `h`: the light direction whose half vector with `w` is `h`.
///
/// See [`HalfDiff`](crate::geometry::HalfDiff) for an example.
#[inline]
pub fn reflect_about(w: DVec3, h: DVec3) -> DVec3 {
    debug_assert!((h.length_squared() - 1.0).abs() < 2e-4);
    2.0 * w.dot(h) * h - w
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::spherical;

    /// The definition: rotate `wi` by −φh about z, then by −θh about y.
    fn by_rotation(wo: DVec3, wi: DVec3) -> HalfDiff {
        let h = (wo + wi).normalize();
        let theta_h = h.x.hypot(h.y).atan2(h.z);
        let phi_h = h.y.atan2(h.x);
        let about_z = glam::DQuat::from_rotation_z(-phi_h) * wi;
        let d = glam::DQuat::from_rotation_y(-theta_h) * about_z;
        HalfDiff {
            theta_h,
            theta_d: d.x.hypot(d.y).atan2(d.z),
            phi_d: d.y.atan2(d.x),
        }
    }

    #[test]
    fn agrees_with_the_rotations() {
        for i in 0..400 {
            let k = f64::from(i);
            let wo = spherical(
                (k * 0.618).fract() * 1.57,
                (k * 0.414).fract() * std::f64::consts::TAU,
            );
            let wi = spherical(
                (k * 0.732).fract() * 1.57,
                (k * 0.236).fract() * std::f64::consts::TAU,
            );
            let (a, b) = (
                HalfDiff::from_directions(wo, wi).unwrap(),
                by_rotation(wo, wi),
            );
            assert!((a.theta_h - b.theta_h).abs() < 1e-12, "{a:?} {b:?}");
            assert!((a.theta_d - b.theta_d).abs() < 1e-12, "{a:?} {b:?}");
            let turn = (a.phi_d - b.phi_d).rem_euclid(std::f64::consts::TAU);
            assert!(turn.min(std::f64::consts::TAU - turn) < 1e-9, "{a:?} {b:?}");
        }
    }

    #[test]
    fn opposed_directions_have_no_half_vector() {
        assert_eq!(HalfDiff::from_directions(DVec3::Z, -DVec3::Z), None);
        assert_eq!(half_vector(DVec3::X, -DVec3::X), None);
    }

    #[test]
    fn equal_directions_have_no_difference() {
        let w = spherical(0.7, 1.0);
        let a = HalfDiff::from_directions(w, w).unwrap();
        assert_eq!(a.theta_d, 0.0);
        assert!((a.theta_h - 0.7).abs() < 1e-15);
    }

    #[test]
    fn reflection_has_the_half_vector_it_came_from() {
        let (w, h) = (spherical(0.4, 2.0), spherical(0.3, -1.0));
        assert!(
            half_vector(w, reflect_about(w, h))
                .unwrap()
                .abs_diff_eq(h, 1e-14)
        );
    }
}
