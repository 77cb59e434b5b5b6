//! Several directions of the BRDF at a vertex (algorithm 15 of the thesis of 2008).

use glam::{DVec3, Vec3};

use super::bundle::{Run, Scratch, Vertex};
use super::follow::add_found;
use super::rays::{NewRay, Rays};
use super::tracer::Tracer;
use crate::batch::Wo;
use crate::color::Rgb;
use crate::direction_sampler::DirectionSample;
use crate::points::PointId;

/// Rays that are traced together, at most, but for those of one vertex.
const MOST_RAYS: usize = 1 << 13;

impl Tracer<'_> {
    /// Draws N directions from each vertex of a surface together, adds the mean of what they find, and keeps the path along one of
    /// them.
    ///
    /// ```text
    /// estimate = 1/N · Σ f_r·cos·L/p · w(N·p, q)
    /// T ← T · f_r·cos/p          for the one of the N, chosen uniformly, that the path goes on along
    /// ```
    ///
    /// One that is chosen uniformly has the density p, so that both are unbiased. A draw that failed counts as 0 in either. The
    /// weights of multiple importance sampling are those of N samples of one technique and one of the other (Veach 1997, 9.2).
    pub(super) fn spread_paths(
        &self,
        run: Run<'_, '_>,
        scratch: &mut Scratch,
        radiance: &mut [DVec3],
        ids: &[PointId],
        paths: &mut Rays,
    ) {
        let follows = self.interreflection && run.bounce + 1 < self.scene.depth;
        let together = (MOST_RAYS / self.spread as usize).max(1);
        scratch.kept.clear();
        for first in (0..run.vertices.len()).step_by(together) {
            let end = run.vertices.len().min(first + together);
            // Step 1: the directions, and which of them go on.
            scratch.found.clear();
            let mut going_on = Vec::with_capacity(end - first);
            for k in first..end {
                let next = self.draw_together(run, k, &mut scratch.found);
                going_on.extend(next);
            }
            // Step 2: what they find, each a part 1/N of the estimate.
            self.find_light(&mut scratch.found, &mut scratch.emitted, follows);
            add_found(&scratch.found, &scratch.emitted.sums, radiance);
            // Step 3: a path carries all that the N carry together.
            if follows {
                for k in going_on {
                    let whole = f64::from(self.spread) * scratch.found.weights[k];
                    scratch.kept.push_from(&scratch.found, k, whole);
                }
            }
        }
        if follows {
            self.keep_survivors(&scratch.kept, run.bounce, ids, paths);
        }
    }

    /// Adds the rays of the directions that are drawn at one vertex, with T·f_r·cos/(N·p) and the density N·p, but for those that
    /// carry nothing. Returns the position of the one that the path goes on along; `None` where that carries nothing.
    fn draw_together(&self, run: Run<'_, '_>, k: usize, rays: &mut Rays) -> Option<usize> {
        let (vertex, id) = (&run.vertices[k], run.ids[k]);
        let sampler = vertex.surface.sampler.as_ref()?;
        let count = self.spread as usize;
        // Step 1: draw the directions.
        let seed = self.numbers.spread_seed(run.bounce, id);
        let samples = sampler.draw_stratified(vertex.wo, count, seed);
        // Step 2: evaluate f_r·cos. A failed draw has no direction, and its value is not used.
        let mut wi = Vec::with_capacity(count);
        wi.extend(samples.iter().map(|s| s.map_or(Vec3::ZERO, |s| s.wi)));
        let mut reflected = vec![Rgb::ZERO; count];
        let brdf = &vertex.surface.brdf;
        brdf.eval_cos_batch(Wo::One(vertex.wo), &wi, &mut reflected);
        // Step 3: choose one of all, also of those that failed.
        let chance = f64::from(self.numbers.chances(run.bounce, id).y);
        let chosen = ((chance * count as f64) as usize).min(count - 1);
        // Step 4: turn them into rays.
        let mut going_on = None;
        for (i, sample) in samples.into_iter().enumerate() {
            let ray = sample.and_then(|sample| self.aim_drawn(vertex, sample, reflected[i]));
            let Some(ray) = ray else { continue };
            if i == chosen {
                going_on = Some(rays.len());
            }
            rays.push(ray);
        }
        going_on
    }

    /// The ray of a direction that was drawn with others; `None` if it carries nothing.
    fn aim_drawn(
        &self,
        vertex: &Vertex<'_>,
        sample: DirectionSample,
        reflected: Rgb,
    ) -> Option<NewRay> {
        let pdf = f64::from(self.spread) * f64::from(sample.pdf);
        let weight = vertex.throughput * (reflected.as_dvec3() / pdf);
        if weight == DVec3::ZERO || !weight.is_finite() {
            return None;
        }
        let direction = vertex.frame.to_world(sample.wi).as_dvec3();
        Some(NewRay {
            owner: vertex.lane,
            from: vertex.position,
            along: direction.try_normalize()?,
            weight,
            pdf,
            leaving: vertex.object,
        })
    }
}
