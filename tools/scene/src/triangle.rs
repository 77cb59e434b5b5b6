//! Where a ray meets a triangle, so that no ray slips between two that have an edge in common.
//!
//! Corners are moved and sheared so that the ray becomes the z axis (Woop, Benthin and Wald 2013). Each corner's image depends
//! on the ray and on that corner alone, and the side of an edge on which the ray passes on the edge's two images alone:
//! neighbours compute the same number but for its sign. Edges belong to both of their triangles.

use glam::DVec3;

/// The corners of a triangle, ordered by coordinate: `coordinates[axis][corner]`. The axes that a ray calls x, y and z are then
/// three loads, whichever they are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    coordinates: [[f64; 3]; 3],
}

impl Triangle {
    pub(crate) fn new([a, b, c]: [DVec3; 3]) -> Self {
        Self {
            coordinates: [[a.x, b.x, c.x], [a.y, b.y, c.y], [a.z, b.z, c.z]],
        }
    }

    #[inline(always)]
    pub(crate) fn corners(&self) -> [DVec3; 3] {
        let [x, y, z] = self.coordinates;
        [0, 1, 2].map(|corner| DVec3::new(x[corner], y[corner], z[corner]))
    }
}

/// A ray, with the shear that turns its direction into the z axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShearedRay {
    /// Which axes become x, y and z; z is that in which the direction is longest.
    axes: [usize; 3],
    /// The origin by these axes.
    permuted_origin: DVec3,
    shear: DVec3,
}

/// Where a triangle is met.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TriangleHit {
    /// Distance along the ray.
    pub(crate) distance: f64,
    /// Weights of the corners, whose sum is 1.
    pub(crate) weights: DVec3,
    /// Whether the corners appear counter-clockwise from where the ray comes.
    pub(crate) from_front: bool,
}

impl ShearedRay {
    /// `direction` is a unit vector.
    #[inline(always)]
    pub(crate) fn new(origin: DVec3, direction: DVec3) -> Self {
        // Step 1: z is the longest axis of the direction; x and y follow in cyclic order.
        let z = direction.abs().max_position();
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        // Step 2: the shear x ← x − z·dx/dz, y ← y − z·dy/dz, z ← z/dz takes the direction to (0, 0, 1).
        let shear = DVec3::new(
            direction[axes[0]] / direction[z],
            direction[axes[1]] / direction[z],
            1.0 / direction[z],
        );
        Self {
            permuted_origin: DVec3::from(axes.map(|axis| origin[axis])),
            axes,
            shear,
        }
    }

    /// Where the ray, or its continuation to behind its origin, meets the triangle.
    #[inline(always)]
    pub(crate) fn meet(&self, triangle: &Triangle) -> Option<TriangleHit> {
        // Step 1: the images of the corners but for the scale of z.
        let axes = self.axes.map(|axis| triangle.coordinates[axis]);
        let origin = self.permuted_origin;
        let (mut x, mut y, mut z) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        for corner in 0..3 {
            z[corner] = axes[2][corner] - origin.z;
            x[corner] = axes[0][corner] - origin.x - self.shear.x * z[corner];
            y[corner] = axes[1][corner] - origin.y - self.shear.y * z[corner];
        }
        // Step 2: twice the signed areas that the origin spans with each edge, u for the one opposite to the first corner.
        let u = x[2] * y[1] - y[2] * x[1];
        let v = x[0] * y[2] - y[0] * x[2];
        let w = x[1] * y[0] - y[1] * x[0];
        // Step 3: the origin is inside, or on an edge, if none of them differs in sign from another.
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let sum = u + v + w;
        if sum == 0.0 {
            // The ray lies in the triangle's plane.
            return None;
        }
        // Step 4: the distance is the mean of the images' z, weighted by u, v and w.
        let weights = DVec3::new(u, v, w) / sum;
        let z = z.map(|z| self.shear.z * z);
        let distance = weights.x * z[0] + weights.y * z[1] + weights.z * z[2];
        distance.is_finite().then_some(TriangleHit {
            distance,
            weights,
            // Images keep their orientation where the z axis keeps its sense.
            from_front: (sum < 0.0) == (self.shear.z < 0.0),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_is_met_from_both_sides() {
        let triangle = Triangle::new([DVec3::ZERO, DVec3::X, DVec3::Y]);
        for (z, from_front) in [(2.0, true), (-2.0, false)] {
            let origin = DVec3::new(0.25, 0.5, z);
            let ray = ShearedRay::new(origin, DVec3::new(0.0, 0.0, -z / 2.0));
            let hit = ray.meet(&triangle).unwrap();
            assert_eq!((hit.distance, hit.from_front), (2.0, from_front), "{z}");
            assert!(hit.weights.abs_diff_eq(DVec3::new(0.25, 0.25, 0.5), 1e-15));
        }
        let past = ShearedRay::new(DVec3::new(0.6, 0.6, 1.0), DVec3::NEG_Z);
        assert!(past.meet(&triangle).is_none());
        let within = ShearedRay::new(DVec3::new(-1.0, 0.2, 0.0), DVec3::X);
        assert!(within.meet(&triangle).is_none());
    }

    /// The side is that of (b − a) × (c − a), from any direction.
    #[test]
    fn the_front_is_where_the_normal_points() {
        let corners = [
            DVec3::new(0.3, -1.0, 0.2),
            DVec3::new(-0.7, 0.4, 1.0),
            DVec3::new(0.9, 0.8, -0.5),
        ];
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        for i in 0..60 {
            let angle = f64::from(i);
            let direction = DVec3::new(angle.sin(), (1.7 * angle).cos(), (0.9 * angle).sin());
            let direction = direction.normalize();
            let hit =
                ShearedRay::new(middle - 3.0 * direction, direction).meet(&Triangle::new(corners));
            let hit = hit.unwrap();
            assert!((hit.distance - 3.0).abs() < 1e-12);
            assert_eq!(hit.from_front, normal.dot(direction) < 0.0, "{i}");
        }
    }
}
