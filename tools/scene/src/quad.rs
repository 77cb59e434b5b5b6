//! Parallelograms.

use glam::DVec3;
use merlkit::render::{Intersection, Ray, Shape};
use merlkit::{Error, Result};

/// A flat parallelogram that reflects on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quad {
    corner: DVec3,
    edge_u: DVec3,
    edge_v: DVec3,
    /// Unit normal, along `edge_u` × `edge_v`.
    normal: DVec3,
    /// With these a point's coordinates along the edges are products: (p − corner)·dual.
    dual_u: DVec3,
    dual_v: DVec3,
}

impl Quad {
    /// A corner and the two edges that begin there.
    ///
    /// # Errors
    /// [`Error::Argument`] for numbers that are not finite, and for edges that span no area.
    pub fn new(corner: DVec3, edge_u: DVec3, edge_v: DVec3) -> Result<Self> {
        let across = edge_u.cross(edge_v);
        let area2 = across.length_squared();
        let longest = edge_u.length_squared().max(edge_v.length_squared());
        let is_usable =
            corner.is_finite() && area2.is_finite() && area2 > 1e-24 * longest * longest;
        if !is_usable {
            return Err(Error::argument(
                format!("a quad at {corner} with the edges {edge_u} and {edge_v} has no area"),
                "give finite edges that are not parallel",
            ));
        }
        // edge_v × n/|n|² has the product 1 with edge_u and 0 with edge_v.
        Ok(Self {
            corner,
            edge_u,
            edge_v,
            normal: across.normalize(),
            dual_u: edge_v.cross(across) / area2,
            dual_v: across.cross(edge_u) / area2,
        })
    }

    /// Distance to where the ray's line meets the quad.
    #[inline(always)]
    fn meet(&self, ray: &Ray) -> Option<f64> {
        // n·(origin + t·direction − corner) = 0. A ray along the plane divides by 0, and no comparison below holds for it.
        let distance = self.normal.dot(self.corner - ray.origin) / self.normal.dot(ray.direction);
        let from_corner = ray.point_at(distance) - self.corner;
        let (u, v) = (self.dual_u.dot(from_corner), self.dual_v.dot(from_corner));
        // Neighbours of equal edges compute these numbers with roundings of their own: a little overlap leaves no slit.
        let inside = -EDGE..=1.0 + EDGE;
        (inside.contains(&u) && inside.contains(&v)).then_some(distance)
    }
}

/// What quads are longer by at each edge, relative to it.
const EDGE: f64 = 1e-12;

impl Shape for Quad {
    fn intersect(&self, ray: &Ray, near: f64, far: f64) -> Option<Intersection> {
        let distance = self.meet(ray).filter(|d| *d > near && *d < far)?;
        let faces_ray = self.normal.dot(ray.direction) < 0.0;
        Some(Intersection {
            distance,
            normal: if faces_ray { self.normal } else { -self.normal },
        })
    }

    fn blocks(&self, ray: &Ray, near: f64, far: f64) -> bool {
        self.meet(ray).is_some_and(|d| d > near && d < far)
    }

    fn is_convex(&self) -> bool {
        true
    }

    fn support(&self, along: DVec3) -> f64 {
        // A linear function is largest at a corner.
        let (u, v) = (along.dot(self.edge_u), along.dot(self.edge_v));
        along.dot(self.corner) + u.max(0.0) + v.max(0.0)
    }

    fn plane_normal(&self) -> Option<DVec3> {
        Some(self.normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wall() -> Quad {
        Quad::new(DVec3::new(-1.0, 0.0, -2.0), 2.0 * DVec3::X, 3.0 * DVec3::Y).unwrap()
    }

    #[test]
    fn it_is_seen_from_both_sides() {
        for (z, normal) in [(1.0, DVec3::Z), (-5.0, DVec3::NEG_Z)] {
            let origin = DVec3::new(0.9, 2.9, z);
            let ray = Ray {
                origin,
                direction: -normal,
            };
            let hit = wall().intersect(&ray, 0.0, f64::INFINITY).unwrap();
            assert_eq!((hit.distance, hit.normal), (3.0, normal));
            assert!(wall().blocks(&ray, 0.0, 3.1) && !wall().blocks(&ray, 0.0, 3.0));
        }
        let past = Ray {
            origin: DVec3::new(1.1, 1.0, 1.0),
            direction: DVec3::NEG_Z,
        };
        assert!(wall().intersect(&past, 0.0, f64::INFINITY).is_none());
        let along = Ray {
            origin: DVec3::new(-3.0, 1.0, -2.0),
            direction: DVec3::X,
        };
        assert!(wall().intersect(&along, 0.0, f64::INFINITY).is_none());
    }

    #[test]
    fn it_ends_where_its_corners_are() {
        assert_eq!(wall().support(DVec3::X), 1.0);
        assert_eq!(wall().support(DVec3::NEG_Y), 0.0);
        assert_eq!(wall().support(DVec3::Z), -2.0);
        assert!(Quad::new(DVec3::ZERO, DVec3::X, 2.0 * DVec3::X).is_err());
    }
}
