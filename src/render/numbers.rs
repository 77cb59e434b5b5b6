//! The random numbers of a path.

use glam::{DVec2, Vec2};

use super::path::PathId;
use super::{Scene, Settings};
use crate::points::{PointSet, mix};

/// The numbers behind one path: sets of four dimensions, one for the pixel, then for each vertex one for the BRDF, roulette
/// and the choice of a candidate, and one for every two lights. Candidates have a seed of their own.
pub(super) struct Numbers {
    points: PointSet,
    seed: u64,
    index: u64,
    /// Paths that the set of points is for.
    count: u64,
    sets_per_vertex: u32,
    candidates: u32,
}

impl Settings {
    /// Seed of all numbers of a pixel.
    pub(super) fn pixel_seed(&self, pixel: usize) -> u64 {
        mix(self.seed ^ mix(pixel as u64))
    }
}

impl Numbers {
    /// Those of a path.
    pub(super) fn new(scene: &Scene, points: PointSet, path: PathId) -> Self {
        let PathId { seed, index, count, .. } = path;
        let sets_per_vertex = 1 + (scene.lights.len() as u32).div_ceil(2);
        Self { points, seed, index, count, sets_per_vertex, candidates: scene.strategy.candidates() }
    }

    fn set(&self, set: u32) -> [f32; 4] {
        self.points.point4_of(self.count, self.seed, self.index, set)
    }

    /// A point of the pixel.
    pub(super) fn pixel(&self) -> DVec2 {
        let p = self.set(0);
        Vec2::new(p[0], p[1]).as_dvec2()
    }

    /// Two numbers for a direction from the BRDF, one for roulette and one for the choice of a candidate.
    pub(super) fn direction(&self, vertex: u32) -> [f32; 4] {
        self.set(1 + vertex * self.sets_per_vertex)
    }

    /// A point on a light. Of the first vertex and light, one that is well spread together with the point of the pixel: on
    /// most pixels they make most of the error.
    pub(super) fn light(&self, vertex: u32, light: usize) -> DVec2 {
        if vertex == 0 && light == 0 {
            let p = self.set(0);
            return Vec2::new(p[2], p[3]).as_dvec2();
        }
        let p = self.set(2 + vertex * self.sets_per_vertex + light as u32 / 2);
        let pair = if light.is_multiple_of(2) { [p[0], p[1]] } else { [p[2], p[3]] };
        Vec2::from_array(pair).as_dvec2()
    }

    /// Two numbers for a candidate. Those of all paths are one sequence of points, so that all are well spread together.
    pub(super) fn candidate(&self, vertex: u32, candidate: u32) -> Vec2 {
        let index = self.index * u64::from(self.candidates) + u64::from(candidate);
        self.points.point_of(self.count * u64::from(self.candidates), mix(!self.seed), index, vertex)
    }
}
