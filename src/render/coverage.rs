//! How much of each pixel objects cover.

use rayon::prelude::*;

use super::bundle::Bundle;
use super::path_numbers::PathRun;
use super::rays::NOTHING;
use super::tracer::Tracer;

/// Rays per pixel, at most: the fraction is then exact to a thousandth.
const MOST_RAYS: u64 = 1024;

/// For each pixel of the tracer's region, row after row, the fraction of its camera rays that meet an object. They are the first `done`
/// of `paths` paths that pictures trace in it, or where these are too many, as many as are enough.
pub(super) fn measure_coverage(tracer: &Tracer<'_>, done: u64, paths: u64) -> Vec<f32> {
    let (done, paths) = match paths > MOST_RAYS {
        true => (MOST_RAYS, MOST_RAYS),
        false => (done, paths),
    };
    let settings = &tracer.settings;
    let region = tracer.region;
    let mut coverage = vec![0.0; region.pixel_count()];
    let rows = coverage.par_chunks_mut(region.size[0]).enumerate();
    rows.for_each_init(Bundle::default, |bundle, (y, row)| {
        let mut hits = vec![0u64; row.len()];
        for x in 0..row.len() {
            let pixel = region.pixel(x, y);
            let mut run = PathRun {
                pixel,
                seed: settings.pixel_seed(pixel),
                from: 0,
                to: done,
                count: paths,
            };
            while run.from < run.to {
                bundle.take_paths(x, &mut run);
                if bundle.is_full() {
                    count_hits(tracer, bundle, &mut hits);
                }
            }
        }
        count_hits(tracer, bundle, &mut hits);
        for (covered, hits) in row.iter_mut().zip(hits) {
            *covered = (hits as f64 / done.max(1) as f64) as f32;
        }
    });
    coverage
}

/// Counts the rays of a bundle that meet an object, each for the pixel of its run's number, and empties the bundle.
fn count_hits<'a>(tracer: &Tracer<'a>, bundle: &mut Bundle<'a>, hits: &mut [u64]) {
    tracer.start(bundle);
    tracer.scene.find_hits(&mut bundle.rays);
    let mut objects = bundle.rays.objects.iter();
    for paths in &bundle.paths {
        let met = objects.by_ref().take(paths.count);
        hits[paths.run] += met.filter(|object| **object != NOTHING).count() as u64;
    }
    bundle.clear();
}
