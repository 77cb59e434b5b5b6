//! Scenes in the thesis's format.

use std::path::Path;

use merlkit::color::Rgb;

use crate::run::{fails, json, pixels, run_in, succeeds};

const EXAMPLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/thesis/grf");

/// The mean of a picture's pixels.
fn mean(folder: &Path) -> Rgb {
    let image = pixels(folder);
    let mut sum = Rgb::ZERO;
    for pixel in image.pixels() {
        sum += *pixel;
    }
    sum / image.pixels().len() as f32
}

#[test]
fn both_examples_of_the_thesis_are_rendered() {
    let folder = tempfile::tempdir().unwrap();
    let draw = |scene: &str, options: &[&str]| {
        let path = format!("{EXAMPLES}/{scene}");
        let quick = ["render", &path, "--size", "48x36", "--spp", "4", "--force"];
        run_in(folder.path(), &[&quick[..], options].concat(), "")
    };
    // The box has the colour (0.3, 0.8, 1), and what is not the box is black.
    let studio = ["--background", "black", "--light", "uniform"];
    succeeds(draw("box.grf", &studio));
    let colour = mean(folder.path());
    assert!(colour.z > colour.y && colour.y > 2.0 * colour.x, "{colour}");
    assert!(colour.x > 0.005, "{colour}");
    let image = pixels(folder.path());
    let corner = image.pixel(0, 0).max_element();
    let middle = image.pixel(24, 18);
    assert!(corner < 1e-3 && middle.z > 0.2, "{corner} {middle}");
    // Without options the studio shines.
    succeeds(draw("box.grf", &[]));
    assert!(mean(folder.path()).z > 0.05);
    let document = json(&succeeds(draw("dragon.grf", &["--json", "-"])));
    let samplers = document["results"]["samplers"].as_array().unwrap();
    assert_eq!(samplers.len(), 3, "{document}");
    let colour = mean(folder.path());
    assert!(colour.min_element() > 0.02, "{colour}");
}

#[test]
fn samplers_come_from_the_scene_and_faults_have_lines() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("a.grf");
    let render = |text: &str, options: &[&str]| {
        std::fs::write(&scene, text).unwrap();
        let quick = [
            "render", "a.grf", "--size", "16x12", "--spp", "1", "--force",
        ];
        run_in(folder.path(), &[&quick[..], options].concat(), "")
    };
    let mesh = "begin mesh brdf phong begin vertexs (0,0,0) (1,0,0) (0,1,0) end vertexs begin faces (0,1,2) end faces end mesh";
    let text = format!("pdf adaptive nQT=3 nAnisoQT=1 {mesh}");
    let sampler = |options: &[&str]| {
        let document = json(&succeeds(render(
            &text,
            &[&["--json", "-"], options].concat(),
        )));
        document["results"]["samplers"][0]["sampler"].clone()
    };
    assert_eq!(sampler(&[]), "adaptive-disc:tables=3");
    assert_eq!(sampler(&["--sampler", "cosine"]), "cosine");
    for (text, complaint) in [
        (
            "\ninclude \"b.grf\"",
            "a.grf, line 2: there is no file b.grf",
        ),
        ("begin mesh\nbrdf phnog", "a.grf, line 2"),
        ("light begin (0,0,0)", "the end of the file"),
    ] {
        let message = fails(render(text, &[]));
        assert!(message.contains(complaint), "{message}");
    }
}
