//! Paths that are followed together, and the arrays that their stages pass on.
//!
//! Every array is allocated once for each thread's bundle and filled again at every stage: a stage clears what it writes.

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::path_numbers::PathRun;
use super::rays::{NewRay, Rays};
use super::scene::Surface;
use crate::color::Rgb;
use crate::direction_sampler::DirectionSample;
use crate::distribution::Reservoir;
use crate::geometry::Frame;
use crate::light::{Emission, LightSample};
use crate::points::PointId;

/// Paths that are followed together: their arrays fit the fastest cache.
pub(super) const BUNDLE: usize = 64;

/// A point of a path, with its local frame.
pub(super) struct Vertex<'a> {
    /// Position of its path in the bundle.
    pub(super) lane: u32,
    pub(super) throughput: DVec3,
    pub(super) position: DVec3,
    pub(super) object: u32,
    pub(super) frame: Frame,
    pub(super) wo: Vec3,
    pub(super) surface: &'a Surface,
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

/// The paths of a bundle that are of one run.
pub(super) struct PathsOfRun {
    /// The run's number.
    pub(super) run: usize,
    pub(super) pixel: [usize; 2],
    pub(super) count: usize,
}

/// A bundle of paths.
#[derive(Default)]
pub(super) struct Bundle<'a> {
    /// Whose its paths are, in their order.
    pub(super) paths: Vec<PathsOfRun>,
    /// The paths' places among those of their seeds, by lane.
    pub(super) ids: Vec<PointId>,
    /// Points of the pixels, by lane.
    pub(super) pixels: Vec<Vec2>,
    /// The paths that go on: the camera's rays first.
    pub(super) rays: Rays,
    pub(super) vertices: Vec<Vertex<'a>>,
    /// The places of the vertices' paths.
    pub(super) vertex_ids: Vec<PointId>,
    /// Estimates of the radiance that arrives at the camera, by lane.
    pub(super) radiance: Vec<DVec3>,
    pub(super) scratch: Scratch,
}

impl Bundle<'_> {
    pub(super) fn is_full(&self) -> bool {
        self.ids.len() >= BUNDLE
    }

    pub(super) fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// Forgets its paths.
    pub(super) fn clear(&mut self) {
        self.paths.clear();
        self.ids.clear();
    }

    /// Takes paths from the beginning of a run, up to as many as it has room for.
    pub(super) fn take_paths(&mut self, number: usize, run: &mut PathRun) {
        let room = (BUNDLE - self.ids.len()) as u64;
        let end = run.to.min(run.from + room);
        for index in run.from..end {
            self.ids.push(PointId {
                seed: run.seed,
                index,
                count: run.count,
            });
        }
        self.paths.push(PathsOfRun {
            run: number,
            pixel: run.pixel,
            count: (end - run.from) as usize,
        });
        run.from = end;
    }
}

/// What the stages of a run pass on.
#[derive(Default)]
pub(super) struct Scratch {
    pub(super) emitted: EmittedLight,
    pub(super) direct: DirectLight,
    pub(super) scattered: Scattering,
    /// Directions that were drawn and carry something, and what they meet.
    pub(super) found: Rays,
    /// Of directions that were drawn together, the one of each vertex that its path goes on along.
    pub(super) kept: Rays,
    pub(super) reservoirs: Vec<Reservoir<NewRay>>,
    /// Vertices whose reservoirs kept a direction, and what its light is scaled by.
    pub(super) scales: Vec<(usize, f64)>,
    /// Radiance that each vertex reflects.
    pub(super) reflected: Vec<DVec3>,
}

/// What lights with an extent emit along rays.
#[derive(Default)]
pub(super) struct EmittedLight {
    pub(super) emissions: Vec<Option<Emission>>,
    /// Radiance along each ray, of all lights.
    pub(super) sums: Vec<DVec3>,
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
    /// The directions, without failed draws.
    pub(super) rays: Rays,
}
