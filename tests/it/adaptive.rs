//! Pictures whose pixels differ in their numbers of paths. Of a target error: the error they claim is the error they have, and
//! stopping leaves the picture unbiased. Shared out by noise: as unbiased, and nearer to the truth than even ones.

use crate::support::measured;
use std::sync::Arc;

use merlkit::direction_sampler::DirectionSampler;
use merlkit::light::{EnvironmentSource, LightSpec};
use merlkit::material::merl::MerlBrdf;
use merlkit::points::PointSet;
use merlkit::render::{
    Budget, Film, PlanRequest, Refinement, RenderSettings, Rendered, Scene, SceneSpec, Strategy,
    Surface, render,
};
use merlkit::sampler::{Cosine, HalfVectorSettings, HalfVectorTable};

/// A sphere under the studio.
struct Picture {
    scene: Scene,
    settings: RenderSettings,
}

impl Picture {
    fn of(name: &str, strategy: Strategy, side: usize) -> Self {
        let brdf = measured(name);
        let table = HalfVectorTable::build(&*brdf, HalfVectorSettings::default()).unwrap();
        Self::with(brdf, Arc::new(table), strategy, side)
    }

    fn with(
        brdf: Arc<MerlBrdf>,
        sampler: Arc<dyn DirectionSampler>,
        strategy: Strategy,
        side: usize,
    ) -> Self {
        let lights = vec![LightSpec::Environment(EnvironmentSource::Studio)];
        let spec = SceneSpec {
            lights,
            strategy,
            ..SceneSpec::row(&["sphere".into()], 1.0)
        };
        let surface = |_, _| {
            Ok(Surface {
                brdf: brdf.clone(),
                sampler: Some(sampler.clone()),
            })
        };
        let scene = Scene::build(&spec, PlanRequest::AsNeeded, surface).unwrap();
        let settings = RenderSettings {
            width: side,
            height: side,
            seed: 1,
            points: PointSet::Sobol,
            budget: Budget::Even(1),
        };
        Self { scene, settings }
    }

    fn render(&self, budget: Budget, seed: u64) -> Rendered {
        let settings = RenderSettings {
            budget,
            seed,
            ..self.settings
        };
        render(&self.scene, &settings, &|_| {}).unwrap()
    }

    fn reference(&self, paths: u64) -> Film {
        self.render(Budget::Even(paths), 77).film
    }

    fn adaptive(&self, paths: u64, seed: u64) -> Film {
        self.render(Budget::Adaptive(paths), seed).film
    }

    fn refined(&self, error: f64, seed: u64) -> (Film, Refinement) {
        let most = 1 << 14;
        let rendered = self.render(Budget::ToError { error, most }, seed);
        (rendered.film, rendered.refinement.unwrap())
    }
}

fn root_mean_square(errors: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = errors.len() as f64;
    (errors.map(|e| e * e).sum::<f64>() / count).sqrt()
}

/// Against a reference, each picture's error is at most 1.2 of the target, so is each tile's over the seeds, and the estimates
/// are neither too small nor much too large.
fn assert_honest(name: &str) {
    let picture = Picture::of(name, Strategy::default(), 32);
    let truth = picture.reference(4096);
    for target in [0.05, 0.02] {
        let films: Vec<(Film, Refinement)> =
            (1..=4).map(|seed| picture.refined(target, seed)).collect();
        let errors: Vec<f64> = films
            .iter()
            .map(|(film, refinement)| refinement.error_against(film, &truth).unwrap())
            .collect();
        assert!(films.iter().all(|(_, r)| r.tiles.iter().all(|t| t.reached)));
        assert!(
            errors.iter().all(|&e| e <= 1.2 * target),
            "{name} at {target}: {errors:?}"
        );
        let claimed = root_mean_square(films.iter().map(|(_, refinement)| refinement.error()));
        let ratio = root_mean_square(errors.iter().copied()) / claimed;
        assert!(
            (0.8..1.2).contains(&ratio),
            "{name} at {target}: true over estimated {ratio}"
        );
        let tiles: Vec<Vec<f64>> = films
            .iter()
            .map(|(film, refinement)| refinement.tile_errors_against(film, &truth).unwrap())
            .collect();
        for tile in 0..tiles[0].len() {
            let error = root_mean_square(tiles.iter().map(|t| t[tile]));
            assert!(
                error <= 1.2 * target,
                "{name} at {target}, tile {tile}: {error}"
            );
        }
    }
}

#[test]
fn nickel_is_as_exact_as_it_says() {
    assert_honest("nickel");
}

#[test]
fn teflon_is_as_exact_as_it_says() {
    assert_honest("teflon");
}

#[test]
fn chrome_is_as_exact_as_it_says() {
    assert_honest("chrome");
}

