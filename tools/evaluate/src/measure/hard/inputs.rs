//! Directions, pairs of directions and random numbers at which formulas divide by zero, cancel or overflow.

use glam::{Vec2, Vec3};

use merlkit::geometry::spherical;
use merlkit::points::PointSet;

/// A direction and what is hard about it.
#[derive(Clone, Debug, PartialEq)]
pub struct HardDirection {
    /// In a few words.
    pub about: String,
    /// The direction; may be none at all.
    pub w: Vec3,
}

/// Directions above the horizon or just so, and vectors that are no directions above it.
pub fn hard_directions() -> Vec<HardDirection> {
    let mut all = Vec::new();
    let mut add = |about: &str, w: Vec3| {
        all.push(HardDirection {
            about: about.into(),
            w,
        })
    };
    add("normal", Vec3::Z);
    add("normal, -0", Vec3::new(-0.0, -0.0, 1.0));
    for theta in [1e-7, 1e-3, 30.0, 45.0, 60.25, 89.5f64] {
        for phi in [0.0, 90.0, 211.3f64] {
            add(
                "ordinary",
                spherical(theta.to_radians(), phi.to_radians()).as_vec3(),
            );
        }
    }
    for power in 3..=12 {
        let z = 10f64.powi(-power);
        let rho = (1.0 - z * z).sqrt();
        add("nearly horizontal", Vec3::new(rho as f32, 0.0, z as f32));
        add(
            "nearly horizontal",
            Vec3::new((-0.6 * rho) as f32, (0.8 * rho) as f32, z as f32),
        );
    }
    add("horizontal", Vec3::X);
    add("horizontal, -0", Vec3::new(0.0, 1.0, -0.0));
    add("just below the horizon", Vec3::new(1.0, 0.0, -1e-9));
    add("below the horizon", Vec3::new(0.6, 0.0, -0.8));
    for w in [
        [1e-45, 0.0, 1.0],
        [1e-40, -1e-42, 1.0],
        [1.0, 0.0, 1e-45],
        [1.0, 1e-45, 1e-40],
    ] {
        add("denormal component", w.into());
    }
    for length in [1.001f32, 0.999, 1e-3, 1e3, 1e-30, 1e30] {
        add("not of unit length", Vec3::new(0.48, 0.36, 0.8) * length);
    }
    add("overflowing length", Vec3::splat(f32::MAX));
    add("denormal vector", Vec3::new(1e-45, 0.0, 1e-45));
    add("zero vector", Vec3::ZERO);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        add("not finite", Vec3::new(bad, 0.0, 1.0));
        add("not finite", Vec3::new(0.0, bad, 1.0));
        add("not finite", Vec3::new(0.0, 0.0, bad));
    }
    all
}

/// Light directions that are hard beside `wo`: itself, the mirror direction and what rounding makes of it, the opposite,
/// every degree of azimuth, and those of [`hard_directions`].
pub fn hard_partners(wo: Vec3) -> Vec<Vec3> {
    let mirror = Vec3::new(-wo.x, -wo.y, wo.z);
    let mut all = vec![wo, mirror, -wo, Vec3::new(wo.x, wo.y, -wo.z)];
    for step in [1e-7f32, -1e-7, 1e-4] {
        all.extend([Vec3::X, Vec3::Y, Vec3::Z].map(|axis| mirror + step * axis));
        all.extend([Vec3::X, Vec3::Y, Vec3::Z].map(|axis| wo + step * axis));
    }
    // With wo in the plane of incidence these put phi_d at the edges of its bins, as near as f32 comes.
    for degree in 0..360 {
        let phi = f64::from(degree).to_radians();
        all.push(spherical(0.7, phi).as_vec3());
    }
    all.extend(hard_directions().into_iter().map(|d| d.w));
    all
}

/// Points of the unit square: its corners and edges, every power of two, equal numbers in both dimensions, the first points
/// of sequences and those near index 2³² and at the last.
pub fn hard_points() -> Vec<Vec2> {
    let top = 1.0f32.next_down();
    let mut ends = vec![0.0, top, f32::MIN_POSITIVE, f32::from_bits(1)];
    ends.extend((1..=24).flat_map(|k| [0.5f32.powi(k), 1.0 - 0.5f32.powi(k)]));
    ends.extend((30..=140).step_by(10).map(|k| 0.5f32.powi(k)));
    let mut all: Vec<Vec2> = Vec::new();
    for a in ends {
        all.extend([[a, a], [a, 0.0], [0.0, a], [a, top], [top, a]].map(Vec2::from));
    }
    for points in [PointSet::Sobol, PointSet::Random] {
        for index in [0, 1, 65_535, 65_536, (1 << 32) - 1, 1 << 32, u64::MAX] {
            all.extend((0..3).map(|seed| points.point(seed, index, 0)));
        }
    }
    all
}

/// Points that are outside the unit square or none at all.
pub fn wrong_points() -> [Vec2; 7] {
    let bad = f32::NAN;
    [
        [1.0, 1.0],
        [1.0, 0.3],
        [-0.5, 0.3],
        [0.3, 2.0],
        [bad, 0.3],
        [0.3, bad],
        [f32::INFINITY, -f32::INFINITY],
    ]
    .map(Vec2::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_lie_in_the_square_and_directions_on_both_sides_of_the_horizon() {
        assert!(
            hard_points()
                .iter()
                .all(|u| (0.0..1.0).contains(&u.x) && (0.0..1.0).contains(&u.y))
        );
        let valid = hard_directions()
            .iter()
            .filter(|d| merlkit::geometry::is_upper(d.w))
            .count();
        assert!(
            valid > 50 && hard_directions().len() - valid > 10,
            "{valid}"
        );
    }
}
