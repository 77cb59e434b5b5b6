//! Pictures of spheres: what a scene shows, which effects it calls for, and the path tracer.
//!
//! ```text
//! SceneSpec → Scene, with its EffectPlan → render → Rendered → Film → image
//! ```
//!
//! A [`SceneSpec`] describes; nothing is loaded for it. The [`EffectPlan`] says, with reasons, which effects it calls for
//! and which materials and lights are used. [`Scene::build`] makes the plan, loads what it names and keeps it, so that
//! [`render()`] computes those effects and no others. The [`Budget`] of the [`RenderSettings`] says how many paths are
//! traced, and where. Materials come in as the traits [`crate::brdf::Brdf`] and
//! [`crate::direction_sampler::DirectionSampler`]; reading their files is their caller's business.

mod budget;
mod bundle;
mod camera;
mod coverage;
mod direct;
mod film;
mod follow;
mod mirror;
mod path_numbers;
mod plan;
mod rays;
mod resample;
mod scene;
mod settings;
mod shape;
mod spec;
mod spread;
mod tracer;
mod visibility;

pub use budget::{Refinement, Rendered, Rendering, Tile, render};
pub use camera::Camera;
pub use film::Film;
pub use plan::{Decision, Effect, EffectPlan, PlanRequest};
pub use scene::{Scene, Surface};
pub use settings::{Budget, RenderSettings};
pub use shape::{Intersection, Ray, Shape, Sphere};
pub use spec::{ObjectSpec, SceneSpec, SphereSpec, Strategy};
