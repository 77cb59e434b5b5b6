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

use super::bundle::{ActivePath, BUNDLE, Bundle, Run, Scratch, Vertex, refill};
use super::path_numbers::PathId;
use super::plan::ROULETTE_FROM;
use super::tracer::Tracer;
use crate::geometry::is_upper;
use crate::points::PointId;

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
            self.start(&ids, &mut bundle);
            self.follow(&mut bundle);
            for (id, radiance) in ids.iter().zip(&bundle.radiance) {
                each(*id, *radiance);
            }
        }
    }

    /// Makes the rays that paths begin with.
    fn start(&self, paths: &[PathId], bundle: &mut Bundle<'a>) {
        bundle.ids.clear();
        for path in paths {
            bundle.ids.push(path.point);
        }
        self.numbers.fill_pixels(&bundle.ids, &mut bundle.pixels);
        bundle.starts.clear();
        for (path, within) in paths.iter().zip(&bundle.pixels) {
            bundle.starts.push(self.ray(path.pixel, within.as_dvec2()));
        }
    }

    /// Estimates the radiance that arrives at the origins of a bundle's camera rays.
    fn follow(&self, bundle: &mut Bundle<'a>) {
        self.begin_paths(bundle);
        let Bundle {
            ids,
            paths,
            vertices,
            vertex_ids,
            radiance,
            scratch,
            ..
        } = bundle;
        for bounce in 0..self.scene.depth {
            // Turn hits into vertices; paths that leave the scene, or meet a surface from below, end.
            vertices.clear();
            vertices.extend(paths.iter().filter_map(|path| self.vertex(path)));
            paths.clear();
            vertex_ids.clear();
            for vertex in vertices.iter() {
                vertex_ids.push(ids[vertex.lane]);
            }
            let mut first = 0;
            // Surfaces evaluate and sample their BRDFs for many directions at once.
            for vertices in vertices.chunk_by(|a, b| std::ptr::eq(a.surface, b.surface)) {
                let run = Run {
                    vertices,
                    bounce,
                    ids: &vertex_ids[first..][..vertices.len()],
                };
                first += vertices.len();
                self.reflect_direct(run, scratch, radiance);
                self.continue_paths(run, scratch, radiance, ids, paths);
                self.add_mirrors(run, scratch, radiance, ids, paths);
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
        for (lane, &ray) in bundle.starts.iter().enumerate() {
            let hit = self.scene.hit(&ray, None);
            emitted.push(&ray, hit);
            bundle.paths.push(ActivePath {
                lane,
                ray,
                hit,
                throughput: DVec3::ONE,
            });
        }
        // No other technique finds what the camera sees without a surface in between, so it counts in full.
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
        ids: &[PointId],
        paths: &mut Vec<ActivePath>,
    ) {
        // A direction is of use if the light that it hits counts, or if the path may have another vertex along it.
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
                if self.survives(&mut path.throughput, run.bounce, ids[path.lane]) {
                    paths.push(path);
                }
            }
        }
    }

    /// Draws a direction from each vertex of a surface and finds what it meets: T ← T · f_r·cos/p. Those that carry nothing end.
    fn draw_next(&self, run: Run<'_, '_>, scratch: &mut Scratch) {
        let points = &mut scratch.scattered.points;
        self.numbers.fill_directions(run.bounce, run.ids, points);
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
    pub(super) fn survives(&self, throughput: &mut DVec3, bounce: u32, id: PointId) -> bool {
        if !self.roulette || bounce + 1 < ROULETTE_FROM {
            return true;
        }
        // Unbiased: T/c with probability c has the mean T. A path whose T is 1 or more in a channel goes on for certain.
        let chance = throughput.max_element().min(1.0);
        *throughput /= chance;
        f64::from(self.numbers.chances(bounce, id).x) < chance
    }
}
