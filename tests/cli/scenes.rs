//! Backgrounds, turned lights, the limit of paths, frames, and sheets whose columns mean something.

use std::fs;
use std::path::Path;

use merlkit::image::{Image, read_exr, read_image};

use crate::run::{fails, json, run_in, succeeds};
use crate::writing::names;

const WHITE: &str = "lambert:reflectance=1";

/// Runs a command of few paths, and returns what it prints.
fn run_command(folder: &Path, command: &str) -> String {
    let command = format!("{command} --sampler cosine --spp 16");
    let arguments: Vec<&str> = command.split(' ').collect();
    succeeds(run_in(folder, &arguments, ""))
}

fn render(folder: &Path, options: &str) -> Image {
    let command = format!("render {WHITE} --size 33x33 --force {options}");
    run_command(folder, &command);
    read_exr(&folder.join("render.exr")).unwrap()
}

/// A white sphere in white light is as bright as it covers pixels.
#[test]
fn a_transparent_background_has_the_alpha_of_its_spheres() {
    let folder = tempfile::tempdir().unwrap();
    for budget in ["", " --adaptive", " --together"] {
        // A cosine draws a white diffuse surface without noise.
        let options = format!("--light uniform --strategy brdf --background none{budget}");
        let image = render(folder.path(), &options);
        let alpha = image.alpha().expect("alpha");
        assert_eq!((alpha[0], alpha[16 * 33 + 16]), (0.0, 1.0));
        assert!(alpha.iter().any(|a| *a > 0.2 && *a < 0.8));
        let tolerance = if budget == " --adaptive" { 0.5 } else { 1e-4 };
        for (pixel, alpha) in image.pixels().iter().zip(alpha) {
            assert!((pixel.x - alpha).abs() < tolerance, "{pixel} {alpha}");
        }
    }
    let png = fs::read(folder.path().join("render.png")).unwrap();
    assert_eq!(png[25], 6, "RGB and alpha");
    // Two tiles and the sheet keep it.
    run_command(
        folder.path(),
        &format!("sheet {WHITE} lambert:reflectance=0.5 --size 24 --background none"),
    );
    let sheet = read_exr(&folder.path().join("sheet.exr")).unwrap();
    let alpha = sheet.alpha().unwrap();
    assert_eq!((alpha[0], alpha[16 * sheet.width() + 16]), (0.0, 1.0));
}

#[test]
fn a_colour_is_seen_in_the_background_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let image = render(folder.path(), "--light directional:0,0 --background white");
    assert!(image.alpha().is_none());
    assert_eq!(image.pixel(0, 0).to_array(), [1.0; 3]);
    render(
        folder.path(),
        "--light point --background #336699 --exposure 2",
    );
    let png = read_image(&folder.path().join("render.png")).unwrap();
    let seen = png.pixel(0, 0);
    assert!(
        (seen.x - 0.0331).abs() < 1e-3 && (seen.z - 0.3185).abs() < 1e-3,
        "{seen}"
    );
    let wrong = fails(run_in(
        folder.path(),
        &["render", "teflon", "--background", "red"],
        "",
    ));
    assert!(wrong.contains("#ffcc00"), "{wrong}");
}

/// Lights that are turned with the camera give the same picture.
#[test]
fn lights_and_cameras_turn() {
    let folder = tempfile::tempdir().unwrap();
    let right = render(folder.path(), "--light point:0,1,20 --rotate 90");
    assert!(right.pixel(22, 16).x > 0.5 && right.pixel(10, 16).x == 0.0);
    let moved = render(folder.path(), "--light point:20,1,0");
    let turned = render(
        folder.path(),
        "--light point:20,1,0 --rotate 90 --eye 6.6,2.4,0",
    );
    let ahead = render(folder.path(), "--light point:20,1,0 --eye 0,2.4,6.6");
    for (a, b, what) in [
        (&right, &moved, "light"),
        (
            &turned,
            &render(folder.path(), "--light point:0,1,-20 --eye 6.6,2.4,0"),
            "both",
        ),
    ] {
        for (a, b) in a.pixels().iter().zip(b.pixels()) {
            assert!((*a - *b).abs().max_element() < 1e-3, "{what}: {a} {b}");
        }
    }
    assert!(ahead != turned);
    // Environments turn too: after a whole turn it is as before, but for rounding.
    let [plain, whole, half] =
        ["0", "360", "180"].map(|deg| render(folder.path(), &format!("--rotate {deg}")));
    let difference = |a: &Image, b: &Image| {
        let pairs = a.pixels().iter().zip(b.pixels());
        pairs
            .map(|(a, b)| (*a - *b).abs().max_element())
            .sum::<f32>()
            / a.pixels().len() as f32
    };
    assert!(difference(&plain, &whole) < 0.01);
    assert!(difference(&plain, &half) > 0.05);
}

