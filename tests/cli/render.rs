//! `render`: strategies and target errors.

use crate::run::{fails, json, pixels, run, run_in, succeeds};

const RENDER: [&str; 5] = ["render", "nickel", "--size", "24x24", "--force"];

/// A folder is one sphere for each material in it, in the order of their names.
#[test]
fn a_folder_is_rendered_as_its_materials() {
    let folder = tempfile::tempdir().unwrap();
    let brdfs = folder.path().join("brdfs");
    let brdfs = brdfs.to_str().unwrap();
    succeeds(run(&["decode", "nickel", "red-plastic", "-o", brdfs], ""));
    let picture = |materials: &[&str], name: &str| {
        let output = folder.path().join(name);
        let output = output.to_str().unwrap();
        let options = ["--size", "48x16", "--spp", "1", "-o", output];
        succeeds(run(&[&["render"], materials, &options].concat(), ""));
        std::fs::read(format!("{output}.png")).unwrap()
    };
    let [nickel, red] = ["nickel", "red-plastic"].map(|name| format!("{brdfs}/{name}.binary"));
    let both = picture(&[&nickel, &red], "both");
    let whole = picture(&[brdfs], "whole");
    let decode = |png: &[u8]| merlkit::image::decode_image(png, "a.png".as_ref()).unwrap();
    assert_eq!(decode(&whole).pixels(), decode(&both).pixels());
}

/// Renders with few paths, and reads the picture.
fn picture(folder: &std::path::Path, command: &str) -> merlkit::image::Image {
    let command = format!("render {command} --sampler cosine --spp 16 --force");
    let arguments: Vec<&str> = command.split(' ').collect();
    succeeds(run_in(folder, &arguments, ""));
    merlkit::image::read_exr(&folder.join("render.exr")).unwrap()
}

/// The pixels of a tile of 24 × 30 pixels in the given column and row.
fn tile(image: &merlkit::image::Image, column: usize, row: usize) -> Vec<[f32; 3]> {
    let places = (0..24 * 30).map(|i| (24 * column + i % 24, 30 * row + i / 24));
    places.map(|(x, y)| image.pixel(x, y).to_array()).collect()
}

#[test]
fn a_sphere_is_drawn_alone_unless_together() {
    let folder = tempfile::tempdir().unwrap();
    let draw = |command: &str| picture(folder.path(), command);
    let [red, grey, white] =
        ["0.8/0.1/0.1", "0.5", "0.9"].map(|r| format!("lambert:reflectance={r}"));
    for light in ["studio", "point", "area --ground"] {
        let alone = tile(&draw(&format!("{grey} --size 24x30 --light {light}")), 0, 0);
        let two = draw(&format!("{red} {grey} --size 48x30 --light {light}"));
        assert!(
            tile(&two, 1, 0) == alone && tile(&two, 0, 0) != alone,
            "{light}"
        );
        let command = format!("{white} {grey} {red} --columns 2 --size 48x60 --light {light}");
        let three = draw(&command);
        assert!(tile(&three, 1, 0) == alone && tile(&three, 0, 1) == tile(&two, 0, 0));
        // The place without a sphere is black.
        assert!(tile(&three, 1, 1).iter().all(|pixel| *pixel == [0.0; 3]));
        assert!(draw(&format!("{command} --threads 1")) == three);
        let together = draw(&format!(
            "{red} {grey} --together --size 48x30 --light {light}"
        ));
        assert!(tile(&together, 1, 0) != alone, "{light}");
    }
    for (options, complaint) in [
        (["--size", "47x30"], "give --size 48x30"),
        (["--together", "--columns=2"], "cannot be used with"),
        (["--size", "480x7"], "240 × 7 pixels for each sphere"),
    ] {
        let command = [&["render", &red, &grey][..], &options].concat();
        let message = fails(run_in(folder.path(), &command, ""));
        assert!(message.contains(complaint), "{message}");
    }
}

