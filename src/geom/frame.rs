//! Orthonormal frames: world to local and back.

use glam::Vec3;

/// A right-handed frame whose `z` is the surface normal.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    x: Vec3,
    y: Vec3,
    z: Vec3,
}

impl Frame {
    /// Frame about the unit normal `n`, without branches at the pole (Duff et al. 2017).
    pub fn about(n: Vec3) -> Self {
        let (x, y) = n.any_orthonormal_pair();
        Self { x, y, z: n }
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
