//! Resampled importance sampling of the lights that have an extent (Talbot et al. 2005).

use glam::DVec3;

use super::numbers::Numbers;
use super::path::{Step, Tracer, Vertex};
use crate::dist::Reservoir;

impl Tracer<'_> {
    /// Radiance that a vertex reflects from lights with an extent, by one of several directions from the BRDF.
    ///
    /// A candidate's weight is its target, the mean channel of f·cos·L with nothing in the way, over its density p. The one
    /// kept, with a probability in proportion to its weight, is traced, and stands for all: f·cos·L over its target, times
    /// the mean weight, L now being what it really finds. Nothing is found that the target doesn't hold, so this is unbiased
    /// in every channel; p cancels.
    pub(super) fn resampled(&self, vertex: &Vertex<'_>, index: u32, numbers: &Numbers) -> DVec3 {
        let mut reservoir = Reservoir::new(f64::from(numbers.direction(index)[3]));
        for candidate in 0..self.scene.strategy.candidates() {
            let step = self.step(vertex, numbers.candidate(index, candidate));
            reservoir.offer(step.map(|step| (step, self.unhidden(&step))));
        }
        let Some(kept) = reservoir.kept() else {
            return DVec3::ZERO;
        };
        let hit = self.next_hit(&kept.candidate.ray, vertex.hit.object);
        kept.candidate.weight * self.found(&kept.candidate, hit) * (kept.mean_weight / kept.weight)
    }

    /// The mean channel of f·cos·L/p with nothing in the way.
    fn unhidden(&self, step: &Step) -> f64 {
        if step.weight == DVec3::ZERO {
            0.0
        } else {
            (step.weight * self.found(step, None)).element_sum() / 3.0
        }
    }
}
