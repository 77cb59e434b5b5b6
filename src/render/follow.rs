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

use fearless_simd::{Level, dispatch};
use glam::DVec3;

use super::bundle::{Bundle, Run, Scratch, Vertex};
use super::path_numbers::PathRun;
use super::plan::ROULETTE_FROM;
use super::rays::{NOTHING, NewRay, Rays, refill};
use super::tracer::Tracer;
use crate::geometry::is_upper;
use crate::points::PointId;

/// Radiance whose square, summed over any number of samples, is still an f64: what standard errors are made of.
const BRIGHTEST: f64 = 1e140;

impl<'a> Tracer<'a> {
    /// Estimates the radiance that arrives along each path of `runs`, and gives it to `each` with the number of its run; in order.
    /// `bundle` is empty before and after, and lends its memory.
    pub(super) fn trace(
        &self,
        runs: impl Iterator<Item = PathRun>,
        bundle: &mut Bundle<'a>,
        mut each: impl FnMut(usize, DVec3),
    ) {
        for (number, mut run) in runs.enumerate() {
            while run.from < run.to {
                bundle.take_paths(number, &mut run);
                if bundle.is_full() {
                    self.finish(bundle, &mut each);
                }
            }
        }
        if !bundle.is_empty() {
            self.finish(bundle, &mut each);
        }
    }

    /// Follows the paths of a bundle to their ends, and empties it.
    fn finish(&self, bundle: &mut Bundle<'a>, each: &mut impl FnMut(usize, DVec3)) {
        self.start(bundle);
        self.follow(bundle);
        let mut radiance = bundle.radiance.iter();
        for paths in &bundle.paths {
            for radiance in radiance.by_ref().take(paths.count) {
                each(paths.run, *radiance);
            }
        }
        bundle.clear();
    }

    /// Makes the rays that paths begin with.
    pub(super) fn start(&self, bundle: &mut Bundle<'a>) {
        let Bundle {
            paths,
            ids,
            pixels,
            rays,
            ..
        } = bundle;
        self.numbers.fill_pixels(ids, pixels);
        rays.begin(ids.len(), self.scene.camera.eye);
        self.aim(paths, pixels, &mut rays.along);
    }

    /// Estimates the radiance that arrives at the origins of a bundle's camera rays.
    fn follow(&self, bundle: &mut Bundle<'a>) {
        self.begin_paths(bundle);
        let Bundle {
            ids,
            rays,
            vertices,
            vertex_ids,
            radiance,
            scratch,
            ..
        } = bundle;
        for bounce in 0..self.scene.depth {
            // Turn hits into vertices; paths that leave the scene, or meet a surface from below, end.
            dispatch!(Level::new(), _ => self.fill_vertices(rays, vertices));
            rays.clear();
            vertex_ids.clear();
            for vertex in vertices.iter() {
                vertex_ids.push(ids[vertex.lane as usize]);
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
                self.continue_paths(run, scratch, radiance, ids, rays);
                self.add_mirrors(run, scratch, radiance, ids, rays);
            }
            if rays.is_empty() {
                break;
            }
        }
        for sum in radiance {
            // NaN fails the comparison too.
            let is_representable = sum.max_element() <= BRIGHTEST;
            if !is_representable {
                *sum = DVec3::ZERO;
            }
            let most = sum.max_element();
            if most > self.scene.clamp {
                *sum *= self.scene.clamp / most;
            }
        }
    }

    /// Finds what the camera rays meet, and what lights with an extent emit along them.
    fn begin_paths(&self, bundle: &mut Bundle<'a>) {
        self.scene.find_hits(&mut bundle.rays);
        // No other technique finds what the camera sees without a surface in between, so it counts in full.
        let emitted = &mut bundle.scratch.emitted;
        let (rays, transparent) = (&bundle.rays, self.scene.transparent);
        self.sum_emitted(rays, emitted, |i, _| {
            // Where the background is left out, only what is in front of an object is seen.
            f64::from(u8::from(!transparent || rays.objects[i] != NOTHING))
        });
        bundle.radiance.clear();
        bundle.radiance.extend_from_slice(&emitted.sums);
    }