#[test]
fn a_limit_of_paths_is_kept_and_said() {
    let folder = tempfile::tempdir().unwrap();
    let free = render(folder.path(), "--light point");
    let limit = 0.5;
    assert!(free.pixels().iter().any(|p| p.max_element() > limit));
    let words = run_command(
        folder.path(),
        &format!("render {WHITE} --size 33x33 --light point --clamp {limit} -o clamped"),
    );
    assert!(
        words.contains("clamped: paths that carried more than 0.5"),
        "{words}"
    );
    let clamped = read_exr(&folder.path().join("clamped.exr")).unwrap();
    for (free, clamped) in free.pixels().iter().zip(clamped.pixels()) {
        assert!(clamped.max_element() <= limit + 1e-6 && clamped.x <= free.x + 1e-6);
    }
    for name in ["clamped.exr", "clamped.png"] {
        let bytes = fs::read(folder.path().join(name)).unwrap();
        assert!(bytes.windows(8).any(|w| w == b"clamped:"), "{name}");
    }
}

#[test]
fn frames_are_numbered_files_or_one_that_moves() {
    let folder = tempfile::tempdir().unwrap();
    let command =
        format!("render {WHITE} lambert:reflectance=0.2 --size 48x24 --light point:0,1,20");
    let turn = |more: &str| run_command(folder.path(), &format!("{command} --frames 4 {more}"));
    turn("--turn light -o t");
    let mut expected = Vec::new();
    for frame in 0..4 {
        expected.push(format!("t_00{frame}.exr"));
        expected.push(format!("t_00{frame}.png"));
    }
    assert_eq!(names(folder.path()), expected);
    let frame = |number: u32| read_exr(&folder.path().join(format!("t_00{number}.exr"))).unwrap();
    run_command(folder.path(), &format!("{command} -o still"));
    assert_eq!(
        frame(0),
        read_exr(&folder.path().join("still.exr")).unwrap()
    );
    run_command(folder.path(), &format!("{command} --rotate 90 -o right"));
    assert_eq!(
        frame(1),
        read_exr(&folder.path().join("right.exr")).unwrap()
    );
    let refused = format!("{command} --frames 4 --turn light -o t");
    let refused: Vec<&str> = refused.split(' ').collect();
    assert!(fails(run_in(folder.path(), &refused, "")).contains("pass --force"));

    // The same bytes on any number of threads.
    for (extension, head) in [("gif", &b"GIF89a"[..]), ("apng", b"\x89PNG")] {
        let draw = |threads: u32| {
            turn(&format!(
                "--turn camera --force --threads {threads} -o m.{extension}"
            ));
            fs::read(folder.path().join(format!("m.{extension}"))).unwrap()
        };
        let bytes = draw(1);
        assert!(bytes.starts_with(head));
        assert!(bytes == draw(3), "{extension}");
    }
    let apng = fs::read(folder.path().join("m.apng")).unwrap();
    assert_eq!(apng.windows(4).filter(|w| w == b"fcTL").count(), 4);
    let alone = fails(run_in(
        folder.path(),
        &["render", "teflon", "--frames", "4"],
        "",
    ));
    assert!(alone.contains("--turn"), "{alone}");
}

