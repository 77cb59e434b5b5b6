//! Pictures from paths.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::camera::Lens;
use super::film::{Pixel, Tally};
use super::follow::{BUNDLE, Start};
use super::numbers::Numbers;
use super::{Effect, EffectPlan, Film, Ray, Scene};
use crate::distribution::Heuristic;
use crate::image::MAX_PIXELS;
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
        let Self {
            width,
            height,
            samples,
            ..
        } = *self;
        let count = width
            .checked_mul(height)
            .filter(|&n| n > 0 && n <= MAX_PIXELS && samples > 0);
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
    pixels
        .par_chunks_mut(width)
        .enumerate()
        .for_each(|(y, row)| {
            tracer.row(y, row);
            progress(width);
        });
    Ok(Film::new(width, height, pixels))
}

/// The plan's switches, read once.
pub(super) struct Tracer<'a> {
    pub(super) scene: &'a Scene,
    settings: &'a Settings,
    lens: Lens,
    /// Whether directions from the BRDF are drawn.
    pub(super) directions: bool,
    /// Whether lights with an extent are sampled.
    pub(super) light_sampling: bool,
    /// Whether directions that hit such lights count as they are drawn.
    pub(super) hits_count: bool,
    /// Whether they count after a choice among several.
    pub(super) resampling: bool,
    pub(super) mis: bool,
    pub(super) heuristic: Heuristic,
    pub(super) shadows: bool,
    pub(super) interreflection: bool,
    pub(super) roulette: bool,
}

/// A path of those that a seed gives a pixel.
#[derive(Clone, Copy)]
pub(super) struct PathId {
    /// Column and row.
    pub(super) pixel: [usize; 2],
    pub(super) seed: u64,
    pub(super) index: u64,
    /// How many the seed gives; only lattices ask.
    pub(super) count: u64,
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
            lens: scene
                .camera
                .lens(settings.width as f64 / settings.height as f64),
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

    /// All paths of a row's pixels.
    fn row(&self, y: usize, row: &mut [Pixel]) {
        let count = self.settings.samples;
        let paths = (0..row.len()).flat_map(|x| {
            let seed = self.settings.pixel_seed([x, y]);
            (0..count).map(move |index| PathId {
                pixel: [x, y],
                seed,
                index,
                count,
            })
        });
        let mut tallies = vec![Tally::default(); row.len()];
        self.trace(paths, |path, radiance| tallies[path.pixel[0]].add(radiance));
        row.iter_mut()
            .zip(&tallies)
            .for_each(|(pixel, tally)| *pixel = tally.pixel());
    }

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

    fn start(&self, path: PathId) -> Start {
        let numbers = Numbers::new(self.scene, self.settings.points, path);
        Start {
            ray: self.ray(path.pixel, numbers.pixel()),
            numbers,
        }
    }

    /// The ray through a point of a pixel, in [0, 1]² from its upper left corner.
    pub(super) fn ray(&self, [x, y]: [usize; 2], within: DVec2) -> Ray {
        let size = DVec2::new(self.settings.width as f64, self.settings.height as f64);
        self.lens
            .ray((DVec2::new(x as f64, y as f64) + within) / size)
    }
}
