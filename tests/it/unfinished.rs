//! Pictures that are stopped, stored, loaded and finished: the bits of a picture that was never stopped.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use merlkit::Error;
use merlkit::files::Overwrite;
use merlkit::image::{read_exr, write_exr, write_png};
use merlkit::light::{EnvironmentSource, LightSpec};
use merlkit::material::{LookupRule, Material};
use merlkit::points::PointSet;
use merlkit::render::{
    Budget, PlanRequest, RenderSettings, Rendered, Rendering, Scene, SceneSpec, Surface, render,
};
use merlkit::sampler::SamplerSpec;

/// A row of two spheres on a floor, under a map of light.
fn scene() -> Scene {
    let names = ["nickel", "lambert:reflectance=0.6"].map(String::from);
    let mut spec = SceneSpec::row(&names, 1.5);
    spec.lights = vec![LightSpec::Environment(EnvironmentSource::Studio)];
    spec.floor = Some(0.4);
    spec.depth = 2;
    Scene::build(&spec, PlanRequest::AsNeeded, |i, directions| {
        let loaded = Material::resolve(&names[i])?.load(LookupRule::Floor)?;
        let spec: SamplerSpec = "half-vector:2KB".parse()?;
        Ok(Surface {
            brdf: loaded.brdf().clone(),
            sampler: directions
                .then(|| spec.build(&loaded))
                .transpose()?
                .map(|s| s.shared()),
        })
    })
    .unwrap()
}

fn settings(budget: Budget, points: PointSet) -> RenderSettings {
    RenderSettings {
        width: 120,
        height: 80,
        seed: 5,
        points,
        budget,
    }
}

/// Several rounds each, of 64 paths per pixel.
fn budgets() -> [RenderSettings; 4] {
    [
        settings(Budget::Even(240), PointSet::Lattice),
        settings(Budget::Even(235), PointSet::Sobol),
        settings(Budget::Adaptive(220), PointSet::Lattice),
        settings(
            Budget::ToError {
                error: 0.03,
                most: 64,
            },
            PointSet::Random,
        ),
    ]
}

fn facts(seed: &str) -> Vec<(String, String)> {
    vec![
        ("material".into(), "nickel".into()),
        ("light".into(), seed.into()),
    ]
}

/// Stops after so many questions, of any thread.
fn advance(rendering: &mut Rendering<'_>, questions: usize) -> (bool, usize) {
    let asked = AtomicUsize::new(0);
    let pixels = AtomicUsize::new(0);
    let finished = rendering.advance(
        &|| asked.fetch_add(1, Ordering::Relaxed) + 1 >= questions,
        &|n| {
            pixels.fetch_add(n, Ordering::Relaxed);
        },
    );
    (finished, pixels.into_inner())
}

/// Stopped again and again, each time stored and loaded by another rendering, on another number of threads.
fn render_in_pieces(scene: &Scene, settings: &RenderSettings, file: &Path) -> (Rendered, usize) {
    let step = match settings.budget {
        Budget::ToError { .. } => 4000,
        _ => 1,
    };
    let pools = [1, 3].map(|threads| {
        let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
        builder.build().unwrap()
    });
    let mut pieces = 0;
    loop {
        let mut rendering = Rendering::begin(scene, settings).unwrap();
        if pieces > 0 {
            rendering.restore(file, &facts("studio")).unwrap();
        }
        let pool = &pools[pieces % 2];
        let (finished, pixels) = pool.install(|| advance(&mut rendering, step));
        pieces += 1;
        if finished {
            assert_eq!(pixels, settings.width * settings.height);
            return (rendering.into_rendered(), pieces);
        }
        rendering.save(file, &facts("studio")).unwrap();
        assert!(pieces < 100, "{}", rendering.describe_progress());
    }
}

#[test]
fn pictures_in_pieces_have_the_bits_of_whole_ones() {
    let (scene, folder) = (scene(), tempfile::tempdir().unwrap());
    let file = folder.path().join("p.partial");
    for settings in budgets() {
        let whole = render(&scene, &settings, &|_| {}).unwrap();
        let (pieced, pieces) = render_in_pieces(&scene, &settings, &file);
        assert!(pieces > 2, "{settings:?}: {pieces} pieces");
        assert!(whole == pieced, "{settings:?}");
    }
}

