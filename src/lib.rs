//! A toolkit for measured BRDFs: materials are loaded, samplers are built for them, and spheres are rendered with both.
//!
//! Data flows one way:
//!
//! ```text
//! argument → Material → Loaded: a Brdf, and what only some materials have (a MERL table, a sampler of their own)
//! "half-vector:64KB" → SamplerSpec, with a Loaded → Sampler: a DirectionSampler, or a sampler file
//! Brdf + DirectionSampler + Light → render::Scene → render::render → an image
//! MERL table + half-vector table → export: a C header, or arrays for numpy
//! Brdf → material::rgl::BsdfFile (for Mitsuba and pbrt), or material::merl::MerlTable
//! ```
//!
//! Start with [`Material::resolve`], [`SamplerSpec`] and [`render::render`]; the programs in `examples/` show each. The page
//! `docs/architecture.md` says where things are and how to add one.
//!
//! Conventions, stated once in [`geometry`]: `wo` is the given direction (the viewer), `wi` the sampled one (the light); both
//! leave the surface, in a local frame whose `+z` is the normal. `eval` is f_r in sr⁻¹ without the cosine; every `pdf` is
//! per solid angle of `wi`.
#![deny(unsafe_code)]
#![warn(missing_docs)]
#![warn(clippy::print_stdout, clippy::print_stderr, clippy::exit)]
#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod batch;
pub mod brdf;
pub mod color;
pub mod direction_sampler;
pub mod distribution;
mod error;
pub mod export;
pub mod files;
pub mod geometry;
pub mod image;
mod lanes;
pub mod light;
pub mod material;
pub mod points;
pub mod render;
pub mod sampler;

pub use batch::Wo;
pub use brdf::Brdf;
pub use direction_sampler::{DirectionSample, DirectionSampler};
pub use error::{Error, Result};
/// Vectors in this crate's interface are those of this version of glam.
pub use glam;
pub use material::{Loaded, LookupRule, Material};
pub use sampler::{Sampler, SamplerSpec};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
