//! The path tracer: next-event estimation, multiple importance sampling, Russian roulette (Kajiya 1986; Veach 1997).
//!
//! Paths are followed in bundles, stage after stage, each over arrays: what one path waits for overlaps with the others.
//! A bounce adds to a path's radiance, with T for its throughput:
//!
//! ```text
//! Σ over lights   T · f_r·cos·L / q · w(q, p)      directions that the light chooses, of density q
//!                 T · f_r·cos·L / p · w(p, q)      the direction that the BRDF's sampler draws, of density p
//! T ← T · f_r·cos / p                              for the path that goes on along that direction
//! T ← T · F                                        for the one along the mirror direction, where the BRDF has a delta part
//! ```
//!
//! w is the weight of multiple importance sampling, 1 where only one of the two techniques finds the light.

use glam::DVec3;

use super::bundle::{ActivePath, BUNDLE, Bundle, CameraRay, Run, Scratch, Vertex, refill};
use super::path_numbers::{PathId, PathRandoms};
use super::plan::ROULETTE_FROM;
use super::tracer::Tracer;
use crate::geometry::is_upper;

/// Radiance whose square, summed over any number of samples, is still an f64: what standard errors are made of.
const BRIGHTEST: f64 = 1e140;

impl<'a> Tracer<'a> {
    /// Estimates of the radiance that arrives along `paths`, given to `each` in their order.
    pub(super) fn trace(
        &self,
        mut paths: impl Iterator<Item = PathId>,
        mut each: impl FnMut(PathId, DVec3),
    ) {
        let mut ids = Vec::with_capacity(BUNDLE);
        let mut bundle = Bundle::default();
        loop {
            ids.clear();
            ids.extend(paths.by_ref().take(BUNDLE));
            if ids.is_empty() {
                break;
            }
            bundle.starts.clear();
            bundle.starts.extend(ids.iter().map(|&id| self.start(id)));
            self.follow(&mut bundle);
            for (id, radiance) in ids.iter().zip(&bundle.radiance) {
                each(*id, *radiance);
            }
        }
    }

    fn start(&self, path: PathId) -> CameraRay {
        let randoms = PathRandoms::new(self.scene, self.settings.points, path);
        CameraRay {
            ray: self.ray(path.pixel, randoms.pixel()),
            randoms,
        }
    }

    /// Estimates the radiance that arrives at the origins of a bundle's camera rays.
    fn follow(&self, bundle: &mut Bundle<'a>) {
        self.begin_paths(bundle);
        let Bundle {
            starts,
            paths,
            vertices,
            radiance,
            scratch,
        } = bundle;
        for bounce in 0..self.scene.depth {
            // Turn hits into vertices; paths that leave the scene, or meet a surface from below, end.
            vertices.clear();
            vertices.extend(paths.iter().filter_map(|path| self.vertex(path)));
            paths.clear();
            // Surfaces evaluate and sample their BRDFs for many directions at once.
            for vertices in vertices.chunk_by(|a, b| std::ptr::eq(a.surface, b.surface)) {
                let run = Run {
                    vertices,
                    bounce,
                    starts,
                };
                self.reflect_direct(run, scratch, radiance);
                self.continue_paths(run, scratch, radiance, paths);
                self.add_mirrors(run, scratch, radiance, paths);
            }
            if paths.is_empty() {
                break;
            }
        }
        for sum in radiance {
            // NaN fails the comparison too.
            let is_representable = sum.max_element() <= BRIGHTEST;
            if !is_representable {
                *sum = DVec3::ZERO;
            }
        }
    }

    /// Finds what the camera rays meet, and what lights with an extent emit along them.
    fn begin_paths(&self, bundle: &mut Bundle<'a>) {
        let emitted = &mut bundle.scratch.emitted;
        bundle.paths.clear();
        emitted.clear();
        for (lane, start) in bundle.starts.iter().enumerate() {
            let ray = start.ray;
            let hit = self.scene.hit(&ray, None);
            emitted.push(&ray, hit);
            bundle.paths.push(ActivePath {
                lane,
                ray,
                hit,
                throughput: DVec3::ONE,
            });
        }
        self.sum_emitted(emitted, |_, _| 1.0);
        bundle.radiance.clear();
        bundle.radiance.extend_from_slice(&emitted.sums);
    }

