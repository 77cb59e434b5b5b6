//! A luminous rectangle.

use glam::{DVec2, DVec3};

use super::light_source::{LightSource, Placement};
use super::{Emission, Light, LightSample, SkySampling};
use crate::Result;
use crate::color::Rgb;

/// A parallelogram that emits equal radiance in all directions from one side: the one that `edge_u` × `edge_v` points to.
///
/// The example of [`LightSpec`](crate::light::LightSpec) describes a light and loads it.
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
    /// A square at the place of the key light, about as wide as the subject and turned towards its middle; irradiance there
    /// is about 2π.
    fn new_key(placement: &Placement) -> Self {
        let centre = placement.key;
        let back = (centre - placement.subject).normalize();
        let across = DVec3::Y.cross(back).normalize_or(DVec3::X);
        // The side is half the distance, so the square fills a solid angle of about 1/4.
        let size = 0.5 * centre.distance(placement.subject);
        let edge_u = across * size;
        let edge_v = back.cross(across) * -size;
        // E = L·Ω: a radiance of 2π/¼ in a solid angle of ¼ gives 2π.
        let radiance = Rgb::splat((std::f64::consts::TAU / 0.25) as f32);
        Self {
            corner: centre - 0.5 * (edge_u + edge_v),
            edge_u,
            edge_v,
            radiance,
        }
    }

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

impl LightSource for Area {
    const WORDS: &'static [&'static str] = &["area"];

    fn from_word(word: &str, placement: &Placement) -> Option<Result<Self>> {
        (word == "area").then(|| Ok(Self::new_key(placement)))
    }

    fn describe(&self) -> String {
        "area".into()
    }

    fn is_delta(&self) -> bool {
        Light::is_delta(self)
    }

    fn is_dark(&self) -> bool {
        self.radiance == Rgb::ZERO
    }

    fn is_valid(&self) -> bool {
        let emits = self.radiance.is_finite() && self.radiance.min_element() >= 0.0;
        emits && self.corner.is_finite() && self.edge_u.is_finite() && self.edge_v.is_finite()
    }

    fn load(&self, _sampling: SkySampling) -> Result<Box<dyn Light>> {
        Ok(Box::new(*self))
    }
}

impl Light for Area {
    /// A point uniform in area.
    fn sample(&self, from: DVec3, u: DVec2) -> Option<LightSample> {
        // corner + u·edge_u + v·edge_v is uniform in area, and `pdf` is its density per solid angle.
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

    fn emitted_along(&self, from: DVec3, direction: DVec3, reach: f64) -> Option<Emission> {
        let facing = self.facing();
        // n·(from + t·direction − corner) = 0. Parallel rays have an infinite t or NaN, which the comparison refuses.
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
        Some(Emission {
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
    fn what_is_sampled_is_emitted_with_the_same_density() {
        // edge_u × edge_v points down here, towards the origin.
        let lamp = lamp();
        for i in 0..1000 {
            let s = lamp
                .sample(DVec3::ZERO, PointSet::Random.point(1, i, 0).as_dvec2())
                .unwrap();
            let emission = lamp
                .emitted_along(DVec3::ZERO, s.wi, f64::INFINITY)
                .unwrap();
            assert!((emission.pdf / s.pdf - 1.0).abs() < 1e-12);
            assert!(
                lamp.emitted_along(DVec3::ZERO, s.wi, s.distance * 0.99)
                    .is_none()
            );
            assert!(
                lamp.emitted_along(DVec3::ZERO, -s.wi, f64::INFINITY)
                    .is_none()
            );
        }
    }

    #[test]
    fn it_is_dark_behind_and_of_no_area() {
        let behind = DVec3::new(0.0, 9.0, 0.0);
        assert!(lamp().sample(behind, DVec2::splat(0.5)).is_none());
        assert!(
            lamp()
                .emitted_along(behind, -DVec3::Y, f64::INFINITY)
                .is_none()
        );
        let line = Area {
            edge_v: lamp().edge_u,
            ..lamp()
        };
        assert!(line.sample(DVec3::ZERO, DVec2::splat(0.5)).is_none());
        assert!(
            line.emitted_along(DVec3::ZERO, DVec3::Y, f64::INFINITY)
                .is_none()
        );
    }
}
