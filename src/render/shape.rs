//! Shapes of objects, intersected in f64.

use std::fmt::Debug;

use fearless_simd::{Level, dispatch};
use glam::DVec3;

/// A half line.
///
/// See [`render`](fn@crate::render::render) for an example that renders a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Unit direction.
    pub direction: DVec3,
}

impl Ray {
    /// The point at `distance`.
    pub fn point_at(&self, distance: f64) -> DVec3 {
        self.origin + distance * self.direction
    }
}

/// Where a ray enters a shape.
///
/// See [`render`](fn@crate::render::render) for an example that renders a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intersection {
    /// Distance along the ray, > 0.
    pub distance: f64,
    /// Outward unit normal there.
    pub normal: DVec3,
}

/// An opaque surface that is seen from outside.
///
/// See [`render`](fn@crate::render::render) for an example that renders a sphere.
pub trait Shape: Debug + Send + Sync {
    /// Where `ray` first enters the shape at a distance between `near` ≥ 0 and `far`, both excluded; `None` if it does not.
    fn intersect(&self, ray: &Ray, near: f64, far: f64) -> Option<Intersection>;

    /// Whether `ray` enters the shape at a distance between `near` and `far`.
    fn blocks(&self, ray: &Ray, near: f64, far: f64) -> bool {
        self.intersect(ray, near, far).is_some()
    }

    /// [`Self::intersect`] for many rays at once: where ray `k` enters the shape between `near[k]` and `reach[k]`, `reach[k]`
    /// becomes the distance and `normals[k]` the normal there, to the bit.
    ///
    /// # Panics
    /// If the slices differ in length.
    fn intersect_batch(
        &self,
        from: &[DVec3],
        along: &[DVec3],
        near: &[f64],
        reach: &mut [f64],
        normals: &mut [DVec3],
    ) {
        intersect_each(self, from, along, near, reach, normals);
    }

    /// Whether a ray that leaves the shape outwards never meets it again: the shape then hides no light from itself, and does
    /// not light itself. The renderer relies on it.
    fn is_convex(&self) -> bool;

    /// An upper bound of `along`·p for all points p of the shape; infinite where none is known. With it the plan finds planes
    /// between objects, so that what can't be in the way is never looked for.
    fn support(&self, along: DVec3) -> f64 {
        let _ = along;
        f64::INFINITY
    }

    /// The unit normal of the plane that all of the shape lies in, of either sign; `None` for a shape that has a volume.
    fn plane_normal(&self) -> Option<DVec3> {
        None
    }
}

/// [`Shape::intersect_batch`], ray after ray.
#[inline(always)]
fn intersect_each<S: Shape + ?Sized>(
    shape: &S,
    from: &[DVec3],
    along: &[DVec3],
    near: &[f64],
    reach: &mut [f64],
    normals: &mut [DVec3],
) {
    let count = reach.len();
    let (from, along, near) = (&from[..count], &along[..count], &near[..count]);
    let normals = &mut normals[..count];
    for k in 0..count {
        let ray = Ray {
            origin: from[k],
            direction: along[k],
        };
        if let Some(met) = shape.intersect(&ray, near[k], reach[k]) {
            reach[k] = met.distance;
            normals[k] = met.normal;
        }
    }
}

/// An opaque sphere, seen from outside.
///
/// See [`render`](fn@crate::render::render) for an example that renders a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre, world space.
    pub centre: DVec3,
    /// Radius, > 0.
    pub radius: f64,
}

impl Sphere {
    /// Distance along `ray` to where it enters the sphere; `None` if it misses or starts inside.
    ///
    /// The discriminant is r² minus the squared distance of the centre from the line, which does not cancel when the ray
    /// starts far away (Haines et al. 2019).
    #[inline(always)]
    pub fn enter(&self, ray: &Ray) -> Option<f64> {
        debug_assert!(ray.direction.is_normalized());
        // Step 1: the foot of the perpendicular from the centre, at the distance `along`.
        let to_centre = self.centre - ray.origin;
        let along = to_centre.dot(ray.direction);
        let perpendicular = to_centre - along * ray.direction;
        // Step 2: half of the chord, h² = r² − |perpendicular|². The near end is at along − h. The far end is seen from
        // inside only.
        let half_chord2 = self.radius * self.radius - perpendicular.length_squared();
        if half_chord2 < 0.0 {
            return None;
        }
        let distance = along - half_chord2.sqrt();
        (distance > 0.0).then_some(distance)
    }

