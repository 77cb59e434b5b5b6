//! Resampled importance sampling of the lights that have an extent (Talbot et al. 2005).

use glam::DVec3;

use super::bundle::{Run, Scratch};
use super::tracer::Tracer;
use crate::distribution::Reservoir;

impl Tracer<'_> {
    /// Radiance that each vertex of a surface reflects from lights with an extent, by one of several directions from the BRDF,
    /// in `scratch.reflected`, which is 0 before.
    ///
    /// A candidate's weight is its target t, the mean channel of f·cos·L with nothing in the way, over its density p. The one
    /// kept, with a probability in proportion to its weight, is traced, and represents all: with L' for what it really finds,
    ///
    /// ```text
    /// estimate = f·cos·L'/t · mean(t/p)
    /// ```
    ///
    /// Nothing is found that the target doesn't hold, so this is unbiased in every channel; p cancels.
    pub(super) fn resample(&self, run: Run<'_, '_>, scratch: &mut Scratch) {
        // Offer all candidates of each vertex to its reservoir.
        scratch.reservoirs.clear();
        for &id in run.ids {
            let chance = self.numbers.chances(run.bounce, id).y;
            scratch.reservoirs.push(Reservoir::new(f64::from(chance)));
        }
        for candidate in 0..self.scene.strategy.candidates() {
            scratch.scattered.points.clear();
            for &id in run.ids {
                let point = self.numbers.candidate(run.bounce, candidate, id);
                scratch.scattered.points.push(point);
            }
            self.scatter(run, &mut scratch.scattered);
            self.offer_candidates(scratch);
        }
        // Trace those that were kept.
        scratch.found.clear();
        scratch.scales.clear();
        for (i, reservoir) in scratch.reservoirs.drain(..).enumerate() {
            let Some(kept) = reservoir.kept() else {
                continue;
            };
            scratch.found.push(kept.candidate);
            // mean(t/p)/(t/p), by which f·cos·L'/p below becomes the estimate above.
            scratch.scales.push((i, kept.mean_weight / kept.weight));
        }
        self.find_next_hits(&mut scratch.found);
        self.sum_found(&scratch.found, &mut scratch.emitted);
        for (k, &(i, scale)) in scratch.scales.iter().enumerate() {
            let weight = scratch.found.weights[k];
            scratch.reflected[i] = weight * scratch.emitted.sums[k] * scale;
        }
    }

    /// Offers one candidate to each vertex's reservoir, with its weight: the mean channel of f·cos·L/p with nothing in the way.
    fn offer_candidates(&self, scratch: &mut Scratch) {
        let rays = &mut scratch.scattered.rays;
        rays.forget_hits();
        self.sum_found(rays, &mut scratch.emitted);
        let mut k = 0;
        for (i, reservoir) in scratch.reservoirs.iter_mut().enumerate() {
            // A failed draw found nothing, and counts as a candidate without weight.
            if k == rays.len() || rays.owners[k] as usize != i {
                reservoir.offer(None);
                continue;
            }
            let ray = rays.get(k);
            let light = scratch.emitted.sums[k];
            reservoir.offer(Some((ray, candidate_weight(ray.weight, light))));
            k += 1;
        }
    }
}

fn candidate_weight(weight: DVec3, found: DVec3) -> f64 {
    if weight == DVec3::ZERO {
        0.0
    } else {
        (weight * found).element_sum() / 3.0
    }
}
