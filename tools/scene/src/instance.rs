//! Shapes that are placed: one mesh in many places, without a copy.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use merlkit::render::{Intersection, Ray, Shape};
use merlkit::{Error, Result};

/// A shape that is turned, scaled, sheared and moved.
#[derive(Clone, Debug)]
pub struct Instance {
    shape: Arc<dyn Shape>,
    to_world: DAffine3,
    to_local: DAffine3,
    /// Takes normals of the shape to those of the instance, but for their length.
    of_normals: DMat3,
}

impl Instance {
    /// Places a shape by a map from its space to that of the scene.
    ///
    /// # Errors
    /// [`Error::Argument`] for a map that is not finite or presses the shape flat.
    pub fn new(shape: Arc<dyn Shape>, to_world: DAffine3) -> Result<Self> {
        let to_local = to_world.inverse();
        if !(to_world.is_finite() && to_local.is_finite()) {
            return Err(Error::argument(
                "an object is scaled to nothing or moved to infinity",
                "give scales other than 0 and finite numbers",
            ));
        }
        Ok(Self {
            of_normals: to_local.matrix3.transpose(),
            shape,
            to_world,
            to_local,
        })
    }

    /// The ray in the space of the shape, and how much longer its distances are there.
    #[inline(always)]
    fn localize(&self, ray: &Ray) -> (Ray, f64) {
        let direction = self.to_local.transform_vector3(ray.direction);
        let stretch = direction.length();
        let local = Ray {
            origin: self.to_local.transform_point3(ray.origin),
            direction: direction / stretch,
        };
        (local, stretch)
    }
}

impl Shape for Instance {
    fn intersect(&self, ray: &Ray, near: f64, far: f64) -> Option<Intersection> {
        let (local, stretch) = self.localize(ray);
        let hit = self
            .shape
            .intersect(&local, near * stretch, far * stretch)?;
        // Normals go by the transpose of the inverse. A map that mirrors leaves them on the side that they are on.
        let normal = (self.of_normals * hit.normal).normalize_or(-ray.direction);
        let distance = hit.distance / stretch;
        (distance > near && distance < far).then_some(Intersection { distance, normal })
    }

    fn blocks(&self, ray: &Ray, near: f64, far: f64) -> bool {
        let (local, stretch) = self.localize(ray);
        self.shape.blocks(&local, near * stretch, far * stretch)
    }

    fn is_convex(&self) -> bool {
        // Affine maps take lines to lines.
        self.shape.is_convex()
    }

    fn support(&self, along: DVec3) -> f64 {
        // n·(A·p + b) = (Aᵀ·n)·p + n·b
        let local = self.to_world.matrix3.transpose() * along;
        self.shape.support(local) + along.dot(self.to_world.translation)
    }

    fn plane_normal(&self) -> Option<DVec3> {
        let normal = self.of_normals * self.shape.plane_normal()?;
        normal.try_normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use merlkit::render::Sphere;

    #[test]
    fn an_ellipsoid_is_met_where_it_is() {
        let ball = Sphere {
            centre: DVec3::ZERO,
            radius: 1.0,
        };
        let to_world = DAffine3::from_translation(DVec3::new(5.0, 0.0, 0.0))
            * DAffine3::from_scale(DVec3::new(2.0, 1.0, 0.5));
        let egg = Instance::new(Arc::new(ball), to_world).unwrap();
        let ray = Ray {
            origin: DVec3::new(5.0, 0.0, 4.0),
            direction: DVec3::NEG_Z,
        };
        let hit = egg.intersect(&ray, 0.0, f64::INFINITY).unwrap();
        assert!((hit.distance - 3.5).abs() < 1e-12 && hit.normal.abs_diff_eq(DVec3::Z, 1e-12));
        assert!(egg.blocks(&ray, 0.0, 3.6) && !egg.blocks(&ray, 0.0, 3.4));
        assert_eq!(egg.support(DVec3::X), 7.0);
        assert_eq!(egg.support(DVec3::NEG_Z), 0.5);
        assert!(Instance::new(Arc::new(ball), DAffine3::from_scale(DVec3::ZERO)).is_err());
        // x²/4 + y² + 4z² = 1 has the normal (x/4, y, 4z).
        let slanted = Ray {
            origin: DVec3::new(6.0, 0.3, 4.0),
            direction: DVec3::NEG_Z,
        };
        let hit = egg.intersect(&slanted, 0.0, f64::INFINITY).unwrap();
        let p = slanted.point_at(hit.distance) - DVec3::new(5.0, 0.0, 0.0);
        let expected = DVec3::new(p.x / 4.0, p.y, 4.0 * p.z).normalize();
        assert!(hit.normal.abs_diff_eq(expected, 1e-12));
    }
}
