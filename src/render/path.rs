//! The path tracer: next-event estimation, multiple importance sampling, Russian roulette (Kajiya 1986; Veach 1997).

use glam::{DVec2, DVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::camera::Lens;
use super::film::{Pixel, Tally};
use super::plan::ROULETTE_FROM;
use super::scene::Hit;
use super::{Effect, EffectPlan, Film, Ray, Scene, Surface};
use crate::geom::{Frame, is_upper};
use crate::image::MAX_PIXELS;
use crate::light::Light;
use crate::points::{PointSet, mix};
use crate::{Error, Result};

/// Size and quality of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Columns, ≥ 1.
    pub width: usize,
    /// Rows, ≥ 1.
    pub height: usize,
    /// Paths a pixel, ≥ 1, spread uniformly over it (a box filter).
    pub samples: u64,
    /// Another seed gives another, equally good picture.
    pub seed: u64,
    /// How the numbers behind a pixel's paths are spread.
    pub points: PointSet,
}

/// Renders `scene`, which was built for `plan`, on all threads of the current pool.
///
/// Random numbers are functions of seed, pixel, sample and dimension, and each pixel's samples are summed in order, so that
/// the film is the same, bit for bit, for any number of threads. `progress(n)` is called from any thread when `n` more
/// pixels are done. A path that carries more than 10¹⁴⁰ is dropped.
///
/// # Errors
/// [`Error::Argument`] for a picture without pixels or samples, or of more than [`MAX_PIXELS`] pixels.
pub fn render(
    scene: &Scene,
    plan: &EffectPlan,
    settings: &Settings,
    progress: &(dyn Fn(usize) + Sync),
) -> Result<Film> {
    let Settings { width, height, samples, .. } = *settings;
    let count = width.checked_mul(height).filter(|&n| n > 0 && n <= MAX_PIXELS && samples > 0);
    let Some(count) = count else {
        return Err(Error::argument(
            format!("a picture of {width} × {height} pixels with {samples} samples each"),
            format!("give at least 1 × 1, at most {MAX_PIXELS} pixels, and one sample"),
        ));
    };
    let tracer = Tracer::new(scene, plan, settings);
    let mut pixels = vec![Pixel::default(); count];
    pixels.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        for (x, pixel) in row.iter_mut().enumerate() {
            *pixel = tracer.pixel(x, y);
        }
        progress(width);
    });
    Ok(Film::new(width, height, pixels))
}

/// Radiance whose square, summed over any number of samples, is still an f64: what standard errors are made of.
const BRIGHTEST: f64 = 1e140;

/// The plan's switches, read once.
struct Tracer<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    lens: Lens,
    /// Whether directions from the BRDF are drawn.
    directions: bool,
    /// Whether lights with an extent are sampled.
    light_sampling: bool,
    /// Whether directions that hit such lights count.
    hits_count: bool,
    mis: bool,
    shadows: bool,
    interreflection: bool,
    roulette: bool,
}

/// A point of a path, with its local frame.
struct Vertex<'a> {
    hit: Hit,
    frame: Frame,
    wo: Vec3,
    surface: &'a Surface,
}

/// A direction drawn from a vertex, and f_r·cos/pdf.
struct Step {
    ray: Ray,
    pdf: f64,
    weight: DVec3,
}

/// The numbers behind one path: sets of four dimensions, one for the pixel, then for each vertex one for the BRDF and
/// roulette and one for every two lights.
struct Numbers<'a> {
    settings: &'a Settings,
    seed: u64,
    index: u64,
    sets_per_vertex: u32,
}

impl Numbers<'_> {
    fn set(&self, set: u32) -> [f32; 4] {
        self.settings.points.point4(self.seed, self.index, set)
    }

    fn pixel(&self) -> DVec2 {
        let p = self.set(0);
        Vec2::new(p[0], p[1]).as_dvec2()
    }

    fn direction(&self, vertex: u32) -> [f32; 4] {
        self.set(1 + vertex * self.sets_per_vertex)
    }

    fn light(&self, vertex: u32, light: usize) -> DVec2 {
        let p = self.set(2 + vertex * self.sets_per_vertex + light as u32 / 2);
        let pair = if light.is_multiple_of(2) { [p[0], p[1]] } else { [p[2], p[3]] };
        Vec2::from_array(pair).as_dvec2()
    }
}