/// A metal by the cosine: most paths find little, few find much. To stop where few have been met, or to send paths where many
/// have been, would change the mean.
fn assert_unbiased(points: PointSet, pictures: u64, image: impl Fn(&Picture, u64) -> Film) {
    const SIDE: usize = 3;
    let mean = |film: &Film| -> f64 {
        (0..SIDE * SIDE)
            .map(|i| film.mean(i % SIDE, i / SIDE).element_sum())
            .sum()
    };
    let truth = mean(&Picture::of("nickel", Strategy::default(), SIDE).reference(1 << 15));
    let mut picture = Picture::with(measured("nickel"), Arc::new(Cosine), Strategy::Brdf, SIDE);
    picture.settings.points = points;
    let means: Vec<f64> = (1..=pictures)
        .map(|seed| mean(&image(&picture, seed)) / truth)
        .collect();
    let n = means.len() as f64;
    let average = means.iter().sum::<f64>() / n;
    let error = (means.iter().map(|m| (m - average).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt();
    assert!(error < 0.02, "{average} ± {error} says nothing");
    assert!(
        (average - 1.0).abs() < 3.5 * error,
        "{average} ± {error} of the true mean"
    );
}

#[test]
fn stopping_leaves_the_mean_as_it_is() {
    assert_unbiased(PointSet::Random, 2000, |picture, seed| {
        picture.refined(0.5, seed).0
    });
}

#[test]
fn sharing_paths_out_leaves_the_mean_as_it_is() {
    for points in [PointSet::Random, PointSet::Lattice] {
        assert_unbiased(points, 5000, |picture, seed| picture.adaptive(16, seed));
    }
}

/// Mean over pixels of the squared relative error of the picture's sums of channels, beside a tenth of its mean where it is dark.
fn relative_error(film: &Film, truth: &Film) -> f64 {
    let pixels = |film: &Film| -> Vec<f64> {
        let (w, h) = (film.width(), film.height());
        (0..w * h)
            .map(|i| film.mean(i % w, i / w).element_sum())
            .collect()
    };
    let (film, truth) = (pixels(film), pixels(truth));
    let dark = 0.1 * truth.iter().sum::<f64>() / truth.len() as f64;
    let errors = film
        .iter()
        .zip(&truth)
        .map(|(f, t)| (f - t).powi(2) / (t * t + dark * dark));
    errors.sum::<f64>() / film.len() as f64
}

#[test]
fn shared_out_paths_leave_less_error() {
    for name in ["nickel", "chrome", "teflon"] {
        let mut picture = Picture::of(name, Strategy::default(), 64);
        picture.settings.points = PointSet::Lattice;
        let truth = picture.reference(4096);
        let even = picture.render(Budget::Even(32), 1).film;
        let (even, shared) = (
            relative_error(&even, &truth),
            relative_error(&picture.adaptive(32, 1), &truth),
        );
        println!("{name}: {shared:.2e} of {even:.2e}");
        assert!(shared < 0.75 * even, "{name}: {shared} and {even}");
    }
}

#[test]
fn shared_out_paths_are_the_same_for_any_number_of_threads_and_leave_nothing_out() {
    let picture = Picture::of("nickel", Strategy::default(), 40);
    let films = [1, 2, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| picture.adaptive(16, 1))
    });
    assert!(films[0] == films[1] && films[0] == films[2]);
    assert_ne!(films[0], picture.adaptive(16, 2));
    assert!((0..1600).all(|i| films[0].mean(i % 40, i / 40).min_element() > 0.0));
    let few = RenderSettings {
        budget: Budget::Adaptive(15),
        ..picture.settings
    };
    assert!(render(&picture.scene, &few, &|_| {}).is_err());
}

#[test]
fn a_picture_of_one_pixel_is_shared_out() {
    let film = Picture::of("nickel", Strategy::default(), 1).adaptive(16, 1);
    assert!(film.mean(0, 0).min_element() > 0.0);
}

#[test]
fn any_number_of_threads_gives_the_same_picture() {
    let picture = Picture::of("nickel", Strategy::default(), 40);
    let films = [1, 2, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| picture.refined(0.1, 1))
    });
    assert!(films[0] == films[1] && films[0] == films[2]);
    assert_ne!(films[0].0, picture.refined(0.1, 2).0);
    assert!(films[0].1.paths <= films[0].1.traced);
}

#[test]
fn the_largest_number_of_paths_is_kept_and_told_of() {
    let mut picture = Picture::of("nickel", Strategy::default(), 24);
    picture.settings.budget = Budget::ToError {
        error: 1e-4,
        most: 100,
    };
    let done = std::sync::atomic::AtomicUsize::new(0);
    let count = |n| {
        done.fetch_add(n, std::sync::atomic::Ordering::Relaxed);
    };
    let rendered = render(&picture.scene, &picture.settings, &count).unwrap();
    let refined = rendered.refinement.unwrap();
    assert_eq!(done.into_inner(), 24 * 24);
    assert!(refined.error() > 1e-4 && refined.tiles.iter().all(|t| !t.reached));
    // 64 is the last of 16, 32, 64, …; pixels without an object have 16.
    let shown: usize = refined.tiles.iter().map(|t| t.pixels.len()).sum();
    assert_eq!(refined.paths, (64 * shown + 16 * (24 * 24 - shown)) as u64);
    assert_eq!(refined.paths, refined.traced);
}

#[test]
fn wrong_targets_are_refused() {
    let picture = Picture::of("nickel", Strategy::default(), 4);
    let refused = |error: f64, most: u64| {
        let settings = RenderSettings {
            budget: Budget::ToError { error, most },
            ..picture.settings
        };
        render(&picture.scene, &settings, &|_| {}).is_err()
    };
    for error in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(refused(error, 1 << 14), "{error}");
    }
    assert!(refused(0.1, 15));
    let other = Picture::of("nickel", Strategy::default(), 5).reference(1);
    let (film, refinement) = picture.refined(0.5, 1);
    assert!(refinement.error_against(&film, &other).is_err());
}