#[test]
fn a_stopped_picture_shows_what_it_has() {
    let scene = scene();
    for (settings, words) in budgets().iter().zip([
        "64 of 240 paths per pixel",
        "64 of 235 paths per pixel",
        "about 27 of 220 paths per pixel",
        " tiles",
    ]) {
        let mut rendering = Rendering::begin(&scene, settings).unwrap();
        assert!(!rendering.is_finished());
        let (finished, _) = advance(&mut rendering, 1);
        let told = rendering.describe_progress();
        assert!(!finished && told.ends_with(words), "{told}");
        let part = rendering.into_rendered();
        let whole = render(&scene, settings, &|_| {}).unwrap();
        assert!(part != whole);
        let (mut sum, mut truth) = (0.0, 0.0);
        for i in 0..settings.width * settings.height {
            let (x, y) = (i % settings.width, i / settings.width);
            let mean = part.film.mean(x, y);
            assert!(mean.is_finite() && mean.min_element() >= 0.0);
            sum += mean.element_sum();
            truth += whole.film.mean(x, y).element_sum();
        }
        assert!((sum / truth - 1.0).abs() < 0.01, "{told}: {}", sum / truth);
    }
    // With as many paths as that, not stopped. Only lattices depend on how many there will be.
    let mut rendering = Rendering::begin(&scene, &budgets()[1]).unwrap();
    advance(&mut rendering, 1);
    let few = settings(Budget::Even(64), PointSet::Sobol);
    assert!(rendering.into_rendered() == render(&scene, &few, &|_| {}).unwrap());
}

/// A small picture of each budget, stopped and stored.
fn stopped(scene: &Scene, folder: &Path) -> Vec<(RenderSettings, PathBuf)> {
    let mut all = Vec::new();
    for (i, mut settings) in budgets().into_iter().enumerate() {
        (settings.width, settings.height) = (20, 15);
        settings.budget = match settings.budget {
            Budget::Even(_) => Budget::Even(8_000),
            Budget::Adaptive(_) => Budget::Adaptive(8_000),
            to_error => to_error,
        };
        let mut rendering = Rendering::begin(scene, &settings).unwrap();
        // Of the adaptive picture, in its second phase.
        let questions = [1, 1, 2, 450][i];
        assert!(!advance(&mut rendering, questions).0);
        let file = folder.join(format!("{i}.partial"));
        rendering.save(&file, &facts("studio")).unwrap();
        all.push((settings, file));
    }
    all
}

#[test]
fn changed_files_are_refused() {
    let (scene, folder) = (scene(), tempfile::tempdir().unwrap());
    for (settings, file) in stopped(&scene, folder.path()) {
        let bytes = std::fs::read(&file).unwrap();
        let mut rendering = Rendering::begin(&scene, &settings).unwrap();
        let mut refused = |bytes: &[u8], what: &str| {
            std::fs::write(&file, bytes).unwrap();
            let error = rendering.restore(&file, &facts("studio")).unwrap_err();
            let known = matches!(error, Error::Invalid { .. } | Error::Unsupported { .. });
            assert!(
                known && !error.to_string().contains('\n'),
                "{what}: {error}"
            );
        };
        // Every byte of what comes first, and some of the numbers.
        let places = (0..300).chain((300..bytes.len()).step_by(bytes.len() / 50));
        for place in places {
            let mut changed = bytes.clone();
            changed[place] ^= 1 << (place % 8);
            refused(&changed, &format!("bit of byte {place}"));
        }
        for len in [
            0,
            1,
            31,
            32,
            39,
            40,
            72,
            500,
            bytes.len() - 32,
            bytes.len() - 1,
        ] {
            refused(&bytes[..len], &format!("{len} bytes"));
        }
        refused(&[&bytes[..], &[0]].concat(), "a byte more");
        std::fs::write(&file, &bytes).unwrap();
        rendering.restore(&file, &facts("studio")).unwrap();
    }
}