    /// The vertices where rays meet loaded surfaces from above, in the order of the rays.
    #[inline(always)]
    fn fill_vertices(&self, rays: &Rays, vertices: &mut Vec<Vertex<'a>>) {
        vertices.clear();
        for k in 0..rays.len() {
            if rays.objects[k] == NOTHING {
                continue;
            }
            let Some(surface) = self.scene.surface(rays.objects[k]) else {
                continue;
            };
            let frame = surface.frame(rays.normals[k].as_vec3());
            let wo = frame.to_local(-rays.along[k].as_vec3());
            if is_upper(wo) {
                vertices.push(Vertex {
                    lane: rays.owners[k],
                    throughput: rays.weights[k],
                    position: rays.from[k] + rays.reach[k] * rays.along[k],
                    object: rays.objects[k],
                    frame,
                    wo,
                    surface,
                });
            }
        }
    }

    /// Adds what vertices of a surface reflect of light that is evaluated, sampled or resampled.
    fn reflect_direct(&self, run: Run<'_, '_>, scratch: &mut Scratch, radiance: &mut [DVec3]) {
        refill(&mut scratch.reflected, run.vertices.len(), DVec3::ZERO);
        if self.resampling {
            self.resample(run, scratch);
        }
        self.add_direct(run, &mut scratch.direct, &mut scratch.reflected);
        for (vertex, reflected) in run.vertices.iter().zip(&scratch.reflected) {
            radiance[vertex.lane as usize] += vertex.throughput * *reflected;
        }
    }

    /// Draws a direction from each vertex of a surface, adds what it finds, and keeps the paths that go on.
    fn continue_paths(
        &self,
        run: Run<'_, '_>,
        scratch: &mut Scratch,
        radiance: &mut [DVec3],
        ids: &[PointId],
        paths: &mut Rays,
    ) {
        // A direction is of use if the light that it hits counts, or if the path may have another vertex along it.
        let follows = self.interreflection && run.bounce + 1 < self.scene.depth;
        if !(self.directions && (self.hits_count || follows)) {
            return;
        }
        if self.spread > 1 {
            self.spread_paths(run, scratch, radiance, ids, paths);
            return;
        }
        self.draw_next(run, scratch);
        // Add the light that the directions find, as far as it counts.
        if self.hits_count {
            self.find_light(&mut scratch.found, &mut scratch.emitted, follows);
            add_found(&scratch.found, &scratch.emitted.sums, radiance);
        } else {
            self.find_next_hits(&mut scratch.found);
        }
        if follows {
            self.keep_survivors(&scratch.found, run.bounce, ids, paths);
        }
    }

    /// Lets roulette decide which of `found` are among the `paths` that go on.
    pub(super) fn keep_survivors(
        &self,
        found: &Rays,
        bounce: u32,
        ids: &[PointId],
        paths: &mut Rays,
    ) {
        for k in 0..found.len() {
            let mut throughput = found.weights[k];
            if self.survives(&mut throughput, bounce, ids[found.owners[k] as usize]) {
                paths.push_from(found, k, throughput);
            }
        }
    }

    /// Draws a direction from each vertex of a surface: T ← T · f_r·cos/p. Those that carry nothing end.
    fn draw_next(&self, run: Run<'_, '_>, scratch: &mut Scratch) {
        let points = &mut scratch.scattered.points;
        self.numbers.fill_directions(run.bounce, run.ids, points);
        self.scatter(run, &mut scratch.scattered);
        let drawn = &scratch.scattered.rays;
        scratch.found.clear();
        for k in 0..drawn.len() {
            let vertex = &run.vertices[drawn.owners[k] as usize];
            let throughput = vertex.throughput * drawn.weights[k];
            if throughput == DVec3::ZERO || !throughput.is_finite() {
                continue;
            }
            scratch.found.push(NewRay {
                owner: vertex.lane,
                weight: throughput,
                ..drawn.get(k)
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

/// Adds T·L of each ray to its path's radiance.
pub(super) fn add_found(rays: &Rays, found: &[DVec3], radiance: &mut [DVec3]) {
    for (k, light) in found.iter().enumerate() {
        radiance[rays.owners[k] as usize] += rays.weights[k] * *light;
    }
}
