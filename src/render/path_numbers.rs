//! The random numbers of a path.

use glam::{DVec2, Vec2};

use super::scene::Scene;
use crate::points::{PointSet, mix};

/// A path of those that a seed gives a pixel.
#[derive(Clone, Copy)]
pub(super) struct PathId {
    /// Column and row.
    pub(super) pixel: [usize; 2],
    pub(super) seed: u64,
    pub(super) index: u64,
    /// How many paths the seed gives; only lattices need it.
    pub(super) count: u64,
}

/// The numbers behind one path: sets of four dimensions, one for the pixel and the first light of the first vertex, then for
/// each vertex one for the BRDF, roulette and the choice of a candidate, and one for every two lights. Candidates have a seed of
/// their own.
pub(super) struct PathRandoms {
    points: PointSet,
    seed: u64,
    index: u64,
    /// How many paths the set of points is for.
    count: u64,
    sets_per_vertex: u32,
    candidates: u32,
}

impl PathRandoms {
    /// The numbers of a path.
    pub(super) fn new(scene: &Scene, points: PointSet, path: PathId) -> Self {
        let PathId {
            seed, index, count, ..
        } = path;
        // A set holds two pairs of numbers. The first has that of the BRDF and that of roulette, the others one for each light.
        let sets_per_vertex = 1 + (scene.lights.len() as u32).div_ceil(2);
        Self {
            points,
            seed,
            index,
            count,
            sets_per_vertex,
            candidates: scene.strategy.candidates(),
        }
    }

    fn pair(&self, set: u32, second: bool) -> Vec2 {
        self.points
            .pair_of(self.count, self.seed, self.index, set, second)
    }

    /// A point of the pixel.
    pub(super) fn pixel(&self) -> DVec2 {
        self.pair(0, false).as_dvec2()
    }

    /// Two numbers for a direction from the BRDF.
    pub(super) fn direction(&self, vertex: u32) -> Vec2 {
        self.pair(1 + vertex * self.sets_per_vertex, false)
    }

    /// One number for roulette and one for the choice of a candidate.
    pub(super) fn chances(&self, vertex: u32) -> Vec2 {
        self.pair(1 + vertex * self.sets_per_vertex, true)
    }

    /// A point on a light. The first vertex's first light uses the same four dimensions as the point of the pixel, which Sobol
    /// points spread together: these two make most of the error of most pixels.
    pub(super) fn light(&self, vertex: u32, light: usize) -> DVec2 {
        let (set, second) = match (vertex, light) {
            (0, 0) => (0, true),
            _ => (
                2 + vertex * self.sets_per_vertex + light as u32 / 2,
                light % 2 == 1,
            ),
        };
        self.pair(set, second).as_dvec2()
    }

    /// Two numbers for a candidate. The candidates of all paths are one sequence of points, well spread together.
    pub(super) fn candidate(&self, vertex: u32, candidate: u32) -> Vec2 {
        let candidates = u64::from(self.candidates);
        let index = self.index * candidates + u64::from(candidate);
        self.points.pair_of(
            self.count.saturating_mul(candidates),
            mix(!self.seed),
            index,
            vertex,
            true,
        )
    }
}
