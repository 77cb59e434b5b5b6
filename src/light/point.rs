//! A point that shines in all directions: evaluated, never hit.

use glam::{DVec2, DVec3};

use super::light_source::{LightSource, Placement, read_numbers};
use super::{Emission, Light, LightSample, SkySampling};
use crate::color::Rgb;
use crate::{Error, Result};

/// A point that shines equally in all directions.
///
/// The example of [`LightSpec`](crate::light::LightSpec) describes a light and loads it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Where it is.
    pub position: DVec3,
    /// Radiant intensity: power per solid angle.
    pub intensity: Rgb,
}

impl Point {
    /// A point at the place of the key light; a surface that faces it from the subject gets an irradiance of 2π.
    fn new_key(placement: &Placement) -> Self {
        let distance2 = placement.key.distance_squared(placement.subject);
        Self {
            position: placement.key,
            intensity: Rgb::splat((std::f64::consts::TAU * distance2) as f32),
        }
    }
}

impl Point {
    /// "X,Y,Z" or "X,Y,Z,INTENSITY"; the intensity that is left out gives the subject an irradiance of 2π.
    fn parse(text: &str, placement: &Placement) -> Result<Self> {
        let placed = |x, y, z| Placement {
            key: DVec3::new(x, y, z),
            ..*placement
        };
        let light = match read_numbers(text).as_deref() {
            Some(&[x, y, z]) => Some(Self::new_key(&placed(x, y, z))),
            Some(&[x, y, z, intensity]) => Some(Self {
                position: DVec3::new(x, y, z),
                intensity: Rgb::splat(intensity as f32),
            }),
            _ => None,
        };
        light.filter(LightSource::is_valid).ok_or_else(|| {
            Error::argument(
                format!("\"{text}\" is no position of a point light"),
                "give x, y and z, and perhaps an intensity ≥ 0, as in point:2,4,3 or point:2,4,3,50",
            )
        })
    }
}

impl LightSource for Point {
    const WORDS: &'static [&'static str] = &["point", "point:X,Y,Z[,INTENSITY]"];

    fn from_word(word: &str, placement: &Placement) -> Option<Result<Self>> {
        if word == "point" {
            return Some(Ok(Self::new_key(placement)));
        }
        Some(Self::parse(word.strip_prefix("point:")?, placement))
    }

    fn describe(&self) -> String {
        "point".into()
    }

    fn is_delta(&self) -> bool {
        Light::is_delta(self)
    }

    fn is_dark(&self) -> bool {
        self.intensity == Rgb::ZERO
    }

    fn is_valid(&self) -> bool {
        let emits = self.intensity.is_finite() && self.intensity.min_element() >= 0.0;
        emits && self.position.is_finite()
    }

    fn load(&self, _sampling: SkySampling) -> Result<Box<dyn Light>> {
        Ok(Box::new(*self))
    }
}

impl Light for Point {
    /// The one direction, with irradiance `intensity`/d²; `None` at the light itself.
    fn sample(&self, from: DVec3, _u: DVec2) -> Option<LightSample> {
        let to = self.position - from;
        let distance = to.length();
        let wi = to.try_normalize()?;
        // The irradiance is I/d². Radiance and density of a delta light are infinite, so their quotient is given, with the
        // density 1.
        let radiance = (self.intensity.as_dvec3() / (distance * distance)).as_vec3();
        radiance.is_finite().then_some(LightSample {
            wi,
            distance,
            radiance,
            pdf: 1.0,
        })
    }

    fn emitted_along(&self, _from: DVec3, _direction: DVec3, _reach: f64) -> Option<Emission> {
        None
    }

    fn is_delta(&self) -> bool {
        true
    }
}