/// Width over height of the outline of what is black in the picture between two columns: of an ellipse the ratio of its axes.
fn outline_ratio(image: &merlkit::image::Image, columns: std::ops::Range<usize>) -> f64 {
    let (mut sum, mut first, mut second) = (0.0, [0.0; 2], [0.0; 2]);
    for y in 0..image.height() {
        for x in columns.clone() {
            let covered = 1.0 - f64::from(image.pixel(x, y).x);
            sum += covered;
            for (axis, place) in [x as f64, y as f64].into_iter().enumerate() {
                first[axis] += covered * place;
                second[axis] += covered * place * place;
            }
        }
    }
    let variance = |axis: usize| second[axis] / sum - (first[axis] / sum).powi(2);
    (variance(0) / variance(1)).sqrt()
}

#[test]
fn a_sphere_is_round() {
    let folder = tempfile::tempdir().unwrap();
    let black = "lambert:reflectance=0 ".repeat(4) + "--light uniform --size 400x120";
    for view in [
        "",
        " --elevation 60",
        " --fov 8",
        " --fov 50",
        " --eye 3,0.2,7",
    ] {
        let image = picture(folder.path(), &format!("{black}{view}"));
        for column in 0..4 {
            let ratio = outline_ratio(&image, 100 * column..100 * column + 100);
            assert!((ratio - 1.0).abs() < 0.01, "{view} {column}: {ratio}");
        }
    }
    // Far from the middle of a wide view a sphere is an egg.
    let image = picture(folder.path(), &format!("{black} --together"));
    assert!(outline_ratio(&image, 0..119) > 1.05);
}

#[test]
fn strategies_are_explained_and_differ() {
    let folder = tempfile::tempdir().unwrap();
    let picture = |options: &[&str]| {
        let text = succeeds(run_in(
            folder.path(),
            &[&RENDER[..], &["--spp", "4"], options].concat(),
            "",
        ));
        (text, pixels(folder.path()))
    };
    let (text, ris) = picture(&["--strategy", "ris", "--explain"]);
    let line = |name: &str| text.lines().find(|l| l.contains(name)).unwrap().to_owned();
    assert!(line("| resampling").contains("| on"), "{text}");
    assert!(line("| multiple importance").contains("| off"), "{text}");
    assert!(ris == picture(&["--strategy", "ris", "--candidates", "8"]).1);
    assert!(ris != picture(&["--strategy", "ris", "--candidates", "2"]).1);
    let mis = picture(&[]).1;
    assert!(mis == picture(&["--strategy", "mis", "--heuristic", "power"]).1);
    assert!(mis != picture(&["--heuristic", "balance"]).1);
}

#[test]
fn a_target_error_is_reached_and_told() {
    let folder = tempfile::tempdir().unwrap();
    let text =
        |options: &[&str]| succeeds(run_in(folder.path(), &[&RENDER[..], options].concat(), ""));
    let tenth = text(&["--target-error", "0.1"]);
    assert!(
        tenth.contains("estimated relative error") && tenth.contains("have stopped"),
        "{tenth}"
    );
    // But for the time, the same.
    let last = |text: &str| text.lines().last().unwrap().to_owned();
    assert_eq!(last(&text(&["--target-error", "10%"])), last(&tenth));
    let short = text(&["--target-error", "0.001", "--max-spp", "32"]);
    assert!(
        short.contains("did not reach the target: raise --max-spp 32"),
        "{short}"
    );
}

#[test]
fn points_and_places_of_paths_make_different_pictures_of_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let picture = |options: &[&str]| {
        succeeds(run_in(
            folder.path(),
            &[&RENDER[..], &["--spp", "16"], options].concat(),
            "",
        ));
        pixels(folder.path())
    };
    let lattice = picture(&[]);
    assert!(picture(&["--points", "lattice"]) == lattice);
    let others = [
        &["--points", "sobol"][..],
        &["--points", "random"],
        &["--adaptive"],
    ]
    .map(picture);
    assert!(others.iter().all(|other| other != &lattice) && others[0] != others[1]);
    assert!(picture(&["--adaptive"]) == others[2]);
}

