//! Regions of a picture have the pixels of the whole.

use super::*;
use merlkit::render::Rendering;

/// Regions of a picture of 37 × 23 pixels that cover it: no two are of one size.
const REGIONS: [([usize; 2], [usize; 2]); 5] = [
    ([0, 0], [16, 9]),
    ([16, 0], [21, 9]),
    ([0, 9], [1, 14]),
    ([1, 9], [30, 14]),
    ([31, 9], [6, 14]),
];

const SETTINGS: RenderSettings = RenderSettings {
    width: 37,
    height: 23,
    seed: 3,
    points: PointSet::Lattice,
    budget: Budget::Even(5),
};

/// Two spheres on a floor that show one another, with and without a background.
fn scene(transparent: bool) -> Scene {
    let brdfs = [lambert(0.8), embedded("nickel")];
    let sky = LightSpec::Environment(EnvironmentSource::Studio);
    let spec = SceneSpec {
        floor: (!transparent).then_some(0.4),
        transparent,
        ..row(2, vec![sky], MIS)
    };
    build(&spec, PlanRequest::AsNeeded, &brdfs)
}

fn draw_region(
    scene: &Scene,
    settings: &RenderSettings,
    [corner, size]: [[usize; 2]; 2],
) -> (Film, Image) {
    let mut rendering = Rendering::begin_region(scene, settings, corner, size).unwrap();
    assert!(rendering.advance(&|| false, &|_| {}));
    let film = rendering.into_rendered().film;
    let image = film.to_image().unwrap();
    (film, image)
}

#[test]
fn a_region_has_the_bits_of_the_whole_picture() {
    for transparent in [false, true] {
        let scene = scene(transparent);
        for points in [PointSet::Random, PointSet::Sobol, PointSet::Lattice] {
            let settings = RenderSettings { points, ..SETTINGS };
            let whole = render(&scene, &settings, &|_| {}).unwrap().film;
            let image = whole.to_image().unwrap();
            let mut pixels = 0;
            for (corner, size) in REGIONS {
                let (film, part) = draw_region(&scene, &settings, [corner, size]);
                assert_eq!([film.width(), film.height()], size);
                assert_eq!(part.alpha().is_some(), transparent);
                for y in 0..size[1] {
                    for x in 0..size[0] {
                        let [column, row] = [corner[0] + x, corner[1] + y];
                        assert_eq!(film.mean(x, y), whole.mean(column, row));
                        let error = film.standard_error(x, y);
                        assert_eq!(error, whole.standard_error(column, row));
                        let alpha = part.alpha().map(|alpha| alpha[y * size[0] + x]);
                        let expected = image.alpha().map(|alpha| alpha[row * 37 + column]);
                        assert_eq!(alpha, expected, "{column}, {row}");
                        pixels += 1;
                    }
                }
            }
            assert_eq!(pixels, 37 * 23);
        }
    }
}

#[test]
fn a_region_that_was_stopped_goes_on_and_is_no_other() {
    let scene = scene(false);
    let settings = RenderSettings {
        budget: Budget::Even(3000),
        ..SETTINGS
    };
    let (corner, size) = ([16, 4], [21, 19]);
    let mut stopped = Rendering::begin_region(&scene, &settings, corner, size).unwrap();
    assert!(!stopped.advance(&|| true, &|_| {}));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("region.partial");
    stopped.save(&path, &[]).unwrap();
    // Neither the whole picture nor another region of that size goes on with it.
    let mut whole = Rendering::begin(&scene, &settings).unwrap();
    assert!(whole.restore(&path, &[]).is_err());
    let mut other = Rendering::begin_region(&scene, &settings, [15, 4], size).unwrap();
    assert!(other.restore(&path, &[]).is_err());
    let mut same = Rendering::begin_region(&scene, &settings, corner, size).unwrap();
    same.restore(&path, &[]).unwrap();
    assert!(same.advance(&|| false, &|_| {}));
    let (expected, _) = draw_region(&scene, &settings, [corner, size]);
    assert_eq!(same.into_rendered().film, expected);
}