/// Numbers that no paths have left, under a right checksum: an error or a picture, and no panic.
#[test]
fn forged_numbers_do_no_harm() {
    use sha2::{Digest, Sha256};
    let (scene, folder) = (scene(), tempfile::tempdir().unwrap());
    let forgeries = [
        0,
        1,
        2,
        4,
        u64::MAX,
        f64::NAN.to_bits(),
        f64::INFINITY.to_bits(),
        (-1.0f64).to_bits(),
        f64::MAX.to_bits(),
    ];
    for (settings, file) in stopped(&scene, folder.path()) {
        let bytes = std::fs::read(&file).unwrap();
        let facts_length = u64::from_le_bytes(bytes[32..40].try_into().unwrap()) as usize;
        let (first, end) = (40 + facts_length, bytes.len() - 32);
        let words = (end - first) / 8;
        let mut refused = 0;
        for word in (0..words.min(8)).chain((8..words).step_by(words / 8)) {
            for forgery in forgeries {
                let mut forged = bytes[..end].to_vec();
                forged[first + 8 * word..][..8].copy_from_slice(&forgery.to_le_bytes());
                let sum = Sha256::digest(&forged);
                forged.extend_from_slice(&sum);
                std::fs::write(&file, &forged).unwrap();
                let mut rendering = Rendering::begin(&scene, &settings).unwrap();
                match rendering.restore(&file, &facts("studio")) {
                    Ok(()) => drop(rendering.into_rendered().film.to_image()),
                    Err(error) => {
                        assert!(matches!(error, Error::Invalid { .. }), "{error}");
                        assert!(!rendering.is_finished());
                        refused += 1;
                    }
                }
            }
        }
        assert!(refused > 24, "{settings:?}: {refused}");
    }
}

#[test]
fn pictures_of_other_commands_are_told_apart() {
    let (scene, folder) = (scene(), tempfile::tempdir().unwrap());
    let (settings, file) = stopped(&scene, folder.path()).remove(0);
    let refusal = |settings: RenderSettings, light: &str| {
        let mut rendering = Rendering::begin(&scene, &settings).unwrap();
        let error = rendering.restore(&file, &facts(light)).unwrap_err();
        assert!(matches!(error, Error::Argument { .. }), "{error}");
        error.to_string()
    };
    let other_seed = RenderSettings {
        seed: 6,
        ..settings
    };
    assert!(
        refusal(other_seed, "studio").contains("another command: seed was 5, and is 6; repeat")
    );
    let points = RenderSettings {
        points: PointSet::Random,
        ..settings
    };
    assert!(refusal(points, "studio").contains(": points was Lattice, and is Random;"));
    let budget = RenderSettings {
        budget: Budget::Even(3),
        ..settings
    };
    assert!(refusal(budget, "studio").contains("budget was Even(8000), and is Even(3)"));
    assert!(refusal(settings, "lamps").contains("light was studio, and is lamps"));
    let both = refusal(other_seed, "lamps");
    assert!(both.contains("seed was 5, and is 6; light was studio, and is lamps"));
}

#[test]
fn a_comment_is_in_the_headers_and_nowhere_else() {
    let folder = tempfile::tempdir().unwrap();
    let image =
        merlkit::image::Image::from_fn(3, 2, |x, y| merlkit::color::Rgb::splat((x + y) as f32))
            .unwrap();
    let said = image.clone().with_comment("unfinished: 3 of 64 paths – ½");
    let path = |name: &str| folder.path().join(name);
    for (image, name) in [(&image, "plain"), (&said, "said")] {
        write_exr(&path(&format!("{name}.exr")), image, Overwrite::Refuse).unwrap();
        write_png(&path(&format!("{name}.png")), image, 0.0, Overwrite::Refuse).unwrap();
    }
    for extension in ["exr", "png"] {
        let holds = |name: &str| {
            let bytes = std::fs::read(path(&format!("{name}.{extension}"))).unwrap();
            let words = b"3 of 64 paths";
            bytes.windows(words.len()).any(|w| w == words)
        };
        assert!(holds("said") && !holds("plain"), "{extension}");
    }
    assert!(read_exr(&path("said.exr")).unwrap() == read_exr(&path("plain.exr")).unwrap());
}