impl<'a> Tracer<'a> {
    fn new(scene: &'a Scene, plan: &EffectPlan, settings: &'a Settings) -> Self {
        let (mis, light_sampling) = (plan.is_on(Effect::Mis), plan.is_on(Effect::LightSampling));
        Self {
            scene,
            settings,
            lens: scene.camera.lens(settings.width as f64 / settings.height as f64),
            directions: plan.is_on(Effect::Directions),
            light_sampling,
            hits_count: mis || !light_sampling,
            mis,
            shadows: plan.is_on(Effect::Shadows),
            interreflection: plan.is_on(Effect::Interreflection),
            roulette: plan.is_on(Effect::Roulette),
        }
    }

    fn pixel(&self, x: usize, y: usize) -> Pixel {
        let Settings { width, height, samples, seed, .. } = *self.settings;
        let seed = mix(seed ^ mix((y * width + x) as u64));
        let sets_per_vertex = 1 + (self.scene.lights.len() as u32).div_ceil(2);
        let size = DVec2::new(width as f64, height as f64);
        let mut tally = Tally::default();
        for index in 0..samples {
            let numbers = Numbers { settings: self.settings, seed, index, sets_per_vertex };
            let p = (DVec2::new(x as f64, y as f64) + numbers.pixel()) / size;
            tally.add(self.radiance(self.lens.ray(p), &numbers));
        }
        tally.pixel()
    }

    /// An estimate of the radiance that arrives at `ray`'s origin.
    fn radiance(&self, mut ray: Ray, numbers: &Numbers<'_>) -> DVec3 {
        let mut hit = self.scene.hit(&ray, None);
        let mut sum = self.emitted(&ray, hit, |_| 1.0);
        let mut throughput = DVec3::ONE;
        for index in 0..self.scene.depth {
            let Some(vertex) = hit.and_then(|hit| self.vertex(hit, ray.direction)) else {
                break;
            };
            sum += throughput * self.lit(&vertex, index, numbers);
            let follows = self.interreflection && index + 1 < self.scene.depth;
            if !(self.directions && (self.hits_count || follows)) {
                break;
            }
            let u = numbers.direction(index);
            let Some(step) = self.step(&vertex, u) else {
                break;
            };
            throughput *= step.weight;
            if throughput == DVec3::ZERO || !throughput.is_finite() {
                break;
            }
            hit = self.next_hit(&step.ray, vertex.hit.object);
            sum += throughput * self.found(&step, hit);
            if !follows || !self.survives(&mut throughput, index, u[2]) {
                break;
            }
            ray = step.ray;
        }
        if sum.max_element() <= BRIGHTEST { sum } else { DVec3::ZERO }
    }

    /// Radiance of lights with an extent that a drawn direction finds, as far as it counts.
    fn found(&self, step: &Step, hit: Option<Hit>) -> DVec3 {
        if !self.hits_count {
            return DVec3::ZERO;
        }
        self.emitted(&step.ray, hit, |pdf| if self.mis { power(step.pdf, pdf) } else { 1.0 })
    }

    /// What a drawn direction meets; nothing, where the plan says that nothing can be in the way.
    fn next_hit(&self, ray: &Ray, leaving: usize) -> Option<Hit> {
        (self.shadows || self.interreflection).then(|| self.scene.hit(ray, Some(leaving))).flatten()
    }

