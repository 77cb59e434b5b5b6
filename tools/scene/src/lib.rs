//! Meshes and other shapes for merlkit's renderer, and scenes that a file describes.
//!
//! ```text
//! OBJ, PLY, glTF → MeshData → TriangleMesh ┐
//! profile of a jar, displaced sphere → MeshData ┘→ Shape → merlkit::render::ObjectSpec
//! ```
//!
//! [`read_scene`] reads a scene file to a [`SceneDescription`], whose [`SceneDescription::build`] gives what the renderer takes.
//! A [`MeshData`] is plain vertices and faces, as a file or a formula gives them. A [`TriangleMesh`] is checked and ready to be
//! intersected. It can be placed several times without a copy, as an [`Instance`].
//!
//! # Examples
//! ```
//! use std::sync::Arc;
//! use merlkit::glam::DVec3;
//! use merlkit::render::{Ray, Shape};
//! use merlkit_scene::{Shading, Sides, TriangleMesh, jar_profile, revolve, smooth_profile};
//!
//! let profile = smooth_profile(&jar_profile(), 49);
//! let jar = TriangleMesh::build(&revolve(&profile, 48)?, Sides::Both, Shading::Flat)?;
//! let ray = Ray { origin: DVec3::new(0.0, 0.5, 5.0), direction: DVec3::NEG_Z };
//! assert!(jar.intersect(&ray, 0.0, f64::INFINITY).is_some());
//! let shape: Arc<dyn Shape> = Arc::new(jar);
//! assert!(!shape.is_convex());
//! # Ok::<(), merlkit::Error>(())
//! ```
#![deny(unsafe_code)]
#![warn(missing_docs)]
#![warn(clippy::print_stdout, clippy::print_stderr, clippy::exit)]
#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod background;
mod convexity;
mod description;
mod displaced;
mod formats;
mod grf;
mod hierarchy;
mod instance;
mod luminous;
mod mesh;
mod mesh_data;
mod object_table;
mod placing;
mod quad;
mod revolution;
mod scene_fault;
mod scene_file;
mod strength;
mod triangle;

pub use background::{Background, decode_srgb};
pub use description::{
    BuiltScene, CameraEntry, LightEntry, ObjectEntry, SceneDescription, ShapeEntry, SurfaceEntry,
};
pub use displaced::displace_sphere;
pub use formats::{MeshFormat, MeshLimits, parse_mesh, parse_mesh_within, read_mesh};
pub use grf::OptionFile;
pub use instance::Instance;
pub use mesh::{Shading, Sides, TriangleMesh};
pub use mesh_data::MeshData;
pub use quad::Quad;
pub use revolution::{jar_profile, revolve, smooth_profile};
pub use scene_file::read_scene;
