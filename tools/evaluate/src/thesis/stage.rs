//! Pictures of a scene by several samplers, against one unbiased reference.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::{Deserialize, Serialize};

use merlkit::color::luminance;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::distribution::Heuristic;
use merlkit::image::{encode_png, encode_srgb};
use merlkit::material::Loaded;
use merlkit::points::PointSet;
use merlkit::render::{
    Budget, Film, PlanRequest, RenderSettings, Scene, SceneSpec, Strategy, Surface, render,
};
use merlkit::sampler::{Sampler, SamplerSpec};
use merlkit::{Error, Result};

use super::bench::build;
use super::plan::ThesisPlan;
use crate::measure::cost::{Seconds, call_times, time};
use crate::measure::difference::{LIT_FROM, luminance_errors, mean};

/// A scene and its materials.
pub(super) struct ThesisScene {
    /// What it shows; the strategy is that of the sampler which is tried.
    pub spec: SceneSpec,
    /// Columns and rows.
    pub size: [usize; 2],
    /// The materials, in the order of the description's.
    pub materials: Vec<Loaded>,
    /// A sampler that leaves out no direction, for the reference: with directions towards the lights, weighted.
    pub reference: SamplerSpec,
}

/// A sampler that is tried: its name, what draws from each material, and how many directions a traced one is kept of.
pub(super) struct SceneSampler {
    /// The thesis's name, or ours for one that it lacks.
    pub name: &'static str,
    /// One for each material.
    pub specs: Vec<SamplerSpec>,
    /// Candidates of resampling; 1 for none.
    pub candidates: u32,
    /// Numbers of samples per pixel.
    pub samples: Vec<u64>,
}

/// What a sampler's picture came to.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct StageResult {
    /// The contender.
    pub name: String,
    /// Samples per pixel.
    pub samples: u64,
    /// Mean relative error of luminance over lit pixels.
    pub error: f64,
    /// Root of the mean squared error, each pixel's relative to its square and a hundredth of the picture's squared mean: dark pixels weigh
    /// less.
    pub rms: f64,
    /// [`Self::error`] over the pixels of each object, where there are several.
    pub errors: Vec<f64>,
    /// Seconds to render, without loading and building.
    pub seconds: Seconds,
    /// CPU seconds to build all samplers.
    pub build_seconds: f64,
    /// Bytes of all samplers.
    pub bytes: usize,
    /// Nanoseconds of a draw, mean over the materials.
    pub draw_ns: f64,
    /// PNG as base64; empty but for the most samples.
    pub png: String,
}

/// A reference and all results of a scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct StagePiece {
    /// Mean over lit pixels of the reference's own relative standard error.
    pub reference_error: f64,
    /// Samples per pixel of the reference.
    pub reference_samples: u64,
    /// PNG of the reference as base64.
    pub reference_png: String,
    /// The results, by contender and then by samples.
    pub results: Vec<StageResult>,
}

impl StagePiece {
    /// The result of a contender at a number of samples.
    pub fn find(&self, name: &str, samples: u64) -> Option<&StageResult> {
        let mut results = self.results.iter();
        results.find(|r| r.name == name && r.samples == samples)
    }
}

impl ThesisScene {
    /// Renders the reference, and every contender's pictures.
    ///
    /// # Errors
    /// Those of building samplers and scenes, and of rendering.
    pub fn compare(&self, contenders: &[SceneSampler], plan: &ThesisPlan) -> Result<StagePiece> {
        // Step 1: the reference, from other random numbers than the contenders'.
        let specs = vec![self.reference.clone(); self.materials.len()];
        let (samplers, _, _) = self.build(&specs)?;
        let strategy = Strategy::Mis(Heuristic::Power);
        let samples = plan.reference_samples;
        let (film, _) = self.render(&samplers, strategy, samples, !plan.seed)?;
        let reference = luminances(&film);
        let objects = self.objects();
        let mut piece = StagePiece {
            reference_error: own_error(&film),
            reference_samples: samples,
            reference_png: encode(&film)?,
            results: Vec::new(),
        };
        // Step 2: each contender, whose samplers are built once.
        for contender in contenders {
            let (samplers, build_seconds, bytes) = self.build(&contender.specs)?;
            let draw_ns = draw_cost(&samplers, plan);
            let strategy = match contender.candidates {
                1 => Strategy::Brdf,
                candidates => Strategy::Ris { candidates },
            };
            for &samples in &contender.samples {
                let (film, seconds) = self.render(&samplers, strategy, samples, plan.seed)?;
                let found = luminances(&film);
                let is_last = contender.samples.last() == Some(&samples);
                let errors = luminance_errors(&found, &reference);
                piece.results.push(StageResult {
                    name: contender.name.to_owned(),
                    samples,
                    error: errors.mean_relative,
                    rms: errors.rel_mse.sqrt(),
                    errors: errors_by_object(&objects, &found, &reference),
                    seconds,
                    build_seconds,
                    bytes,
                    draw_ns,
                    png: if is_last {
                        encode(&film)?
                    } else {
                        String::new()
                    },
                });
            }
        }
        Ok(piece)
    }