    fn vertex(&self, path: &ActivePath) -> Option<Vertex<'a>> {
        let hit = path.hit?;
        let surface = self.scene.surface(hit.object)?;
        let frame = surface.frame(hit.normal.as_vec3());
        let wo = frame.to_local(-path.ray.direction.as_vec3());
        is_upper(wo).then_some(Vertex {
            lane: path.lane,
            throughput: path.throughput,
            hit,
            frame,
            wo,
            surface,
        })
    }

    /// Adds what vertices of a surface reflect of light that is evaluated, sampled or resampled.
    fn reflect_direct(&self, run: Run<'_, '_>, scratch: &mut Scratch, radiance: &mut [DVec3]) {
        refill(&mut scratch.reflected, run.vertices.len(), DVec3::ZERO);
        if self.resampling {
            self.resample(run, scratch);
        }
        self.add_direct(run, &mut scratch.direct, &mut scratch.reflected);
        for (vertex, reflected) in run.vertices.iter().zip(&scratch.reflected) {
            radiance[vertex.lane] += vertex.throughput * *reflected;
        }
    }

    /// Draws a direction from each vertex of a surface, adds what it finds, and keeps the paths that go on.
    fn continue_paths(
        &self,
        run: Run<'_, '_>,
        scratch: &mut Scratch,
        radiance: &mut [DVec3],
        paths: &mut Vec<ActivePath>,
    ) {
        let follows = self.interreflection && run.bounce + 1 < self.scene.depth;
        if !(self.directions && (self.hits_count || follows)) {
            return;
        }
        self.draw_next(run, scratch);
        // Add the light that the directions find, as far as it counts.
        if self.hits_count {
            self.sum_found(&scratch.found, &mut scratch.emitted);
            for (path, found) in scratch.next.iter().zip(&scratch.emitted.sums) {
                radiance[path.lane] += path.throughput * *found;
            }
        }
        // Let roulette decide which paths go on.
        if follows {
            for mut path in scratch.next.drain(..) {
                let randoms = &run.starts[path.lane].randoms;
                if self.survives(&mut path.throughput, run.bounce, randoms) {
                    paths.push(path);
                }
            }
        }
    }

    /// Draws a direction from each vertex of a surface and finds what it meets: T ← T · f_r·cos/p. Those that carry nothing end.
    fn draw_next(&self, run: Run<'_, '_>, scratch: &mut Scratch) {
        scratch.scattered.points.clear();
        for vertex in run.vertices {
            let point = run.randoms(vertex).direction(run.bounce);
            scratch.scattered.points.push(point);
        }
        self.scatter(run, &mut scratch.scattered);
        scratch.found.clear();
        scratch.next.clear();
        for (vertex, scattered) in run.vertices.iter().zip(&scratch.scattered.rays) {
            let Some(scattered) = scattered else { continue };
            let throughput = vertex.throughput * scattered.weight;
            if throughput == DVec3::ZERO || !throughput.is_finite() {
                continue;
            }
            let hit = self.next_hit(&scattered.ray, vertex.hit.object);
            scratch.found.push((*scattered, hit));
            scratch.next.push(ActivePath {
                lane: vertex.lane,
                ray: scattered.ray,
                hit,
                throughput,
            });
        }
    }

    /// Ends a path at random in proportion to what it can't carry any more, and makes up for it in the survivors: with the
    /// chance c = min(1, max T), T ← T/c.
    pub(super) fn survives(
        &self,
        throughput: &mut DVec3,
        bounce: u32,
        randoms: &PathRandoms,
    ) -> bool {
        if !self.roulette || bounce + 1 < ROULETTE_FROM {
            return true;
        }
        let chance = throughput.max_element().min(1.0);
        *throughput /= chance;
        f64::from(randoms.chances(bounce).x) < chance
    }
}
