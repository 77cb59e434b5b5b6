//! Pictures with equally many paths in every pixel.

use rayon::prelude::*;

use crate::render::film::{Film, Pixel, RunningMoments};
use crate::render::path_numbers::PathId;
use crate::render::scene::Scene;
use crate::render::settings::RenderSettings;
use crate::render::tracer::Tracer;

/// Renders `scene` with `paths` paths in every pixel. The settings are checked.
pub(super) fn render_even(
    scene: &Scene,
    settings: &RenderSettings,
    paths: u64,
    progress: &(dyn Fn(usize) + Sync),
) -> Film {
    let RenderSettings { width, height, .. } = *settings;
    let tracer = Tracer::new(scene, settings);
    let mut pixels = vec![Pixel::default(); width * height];
    let rows = pixels.par_chunks_mut(width).enumerate();
    rows.for_each(|(y, row)| {
        let mut moments = vec![RunningMoments::default(); row.len()];
        trace_row(&tracer, y, &mut moments, |x| {
            (settings.pixel_seed([x, y]), paths)
        });
        for (pixel, moments) in row.iter_mut().zip(&moments) {
            *pixel = moments.pixel();
        }
        progress(width);
    });
    Film::new(width, height, pixels)
}

/// Traces all paths of a row's pixels; `seed_and_count(x)` says from which seed and how many for the pixel in column `x`.
pub(super) fn trace_row(
    tracer: &Tracer<'_>,
    y: usize,
    row: &mut [RunningMoments],
    seed_and_count: impl Fn(usize) -> (u64, u64),
) {
    let paths = (0..row.len()).flat_map(|x| {
        let (seed, count) = seed_and_count(x);
        (0..count).map(move |index| PathId {
            pixel: [x, y],
            seed,
            index,
            count,
        })
    });
    tracer.trace(paths, |path, radiance| row[path.pixel[0]].add(radiance));
}
