//! Lights without extent: evaluated, never hit.

use glam::{DVec2, DVec3};

use super::{Light, LightSample, Seen};
use crate::color::Rgb;

/// A point that shines equally in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Where it is.
    pub position: DVec3,
    /// Radiant intensity: power per solid angle.
    pub intensity: Rgb,
}

impl Light for Point {
    /// The one direction, with irradiance `intensity`/d²; `None` at the light itself.
    fn sample(&self, from: DVec3, _u: DVec2) -> Option<LightSample> {
        let to = self.position - from;
        let distance = to.length();
        let wi = to.try_normalize()?;
        let radiance = (self.intensity.as_dvec3() / (distance * distance)).as_vec3();
        radiance.is_finite().then_some(LightSample {
            wi,
            distance,
            radiance,
            pdf: 1.0,
        })
    }

    fn seen(&self, _from: DVec3, _direction: DVec3, _reach: f64) -> Option<Seen> {
        None
    }

    fn is_delta(&self) -> bool {
        true
    }
}

/// Parallel light from infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directional {
    /// Towards the light, of any length; a zero vector gives no light.
    pub towards: DVec3,
    /// Irradiance on a surface that faces the light.
    pub irradiance: Rgb,
}

impl Light for Directional {
    fn sample(&self, _from: DVec3, _u: DVec2) -> Option<LightSample> {
        let wi = self.towards.try_normalize()?;
        Some(LightSample {
            wi,
            distance: f64::INFINITY,
            radiance: self.irradiance,
            pdf: 1.0,
        })
    }

    fn seen(&self, _from: DVec3, _direction: DVec3, _reach: f64) -> Option<Seen> {
        None
    }

    fn is_delta(&self) -> bool {
        true
    }
}
