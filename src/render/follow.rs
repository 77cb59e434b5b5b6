//! The path tracer: next-event estimation, multiple importance sampling, Russian roulette (Kajiya 1986; Veach 1997).
//!
//! Paths are followed in bundles, stage after stage, each over arrays: what one path waits for overlaps with the others.

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::path_numbers::{PathId, PathRandoms};
use super::plan::ROULETTE_FROM;
use super::scene::Hit;
use super::shape::Ray;
use super::tracer::Tracer;
use super::vertex::{ActivePath, CameraRay, ScatteredRay, Vertex};
use crate::color::Rgb;
use crate::geometry::is_upper;
use crate::light::Light;

/// Paths that are followed together: their arrays fit the fastest cache.
pub(super) const BUNDLE: usize = 64;

/// Radiance whose square, summed over any number of samples, is still an f64: what standard errors are made of.
const BRIGHTEST: f64 = 1e140;

/// Light that is about to be reflected at a vertex.
struct IncidentLight {
    /// Position of the vertex in its run.
    index: usize,
    towards: DVec3,
    distance: f64,
    radiance: DVec3,
    pdf: f64,
}

impl<'a> Tracer<'a> {
    /// Estimates of the radiance that arrives along `paths`, given to `each` in their order.
    pub(super) fn trace(
        &self,
        mut paths: impl Iterator<Item = PathId>,
        mut each: impl FnMut(PathId, DVec3),
    ) {
        let mut ids = Vec::with_capacity(BUNDLE);
        let mut starts = Vec::with_capacity(BUNDLE);
        loop {
            ids.clear();
            ids.extend(paths.by_ref().take(BUNDLE));
            if ids.is_empty() {
                break;
            }
            starts.clear();
            starts.extend(ids.iter().map(|&id| self.start(id)));
            for (id, radiance) in ids.iter().zip(self.follow(&starts)) {
                each(*id, radiance);
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

    /// Estimates of the radiance that arrives at the origins of rays.
    pub(super) fn follow(&self, starts: &[CameraRay]) -> Vec<DVec3> {
        let begin = |(lane, start): (usize, &CameraRay)| {
            let hit = self.scene.hit(&start.ray, None);
            ActivePath {
                lane,
                ray: start.ray,
                hit,
                throughput: DVec3::ONE,
            }
        };
        let mut paths: Vec<ActivePath> = starts.iter().enumerate().map(begin).collect();
        let mut sums = self.emitted(paths.iter().map(|p| (&p.ray, p.hit)), |_, _| 1.0);
        for bounce in 0..self.scene.depth {
            let vertices: Vec<Vertex<'a>> =
                paths.iter().filter_map(|path| self.vertex(path)).collect();
            paths.clear();
            for run in vertices.chunk_by(|a, b| std::ptr::eq(a.surface, b.surface)) {
                let lit = self.lit(run, bounce, starts);
                run.iter()
                    .zip(lit)
                    .for_each(|(vertex, lit)| sums[vertex.lane] += vertex.throughput * lit);
                self.go_on(run, bounce, starts, &mut sums, &mut paths);
            }
            if paths.is_empty() {
                break;
            }
        }
        let kept = |sum: DVec3| {
            if sum.max_element() <= BRIGHTEST {
                sum
            } else {
                DVec3::ZERO
            }
        };
        sums.into_iter().map(kept).collect()
    }

    fn vertex(&self, path: &ActivePath) -> Option<Vertex<'a>> {
        let hit = path.hit?;
        let surface = self.scene.surface(hit.object)?;
        let frame = surface.frame(hit.normal.as_vec3());
        let wo = frame.to_local(-path.ray.direction.as_vec3());
        let &ActivePath {
            lane, throughput, ..
        } = path;
        is_upper(wo).then_some(Vertex {
            lane,
            throughput,
            hit,
            frame,
            wo,
            surface,
        })
    }

    /// Draws a direction from each vertex of a surface, adds what it finds, and keeps the paths that go on.
    fn go_on(
        &self,
        run: &[Vertex<'a>],
        bounce: u32,
        starts: &[CameraRay],
        sums: &mut [DVec3],
        paths: &mut Vec<ActivePath>,
    ) {
        let follows = self.interreflection && bounce + 1 < self.scene.depth;
        if !(self.directions && (self.hits_count || follows)) {
            return;
        }
        let points: Vec<Vec2> = run
            .iter()
            .map(|v| starts[v.lane].randoms.direction(bounce))
            .collect();
        let (mut found, mut next) = (Vec::with_capacity(run.len()), Vec::with_capacity(run.len()));
        for (vertex, step) in run.iter().zip(self.steps(run, &points)) {
            let Some((step, throughput)) = step.map(|step| (step, vertex.throughput * step.weight))
            else {
                continue;
            };
            if throughput != DVec3::ZERO && throughput.is_finite() {
                let hit = self.next_hit(&step.ray, vertex.hit.object);
                found.push((step, hit));
                next.push(ActivePath {
                    lane: vertex.lane,
                    ray: step.ray,
                    hit,
                    throughput,
                });
            }
        }
        if self.hits_count {
            for (path, radiance) in next.iter().zip(self.found(&found)) {
                sums[path.lane] += path.throughput * radiance;
            }
        }
        if follows {
            let kept = next.into_iter().filter_map(|mut path| {
                self.survives(&mut path.throughput, bounce, &starts[path.lane].randoms)
                    .then_some(path)
            });
            paths.extend(kept);
        }
    }

    /// Radiance of lights with an extent that drawn directions find up to what they hit, each as far as it counts.
    pub(super) fn found(&self, steps: &[(ScatteredRay, Option<Hit>)]) -> Vec<DVec3> {
        let weight = |i: usize, pdf| {
            if self.mis {
                self.heuristic.weight(steps[i].0.pdf, pdf)
            } else {
                1.0
            }
        };
        self.emitted(steps.iter().map(|(step, hit)| (&step.ray, *hit)), weight)
    }

    /// What a drawn direction meets; nothing, where the plan says that nothing can be in the way.
    pub(super) fn next_hit(&self, ray: &Ray, leaving: usize) -> Option<Hit> {
        (self.shadows || self.interreflection)
            .then(|| self.scene.hit(ray, Some(leaving)))
            .flatten()
    }

    /// Radiance of lights with an extent along rays, up to what they hit; each light's by `weight` of the ray's place and the
    /// light's density.
    fn emitted<'r>(
        &self,
        rays: impl ExactSizeIterator<Item = (&'r Ray, Option<Hit>)>,
        weight: impl Fn(usize, f64) -> f64,
    ) -> Vec<DVec3> {
        let count = rays.len();
        let (mut from, mut along, mut reach) = (
            Vec::with_capacity(count),
            Vec::with_capacity(count),
            Vec::with_capacity(count),
        );
        for (ray, hit) in rays {
            from.push(ray.origin);
            along.push(ray.direction);
            reach.push(hit.map_or(f64::INFINITY, |h| h.distance));
        }
        let mut sums = vec![DVec3::ZERO; count];
        let mut emissions = vec![None; count];
        for light in &self.scene.lights {
            light.emitted_batch(&from, &along, &reach, &mut emissions);
            for (i, (sum, emission)) in sums.iter_mut().zip(&emissions).enumerate() {
                if let Some(s) = emission {
                    *sum += s.radiance.as_dvec3() * weight(i, s.pdf);
                }
            }
        }
        sums
    }

    /// Radiance that vertices of a surface reflect from light that is evaluated, sampled or resampled.
    fn lit(&self, run: &[Vertex<'_>], bounce: u32, starts: &[CameraRay]) -> Vec<DVec3> {
        let mut sums = if self.resampling {
            self.resampled(run, bounce, starts)
        } else {
            vec![DVec3::ZERO; run.len()]
        };
        for (i, light) in self.scene.lights.iter().enumerate() {
            if light.is_delta() {
                self.lit_by(
                    run,
                    light.as_ref(),
                    &vec![DVec2::ZERO; run.len()],
                    &mut sums,
                );
            } else if self.light_sampling {
                let points: Vec<DVec2> = run
                    .iter()
                    .map(|v| starts[v.lane].randoms.light(bounce, i))
                    .collect();
                self.lit_by(run, light.as_ref(), &points, &mut sums);
            }
        }
        sums
    }

    /// Adds what each vertex reflects of the light in the direction that a point chooses.
    fn lit_by(&self, run: &[Vertex<'_>], light: &dyn Light, points: &[DVec2], sums: &mut [DVec3]) {
        let Some(Vertex { surface, .. }) = run.first() else {
            return;
        };
        let from: Vec<DVec3> = run.iter().map(|v| v.hit.at).collect();
        let mut samples = vec![None; run.len()];
        light.sample_batch(&from, points, &mut samples);
        let (mut lit, mut wo, mut wi) = (
            Vec::with_capacity(run.len()),
            Vec::with_capacity(run.len()),
            Vec::with_capacity(run.len()),
        );
        for (index, (vertex, sample)) in run.iter().zip(&samples).enumerate() {
            let Some(s) = sample else { continue };
            let local = vertex.frame.to_local(s.wi.as_vec3());
            // What comes from below is not reflected.
            if is_upper(local) {
                lit.push(IncidentLight {
                    index,
                    towards: s.wi,
                    distance: s.distance,
                    radiance: s.radiance.as_dvec3(),
                    pdf: s.pdf,
                });
                wo.push(vertex.wo);
                wi.push(local);
            }
        }
        let mut reflected = vec![Rgb::ZERO; lit.len()];
        surface.brdf.eval_cos_pairs(&wo, &wi, &mut reflected);
        let mut other = vec![0.0; lit.len()];
        if let Some(sampler) = surface
            .sampler
            .as_ref()
            .filter(|_| self.mis && !light.is_delta())
        {
            sampler.pdf_pairs(&wo, &wi, &mut other);
        }
        for ((lit, reflected), other) in lit.iter().zip(reflected).zip(other) {
            let reflected = reflected.as_dvec3() * lit.radiance;
            let vertex = &run[lit.index];
            if reflected != DVec3::ZERO && !self.is_hidden(vertex, lit) {
                sums[lit.index] +=
                    reflected * (self.heuristic.weight(lit.pdf, f64::from(other)) / lit.pdf);
            }
        }
    }

    fn is_hidden(&self, vertex: &Vertex<'_>, lit: &IncidentLight) -> bool {
        let ray = Ray {
            origin: vertex.hit.at,
            direction: lit.towards,
        };
        self.shadows && self.scene.is_hidden(&ray, vertex.hit.object, lit.distance)
    }

    /// A direction from each vertex of a surface; `None` for a failed draw.
    pub(super) fn steps(&self, run: &[Vertex<'_>], points: &[Vec2]) -> Vec<Option<ScatteredRay>> {
        let surface = run.first().map(|vertex| vertex.surface);
        let Some((surface, sampler)) = surface.and_then(|s| Some((s, s.sampler.as_ref()?))) else {
            return vec![None; run.len()];
        };
        let wo: Vec<Vec3> = run.iter().map(|v| v.wo).collect();
        let mut samples = vec![None; run.len()];
        sampler.sample_pairs(&wo, points, &mut samples);
        let wi: Vec<Vec3> = samples
            .iter()
            .map(|s| s.map_or(Vec3::ZERO, |s| s.wi))
            .collect();
        let mut reflected = vec![Rgb::ZERO; run.len()];
        surface.brdf.eval_cos_pairs(&wo, &wi, &mut reflected);
        let step = |((vertex, sample), reflected): ((&Vertex<'_>, &Option<_>), Rgb)| {
            let sample: &crate::direction_sampler::DirectionSample = sample.as_ref()?;
            let pdf = f64::from(sample.pdf);
            let direction = vertex
                .frame
                .to_world(sample.wi)
                .as_dvec3()
                .try_normalize()?;
            let ray = Ray {
                origin: vertex.hit.at,
                direction,
            };
            Some(ScatteredRay {
                ray,
                pdf,
                weight: reflected.as_dvec3() / pdf,
            })
        };
        run.iter().zip(&samples).zip(reflected).map(step).collect()
    }

    /// Ends a path at random in proportion to what it can't carry any more, and makes up for it in the survivors.
    fn survives(&self, throughput: &mut DVec3, bounce: u32, randoms: &PathRandoms) -> bool {
        if !self.roulette || bounce + 1 < ROULETTE_FROM {
            return true;
        }
        let chance = throughput.max_element().min(1.0);
        *throughput /= chance;
        f64::from(randoms.chances(bounce).x) < chance
    }
}
