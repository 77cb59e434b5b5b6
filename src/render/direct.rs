//! Light on the vertices of a surface: what lights emit along rays, directions towards lights, and directions from the BRDF.

use fearless_simd::{Level, dispatch};
use glam::{DVec2, DVec3, Vec3};

use super::bundle::{DirectLight, EmittedLight, IncidentLight, Run, Scattering, Vertex};
use super::rays::{NewRay, Rays, refill};
use super::scene::Surface;
use super::shape::Ray;
use super::tracer::Tracer;
use crate::batch::Wo;
use crate::color::Rgb;
use crate::direction_sampler::DirectionSample;
use crate::geometry::is_upper;
use crate::light::Light;

impl Tracer<'_> {
    /// Sums radiance of lights with an extent along rays, up to what these hit; each light's by `weight` of the ray's position
    /// and the light's density.
    pub(super) fn sum_emitted(
        &self,
        rays: &Rays,
        emitted: &mut EmittedLight,
        weight: impl Fn(usize, f64) -> f64,
    ) {
        let EmittedLight { emissions, sums } = emitted;
        refill(sums, rays.len(), DVec3::ZERO);
        refill(emissions, rays.len(), None);
        for light in &self.scene.lights {
            light.emitted_batch(&rays.from, &rays.along, &rays.reach, emissions);
            for (i, (sum, emission)) in sums.iter_mut().zip(&*emissions).enumerate() {
                if let Some(emission) = emission {
                    *sum += emission.radiance.as_dvec3() * weight(i, emission.pdf);
                }
            }
        }
    }

    /// Sums radiance of lights with an extent that drawn directions find up to what they hit, each as far as it counts:
    /// w(p, q)·L.
    pub(super) fn sum_found(&self, found: &Rays, emitted: &mut EmittedLight) {
        self.sum_emitted(found, emitted, |i, light_pdf| {
            if self.mis {
                self.heuristic.weight(found.pdfs[i], light_pdf)
            } else {
                1.0
            }
        });
    }

    /// Finds what drawn directions meet, and sums radiance of lights that they find up to there, as [`Self::sum_found`].
    ///
    /// Where no path `follows` them, those along which there is no light are left out of `found` rather than traced.
    pub(super) fn find_light(&self, found: &mut Rays, emitted: &mut EmittedLight, follows: bool) {
        let are_traced = self.shadows || self.interreflection;
        if are_traced && !follows && self.lights_are_missed {
            found.forget_hits();
            self.sum_found(found, emitted);
            found.keep_lit(&emitted.sums);
        }
        self.find_next_hits(found);
        self.sum_found(found, emitted);
    }

    /// What drawn directions meet; nothing, where the plan says that nothing can be in the way.
    pub(super) fn find_next_hits(&self, rays: &mut Rays) {
        // Lights are not objects. Where nothing hides them and no path goes on, a hit would change nothing.
        if self.shadows || self.interreflection {
            self.scene.find_hits(rays);
        } else {
            rays.forget_hits();
        }
    }

    /// Adds what vertices of a surface reflect of delta lights, and of lights with an extent in directions that these choose.
    pub(super) fn add_direct(
        &self,
        run: Run<'_, '_>,
        direct: &mut DirectLight,
        sums: &mut [DVec3],
    ) {
        for (i, light) in self.scene.lights.iter().enumerate() {
            // A delta light has one direction, and needs no random numbers for it.
            if light.is_delta() {
                refill(&mut direct.points, run.vertices.len(), DVec2::ZERO);
            } else if self.light_sampling {
                let numbers = &mut direct.numbers;
                self.numbers.fill_lights(run.bounce, i, run.ids, numbers);
                direct.points.clear();
                for number in numbers {
                    direct.points.push(number.as_dvec2());
                }
            } else {
                continue;
            }
            self.add_light(run, light.as_ref(), direct, sums);
        }
    }

    /// Adds what each vertex reflects of the light in the direction that a point chooses: f_r·cos·L/q · w(q, p).
    fn add_light(
        &self,
        run: Run<'_, '_>,
        light: &dyn Light,
        direct: &mut DirectLight,
        sums: &mut [DVec3],
    ) {
        let Some(Vertex { surface, .. }) = run.vertices.first() else {
            return;
        };
        choose_light(run.vertices, light, direct);
        self.reflect_light(surface, light, direct);
        for (k, lit) in direct.lights.iter().enumerate() {
            // f_r·cos·L/q · w(q, p). Without a second technique p is 0 and w is 1. What reflects nothing needs no shadow ray.
            let reflected = direct.reflected[k].as_dvec3() * lit.radiance;
            let vertex = &run.vertices[lit.index];
            if reflected != DVec3::ZERO && !self.is_hidden(vertex, lit) {
                // Of N directions that are drawn together the density counts N times.
                let brdf_pdf = f64::from(self.spread) * f64::from(direct.brdf_pdf[k]);
                let weight = self.heuristic.weight(lit.pdf, brdf_pdf);
                sums[lit.index] += reflected * (weight / lit.pdf);
            }
        }
    }

    /// Evaluates f_r·cos towards the light, and the density p of the BRDF's sampler where two techniques are weighted.
    fn reflect_light(&self, surface: &Surface, light: &dyn Light, direct: &mut DirectLight) {
        let DirectLight {
            lights,
            wo,
            wi,
            reflected,
            brdf_pdf,
            ..
        } = direct;
        refill(reflected, lights.len(), Rgb::ZERO);
        surface.brdf.eval_cos_batch(Wo::Each(wo), wi, reflected);
        refill(brdf_pdf, lights.len(), 0.0);
        if let Some(sampler) = &surface.sampler
            && self.mis
            && !light.is_delta()
        {
            sampler.pdf_batch(Wo::Each(wo), wi, brdf_pdf);
        }
    }

    fn is_hidden(&self, vertex: &Vertex<'_>, lit: &IncidentLight) -> bool {
        let ray = Ray {
            origin: vertex.position,
            direction: lit.towards,
        };
        self.shadows && self.scene.is_hidden(&ray, vertex.object, lit.distance)
    }

    /// Draws a direction from each vertex of a surface by its point of the unit square, with f_r·cos/p.
    pub(super) fn scatter(&self, run: Run<'_, '_>, scattering: &mut Scattering) {
        let Scattering {
            points,
            wo,
            wi,
            samples,
            reflected,
            rays,
        } = scattering;
        rays.clear();
        let Some(Vertex { surface, .. }) = run.vertices.first() else {
            return;
        };
        let Some(sampler) = &surface.sampler else {
            return;
        };
        // Draw wi, of density p.
        wo.clear();
        wo.extend(run.vertices.iter().map(|vertex| vertex.wo));
        refill(samples, run.vertices.len(), None);
        sampler.sample_batch(Wo::Each(wo), points, samples);
        // Evaluate f_r·cos there. A failed draw has no direction, and its value is not used.
        wi.clear();
        wi.extend(samples.iter().map(|s| s.map_or(Vec3::ZERO, |s| s.wi)));
        refill(reflected, run.vertices.len(), Rgb::ZERO);
        surface.brdf.eval_cos_batch(Wo::Each(wo), wi, reflected);
        // Turn the directions into rays of world space.
        dispatch!(Level::new(), _ => fill_drawn_rays(run.vertices, samples, reflected, rays));
    }
}

