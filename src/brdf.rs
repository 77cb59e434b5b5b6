//! Reflectance as a function of two directions.
//!
//! Materials ([`crate::material`]) implement it, samplers and the renderer use it.

use glam::Vec3;

use crate::batch::Wo;
use crate::color::{self, Rgb};
use crate::geometry::{Symmetry, unit_upper};

/// A reflectance function f_r(wo, wi) in the local frame.
///
/// # Examples
/// ```
/// use merlkit::Brdf;
/// use merlkit::color::Rgb;
/// use merlkit::geometry::unit_upper;
/// use merlkit::glam::Vec3;
///
/// /// Reflects half of the light, equally in all directions.
/// struct Grey;
///
/// impl Brdf for Grey {
///     fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
///         if unit_upper(wo).is_none() || unit_upper(wi).is_none() {
///             return Rgb::ZERO;
///         }
///         Rgb::splat(0.5 / std::f32::consts::PI)
///     }
///
///     fn is_isotropic(&self) -> bool {
///         true
///     }
/// }
///
/// assert_eq!(Grey.eval(Vec3::Z, Vec3::NEG_Z), Rgb::ZERO);
/// assert_eq!(Grey.eval_cos(Vec3::Z, Vec3::Z), Grey.eval(Vec3::Z, Vec3::Z));
/// ```
pub trait Brdf: Send + Sync {
    /// f_r in sr⁻¹, without the cosine. Zero, never NaN, for a direction that is not finite or not above the horizon.
    /// Directions of other lengths than 1 are renormalised ([`crate::geometry::unit_upper`]).
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb;

    /// f_r·cosθᵢ in sr⁻¹.
    fn eval_cos(&self, wo: Vec3, wi: Vec3) -> Rgb {
        self.eval(wo, wi) * unit_upper(wi).map_or(0.0, |wi| wi.z)
    }

    /// f_r of a batch of pairs: `out[k]` becomes `eval(wo.lane(k), wi[k])`, to the bit.
    ///
    /// # Panics
    /// If the slices differ in length ([`Wo::assert_lanes`]).
    #[track_caller]
    fn eval_batch(&self, wo: Wo<'_>, wi: &[Vec3], out: &mut [Rgb]) {
        wo.assert_lanes(wi.len(), out.len());
        for (lane, (out, &wi)) in out.iter_mut().zip(wi).enumerate() {
            *out = self.eval(wo.lane(lane), wi);
        }
    }

    /// f_r·cosθᵢ of a batch of pairs: `out[k]` becomes `eval_cos(wo.lane(k), wi[k])`, to the bit.
    ///
    /// # Panics
    /// If the slices differ in length ([`Wo::assert_lanes`]).
    #[track_caller]
    fn eval_cos_batch(&self, wo: Wo<'_>, wi: &[Vec3], out: &mut [Rgb]) {
        wo.assert_lanes(wi.len(), out.len());
        for (lane, (out, &wi)) in out.iter_mut().zip(wi).enumerate() {
            *out = self.eval_cos(wo.lane(lane), wi);
        }
    }

    /// The fraction of the light from the mirror direction of `wo` about the normal that is reflected towards `wo`, where the
    /// BRDF has a part that reflects that direction alone: a delta function, which [`Self::eval`] leaves out. `None` for a
    /// BRDF without one, and for a `wo` that is not finite or not above the horizon.
    fn mirror(&self, _wo: Vec3) -> Option<Rgb> {
        None
    }

    /// Whether turning both directions about the normal leaves f_r as it is.
    fn is_isotropic(&self) -> bool;

    /// The symmetry of azimuths of `wo`: a part of them represents all others.
    fn symmetry(&self) -> Symmetry {
        if self.is_isotropic() {
            Symmetry::Isotropic
        } else {
            Symmetry::Whole
        }
    }
}

/// Reduction of RGB to the scalar a sampler follows.
///
/// The example of [`luminance`](crate::color::luminance) compares the mean with the luminance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Importance {
    /// Mean of the channels: the lowest spread of RGB weights on most measured materials.
    #[default]
    Mean,
    /// Relative luminance.
    Luminance,
}

impl Importance {
    /// The scalar's name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mean => "mean",
            Self::Luminance => "luminance",
        }
    }

    /// The scalar of a value.
    #[inline]
    pub fn reduce(self, value: Rgb) -> f32 {
        match self {
            Self::Mean => color::mean(value),
            Self::Luminance => color::luminance(value),
        }
    }
}
