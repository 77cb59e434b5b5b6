//! The random numbers of paths.

use glam::Vec2;

use super::scene::Scene;
use crate::points::{PointId, PointSet, mix};

/// Neighbours among the paths that a seed gives a pixel.
#[derive(Clone, Copy)]
pub(super) struct PathRun {
    /// Column and row.
    pub(super) pixel: [usize; 2],
    pub(super) seed: u64,
    /// From this one on, up to `to`.
    pub(super) from: u64,
    pub(super) to: u64,
    /// How many the seed gives in all.
    pub(super) count: u64,
}

/// Where the numbers behind paths are found: sets of four dimensions, one for the pixel and the first light of the first vertex,
/// then for each vertex one for the BRDF, roulette and the choice of a candidate, and one for every two lights. Candidates have a
/// seed of their own.
pub(super) struct PathNumbers {
    points: PointSet,
    sets_per_vertex: u32,
    candidates: u32,
}

impl PathNumbers {
    /// The numbers of paths through a scene.
    pub(super) fn new(scene: &Scene, points: PointSet) -> Self {
        Self {
            points,
            sets_per_vertex: 1 + (scene.lights.len() as u32).div_ceil(2),
            candidates: scene.strategy.candidates(),
        }
    }

    /// For each path a point of its pixel.
    pub(super) fn fill_pixels(&self, ids: &[PointId], out: &mut Vec<Vec2>) {
        self.points.fill_pairs(ids, 0, false, out);
    }

    /// For each path two numbers for a direction from the BRDF.
    pub(super) fn fill_directions(&self, vertex: u32, ids: &[PointId], out: &mut Vec<Vec2>) {
        let set = 1 + vertex * self.sets_per_vertex;
        self.points.fill_pairs(ids, set, false, out);
    }

    /// For each path a point on a light. The first vertex's first light uses the same four dimensions as the point of the
    /// pixel, which Sobol points spread together: these two make most of the error of most pixels.
    pub(super) fn fill_lights(
        &self,
        vertex: u32,
        light: usize,
        ids: &[PointId],
        out: &mut Vec<Vec2>,
    ) {
        let (set, second) = match (vertex, light) {
            (0, 0) => (0, true),
            _ => (
                2 + vertex * self.sets_per_vertex + light as u32 / 2,
                light % 2 == 1,
            ),
        };
        self.points.fill_pairs(ids, set, second, out);
    }

    /// One number for roulette and one for the choice of a candidate.
    pub(super) fn chances(&self, vertex: u32, id: PointId) -> Vec2 {
        let set = 1 + vertex * self.sets_per_vertex;
        self.points.pair_of(id.count, id.seed, id.index, set, true)
    }

    /// A seed for the directions that are drawn together at a vertex of a path.
    pub(super) fn spread_seed(&self, vertex: u32, id: PointId) -> u64 {
        let path = mix(mix(!id.seed).wrapping_add(id.index));
        mix(path.wrapping_add(u64::from(vertex) + 1))
    }

    /// Two numbers for a candidate. The candidates of all paths are one sequence of points, well spread together.
    pub(super) fn candidate(&self, vertex: u32, candidate: u32, id: PointId) -> Vec2 {
        let candidates = u64::from(self.candidates);
        let index = id.index * candidates + u64::from(candidate);
        self.points.pair_of(
            id.count.saturating_mul(candidates),
            mix(!id.seed),
            index,
            vertex,
            true,
        )
    }
}
