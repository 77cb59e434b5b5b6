//! Pictures that must be the same, to the byte or within noise.

use super::*;

/// Compares two films block by block, in standard errors of the difference.
fn assert_same_within_noise(a: &Film, b: &Film, what: &str) {
    const BLOCK: usize = 4;
    let (mut squares, mut blocks) = (0.0, 0.0);
    let (columns, rows) = (a.width() / BLOCK, a.height() / BLOCK);
    for block in 0..columns * rows {
        let (mut difference, mut variance, mut total) = (0.0, 0.0, 0.0);
        for i in 0..BLOCK * BLOCK {
            let (x, y) = (
                block % columns * BLOCK + i % BLOCK,
                block / columns * BLOCK + i / BLOCK,
            );
            difference += a.mean(x, y).element_sum() - b.mean(x, y).element_sum();
            // Channels move together: their errors add.
            variance += a.standard_error(x, y).element_sum().powi(2)
                + b.standard_error(x, y).element_sum().powi(2);
            total += a.mean(x, y).element_sum();
        }
        let z = difference / variance.sqrt().max(1e-9 * total + 1e-12);
        assert!(
            z.abs() < 4.5,
            "{what}: block {block} differs by {z} standard errors"
        );
        squares += z * z;
        blocks += f64::from(variance > 0.0);
    }
    assert!(
        squares < 1.8 * f64::max(blocks, 1.0),
        "{what}: mean z² {}",
        squares / f64::max(blocks, 1.0)
    );
}

#[test]
fn strategies_agree_where_everything_meets() {
    let brdfs = [lambert(0.8), embedded("red-plastic")];
    let films = STRATEGIES.map(|strategy| {
        let spec = SceneSpec {
            floor: Some(0.5),
            depth: 5,
            ..row(2, vec![lamp(), uniform(0.2)], strategy)
        };
        planned(&spec, &brdfs, 32, 256)
    });
    assert_same_within_noise(&films[0], &films[1], "mis and light");
    assert_same_within_noise(&films[0], &films[2], "mis and brdf");
}

#[test]
fn everything_forced_on_gives_the_same_picture() {
    let brdfs = [lambert(0.8), embedded("blue-metallic-paint")];
    let point = || row(2, vec![], MIS).light("point").unwrap();
    let cases = [
        ("one sphere, point", row(1, vec![point()], MIS)),
        ("one sphere, environment", row(1, vec![uniform(1.0)], MIS)),
        (
            "one sphere, lamp, light only",
            row(1, vec![lamp()], Strategy::Light),
        ),
        (
            "one sphere, lamp and point, brdf only",
            row(1, vec![lamp(), point()], Strategy::Brdf),
        ),
        (
            "two spheres, direct",
            SceneSpec {
                depth: 1,
                ..row(2, vec![point()], MIS)
            },
        ),
        ("two spheres on a floor, point", {
            SceneSpec {
                floor: Some(0.6),
                depth: 3,
                ..row(2, vec![point()], MIS)
            }
        }),
    ];
    for (name, spec) in cases {
        let planned = planned(&spec, &brdfs, 32, 128);
        let forced = film(&spec, PlanRequest::Everything, &brdfs, 32, 128);
        assert_same_within_noise(&planned, &forced, name);
        assert!(planned.mean(16, 16).x > 0.0, "{name} is black");
        for effect in Effect::ALL {
            let one = film(&spec, PlanRequest::Plus(effect), &brdfs, 32, 32);
            assert_same_within_noise(&one, &forced, &format!("{name}, {} forced", effect.name()));
        }
    }
}

#[test]
fn a_wrong_picture_is_told_from_noise() {
    let spec = row(1, vec![lamp()], Strategy::Light);
    let right = planned(&spec, &[lambert(0.8)], 32, 512);
    let wrong = planned(&spec, &[lambert(0.76)], 32, 512);
    let compare = || assert_same_within_noise(&right, &wrong, "albedo 0.8 and 0.76");
    assert!(std::panic::catch_unwind(compare).is_err());
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let brdfs = [lambert(0.8), embedded("nickel")];
    let sky = LightSpec::Environment(EnvironmentSource::Studio);
    let spec = SceneSpec {
        floor: Some(0.4),
        ..row(2, vec![sky], MIS)
    };
    let scene = build(&spec, PlanRequest::AsNeeded, &brdfs);
    let settings = RenderSettings {
        width: 41,
        height: 23,
        seed: 3,
        points: PointSet::Sobol,
        budget: Budget::Even(5),
    };
    let folder = tempfile::tempdir().unwrap();
    let files = [1, 2, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let done = std::sync::atomic::AtomicUsize::new(0);
        let count = |n| {
            done.fetch_add(n, std::sync::atomic::Ordering::Relaxed);
        };
        let image = pool
            .install(|| render(&scene, &settings, &count))
            .unwrap()
            .film
            .to_image()
            .unwrap();
        assert_eq!(done.into_inner(), 41 * 23);
        let path = |extension| folder.path().join(format!("{threads}.{extension}"));
        pool.install(|| write_exr(&path("exr"), &image, Overwrite::Refuse))
            .unwrap();
        write_png(&path("png"), &image, 0.0, Overwrite::Refuse).unwrap();
        ["exr", "png"].map(|e| std::fs::read(path(e)).unwrap())
    });
    assert!(files[0] == files[1] && files[0] == files[2]);
    let other = render(
        &scene,
        &RenderSettings {
            seed: 4,
            ..settings
        },
        &|_| {},
    )
    .unwrap();
    assert_ne!(other, render(&scene, &settings, &|_| {}).unwrap());
}

#[test]
fn the_studio_is_the_same_with_and_without_tables() {
    let tables = studio(SkySampling::Importance);
    let plain = studio(SkySampling::Uniform);
    assert!(tables.table_bytes() > 0 && plain.table_bytes() == 0);
    let mean = |sky: &dyn Light| {
        let n = 1 << 15;
        let value = |i| {
            let s = sky
                .sample(DVec3::ZERO, PointSet::Sobol.point(1, i, 0).as_dvec2())
                .unwrap();
            f64::from(s.radiance.y) / s.pdf
        };
        (0..n).map(value).sum::<f64>() / n as f64
    };
    let (a, b) = (mean(&tables), mean(&plain));
    assert!((a / b - 1.0).abs() < 0.02, "{a} {b}");
}