#[test]
fn columns_of_a_sheet_are_samplers_or_values_of_a_parameter() {
    let folder = tempfile::tempdir().unwrap();
    let quick = "--size 24 --spp 4 --reference-spp 64 --force";
    let sheet = |command: &str| {
        let arguments: Vec<String> = format!("sheet {command} {quick}")
            .split(' ')
            .map(String::from)
            .collect();
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let words = succeeds(run_in(folder.path(), &arguments, ""));
        (words, read_exr(&folder.path().join("sheet.exr")).unwrap())
    };
    let (words, image) = sheet(
        "ward lambert --columns-by sampler --sampler cosine --sampler lobe:cosine --difference",
    );
    // Three columns; two rows for each material, each with its label; one line over the columns.
    assert_eq!(
        (image.width(), image.height()),
        (3 * 28 + 4, 4 * (24 + 12 + 4) + 4 + 12)
    );
    let errors: Vec<f64> = words
        .lines()
        .filter(|line| line.contains("| ward") || line.contains("| lambert"))
        .map(|line| line.split('|').nth(3).unwrap().trim().parse().unwrap())
        .collect();
    assert_eq!(errors.len(), 4, "{words}");
    assert!(errors.iter().all(|e| *e > 0.0 && *e < 1.0), "{errors:?}");

    // The value that the material has is the nearest to the reference.
    let (words, _) =
        sheet("lambert:reflectance=0.5 --sampler cosine --columns-by reflectance=0.1,0.5,0.9");
    let error = |value: &str| {
        let column = format!("| reflectance={value} ");
        let line = words.lines().find(|line| line.contains(&column)).unwrap();
        line.split('|')
            .nth(3)
            .unwrap()
            .trim()
            .parse::<f64>()
            .unwrap()
    };
    let [dark, same, bright] = ["0.1", "0.5", "0.9"].map(error);
    assert!(
        same < 0.3 * dark && same < 0.3 * bright,
        "{dark} {same} {bright}"
    );
    // A stored fit has the parameters of its best formula.
    let fit = r#"{"schema": 3, "kind": "fit", "results": {"materials": [{"fits": [
        {"error": 0.1, "material": "lambert:reflectance=0.2+ggx:ax=0.2,ay=0.2"}]}]}}"#;
    std::fs::write(folder.path().join("fit.json"), fit).unwrap();
    std::fs::write(folder.path().join("bent.json"), &fit[..100]).unwrap();
    let (words, _) = sheet("fit.json --sampler cosine --columns-by alpha=0.1,0.2,0.6");
    let errors = ["0.1", "0.2", "0.6"].map(|value| {
        let column = format!("| alpha={value} ");
        let line = words.lines().find(|line| line.contains(&column)).unwrap();
        line.split('|')
            .nth(3)
            .unwrap()
            .trim()
            .parse::<f64>()
            .unwrap()
    });
    assert!(errors[1] < errors[0] && errors[1] < errors[2], "{errors:?}");
    for (command, complaint) in [
        ("sheet bent.json --columns-by alpha=0.1", "does not read"),
        (
            "sheet lambert --sampler cosine --sampler lobe:cosine",
            "--columns-by sampler",
        ),
        ("sheet nickel --columns-by sx=0.1", "has no parameters"),
        ("sheet lambert --columns-by sx=0.1", "has no parameter sx"),
        ("sheet lambert --difference", "--columns-by"),
    ] {
        let arguments: Vec<&str> = command.split(' ').collect();
        let message = fails(run_in(folder.path(), &arguments, ""));
        assert!(message.contains(complaint), "{command}: {message}");
    }
}

/// A picture says in its header how to make it again, and `info` reads it back; where its files went is left out.
#[test]
fn pictures_say_where_they_come_from() {
    let folder = tempfile::tempdir().unwrap();
    let draw = |name: &str, threads: &str| {
        let arguments = [
            "render",
            "nickel",
            "--spp",
            "1",
            "--size",
            "16x16",
            "--seed",
            "7",
            "--threads",
            threads,
            "-o",
            name,
        ];
        succeeds(run_in(folder.path(), &arguments, ""));
    };
    draw("a", "1");
    draw("b", "2");
    for kind in ["exr", "png"] {
        let [a, b] = ["a", "b"]
            .map(|name| std::fs::read(folder.path().join(format!("{name}.{kind}"))).unwrap());
        assert_eq!(a, b);
        let arguments = ["info", &format!("a.{kind}"), "--json", "-"];
        let document = json(&succeeds(run_in(folder.path(), &arguments, "")));
        let recorded = document["results"][0]["recorded"].as_array().unwrap();
        let line = |k: usize| recorded[k].as_str().unwrap();
        assert!(
            line(0).starts_with(concat!("merlkit ", env!("CARGO_PKG_VERSION"))),
            "{recorded:?}"
        );
        assert_eq!(
            line(1),
            "command: merlkit render nickel --spp 1 --size 16x16 --seed 7"
        );
        assert!(
            line(2).starts_with("material: nickel, SHA-256 "),
            "{recorded:?}"
        );
    }
}

/// Names of files need not be text.
#[cfg(unix)]
#[test]
fn names_that_are_no_text_do_no_harm() {
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().unwrap();
    let name = std::ffi::OsStr::from_bytes(b"a\xff");
    let output = std::process::Command::new(assert_cmd::cargo::cargo_bin!("merlkit"))
        .args(["render", WHITE, "--spp", "1", "--size", "8x8", "-o"])
        .arg(name)
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}
