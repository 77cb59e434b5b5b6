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

/// Table 7.2 of the thesis at a small size. Its scene, which is not printed, is the box.
#[test]
fn the_option_file_of_the_thesis_is_rendered() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let example = std::fs::read_to_string(format!("{EXAMPLES}/example.op")).unwrap();
    let options = example
        .replace("500 400", "20 16")
        .replace("NSECRAYSROOT 100", "NSECRAYSROOT 3")
        .replace("PRECOMPUTED 90", "PRECOMPUTED 3")
        .replace("IMGRES 800", "IMGRES 64")
        .replace("VIEWER 0.5 0.5 1", "VIEWER 1 2 8");
    std::fs::write(path("a.op"), &options).unwrap();
    std::fs::copy(format!("{EXAMPLES}/box.grf"), path("escena.grf")).unwrap();
    let render = |arguments: &[&str]| {
        let command = [&["render", "--options", "a.op"], arguments].concat();
        run_in(folder.path(), &command, "")
    };
    let document = json(&succeeds(render(&["--json", "-"])));
    let results = &document["results"];
    let sampler = results["samplers"][0]["sampler"].as_str().unwrap();
    for setting in ["tables=3", "n-max=1.7", "grid=64"] {
        assert!(sampler.contains(setting), "{sampler}");
    }
    assert_eq!(
        (&results["width"], &results["height"]),
        (&20.into(), &16.into())
    );
    assert!(path("buzon.exr").exists() && path("buzon.png").exists());
    // Nine directions at each vertex: more draws than camera rays.
    assert!(
        results["draws"]["directions"].as_u64().unwrap() >= 9,
        "{document}"
    );
    // The command line goes before the file, in everything.
    let document = json(&succeeds(render(&[
        "--size",
        "8x8",
        "--sampler",
        "cosine",
        "--directions",
        "1",
        "-o",
        "mine",
        "--json",
        "-",
    ])));
    assert_eq!(document["results"]["width"], 8);
    assert_eq!(document["results"]["samplers"][0]["sampler"], "cosine");
    assert!(path("mine.exr").exists());
    let other = options.replace("escena.grf", "nowhere.grf");
    for (text, arguments, complaint) in [
        (
            options.replace("BPT_DEPTH", "BPT_DEEP"),
            &[][..],
            "a.op, line 12: there is no key BPT_DEEP",
        ),
        (other, &[], "nowhere.grf"),
        (String::new(), &[], "names no scene"),
        (
            options.clone(),
            &["nickel"],
            "--options without a scene file",
        ),
    ] {
        std::fs::write(path("a.op"), text).unwrap();
        let error = fails(render(arguments));
        assert!(error.contains(complaint), "{error}");
    }
}

/// A lamp of two triangles lights a floor below it.
#[test]
fn meshes_emit_light() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = |at: &str, look: &str| {
        format!(
            "transform translation {at} begin begin mesh {look} begin vertexs (-1,0,-1) (1,0,-1) (1,0,1) (-1,0,1) end vertexs \
             begin faces (0,1,2,3) end faces end mesh end\n"
        )
    };
    let draw = |look: &str, options: &[&str]| {
        let text = mesh("(0,0,0)", "brdf diffuse kd=0.5") + &mesh("(0,1,0)", look);
        std::fs::write(folder.path().join("a.grf"), text).unwrap();
        let quick = [
            "render",
            "a.grf",
            "--size",
            "24x24",
            "--spp",
            "16",
            "--force",
            "--eye",
            "0,0.5,6",
            "--look-at",
            "0,0.4,0",
        ];
        succeeds(run_in(folder.path(), &[&quick[..], options].concat(), ""));
        mean(folder.path())
    };
    let lit = draw("emission (2,1,0.5)", &["--background", "black"]);
    assert!(lit.x > 0.02 && (lit.x / lit.y - 2.0).abs() < 0.3, "{lit}");
    let more = draw("emission (4,2,1)", &["--background", "black"]);
    assert!(
        (more / lit - Rgb::splat(2.0)).abs().max_element() < 0.05,
        "{more} {lit}"
    );
    // Lights of the command line replace those of objects.
    let other = draw(
        "emission (4,2,1)",
        &["--background", "black", "--light", "point:0,0.5,0,0"],
    );
    assert!(other.max_element() < 1e-6, "{other}");
}
