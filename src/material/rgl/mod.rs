//! `.bsdf` files: measured materials as Mitsuba 3 and pbrt-v4 read them (Dupuy & Jakob 2018, the RGL database).
//!
//! A file tabulates f_r·cosθᵢ for some given directions over a square of half vectors, and a density to draw half vectors by.
//! Where a MERL table comes from or goes to is [`crate::material::merl`]'s business.

mod brdf;
mod file;
mod rgl;
mod sampler;
mod spectrum;
mod tabulate;
mod tensors;
mod warp;

pub use file::{BsdfFile, Colour};
pub use rgl::RglBrdf;
pub use tabulate::{BsdfSize, tabulate};
pub use tensors::{Tensor, looks_like_bsdf};