/// Adds the ray of each direction that was drawn, in world space, with f_r·cos/p.
#[inline(always)]
fn fill_drawn_rays(
    vertices: &[Vertex<'_>],
    samples: &[Option<DirectionSample>],
    reflected: &[Rgb],
    rays: &mut Rays,
) {
    for (k, vertex) in vertices.iter().enumerate() {
        let Some(sample) = samples[k] else { continue };
        let pdf = f64::from(sample.pdf);
        let direction = vertex.frame.to_world(sample.wi).as_dvec3();
        if let Some(along) = direction.try_normalize() {
            rays.push(NewRay {
                owner: k as u32,
                from: vertex.position,
                along,
                weight: reflected[k].as_dvec3() / pdf,
                pdf,
                leaving: vertex.object,
            });
        }
    }
}

/// Chooses a direction towards the light from each vertex, and keeps those from above the surface: what comes from below is
/// not reflected.
fn choose_light(vertices: &[Vertex<'_>], light: &dyn Light, direct: &mut DirectLight) {
    let DirectLight {
        from,
        points,
        samples,
        lights,
        wo,
        wi,
        ..
    } = direct;
    from.clear();
    from.extend(vertices.iter().map(|vertex| vertex.position));
    refill(samples, vertices.len(), None);
    light.sample_batch(from, points, samples);
    lights.clear();
    wo.clear();
    wi.clear();
    for (index, vertex) in vertices.iter().enumerate() {
        let Some(sample) = samples[index] else {
            continue;
        };
        let local = vertex.frame.to_local(sample.wi.as_vec3());
        if is_upper(local) {
            lights.push(IncidentLight {
                index,
                towards: sample.wi,
                distance: sample.distance,
                radiance: sample.radiance.as_dvec3(),
                pdf: sample.pdf,
            });
            wo.push(vertex.wo);
            wi.push(local);
        }
    }
}
