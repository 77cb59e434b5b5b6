//! Pictures of spheres: what a scene shows, which effects it calls for, and the path tracer.
//!
//! ```text
//! SceneSpec → EffectPlan → Scene → render → Film → image
//! ```
//!
//! A [`SceneSpec`] describes; nothing is loaded for it. The [`EffectPlan`] says, with reasons, which effects it calls for
//! and which materials and lights are used. [`Scene::build`] loads those and no others, and [`render()`] computes those
//! and no others; [`render_allocated`] sends more paths where the picture is noisy, and [`render_to_error`] takes as many as a target
//! error needs. Materials come in as the traits [`crate::brdf::Brdf`] and [`crate::direction_sampler::DirectionSampler`]; reading
//! their files is their caller's business.

mod adaptive;
mod allocate;
mod camera;
mod film;
mod follow;
mod numbers;
mod path;
mod plan;
mod resample;
mod scene;
mod shape;
mod spec;

pub use adaptive::{Refined, Tile, render_to_error};
pub use allocate::{LEAST_ALLOCATED, render_allocated};
pub use camera::Camera;
pub use film::Film;

pub use path::{Settings, render};
pub use plan::{Decision, Effect, EffectPlan};
pub use scene::{Scene, Surface};
pub use shape::{Ray, Sphere};
pub use spec::{EnvironmentSource, LightSpec, SceneSpec, SphereSpec, Strategy};