    /// Outward unit normal at a point of the surface.
    #[inline(always)]
    pub fn normal(&self, at: DVec3) -> DVec3 {
        (at - self.centre).normalize_or(DVec3::Y)
    }
}

impl Shape for Sphere {
    #[inline(always)]
    fn intersect(&self, ray: &Ray, near: f64, far: f64) -> Option<Intersection> {
        let distance = self.enter(ray)?;
        if distance > near && distance < far {
            let normal = self.normal(ray.point_at(distance));
            Some(Intersection { distance, normal })
        } else {
            None
        }
    }

    fn intersect_batch(
        &self,
        from: &[DVec3],
        along: &[DVec3],
        near: &[f64],
        reach: &mut [f64],
        normals: &mut [DVec3],
    ) {
        dispatch!(Level::new(), _ => intersect_each(self, from, along, near, reach, normals));
    }

    /// Without the normal, which nobody asks for.
    fn blocks(&self, ray: &Ray, near: f64, far: f64) -> bool {
        self.enter(ray).is_some_and(|d| d > near && d < far)
    }

    fn is_convex(&self) -> bool {
        true
    }

    fn support(&self, along: DVec3) -> f64 {
        along.dot(self.centre) + self.radius * along.length()
    }
}

/// The half space below y = 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Floor;

impl Floor {
    /// Distance along `ray` to where it goes below the plane y = 0; `None` if it never does.
    fn enter(ray: &Ray) -> Option<f64> {
        // y + t·d.y = 0. A ray along the plane divides by 0, and its distance is not finite.
        let distance = ray.origin.y / -ray.direction.y;
        (distance > 0.0 && ray.direction.y < 0.0 && distance.is_finite()).then_some(distance)
    }
}

impl Shape for Floor {
    fn intersect(&self, ray: &Ray, near: f64, far: f64) -> Option<Intersection> {
        let distance = Self::enter(ray).filter(|d| *d > near && *d < far)?;
        Some(Intersection {
            distance,
            normal: DVec3::Y,
        })
    }

    fn is_convex(&self) -> bool {
        true
    }

    /// The half space ends upwards only.
    fn support(&self, along: DVec3) -> f64 {
        let upwards = along.x == 0.0 && along.z == 0.0 && along.y >= 0.0;
        if upwards { 0.0 } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_enter_spheres_from_outside_only() {
        let ball = Sphere {
            centre: DVec3::new(0.0, 0.0, -5.0),
            radius: 2.0,
        };
        let ray = |origin, direction| Ray { origin, direction };
        assert_eq!(ball.enter(&ray(DVec3::ZERO, -DVec3::Z)), Some(3.0));
        assert_eq!(ball.enter(&ray(DVec3::ZERO, DVec3::Z)), None);
        assert_eq!(ball.enter(&ray(ball.centre, DVec3::Z)), None);
        assert_eq!(ball.enter(&ray(DVec3::new(2.1, 0.0, 0.0), -DVec3::Z)), None);
        let far = ball
            .enter(&ray(DVec3::new(1.0, 0.0, 1e7), -DVec3::Z))
            .unwrap();
        assert!((far - (1e7 + 5.0 - 3.0f64.sqrt())).abs() < 1e-8);
    }

    #[test]
    fn the_floor_is_entered_from_above_only() {
        let down = DVec3::new(0.6, -0.8, 0.0);
        assert_eq!(
            Floor::enter(&Ray {
                origin: DVec3::Y * 2.0,
                direction: down
            }),
            Some(2.5)
        );
        assert_eq!(
            Floor::enter(&Ray {
                origin: -DVec3::Y,
                direction: down
            }),
            None
        );
        assert_eq!(
            Floor::enter(&Ray {
                origin: -DVec3::Y,
                direction: DVec3::Y
            }),
            None
        );
        assert_eq!(
            Floor::enter(&Ray {
                origin: DVec3::Y,
                direction: DVec3::X
            }),
            None
        );
    }
}