    fn vertex(&self, hit: Hit, direction: DVec3) -> Option<Vertex<'a>> {
        let surface = self.scene.surface(hit.object)?;
        let frame = Frame::about(hit.normal.as_vec3());
        let wo = frame.to_local(-direction.as_vec3());
        is_upper(wo).then_some(Vertex { hit, frame, wo, surface })
    }

    /// Radiance of lights with an extent along a ray, up to what it hits; each light's by `weight` of its density.
    fn emitted(&self, ray: &Ray, hit: Option<Hit>, weight: impl Fn(f64) -> f64) -> DVec3 {
        let reach = hit.map_or(f64::INFINITY, |h| h.distance);
        let lights = self.scene.lights.iter();
        lights
            .filter_map(|light| light.seen(ray.origin, ray.direction, reach))
            .map(|s| s.radiance.as_dvec3() * weight(s.pdf))
            .fold(DVec3::ZERO, |sum, radiance| sum + radiance)
    }

    /// Radiance that a vertex reflects from light that is evaluated or sampled.
    fn lit(&self, vertex: &Vertex<'_>, index: u32, numbers: &Numbers<'_>) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for (i, light) in self.scene.lights.iter().enumerate() {
            if light.is_delta() {
                sum += self.lit_by(vertex, light.as_ref(), DVec2::ZERO);
            } else if self.light_sampling {
                sum += self.lit_by(vertex, light.as_ref(), numbers.light(index, i));
            }
        }
        sum
    }

    fn lit_by(&self, vertex: &Vertex<'_>, light: &dyn Light, u: DVec2) -> DVec3 {
        let Some(sample) = light.sample(vertex.hit.at, u) else {
            return DVec3::ZERO;
        };
        let wi = vertex.frame.to_local(sample.wi.as_vec3());
        let reflected = vertex.surface.brdf.eval_cos(vertex.wo, wi).as_dvec3() * sample.radiance.as_dvec3();
        if reflected == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let ray = Ray { origin: vertex.hit.at, direction: sample.wi };
        if self.shadows && self.scene.is_hidden(&ray, vertex.hit.object, sample.distance) {
            return DVec3::ZERO;
        }
        let other = if self.mis && !light.is_delta() { vertex.pdf(wi) } else { 0.0 };
        reflected * (power(sample.pdf, other) / sample.pdf)
    }

    fn step(&self, vertex: &Vertex<'_>, u: [f32; 4]) -> Option<Step> {
        let sample = vertex.surface.sampler.as_ref()?.sample(vertex.wo, Vec2::new(u[0], u[1]))?;
        let pdf = f64::from(sample.pdf);
        let weight = vertex.surface.brdf.eval_cos(vertex.wo, sample.wi).as_dvec3() / pdf;
        let direction = vertex.frame.to_world(sample.wi).as_dvec3().try_normalize()?;
        Some(Step { ray: Ray { origin: vertex.hit.at, direction }, pdf, weight })
    }

    /// Ends a path at random in proportion to what it can't carry any more, and makes up for it in the survivors.
    fn survives(&self, throughput: &mut DVec3, index: u32, u: f32) -> bool {
        if !self.roulette || index + 1 < ROULETTE_FROM {
            return true;
        }
        let chance = throughput.max_element().min(1.0);
        *throughput /= chance;
        f64::from(u) < chance
    }
}

impl Vertex<'_> {
    fn pdf(&self, wi: Vec3) -> f64 {
        self.surface.sampler.as_ref().map_or(0.0, |s| f64::from(s.pdf(self.wo, wi)))
    }
}

/// Weight of a technique of density `own` beside one of density `other`: the power heuristic with exponent 2, by their ratio
/// so that no square overflows.
fn power(own: f64, other: f64) -> f64 {
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

#[cfg(test)]
mod tests {
    use super::power;

    #[test]
    fn weights_of_two_techniques_sum_to_one() {
        for (a, b) in [(1.0, 1.0), (3.0, 0.5), (1e200, 1e-200), (1.0, 0.0)] {
            assert!((power(a, b) + power(b, a) - 1.0).abs() < 1e-15 || b == 0.0);
        }
        assert_eq!(power(2.0, 0.0), 1.0);
        assert_eq!(power(1e-200, 1e200), 0.0);
    }
}