#[test]
fn many_paths_are_spread_as_sobol_points_by_default() {
    let folder = tempfile::tempdir().unwrap();
    let picture = |options: &str| {
        let command = format!("render nickel --size 8x8 --force {options}");
        let arguments: Vec<&str> = command.split(' ').collect();
        succeeds(run_in(folder.path(), &arguments, ""));
        pixels(folder.path())
    };
    for (paths, points) in [("511", "lattice"), ("512", "sobol")] {
        let default = picture(&format!("--spp {paths}"));
        let named = picture(&format!("--spp {paths} --points {points}"));
        assert!(default == named, "{paths}");
    }
}

#[test]
fn options_of_other_strategies_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (options, expected) in [
        (
            &["--candidates", "4"][..],
            "--candidates has no effect with --strategy mis",
        ),
        (
            &["--strategy", "light", "--heuristic", "power"],
            "omit it, or pass --strategy mis",
        ),
        (&["--strategy", "ris", "--candidates", "0"], "1..=65536"),
        (&["--target-error=-1"], "a fraction above 0"),
        (&["--target-error", "0"], "a fraction above 0"),
        (
            &["--target-error", "0.1", "--spp", "4"],
            "cannot be used with",
        ),
        (&["--max-spp", "64"], "--target-error"),
        (
            &["--target-error", "0.1", "--max-spp", "8"],
            "8 is not in 16..",
        ),
        (
            &["--target-error", "0.1", "--adaptive"],
            "cannot be used with",
        ),
        (
            &["--target-error", "0.1", "--points", "lattice"],
            "omit --points lattice or --target-error",
        ),
        (&["--adaptive", "--spp", "8"], "give 16 or more"),
    ] {
        let text = fails(run_in(folder.path(), &[&RENDER[..], options].concat(), ""));
        assert!(text.contains(expected), "{options:?}: {text}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn environments_have_the_same_words_in_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let picture = |light: &str| {
        let options = ["--spp", "1", "--light", light];
        succeeds(run_in(folder.path(), &[&RENDER[..], &options].concat(), ""));
        pixels(folder.path())
    };
    let studio = picture("studio");
    assert!(studio == picture("environment"));
    assert!(studio != picture("lamps"));
    assert!(picture("uniform") == picture("uniform:1,1,1"));
    let words = "studio, lamps, uniform[:RADIANCE] or FILE[:clamp[=MAX]]";
    let tune = ["tune", "nickel", "--target-error", "5%", "--environment"];
    for command in [&[&RENDER[..], &["--light"]].concat()[..], &tune] {
        for (word, expected) in [
            ("sky", words),
            ("uniform:-1", "give one number ≥ 0 or three"),
        ] {
            let text = fails(run_in(folder.path(), &[command, &[word]].concat(), ""));
            assert!(text.contains(expected), "{command:?} {word}: {text}");
        }
    }
}

