//! Environments from files, as a user names them.

use std::path::Path;
use std::process::Output;

use merlkit::color::Rgb;
use merlkit::files::Overwrite;
use merlkit::image::{Image, read_exr, write_exr};

use crate::run::{fails, run_in, succeeds};

/// A map of 0.2, 32 × 16, with one pixel in column 9, row 2.
fn map(value: f32) -> Image {
    Image::from_fn(32, 16, |x, y| match (x, y) {
        (9, 2) => Rgb::splat(value),
        _ => Rgb::splat(0.2),
    })
    .unwrap()
}

fn save(folder: &Path, name: &str, image: &Image) {
    write_exr(&folder.join(name), image, Overwrite::Replace).unwrap();
}

fn render(folder: &Path, light: &str) -> Output {
    let arguments = [
        "render",
        "lambert:reflectance=0.5",
        "--size",
        "8x8",
        "--spp",
        "1",
        "--force",
        "--light",
        light,
    ];
    run_in(folder, &arguments, "")
}

/// Standard error of a command that succeeds, and its picture.
fn noted(folder: &Path, light: &str) -> (String, Image) {
    let output = render(folder, light);
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{text}");
    (text, read_exr(&folder.join("render.exr")).unwrap())
}

#[test]
fn one_map_in_every_format_gives_one_picture() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // Values that every format has: 0, 1, a quarter in the red of the lower half.
    let (top, bottom) = (Rgb::new(1.0, 1.0, 0.0), Rgb::new(0.0, 1.0, 1.0));
    let image = Image::from_fn(4, 2, |_, y| if y == 0 { top } else { bottom }).unwrap();
    save(folder, "sky.exr", &image);
    let mut pfm = b"PF\n4 2\n-1\n".to_vec();
    for colour in [bottom, top] {
        pfm.extend(
            (0..4)
                .flat_map(|_| colour.to_array())
                .flat_map(f32::to_le_bytes),
        );
    }
    std::fs::write(folder.join("sky.pfm"), pfm).unwrap();
    let mut hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n".to_vec();
    hdr.extend([[128, 128, 0, 129]; 4].concat());
    hdr.extend([[0, 128, 128, 129]; 4].concat());
    std::fs::write(folder.join("sky.hdr"), &hdr).unwrap();
    let bytes = [[255, 255, 0]; 4]
        .into_iter()
        .chain([[0, 255, 255]; 4])
        .flatten();
    let png = merlkit::image::encode_png(4, 2, &bytes.collect::<Vec<u8>>()).unwrap();
    std::fs::write(folder.join("sky.png"), png).unwrap();
    // The name says nothing.
    std::fs::write(folder.join("hdr.exr"), &hdr).unwrap();
    std::fs::write(folder.join("sky"), &hdr).unwrap();
    let (quiet, picture) = noted(folder, "sky.exr");
    assert_eq!(quiet, "");
    // The sky lights the upper side of the sphere: the map is upright.
    let (above, below) = (picture.pixel(4, 2), picture.pixel(4, 6));
    assert!(above.x > above.z && below.z > below.x, "{above} {below}");
    for name in ["sky.pfm", "sky.hdr", "hdr.exr", "sky"] {
        let (text, same) = noted(folder, name);
        assert_eq!(text, "", "{name}");
        assert!(same == picture, "{name}");
    }
    let (text, same) = noted(folder, "sky.png");
    assert!(
        text.starts_with("merlkit: sky.png: a PNG holds no light above 1"),
        "{text}"
    );
    assert!(same == picture);
}

#[test]
fn small_negatives_are_raised_and_told() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    save(folder, "neg.exr", &map(-1e-5));
    save(folder, "zero.exr", &map(0.0));
    let (text, picture) = noted(folder, "neg.exr");
    let expected = "merlkit: neg.exr: small negative channels of 1 pixel, such as compression and resampling leave, were raised to \
                    0, the lowest from -0.00001\n";
    assert_eq!(text, expected);
    let (quiet, zero) = noted(folder, "zero.exr");
    assert_eq!(quiet, "");
    assert!(picture == zero);
    save(folder, "neg.exr", &map(-1.0));
    let text = fails(render(folder, "neg.exr"));
    assert!(
        text.contains("down to -1, in 1 pixel (in column 9, row 2)"),
        "{text}"
    );
}

