//! A luminous rectangle.

use glam::{DVec2, DVec3};

use super::{Light, LightSample, Seen};
use crate::color::Rgb;

/// A parallelogram that emits equal radiance in all directions from one side: the one that `edge_u` × `edge_v` points to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// A corner.
    pub corner: DVec3,
    /// From the corner along one side.
    pub edge_u: DVec3,
    /// From the corner along the other side.
    pub edge_v: DVec3,
    /// Radiance of every point of the luminous side.
    pub radiance: Rgb,
}

impl Area {
    /// Area times the normal.
    fn facing(&self) -> DVec3 {
        self.edge_u.cross(self.edge_v)
    }

    /// Density per solid angle of points uniform in area: d²/(A·cos), or `None` from behind and from within the plane.
    fn pdf(&self, direction: DVec3, distance: f64) -> Option<f64> {
        let pdf = distance * distance / -self.facing().dot(direction);
        (pdf > 0.0 && pdf.is_finite()).then_some(pdf)
    }
}

impl Light for Area {
    /// A point uniform in area.
    fn sample(&self, from: DVec3, u: DVec2) -> Option<LightSample> {
        let to = self.corner + u.x * self.edge_u + u.y * self.edge_v - from;
        let (wi, distance) = (to.try_normalize()?, to.length());
        let pdf = self.pdf(wi, distance)?;
        Some(LightSample {
            wi,
            distance,
            radiance: self.radiance,
            pdf,
        })
    }

    fn seen(&self, from: DVec3, direction: DVec3, reach: f64) -> Option<Seen> {
        let facing = self.facing();
        let distance = facing.dot(self.corner - from) / facing.dot(direction);
        if !(distance > 0.0 && distance < reach) {
            return None;
        }
        let at = from + distance * direction - self.corner;
        // Coordinates along the edges, by the areas that the point spans with them.
        let u = at.cross(self.edge_v).dot(facing) / facing.length_squared();
        let v = self.edge_u.cross(at).dot(facing) / facing.length_squared();
        let inside = (0.0..1.0).contains(&u) && (0.0..1.0).contains(&v);
        let pdf = self.pdf(direction, distance).filter(|_| inside)?;
        Some(Seen {
            radiance: self.radiance,
            pdf,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::PointSet;

    fn lamp() -> Area {
        let edge_u = DVec3::new(1.0, 0.2, 0.0);
        Area {
            corner: DVec3::new(-0.5, 2.0, 0.3),
            edge_u,
            edge_v: DVec3::new(0.1, 0.0, 2.0),
            radiance: Rgb::ONE,
        }
    }

    #[test]
    fn what_is_sampled_is_seen_with_the_same_density() {
        // edge_u × edge_v points down here, towards the origin.
        let lamp = lamp();
        for i in 0..1000 {
            let s = lamp
                .sample(DVec3::ZERO, PointSet::Random.point(1, i, 0).as_dvec2())
                .unwrap();
            let seen = lamp.seen(DVec3::ZERO, s.wi, f64::INFINITY).unwrap();
            assert!((seen.pdf / s.pdf - 1.0).abs() < 1e-12);
            assert!(lamp.seen(DVec3::ZERO, s.wi, s.distance * 0.99).is_none());
            assert!(lamp.seen(DVec3::ZERO, -s.wi, f64::INFINITY).is_none());
        }
    }

    #[test]
    fn it_is_dark_behind_and_of_no_area() {
        let behind = DVec3::new(0.0, 9.0, 0.0);
        assert!(lamp().sample(behind, DVec2::splat(0.5)).is_none());
        assert!(lamp().seen(behind, -DVec3::Y, f64::INFINITY).is_none());
        let line = Area {
            edge_v: lamp().edge_u,
            ..lamp()
        };
        assert!(line.sample(DVec3::ZERO, DVec2::splat(0.5)).is_none());
        assert!(line.seen(DVec3::ZERO, DVec3::Y, f64::INFINITY).is_none());
    }
}