/// The eye and the lights go where they are put.
#[test]
fn the_camera_and_the_lights_are_placed() {
    let folder = tempfile::tempdir().unwrap();
    let render = |options: &[&str]| {
        let quick = [
            "render",
            "lambert:reflectance=0.5",
            "--size",
            "33x33",
            "--spp",
            "16",
        ];
        let all = [&quick[..], &["--sampler", "cosine", "--force"], options].concat();
        succeeds(run_in(folder.path(), &all, ""));
        merlkit::image::read_exr(&folder.path().join("render.exr")).unwrap()
    };
    // Light from the right, then from the left: which half of the sphere is brighter.
    for (light, right_is_brighter) in [
        ("point:20,1,0", true),
        ("point:-20,1,0,400", false),
        ("directional:90,90", true),
        ("directional:90,-90,1", false),
    ] {
        let image = render(&["--light", light]);
        let [left, right] = [13, 19].map(|x| image.pixel(x, 16).x);
        assert_eq!(right > left, right_is_brighter, "{light}: {left} {right}");
    }
    // Seen from above, light from above reaches all that is seen.
    let above = render(&["--light", "directional:0,0", "--elevation", "89"]);
    assert!(above.pixel(16, 16).x > 0.45, "{}", above.pixel(16, 16));
    // The farther the eye, the flatter: the sphere keeps its size.
    let [near, far] = ["60", "2"].map(|fov| render(&["--fov", fov, "--light", "uniform"]));
    assert!((near.pixel(16, 16) - far.pixel(16, 16)).abs().max_element() < 0.05);
    let behind = render(&["--eye", "0,1,-9", "--light", "directional:90,180"]);
    assert!(behind.pixel(16, 16).x > 0.4, "{}", behind.pixel(16, 16));
    for (options, complaint) in [
        (["--fov", "0"], "from 1 to 120"),
        (["--elevation", "90"], "from -89 to 89"),
        (["--eye", "1,2"], "three numbers"),
        (["--light", "point:1,2"], "point:2,4,3"),
    ] {
        let all = [&["render", "teflon"][..], &options].concat();
        let message = fails(run_in(folder.path(), &all, ""));
        assert!(message.contains(complaint), "{message}");
    }
}

/// The stages of a picture are measured, and a sampler from a file draws the pixels of the one that was built.
#[test]
fn costs_are_told_and_stored_samplers_draw() {
    let folder = tempfile::tempdir().unwrap();
    let in_folder = |command: &str| {
        let arguments: Vec<&str> = command.split(' ').collect();
        run_in(folder.path(), &arguments, "")
    };
    let quick = "--size 48x16 --spp 2 --force";
    let [grey, red] = ["lambert:reflectance=0.5", "phong"];
    for (material, file) in [(grey, "grey"), (red, "red")] {
        let build = format!("build {material} --sampler half-vector:2KB -o {file}.safetensors");
        succeeds(in_folder(&build));
    }
    let built = format!("render {grey} {red} --sampler half-vector:2KB {quick}");
    succeeds(in_folder(&built));
    let expected = pixels(folder.path());
    let files = "--sampler grey.safetensors --sampler red.safetensors";
    let stored = format!("render {grey} {red} {files} {quick} --explain --json -");
    let document = json(&succeeds(in_folder(&stored)));
    assert!(pixels(folder.path()) == expected);
    let results = &document["results"];
    let seconds = |stage: &str| results["seconds"][stage].as_f64().unwrap();
    let stages = ["loading", "building", "drawing", "densities", "tracing"].map(seconds);
    assert!(stages.iter().all(|s| *s > 0.0), "{results}");
    assert!(stages.iter().sum::<f64>() < seconds("total"), "{results}");
    let bytes = |i: usize| results["samplers"][i]["bytes"].as_u64().unwrap();
    assert!(bytes(0) > 500 && bytes(1) > 500, "{results}");
    let drawn = results["draws"]["directions"].as_u64().unwrap();
    let timed = results["draws"]["timed"].as_u64().unwrap();
    // A draw at each hit: at most one for each path, and about one in eight of them timed.
    assert!(drawn <= 48 * 16 * 2 && drawn > 100, "{results}");
    assert!(timed > 0 && timed < drawn / 2, "{results}");
    let text = succeeds(in_folder(&format!("{built} --explain")));
    for word in ["| drawing", "| tracing", "half-vector:2KB"] {
        assert!(text.contains(word), "{text}");
    }
    for (command, complaint) in [
        (
            format!("render {red} --sampler grey.safetensors {quick}"),
            "was built from",
        ),
        (
            format!("render {grey} {red} --sampler grey.safetensors {quick}"),
            "once for each",
        ),
        (
            format!("render {grey} {red} {red} {files} {quick}"),
            "2 samplers for 3 materials",
        ),
        (
            format!("render {grey} {grey} {files} --together {quick}"),
            "two samplers",
        ),
    ] {
        let message = fails(in_folder(&command));
        assert!(message.contains(complaint), "{command}: {message}");
    }
}
