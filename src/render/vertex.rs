//! Points of paths, and directions drawn from them.

use glam::{DVec3, Vec3};

use super::path_numbers::PathRandoms;
use super::scene::{Hit, Surface};
use super::shape::Ray;
use crate::geometry::Frame;

/// The ray through a pixel that a path begins with.
pub(super) struct CameraRay {
    pub(super) ray: Ray,
    pub(super) randoms: PathRandoms,
}

/// A path that goes on.
pub(super) struct ActivePath {
    /// Position in the bundle.
    pub(super) lane: usize,
    pub(super) ray: Ray,
    pub(super) hit: Option<Hit>,
    pub(super) throughput: DVec3,
}

/// A point of a path, with its local frame.
pub(super) struct Vertex<'a> {
    /// Position of its path in the bundle.
    pub(super) lane: usize,
    pub(super) throughput: DVec3,
    pub(super) hit: Hit,
    pub(super) frame: Frame,
    pub(super) wo: Vec3,
    pub(super) surface: &'a Surface,
}

/// A direction drawn from a vertex, and f_r·cos/pdf.
#[derive(Clone, Copy)]
pub(super) struct ScatteredRay {
    pub(super) ray: Ray,
    pub(super) pdf: f64,
    pub(super) weight: DVec3,
}