#[test]
fn json_has_the_counts() {
    let folder = tempfile::tempdir().unwrap();
    save(folder.path(), "neg.exr", &map(-1e-5));
    let json = |sky: &str| -> serde_json::Value {
        let arguments = [
            "tune",
            "lambert:reflectance=0.5",
            "--target-error",
            "20%",
            "--sampler",
            "cosine",
            "--environment",
            sky,
            "--json",
            "-",
        ];
        let output = run_in(folder.path(), &arguments, "");
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(
            text.contains("neg.exr: small negative"),
            sky == "neg.exr",
            "{text}"
        );
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let results = &json("neg.exr")["results"];
    let file = &results["environment_file"];
    assert_eq!(
        (&file["raised_pixels"], &file["path"]),
        (&1.into(), &"neg.exr".into())
    );
    assert!(
        (file["lowest"].as_f64().unwrap() + 1e-5).abs() < 1e-9,
        "{file}"
    );
    assert!(file["clamped_to"].is_null() && results["tried"].is_array());
    assert!(json("lamps")["results"].get("environment_file").is_none());
}

#[test]
fn infinite_pixels_are_named_with_the_choice_to_clamp() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    save(folder, "inf.exr", &map(f32::INFINITY));
    save(folder, "bright.exr", &map(65_504.0));
    save(folder, "hundred.exr", &map(100.0));
    let text = fails(render(folder, "inf.exr"));
    for expected in [
        "infinite radiance in 1 pixel (in column 9, row 2)",
        "inf.exr:clamp ",
        "inf.exr:clamp=MAX",
    ] {
        assert!(text.contains(expected), "{text}");
    }
    let (text, clamped) = noted(folder, "inf.exr:clamp");
    assert_eq!(
        text,
        "merlkit: inf.exr: the light of 1 pixel was lowered to 65504, as asked\n"
    );
    assert!(clamped == noted(folder, "bright.exr").1);
    let (text, clamped) = noted(folder, "inf.exr:clamp=100");
    assert!(text.contains("1 pixel was lowered to 100"), "{text}");
    let (quiet, hundred) = noted(folder, "hundred.exr:clamp=100");
    assert_eq!(quiet, "");
    assert!(clamped == hundred);
    save(folder, "nan.exr", &map(f32::NAN));
    let text = fails(render(folder, "nan.exr:clamp"));
    assert!(
        text.contains("NaN in 1 pixel (in column 9, row 2)"),
        "{text}"
    );
    assert!(fails(render(folder, "inf.exr:clamp=-1")).contains("not a radiance to clamp to"));
}

#[test]
fn maps_of_other_shapes_are_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    for (width, height, remedy) in [
        (64, 64, "a mirror ball, an angular or an octahedral map"),
        (100, 51, "resize it to 102 × 51"),
        (64, 16, "extend it to 64 × 32"),
        (64, 48, "a cross or a strip"),
    ] {
        let image = Image::from_fn(width, height, |_, _| Rgb::splat(0.2)).unwrap();
        save(folder.path(), "map.exr", &image);
        let text = fails(render(folder.path(), "map.exr"));
        let what = format!("an environment of {width} × {height} pixels is not supported");
        assert!(
            text.contains(&what) && text.contains("twice as wide as high"),
            "{text}"
        );
        assert!(text.contains(remedy), "{text}");
    }
}

#[test]
fn other_files_are_named_by_what_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("env.jpg");
    std::fs::write(&path, b"\xff\xd8\xff\xe0\0\x10JFIF\0").unwrap();
    let text = fails(render(folder.path(), "env.jpg"));
    assert!(
        text.contains(
            "env.jpg: a JPEG picture is not supported; convert it: magick env.jpg env.png"
        ),
        "{text}"
    );
    assert!(fails(render(folder.path(), "gone.hdr")).contains("gone.hdr: cannot open"));
    assert!(fails(render(folder.path(), "sun")).contains("no light is called \"sun\""));
}

#[test]
fn help_says_where_up_is() {
    let text = succeeds(run_in(Path::new("."), &["render", "--help"], ""));
    let words: Vec<&str> = text.split_whitespace().collect();
    assert!(
        words
            .join(" ")
            .contains("its top is +y, its centre −z, its right half +x"),
        "{text}"
    );
    assert!(
        text.lines().count() <= 110,
        "{} lines",
        text.lines().count()
    );
}

/// Nothing can be made in this folder, not even by the superuser.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_without_permission_is_found_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let started = std::time::Instant::now();
    let arguments = ["render", "nickel", "--spp", "100000", "-o", "/proc/picture"];
    let text = fails(run_in(folder.path(), &arguments, ""));
    assert!(
        text.contains("/proc: cannot write into this folder: "),
        "{text}"
    );
    assert!(!text.contains(".tmp"), "{text}");
    assert!(started.elapsed().as_secs() < 60);
}

#[test]
fn there_is_nothing_to_resume_in_an_empty_folder() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["compare", "nickel", "--quick", "--resume", "-o", "new"];
    let text = fails(run_in(folder.path(), &arguments, ""));
    assert!(
        text.contains("nothing to resume: there is no new"),
        "{text}"
    );
    assert!(!folder.path().join("new").exists());
}
