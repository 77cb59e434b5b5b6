//! Resampled importance sampling of the lights that have an extent (Talbot et al. 2005).

use glam::{DVec3, Vec2};

use super::tracer::Tracer;
use super::vertex::{CameraRay, ScatteredRay, Vertex};
use crate::distribution::Reservoir;

impl Tracer<'_> {
    /// Radiance that each vertex of a surface reflects from lights with an extent, by one of several directions from the BRDF.
    ///
    /// A candidate's weight is its target, the mean channel of f·cos·L with nothing in the way, over its density p. The one
    /// kept, with a probability in proportion to its weight, is traced, and stands for all: f·cos·L over its target, times
    /// the mean weight, L now being what it really finds. Nothing is found that the target doesn't hold, so this is unbiased
    /// in every channel; p cancels.
    pub(super) fn resampled(
        &self,
        run: &[Vertex<'_>],
        bounce: u32,
        starts: &[CameraRay],
    ) -> Vec<DVec3> {
        let randoms = |v: &Vertex<'_>| &starts[v.lane].randoms;
        let open = |v| Reservoir::new(f64::from(randoms(v).chances(bounce).y));
        let mut reservoirs: Vec<Reservoir<ScatteredRay>> = run.iter().map(open).collect();
        for candidate in 0..self.scene.strategy.candidates() {
            let points: Vec<Vec2> = run
                .iter()
                .map(|v| randoms(v).candidate(bounce, candidate))
                .collect();
            let steps = self.steps(run, &points);
            for (reservoir, offer) in reservoirs.iter_mut().zip(self.targets(&steps)) {
                reservoir.offer(offer);
            }
        }
        let mut sums = vec![DVec3::ZERO; run.len()];
        let (mut found, mut scales) = (Vec::new(), Vec::new());
        for (i, kept) in reservoirs
            .into_iter()
            .enumerate()
            .filter_map(|(i, r)| Some((i, r.kept()?)))
        {
            let hit = self.next_hit(&kept.candidate.ray, run[i].hit.object);
            found.push((kept.candidate, hit));
            scales.push((i, kept.mean_weight / kept.weight));
        }
        for (((step, _), radiance), (i, scale)) in found.iter().zip(self.found(&found)).zip(scales)
        {
            sums[i] = step.weight * radiance * scale;
        }
        sums
    }

    /// Steps with the mean channel of f·cos·L/p with nothing in the way.
    fn targets(&self, steps: &[Option<ScatteredRay>]) -> Vec<Option<(ScatteredRay, f64)>> {
        let drawn: Vec<_> = steps.iter().flatten().map(|step| (*step, None)).collect();
        let mut found = self.found(&drawn).into_iter();
        let target = |step: &ScatteredRay, found: DVec3| {
            if step.weight == DVec3::ZERO {
                0.0
            } else {
                (step.weight * found).element_sum() / 3.0
            }
        };
        let offer = |step: &Option<ScatteredRay>| {
            step.as_ref()
                .zip(found.next())
                .map(|(s, f)| (*s, target(s, f)))
        };
        steps.iter().map(offer).collect()
    }
}
