//! A toolkit for measured BRDFs. It loads materials, builds importance samplers for them, and renders spheres with both.
//!
//! This program loads a material, builds a sampler for it and draws a direction:
//!
//! ```
//! use merlkit::geometry::spherical;
//! use merlkit::glam::Vec2;
//! use merlkit::{LookupRule, Material, SamplerSpec};
//!
//! # fn main() -> merlkit::Result<()> {
//! let material = Material::resolve("lambert:reflectance=0.5")?.load(LookupRule::Floor)?;
//! let spec: SamplerSpec = "half-vector:2KB".parse()?;
//! let sampler = spec.build(&material)?;
//!
//! // `wo` points towards the viewer, and the sampler draws `wi` towards the light. A failed draw has the weight 0.
//! let wo = spherical(0.5, 0.0).as_vec3();
//! if let Some(drawn) = sampler.as_dyn().sample(wo, Vec2::new(0.3, 0.7)) {
//!     let weight = material.brdf().eval_cos(wo, drawn.wi) / drawn.pdf;
//!     println!("the mean of weights such as {weight} is the albedo");
//! }
//! # Ok(())
//! # }
//! ```
//!
//! # What do you want to do?
//!
//! | task | start here |
//! |---|---|
//! | load and evaluate a material: a MERL binary, a `.bsdf` file, a built-in name or a formula | [`Material`], [`Brdf`] |
//! | draw directions from it | [`SamplerSpec`], [`DirectionSampler`] |
//! | evaluate or draw many directions at once | [`Wo`] |
//! | keep a sampler in a file | [`sampler::store::SamplerFile`] |
//! | use a BRDF or a sampler of your own | [`Brdf`], [`Loaded::from_brdf`], [`DirectionSampler`] |
//! | make a MERL table from measurements | [`material::measurements::Measurements`], [`material::merl::MerlTable`] |
//! | write a material for Mitsuba 3 or pbrt-v4 | [`material::rgl::BsdfFile`] |
//! | write a C header, or arrays for numpy | [`export::Export`] |
//! | light and render a scene | [`light::LightSpec`], [`render()`](render::render) |
//! | read and write pictures | [`image::Image`] |
//! | integrate over the hemisphere, or convert angles | [`geometry::Quadrature`], [`geometry::HalfDiff`] |
//!
//! The programs in `examples/` are longer. The page `docs/architecture.md` shows where things are and how to add one.
//!
//! # How data flows
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
//! # Conventions
//!
//! They are stated once, in [`geometry`]. `wo` is the given direction (the viewer) and `wi` the sampled one (the light). Both
//! leave the surface, in a local frame whose `+z` is the normal. `eval` is f_r in sr⁻¹ without the cosine, and every `pdf` is
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
