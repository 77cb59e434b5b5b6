//! Reflectance as a function of two directions.
//!
//! Decoding files is [`crate::merl`]'s business; choosing directions is [`crate::sampler`]'s.

mod bins;
mod importance;
mod interpolate;
mod measured;

pub use bins::BinIndex;
pub use importance::Importance;
pub use measured::{LookupRule, Measured};

use glam::Vec3;

use crate::color::Rgb;

/// A reflectance function f_r(wo, wi) in the local frame.
pub trait Brdf: Send + Sync {
    /// f_r in sr⁻¹, without the cosine. Zero, never NaN, for a direction that is not finite or not above the horizon.
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb;

    /// f_r·cosθᵢ in sr⁻¹.
    fn eval_cos(&self, wo: Vec3, wi: Vec3) -> Rgb {
        self.eval(wo, wi) * wi.z.max(0.0)
    }

    /// Whether turning both directions about the normal leaves f_r as it is.
    fn is_isotropic(&self) -> bool;
}