    /// One sampler a material, with the CPU seconds and the bytes of all.
    fn build(&self, specs: &[SamplerSpec]) -> Result<(Vec<Sampler>, f64, usize)> {
        let mut samplers = Vec::new();
        let (mut seconds, mut bytes) = (0.0, 0);
        for (material, spec) in self.materials.iter().zip(specs) {
            let (sampler, cost) = build(material, spec)?;
            seconds += cost.seconds.cpu;
            bytes += cost.bytes;
            samplers.push(sampler);
        }
        Ok((samplers, seconds, bytes))
    }

    fn render(
        &self,
        samplers: &[Sampler],
        strategy: Strategy,
        samples: u64,
        seed: u64,
    ) -> Result<(Film, Seconds)> {
        let mut spec = self.spec.clone();
        spec.strategy = strategy;
        spec.mirrors.clear();
        for (i, material) in self.materials.iter().enumerate() {
            if material.facts().has_mirror {
                spec.mirrors.push(i);
            }
        }
        let settings = RenderSettings {
            width: self.size[0],
            height: self.size[1],
            seed,
            points: PointSet::Random,
            budget: Budget::Even(samples),
        };
        let scene = Scene::build(&spec, PlanRequest::AsNeeded, |i, directions| {
            self.surface(samplers, i, directions)
        })?;
        let (rendered, seconds) = time(|| render(&scene, &settings, &|_| {}));
        Ok((rendered?.film, seconds))
    }

    fn surface(&self, samplers: &[Sampler], i: usize, directions: bool) -> Result<Surface> {
        let material = self.materials.get(i);
        let material = material.ok_or_else(|| {
            Error::argument(
                "a scene with more materials than were loaded",
                "report this",
            )
        })?;
        let sampler = samplers.get(i).filter(|_| directions);
        Ok(Surface {
            brdf: material.brdf().clone(),
            sampler: sampler.map(Sampler::shared),
        })
    }

    /// The sphere that the middle of each pixel shows, by rows, where there are several spheres; nothing otherwise.
    fn objects(&self) -> Vec<Option<usize>> {
        let [width, height] = self.size;
        if self.spec.spheres.len() < 2 {
            return Vec::new();
        }
        let mut objects = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                let p = glam::DVec2::new(
                    (x as f64 + 0.5) / width as f64,
                    (y as f64 + 0.5) / height as f64,
                );
                let ray = self.spec.camera.ray(p, width as f64 / height as f64);
                let mut nearest = (f64::INFINITY, None);
                for (i, sphere) in self.spec.spheres.iter().enumerate() {
                    if let Some(distance) = sphere.shape.enter(&ray)
                        && distance < nearest.0
                    {
                        nearest = (distance, Some(i));
                    }
                }
                objects.push(nearest.1);
            }
        }
        objects
    }
}

/// Mean nanoseconds of a draw over some samplers.
fn draw_cost(samplers: &[Sampler], plan: &ThesisPlan) -> f64 {
    let drawing: Vec<&dyn DirectionSampler> = samplers.iter().map(Sampler::as_dyn).collect();
    let times = call_times(&drawing, plan.timed_calls, plan.seed);
    mean(times.iter().map(|t| t.sample_ns.ns))
}

/// Luminance of every pixel, rows from the top.
fn luminances(film: &Film) -> Vec<f64> {
    let mut all = Vec::with_capacity(film.width() * film.height());
    for y in 0..film.height() {
        for x in 0..film.width() {
            all.push(f64::from(luminance(film.mean(x, y).as_vec3())));
        }
    }
    all
}

/// Mean over lit pixels of the standard error over the mean, by luminance.
fn own_error(film: &Film) -> f64 {
    let values = luminances(film);
    let level = mean(values.iter().copied());
    let mut errors = Vec::new();
    for (k, value) in values.iter().enumerate() {
        let error = film.standard_error(k % film.width(), k / film.width());
        if *value > LIT_FROM * level {
            errors.push(f64::from(luminance(error.as_vec3())) / value);
        }
    }
    mean(errors.into_iter())
}

/// Mean relative error over the pixels of each object.
fn errors_by_object(objects: &[Option<usize>], found: &[f64], reference: &[f64]) -> Vec<f64> {
    let count = objects.iter().flatten().max().map_or(0, |most| most + 1);
    let mut errors = Vec::with_capacity(count);
    for object in 0..count {
        let (mut ours, mut right) = (Vec::new(), Vec::new());
        for (k, shown) in objects.iter().enumerate() {
            if *shown == Some(object) {
                ours.push(found[k]);
                right.push(reference[k]);
            }
        }
        errors.push(luminance_errors(&ours, &right).mean_relative);
    }
    errors
}

/// A picture as PNG, as base64.
fn encode(film: &Film) -> Result<String> {
    let image = film.to_image()?;
    let png = encode_png(image.width(), image.height(), &encode_srgb(&image, 0.0))?;
    Ok(STANDARD.encode(png))
}
