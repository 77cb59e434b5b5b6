//! Paths that are followed together, and the arrays that their stages pass on.
//!
//! Every array is allocated once for each thread's bundle and filled again at every stage: a stage clears what it writes.

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::scene::{Hit, Surface};
use super::shape::Ray;
use crate::color::Rgb;
use crate::direction_sampler::DirectionSample;
use crate::distribution::Reservoir;
use crate::geometry::Frame;
use crate::light::{Emission, LightSample};
use crate::points::PointId;

/// Paths that are followed together: their arrays fit the fastest cache.
pub(super) const BUNDLE: usize = 64;

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

/// Light that is about to be reflected at a vertex.
pub(super) struct IncidentLight {
    /// Position of the vertex in its run.
    pub(super) index: usize,
    pub(super) towards: DVec3,
    pub(super) distance: f64,
    pub(super) radiance: DVec3,
    pub(super) pdf: f64,
}

/// Neighbouring vertices of one bounce that lie on the same surface.
#[derive(Clone, Copy)]
pub(super) struct Run<'r, 'a> {
    pub(super) vertices: &'r [Vertex<'a>],
    /// Surfaces that the paths have met before.
    pub(super) bounce: u32,
    /// The paths' places among those of their seeds, vertex by vertex.
    pub(super) ids: &'r [PointId],
}

/// A bundle of paths.
#[derive(Default)]
pub(super) struct Bundle<'a> {
    /// The paths' places among those of their seeds, by lane.
    pub(super) ids: Vec<PointId>,
    /// Points of the pixels, by lane.
    pub(super) pixels: Vec<Vec2>,
    /// Rays through these, by lane.
    pub(super) starts: Vec<Ray>,
    /// The paths that go on.
    pub(super) paths: Vec<ActivePath>,
    pub(super) vertices: Vec<Vertex<'a>>,
    /// The places of the vertices' paths.
    pub(super) vertex_ids: Vec<PointId>,
    /// Estimates of the radiance that arrives at the camera, by lane.
    pub(super) radiance: Vec<DVec3>,
    pub(super) scratch: Scratch,
}

/// What the stages of a run pass on.
#[derive(Default)]
pub(super) struct Scratch {
    pub(super) emitted: EmittedLight,
    pub(super) direct: DirectLight,
    pub(super) scattered: Scattering,
    /// Directions that were drawn, and what they meet.
    pub(super) found: Vec<(ScatteredRay, Option<Hit>)>,
    /// The paths that these directions make.
    pub(super) next: Vec<ActivePath>,
    pub(super) reservoirs: Vec<Reservoir<ScatteredRay>>,
    /// Vertices whose reservoirs kept a direction, and what its light is scaled by.
    pub(super) scales: Vec<(usize, f64)>,
    /// Radiance that each vertex reflects.
    pub(super) reflected: Vec<DVec3>,
}

/// Rays along which lights with an extent are looked for, and what they find.
#[derive(Default)]
pub(super) struct EmittedLight {
    pub(super) from: Vec<DVec3>,
    pub(super) along: Vec<DVec3>,
    pub(super) reach: Vec<f64>,
    pub(super) emissions: Vec<Option<Emission>>,
    /// Radiance along each ray, of all lights.
    pub(super) sums: Vec<DVec3>,
}

impl EmittedLight {
    /// Forgets all rays.
    pub(super) fn clear(&mut self) {
        self.from.clear();
        self.along.clear();
        self.reach.clear();
    }

    /// Adds a ray that ends at what it hits.
    pub(super) fn push(&mut self, ray: &Ray, hit: Option<Hit>) {
        self.from.push(ray.origin);
        self.along.push(ray.direction);
        self.reach.push(hit.map_or(f64::INFINITY, |h| h.distance));
    }
}

/// Light that is sampled or evaluated from the vertices of a run, and what they reflect of it.
#[derive(Default)]
pub(super) struct DirectLight {
    pub(super) from: Vec<DVec3>,
    pub(super) numbers: Vec<Vec2>,
    pub(super) points: Vec<DVec2>,
    pub(super) samples: Vec<Option<LightSample>>,
    /// The samples from above the surfaces; the following arrays go with them.
    pub(super) lights: Vec<IncidentLight>,
    pub(super) wo: Vec<Vec3>,
    pub(super) wi: Vec<Vec3>,
    pub(super) reflected: Vec<Rgb>,
    /// The BRDF sampler's density of each direction; 0 where it is not needed.
    pub(super) brdf_pdf: Vec<f32>,
}

/// Directions drawn from the vertices of a run.
#[derive(Default)]
pub(super) struct Scattering {
    /// Points of the unit square that choose them.
    pub(super) points: Vec<Vec2>,
    pub(super) wo: Vec<Vec3>,
    pub(super) wi: Vec<Vec3>,
    pub(super) samples: Vec<Option<DirectionSample>>,
    pub(super) reflected: Vec<Rgb>,
    /// The directions; `None` for a failed draw.
    pub(super) rays: Vec<Option<ScatteredRay>>,
}

/// Makes an array of `count` elements that are all `value`.
pub(super) fn refill<T: Clone>(array: &mut Vec<T>, count: usize, value: T) {
    array.clear();
    array.resize(count, value);
}
