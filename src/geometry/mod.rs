//! Directions in the local frame and the maps between their domains.
//!
//! The crate's one convention: `wo` is given (towards the viewer), `wi` is sampled (towards the light), both leave the
//! surface, and `+z` is the normal. Angles are radians. A direction is valid when its components are finite and `z > 0`.
//! BRDFs and samplers take directions of any length and renormalise those whose length is not 1 up to rounding
//! ([`unit_upper`]); anything else, and NaN, is no direction: f_r and pdf are 0 and nothing is drawn.
//!
//! Evaluation of BRDFs and choice of samples are its neighbours' business ([`crate::brdf`], [`crate::sampler`]).

pub mod approx;
mod bin_circle;
pub(crate) mod bin_quadrature;
mod disc;
mod fibonacci;
mod frame;
mod half_diff;
pub(crate) mod half_vector_chart;
mod half_vector_domain;
pub mod merl_axes;
mod pairs;
mod quadrature;
mod symmetry;
pub(crate) mod tan2_cells;

pub use disc::{concentric_disc, concentric_square, cosine_hemisphere};
pub use fibonacci::FibonacciLattice;
pub use frame::Frame;
pub use half_diff::{HalfDiff, half_vector, reflect_about};
pub use half_vector_domain::HalfVectorDomain;
pub use pairs::DirectionPairs;
pub use quadrature::{POINTS_PER_BIN, Quadrature};
pub use symmetry::Symmetry;

use glam::{DVec3, Vec3};

/// Unit direction of polar angle `theta` and azimuth `phi`, radians.
///
/// # Examples
/// ```
/// use merlkit::geometry::{spherical, to_spherical, unit_upper};
///
/// let wo = spherical(0.5, 1.0);
/// let (theta, phi) = to_spherical(wo);
/// assert!((theta - 0.5).abs() < 1e-12 && (phi - 1.0).abs() < 1e-12);
///
/// // Directions below the horizon are outside the domain of BRDFs and samplers.
/// assert!(unit_upper(wo.as_vec3()).is_some());
/// assert!(unit_upper(-wo.as_vec3()).is_none());
/// ```
pub fn spherical(theta: f64, phi: f64) -> DVec3 {
    let (st, ct) = theta.sin_cos();
    let (sp, cp) = phi.sin_cos();
    DVec3::new(st * cp, st * sp, ct)
}

/// Polar angle and azimuth in (−π, π] of a direction of any length; the inverse of [`spherical`].
///
/// See [`spherical`] for an example.
pub fn to_spherical(w: DVec3) -> (f64, f64) {
    (w.x.hypot(w.y).atan2(w.z), w.y.atan2(w.x))
}

/// Squared lengths this near to 1 are left as they are.
const LENGTH_SLACK: f32 = 1e-5;

/// Whether [`unit_upper`] takes `w` as it is.
///
/// See [`spherical`] for an example.
#[inline(always)]
pub fn is_unit_upper(w: Vec3) -> bool {
    ((w.length_squared() - 1.0).abs() <= LENGTH_SLACK) & (w.z > 0.0)
}

/// `w` at unit length: itself where it is so up to rounding, renormalised elsewhere. `None` unless it is finite and above
/// the horizon; a height that f32 loses against the length is not above it.
///
/// See [`spherical`] for an example.
#[inline]
pub fn unit_upper(w: Vec3) -> Option<Vec3> {
    // |w|² − 1 is about 2(|w| − 1): lengths within 5·10⁻⁶ of 1 keep their bits.
    if (w.length_squared() - 1.0).abs() <= LENGTH_SLACK {
        (w.z > 0.0).then_some(w)
    } else {
        renormalised(w)
    }
}

#[cold]
fn renormalised(w: Vec3) -> Option<Vec3> {
    // The square of any f32 is an ordinary f64.
    is_upper(w)
        .then(|| w.as_dvec3().normalize().as_vec3())
        .filter(|unit| unit.z > 0.0)
}

/// Finite and above the horizon: the domain of every BRDF and sampler here.
///
/// See [`spherical`] for an example.
#[inline]
pub fn is_upper(w: Vec3) -> bool {
    w.z > 0.0 && w.is_finite()
}
