//! Pictures of a target error: the error they claim is the error they have, and stopping leaves the picture unbiased.

use std::sync::Arc;

use merlkit::brdf::{LookupRule, Measured};
use merlkit::merl::decode_embedded;
use merlkit::points::PointSet;
use merlkit::render::{
    EffectPlan, EnvironmentSource, Film, LightSpec, Refined, Scene, SceneSpec, Settings, Strategy, Surface,
    render, render_to_error,
};
use merlkit::sampler::{Cosine, DirectionSampler, HalfVectorSettings, HalfVectorTable};

fn measured(name: &str) -> Arc<Measured> {
    Arc::new(Measured::new(Arc::new(decode_embedded(name).unwrap()), LookupRule::Floor))
}

/// A sphere under the studio.
struct Picture {
    scene: Scene,
    plan: EffectPlan,
    settings: Settings,
}

impl Picture {
    fn of(name: &str, strategy: Strategy, side: usize) -> Self {
        let brdf = measured(name);
        let table = HalfVectorTable::build(&*brdf, HalfVectorSettings::default()).unwrap();
        Self::with(brdf, Arc::new(table), strategy, side)
    }

    fn with(
        brdf: Arc<Measured>,
        sampler: Arc<dyn DirectionSampler>,
        strategy: Strategy,
        side: usize,
    ) -> Self {
        let lights = vec![LightSpec::Environment(EnvironmentSource::Studio)];
        let spec = SceneSpec { lights, strategy, ..SceneSpec::row(&["sphere".into()], 1.0) };
        let plan = EffectPlan::of(&spec);
        let surface = |_, _| Ok(Surface { brdf: brdf.clone(), sampler: Some(sampler.clone()) });
        let scene = Scene::build(&spec, &plan, surface).unwrap();
        let settings =
            Settings { width: side, height: side, samples: 1 << 14, seed: 1, points: PointSet::Sobol };
        Self { scene, plan, settings }
    }

    fn reference(&self, samples: u64) -> Film {
        let settings = Settings { samples, seed: 77, ..self.settings };
        render(&self.scene, &self.plan, &settings, &|_| {}).unwrap()
    }

    fn refined(&self, error: f64, seed: u64) -> Refined {
        let settings = Settings { seed, ..self.settings };
        render_to_error(&self.scene, &self.plan, &settings, error, &|_| {}).unwrap()
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
        let films: Vec<Refined> = (1..=4).map(|seed| picture.refined(target, seed)).collect();
        let errors: Vec<f64> = films.iter().map(|f| f.error_against(&truth).unwrap()).collect();
        assert!(films.iter().all(|f| f.tiles.iter().all(|t| t.reached)));
        assert!(errors.iter().all(|&e| e <= 1.2 * target), "{name} at {target}: {errors:?}");
        let claimed = root_mean_square(films.iter().map(Refined::error));
        let ratio = root_mean_square(errors.iter().copied()) / claimed;
        assert!((0.8..1.2).contains(&ratio), "{name} at {target}: true over estimated {ratio}");
        let tiles: Vec<Vec<f64>> = films.iter().map(|f| f.tile_errors_against(&truth).unwrap()).collect();
        for tile in 0..tiles[0].len() {
            let error = root_mean_square(tiles.iter().map(|t| t[tile]));
            assert!(error <= 1.2 * target, "{name} at {target}, tile {tile}: {error}");
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

/// A metal by the cosine: most paths find little, few find much, and to stop where few have been met would darken.
#[test]
fn stopping_leaves_the_mean_as_it_is() {
    const SIDE: usize = 3;
    let mean =
        |film: &Film| -> f64 { (0..SIDE * SIDE).map(|i| film.mean(i % SIDE, i / SIDE).element_sum()).sum() };
    let truth = mean(&Picture::of("nickel", Strategy::default(), SIDE).reference(1 << 15));
    let mut picture = Picture::with(measured("nickel"), Arc::new(Cosine), Strategy::Brdf, SIDE);
    picture.settings.points = PointSet::Random;
    let means: Vec<f64> = (1..=2000).map(|seed| mean(&picture.refined(0.5, seed).film) / truth).collect();
    let n = means.len() as f64;
    let average = means.iter().sum::<f64>() / n;
    let error = (means.iter().map(|m| (m - average).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt();
    assert!(error < 0.02, "{average} ± {error} says nothing");
    assert!((average - 1.0).abs() < 3.5 * error, "{average} ± {error} of the true mean");
}

#[test]
fn any_number_of_threads_gives_the_same_picture() {
    let picture = Picture::of("nickel", Strategy::default(), 40);
    let films = [1, 2, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| picture.refined(0.1, 1))
    });
    assert!(films[0] == films[1] && films[0] == films[2]);
    assert_ne!(films[0].film, picture.refined(0.1, 2).film);
    assert!(films[0].paths <= films[0].traced);
}

#[test]
fn the_largest_number_of_paths_is_kept_and_told_of() {
    let mut picture = Picture::of("nickel", Strategy::default(), 24);
    picture.settings.samples = 100;
    let done = std::sync::atomic::AtomicUsize::new(0);
    let count = |n| {
        done.fetch_add(n, std::sync::atomic::Ordering::Relaxed);
    };
    let refined = render_to_error(&picture.scene, &picture.plan, &picture.settings, 1e-4, &count).unwrap();
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
    let refused = |error: f64, settings: &Settings| {
        render_to_error(&picture.scene, &picture.plan, settings, error, &|_| {}).is_err()
    };
    for error in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(refused(error, &picture.settings), "{error}");
    }
    assert!(refused(0.1, &Settings { samples: 15, ..picture.settings }));
    assert!(refused(0.1, &Settings { width: 0, ..picture.settings }));
    let other = Picture::of("nickel", Strategy::default(), 5).reference(1);
    assert!(picture.refined(0.5, 1).error_against(&other).is_err());
}
