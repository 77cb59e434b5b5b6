//! Parallel light: evaluated, never hit.

use glam::{DVec2, DVec3};

use super::light_source::{LightSource, Placement, read_numbers};
use super::{Emission, Light, LightSample, SkySampling};
use crate::color::Rgb;
use crate::{Error, Result};

/// Parallel light from infinitely far away.
///
/// The example of [`LightSpec`](crate::light::LightSpec) describes a light and loads it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directional {
    /// Towards the light, of any length; a zero vector gives no light.
    pub towards: DVec3,
    /// Irradiance on a surface that faces the light.
    pub irradiance: Rgb,
}

impl Directional {
    /// Light from the upper left, in front; irradiance π.
    fn new_key() -> Self {
        Self {
            towards: DVec3::new(-0.5, 1.0, 0.8).normalize(),
            irradiance: Rgb::splat(std::f32::consts::PI),
        }
    }
}

impl Directional {
    /// "THETA,PHI" or "THETA,PHI,IRRADIANCE": degrees from +y, and from the viewer's side (+z) to the right (+x). The irradiance
    /// that is left out is π.
    fn parse(text: &str) -> Result<Self> {
        let light = match read_numbers(text).as_deref() {
            Some(&[theta, phi]) => Some((theta, phi, std::f64::consts::PI)),
            Some(&[theta, phi, irradiance]) => Some((theta, phi, irradiance)),
            _ => None,
        };
        let light = light.map(|(theta, phi, irradiance)| {
            let (sin_theta, cos_theta) = theta.to_radians().sin_cos();
            let (sin_phi, cos_phi) = phi.to_radians().sin_cos();
            Self {
                towards: DVec3::new(sin_theta * sin_phi, cos_theta, sin_theta * cos_phi),
                irradiance: Rgb::splat(irradiance as f32),
            }
        });
        light.filter(LightSource::is_valid).ok_or_else(|| {
            Error::argument(
                format!("\"{text}\" is no direction of parallel light"),
                "give theta and phi in degrees, and perhaps an irradiance ≥ 0, as in directional:30,-45 or directional:30,-45,2",
            )
        })
    }
}

impl LightSource for Directional {
    const WORDS: &'static [&'static str] = &["directional", "directional:THETA,PHI[,IRRADIANCE]"];

    fn from_word(word: &str, _placement: &Placement) -> Option<Result<Self>> {
        if word == "directional" {
            return Some(Ok(Self::new_key()));
        }
        Some(Self::parse(word.strip_prefix("directional:")?))
    }

    fn describe(&self) -> String {
        "directional".into()
    }

    fn is_delta(&self) -> bool {
        Light::is_delta(self)
    }

    fn is_dark(&self) -> bool {
        self.irradiance == Rgb::ZERO
    }

    fn is_valid(&self) -> bool {
        let emits = self.irradiance.is_finite() && self.irradiance.min_element() >= 0.0;
        emits && self.towards.is_finite()
    }

    fn load(&self, _sampling: SkySampling) -> Result<Box<dyn Light>> {
        Ok(Box::new(*self))
    }
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

    fn emitted_along(&self, _from: DVec3, _direction: DVec3, _reach: f64) -> Option<Emission> {
        None
    }

    fn is_delta(&self) -> bool {
        true
    }
}
