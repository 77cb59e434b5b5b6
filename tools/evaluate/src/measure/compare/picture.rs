//! The picture experiment: spheres rendered with each competitor, against a reference with its own error.

use serde::{Deserialize, Serialize};

use super::Competitor;
use crate::measure::convergence::Technique;
use crate::measure::cost::{Seconds, time};
use crate::measure::difference::{LIT_FROM, PictureErrors, flip_radiance, luminance_errors, mean};
use merlkit::color::luminance;
use merlkit::distribution::Heuristic;
use merlkit::image::{Image, encode_png, encode_srgb};
use merlkit::light::{EnvironmentSource, LightSpec};
use merlkit::material::Loaded;
use merlkit::points::PointSet;
use merlkit::render::{
    Budget, Film, PlanRequest, RenderSettings, Scene, SceneSpec, Strategy, Surface, render,
};
use merlkit::sampler::{Sampler, SamplerSpec};
use merlkit::{Error, Result};

/// Which scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SceneKind {
    /// One sphere in the studio: the thesis's scene 6.
    Environment,
    /// One sphere on the ground under a luminous square, light from all around and between sphere and ground: in the place
    /// of the thesis's scene 2.
    Glossy,
    /// Three spheres of three materials in the studio, which light one another.
    Three,
}

impl SceneKind {
    /// Its name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Environment => "sphere in the studio",
            Self::Glossy => "glossy sphere on the ground",
            Self::Three => "three spheres",
        }
    }

    fn spec(self, materials: &[String], strategy: Strategy) -> Result<SceneSpec> {
        let mut spec = SceneSpec::row(materials, 1.0);
        spec.strategy = strategy;
        spec.lights = vec![LightSpec::Environment(EnvironmentSource::Studio)];
        match self {
            Self::Environment => spec.depth = 1,
            Self::Glossy => {
                let area = spec.light("area")?;
                spec.lights.push(area);
                spec.floor = Some(GROUND);
                spec.depth = 2;
            }
            Self::Three => spec.depth = 3,
        }
        Ok(spec)
    }
}

/// Reflectance of the ground: a mid grey.
const GROUND: f32 = 0.35;

/// Samples per pixel of the thesis's comparison by picture (figure 6.22).
pub const PICTURE_SAMPLES: u64 = 25;

/// How much of the experiment is run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PicturePlan {
    /// Pixels a side.
    pub side: usize,
    /// Samples per pixel.
    pub samples: Vec<u64>,
    /// Samples per pixel of the reference.
    pub reference_samples: u64,
    /// The competitors' seed; the reference has another.
    pub seed: u64,
}

impl PicturePlan {
    /// 96² pixels at 25 samples.
    pub fn quick(seed: u64) -> Self {
        Self {
            side: 96,
            samples: vec![PICTURE_SAMPLES],
            reference_samples: 1024,
            seed,
        }
    }

    /// 96² pixels at 1, 25 and 100 samples, as in the thesis. Its 400 would want a reference that takes most of the time.
    pub fn full(seed: u64) -> Self {
        Self {
            side: 96,
            samples: vec![1, PICTURE_SAMPLES, 100],
            reference_samples: 4096,
            seed,
        }
    }

    fn settings(&self, samples: u64, seed: u64, points: PointSet) -> RenderSettings {
        RenderSettings {
            width: self.side,
            height: self.side,
            seed,
            points,
            budget: Budget::Even(samples),
        }
    }
}

/// What pictures are held against.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PictureReference {
    /// How it was made.
    pub label: String,
    /// Samples per pixel.
    pub samples: u64,
    /// Mean over lit pixels of its own relative standard error.
    pub relative_error: f64,
    /// PNG, tone-mapped, as bytes.
    #[serde(with = "bytes")]
    pub png: Vec<u8>,
}

/// A competitor's picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PictureResult {
    /// Sampler and strategy.
    pub competitor: Competitor,
    /// Its name for people.
    pub label: String,
    /// Samples per pixel.
    pub samples: u64,
    /// Seconds to render, without loading and building.
    pub seconds: Seconds,
    /// Wall-clock seconds that building the samplers took.
    pub build_seconds: f64,
    /// Its errors.
    pub errors: PictureErrors,
    /// Mean FLIP against the reference, over exposures, as `merlkit diff` measures it: 0 where no difference is seen, 1 at
    /// most. `None` against a black reference, which has no exposure.
    pub flip: Option<f64>,
    /// PNG of the picture, tone-mapped; empty but at [`PICTURE_SAMPLES`].
    #[serde(with = "bytes")]
    pub png: Vec<u8>,
    /// PNG of its relative difference from the reference; empty but at [`PICTURE_SAMPLES`].
    #[serde(with = "bytes")]
    pub difference: Vec<u8>,
}

/// Renders the reference of a scene: the largest half-vector table and the lights' own directions, power heuristic, random
/// numbers.
///
/// # Errors
/// Those of building samplers and scenes.
pub fn picture_reference(
    scene: SceneKind,
    materials: &[Loaded],
    plan: &PicturePlan,
) -> Result<(PictureReference, Film)> {
    let spec = "half-vector:1MB".parse()?;
    let samplers = build(materials, &spec)?;
    let settings = plan.settings(plan.reference_samples, !plan.seed, PointSet::Random);
    let (film, _) = render_with(
        scene,
        materials,
        &samplers,
        Technique::Mis(Heuristic::Power),
        &settings,
    )?;
    let reference = PictureReference {
        label: format!("{spec} with light sampling, power heuristic"),
        samples: plan.reference_samples,
        relative_error: own_error(&film),
        png: png(&film.to_image()?)?,
    };
    Ok((reference, film))
}

