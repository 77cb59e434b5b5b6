//! The path tracer: next-event estimation, multiple importance sampling, Russian roulette (Kajiya 1986; Veach 1997).

use glam::{DVec2, DVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::camera::Lens;
use super::film::{Pixel, Tally};
use super::numbers::Numbers;
use super::plan::ROULETTE_FROM;
use super::scene::Hit;
use super::{Effect, EffectPlan, Film, Ray, Scene, Surface};
use crate::dist::Heuristic;
use crate::geom::{Frame, is_upper};
use crate::image::MAX_PIXELS;
use crate::light::Light;
use crate::points::PointSet;
use crate::{Error, Result};

/// Size and quality of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Columns, ≥ 1.
    pub width: usize,
    /// Rows, ≥ 1.
    pub height: usize,
    /// Paths a pixel, ≥ 1, spread uniformly over it (a box filter); for [`super::render_to_error`] the most.
    pub samples: u64,
    /// Another seed gives another, equally good picture.
    pub seed: u64,
    /// How the numbers behind a pixel's paths are spread.
    pub points: PointSet,
}

impl Settings {
    /// The number of pixels.
    ///
    /// # Errors
    /// [`Error::Argument`] for a picture without pixels or samples, or of more than [`MAX_PIXELS`] pixels.
    pub(super) fn pixels(&self) -> Result<usize> {
        let Self { width, height, samples, .. } = *self;
        let count = width.checked_mul(height).filter(|&n| n > 0 && n <= MAX_PIXELS && samples > 0);
        count.ok_or_else(|| {
            Error::argument(
                format!("a picture of {width} × {height} pixels with {samples} samples each"),
                format!("give at least 1 × 1, at most {MAX_PIXELS} pixels, and one sample"),
            )
        })
    }
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
    let Settings { width, height, .. } = *settings;
    let tracer = Tracer::new(scene, plan, settings);
    let mut pixels = vec![Pixel::default(); settings.pixels()?];
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
pub(super) struct Tracer<'a> {
    pub(super) scene: &'a Scene,
    settings: &'a Settings,
    lens: Lens,
    /// Whether directions from the BRDF are drawn.
    directions: bool,
    /// Whether lights with an extent are sampled.
    light_sampling: bool,
    /// Whether directions that hit such lights count as they are drawn.
    hits_count: bool,
    /// Whether they count after a choice among several.
    resampling: bool,
    mis: bool,
    heuristic: Heuristic,
    shadows: bool,
    interreflection: bool,
    roulette: bool,
}

/// A point of a path, with its local frame.
pub(super) struct Vertex<'a> {
    pub(super) hit: Hit,
    frame: Frame,
    wo: Vec3,
    surface: &'a Surface,
}

/// A direction drawn from a vertex, and f_r·cos/pdf.
#[derive(Clone, Copy)]
pub(super) struct Step {
    pub(super) ray: Ray,
    pdf: f64,
    pub(super) weight: DVec3,
}

impl<'a> Tracer<'a> {
    pub(super) fn new(scene: &'a Scene, plan: &EffectPlan, settings: &'a Settings) -> Self {
        let (mis, light_sampling) = (plan.is_on(Effect::Mis), plan.is_on(Effect::LightSampling));
        // Where lights are sampled and nothing is weighted, what directions hit would be counted twice.
        let found = mis || !light_sampling;
        let resampling = found && plan.is_on(Effect::Resampling);
        Self {
            scene,
            settings,
            lens: scene.camera.lens(settings.width as f64 / settings.height as f64),
            directions: plan.is_on(Effect::Directions),
            light_sampling,
            hits_count: found && !resampling,
            resampling,
            mis,
            heuristic: scene.strategy.heuristic(),
            shadows: plan.is_on(Effect::Shadows),
            interreflection: plan.is_on(Effect::Interreflection),
            roulette: plan.is_on(Effect::Roulette),
        }
    }

    fn pixel(&self, x: usize, y: usize) -> Pixel {
        let seed = self.settings.pixel_seed(x, y);
        let mut tally = Tally::default();
        for index in 0..self.settings.samples {
            tally.add(self.sample(x, y, seed, index));
        }
        tally.pixel()
    }

    /// Path `index` of those that a seed gives a pixel.
    pub(super) fn sample(&self, x: usize, y: usize, seed: u64, index: u64) -> DVec3 {
        let numbers = Numbers::new(self.scene, self.settings.points, seed, index);
        self.radiance(self.ray(x, y, numbers.pixel()), &numbers)
    }

    /// The ray through a point of a pixel, in [0, 1]² from its upper left corner.
    pub(super) fn ray(&self, x: usize, y: usize, within: DVec2) -> Ray {
        let size = DVec2::new(self.settings.width as f64, self.settings.height as f64);
        self.lens.ray((DVec2::new(x as f64, y as f64) + within) / size)
    }

    /// An estimate of the radiance that arrives at `ray`'s origin.
    fn radiance(&self, mut ray: Ray, numbers: &Numbers) -> DVec3 {
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
            let Some(step) = self.step(&vertex, Vec2::new(u[0], u[1])) else {
                break;
            };
            throughput *= step.weight;
            if throughput == DVec3::ZERO || !throughput.is_finite() {
                break;
            }
            hit = self.next_hit(&step.ray, vertex.hit.object);
            if self.hits_count {
                sum += throughput * self.found(&step, hit);
            }
            if !follows || !self.survives(&mut throughput, index, u[2]) {
                break;
            }
            ray = step.ray;
        }
        if sum.max_element() <= BRIGHTEST { sum } else { DVec3::ZERO }
    }

    /// Radiance of lights with an extent that a drawn direction finds up to what it hits, each as far as it counts.
    pub(super) fn found(&self, step: &Step, hit: Option<Hit>) -> DVec3 {
        let weight = |pdf| if self.mis { self.heuristic.weight(step.pdf, pdf) } else { 1.0 };
        self.emitted(&step.ray, hit, weight)
    }

    /// What a drawn direction meets; nothing, where the plan says that nothing can be in the way.
    pub(super) fn next_hit(&self, ray: &Ray, leaving: usize) -> Option<Hit> {
        (self.shadows || self.interreflection).then(|| self.scene.hit(ray, Some(leaving))).flatten()
    }

    fn vertex(&self, hit: Hit, direction: DVec3) -> Option<Vertex<'a>> {
        let surface = self.scene.surface(hit.object)?;
        let frame = surface.frame(hit.normal.as_vec3());
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

    /// Radiance that a vertex reflects from light that is evaluated, sampled or resampled.
    fn lit(&self, vertex: &Vertex<'_>, index: u32, numbers: &Numbers) -> DVec3 {
        let mut sum = if self.resampling { self.resampled(vertex, index, numbers) } else { DVec3::ZERO };
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
        reflected * (self.heuristic.weight(sample.pdf, other) / sample.pdf)
    }

    pub(super) fn step(&self, vertex: &Vertex<'_>, u: Vec2) -> Option<Step> {
        let sample = vertex.surface.sampler.as_ref()?.sample(vertex.wo, u)?;
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
