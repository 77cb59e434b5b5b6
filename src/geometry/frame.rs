//! Orthonormal frames: world to local and back.

use glam::Vec3;

/// A right-handed frame whose `z` is the surface normal.
///
/// # Examples
/// ```
/// use merlkit::geometry::Frame;
/// use merlkit::glam::Vec3;
///
/// let frame = Frame::from_normal(Vec3::X);
/// assert!(frame.to_local(Vec3::X).abs_diff_eq(Vec3::Z, 1e-6));
/// assert!(frame.to_world(Vec3::Z).abs_diff_eq(Vec3::X, 1e-6));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    x: Vec3,
    y: Vec3,
    z: Vec3,
}

impl Frame {
    /// Frame about the unit normal `n`, without branches at the pole (Duff et al. 2017).
    pub fn from_normal(n: Vec3) -> Self {
        debug_assert!(n.is_normalized());
        let (x, y) = n.any_orthonormal_pair();
        Self { x, y, z: n }
    }

    /// Frame about the unit normal `n` whose x runs along the circle about the unit vector `axis`, as `axis` × `n`; as
    /// [`Self::from_normal`] within 10⁻⁶ of that axis.
    pub fn around(n: Vec3, axis: Vec3) -> Self {
        // |axis × n| is the sine of their angle. Below 10⁻⁶ the rounding of f32 would choose the direction.
        let along = axis.cross(n);
        if along.length_squared() < 1e-12 {
            return Self::from_normal(n);
        }
        let x = along.normalize();
        Self {
            x,
            y: n.cross(x),
            z: n,
        }
    }

    /// World to local.
    pub fn to_local(&self, w: Vec3) -> Vec3 {
        Vec3::new(w.dot(self.x), w.dot(self.y), w.dot(self.z))
    }

    /// Local to world.
    pub fn to_world(&self, w: Vec3) -> Vec3 {
        self.x * w.x + self.y * w.y + self.z * w.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_around_an_axis_run_along_its_circles() {
        for n in [
            Vec3::X,
            Vec3::Z,
            Vec3::new(0.6, -0.64, 0.48),
            Vec3::Y,
            -Vec3::Y,
        ] {
            let frame = Frame::around(n, Vec3::Y);
            for w in [Vec3::X, Vec3::Y, Vec3::Z] {
                assert!(
                    frame.to_world(frame.to_local(w)).abs_diff_eq(w, 1e-6),
                    "{n}"
                );
            }
            assert!(frame.to_local(n).abs_diff_eq(Vec3::Z, 1e-6), "{n}");
            assert!(
                frame
                    .to_world(Vec3::X)
                    .cross(frame.to_world(Vec3::Y))
                    .abs_diff_eq(n, 1e-6),
                "{n}"
            );
            let off_axis = n.cross(Vec3::Y).length() > 0.1;
            assert!(
                !off_axis
                    || frame
                        .to_world(Vec3::X)
                        .abs_diff_eq(Vec3::Y.cross(n).normalize(), 1e-6),
                "{n}"
            );
        }
    }
}