fn png(image: &Image) -> Result<Vec<u8>> {
    encode_png(image.width(), image.height(), &encode_srgb(image, 0.0))
}

/// One sampler a material.
fn build(materials: &[Loaded], spec: &SamplerSpec) -> Result<Vec<Sampler>> {
    materials
        .iter()
        .map(|material| spec.build(material))
        .collect()
}

/// Pictures of a competitor at each of the plan's numbers of samples; its samplers are built once.
///
/// # Errors
/// Those of building samplers and scenes.
pub fn pictures(
    scene: SceneKind,
    materials: &[Loaded],
    competitor: Competitor,
    plan: &PicturePlan,
    reference: &Film,
) -> Result<Vec<PictureResult>> {
    let (samplers, building) = time(|| build(materials, &competitor.spec));
    let samplers = samplers?;
    let mut results = Vec::new();
    for &samples in &plan.samples {
        let settings = plan.settings(samples, plan.seed, PointSet::Sobol);
        let (film, seconds) =
            render_with(scene, materials, &samplers, competitor.technique, &settings)?;
        // Only one number of samples is shown on the page.
        let (picture, its_difference) = if samples == PICTURE_SAMPLES {
            (
                png(&film.to_image()?)?,
                png(&difference(&film, reference)?)?,
            )
        } else {
            (Vec::new(), Vec::new())
        };
        results.push(PictureResult {
            label: competitor.label(),
            competitor: competitor.clone(),
            samples,
            seconds,
            build_seconds: building.wall,
            errors: picture_errors(&film, reference),
            flip: mean_flip(&film, reference)?,
            png: picture,
            difference: its_difference,
        });
    }
    Ok(results)
}

/// Renders `scene` and times it; loading and building are not counted.
fn render_with(
    scene: SceneKind,
    materials: &[Loaded],
    samplers: &[Sampler],
    technique: Technique,
    settings: &RenderSettings,
) -> Result<(Film, Seconds)> {
    let names: Vec<String> = materials.iter().map(|m| m.name().to_owned()).collect();
    let mut spec = scene.spec(&names, strategy(technique))?;
    for (i, material) in materials.iter().enumerate() {
        if material.facts().has_mirror {
            spec.mirrors.push(i);
        }
    }
    let surface = |i: usize, directions: bool| {
        let missing = || {
            Error::argument(
                "a scene with more materials than were given",
                "name each material once",
            )
        };
        let material = materials.get(i).ok_or_else(missing)?;
        let sampler = samplers.get(i).filter(|_| directions).map(Sampler::shared);
        Ok(Surface {
            brdf: material.brdf().clone(),
            sampler,
        })
    };
    let scene = Scene::build(&spec, PlanRequest::AsNeeded, surface)?;
    let (rendered, seconds) = time(|| render(&scene, settings, &|_| {}));
    Ok((rendered?.film, seconds))
}

/// The renderer's strategy for a technique of the lit point.
fn strategy(technique: Technique) -> Strategy {
    match technique {
        Technique::Brdf => Strategy::Brdf,
        Technique::Light => Strategy::Light,
        Technique::Mis(heuristic) => Strategy::Mis(heuristic),
        Technique::Ris(candidates) => Strategy::Ris { candidates },
    }
}

/// Luminance of every pixel, rows from the top.
fn luminances(film: &Film) -> Vec<f64> {
    let pixels = (0..film.height()).flat_map(|y| (0..film.width()).map(move |x| (x, y)));
    pixels
        .map(|(x, y)| luminance_f64(film.mean(x, y)))
        .collect()
}

fn luminance_f64(radiance: glam::DVec3) -> f64 {
    f64::from(luminance(radiance.as_vec3()))
}

/// Errors of `film` against `reference` of the same size; 0 for a black reference.
pub fn picture_errors(film: &Film, reference: &Film) -> PictureErrors {
    luminance_errors(&luminances(film), &luminances(reference))
}

/// Mean FLIP; `None` if the reference is black.
fn mean_flip(film: &Film, reference: &Film) -> Result<Option<f64>> {
    let reference = reference.to_image()?;
    if reference
        .pixels()
        .iter()
        .all(|&pixel| luminance(pixel) <= 0.0)
    {
        return Ok(None);
    }
    Ok(Some(flip_radiance(&film.to_image()?, &reference)?.mean()))
}

/// Mean over lit pixels of the standard error over the mean, by luminance.
fn own_error(film: &Film) -> f64 {
    let level = mean(luminances(film).into_iter());
    let pixels = (0..film.height()).flat_map(|y| (0..film.width()).map(move |x| (x, y)));
    let error = |(x, y)| {
        let value = luminance_f64(film.mean(x, y));
        (value > LIT_FROM * level).then(|| luminance_f64(film.standard_error(x, y)) / value)
    };
    mean(pixels.filter_map(error))
}

/// |picture − reference|/reference by luminance: black is none, white 100 % and more.
fn difference(film: &Film, reference: &Film) -> Result<Image> {
    let level = mean(luminances(reference).into_iter());
    Image::from_fn(film.width(), film.height(), |x, y| {
        let (found, right) = (
            luminance_f64(film.mean(x, y)),
            luminance_f64(reference.mean(x, y)),
        );
        let relative = if right > LIT_FROM * level {
            (found - right).abs() / right
        } else {
            0.0
        };
        glam::Vec3::splat(relative.min(1.0) as f32)
    })
}

/// Bytes as base64 text.
mod bytes {
    use base64::Engine;
    use base64::engine::general_purpose::STANDARD;
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    pub fn serialize<S: Serializer>(bytes: &[u8], to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(&STANDARD.encode(bytes))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<u8>, D::Error> {
        STANDARD
            .decode(String::deserialize(from)?)
            .map_err(D::Error::custom)
    }
}
