//! Scenes that a file describes.

use std::fs;
use std::path::Path;

use merlkit::image::Image;

use crate::run::{fails, pixels, run_in, succeeds};

const ROOM: &str = include_str!("../../tools/scene/scenes/room.toml");

const PAGE: &str = include_str!("../../docs/scenes.md");

/// The examples of the page.
fn examples() -> Vec<String> {
    let blocks = PAGE.split("```toml\n").skip(1);
    blocks
        .map(|block| block.split("```").next().unwrap().to_owned())
        .collect()
}

fn render(folder: &Path, options: &str) -> Image {
    let command = format!("render scene.toml --force {options}");
    let arguments: Vec<&str> = command.split_whitespace().collect();
    succeeds(run_in(folder, &arguments, ""));
    pixels(folder)
}

#[test]
fn the_examples_of_the_page_are_rendered() {
    let examples = examples();
    assert_eq!(examples.len(), 2);
    for text in examples {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("scene.toml"), &text).unwrap();
        let image = render(folder.path(), "--size 24x18 --spp 2 --sampler cosine");
        assert_eq!((image.width(), image.height()), (24, 18));
        let lit = image
            .pixels()
            .iter()
            .filter(|pixel| pixel.max_element() > 0.01);
        assert!(lit.count() > 40);
    }
}

#[test]
fn the_command_line_comes_before_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let text = ROOM.replace("size = [256, 256]\nspp = 64", "size = [12, 10]\nspp = 2");
    fs::write(folder.path().join("scene.toml"), text).unwrap();
    let image = render(folder.path(), "");
    assert_eq!((image.width(), image.height()), (12, 10));
    // What is said twice, the command line says.
    let other = render(folder.path(), "--size 8x9 --spp 4");
    assert_eq!((other.width(), other.height()), (8, 9));
    let same = render(
        folder.path(),
        "--spp 2 --bounces 8 --eye 278,273,-800 --look-at 278,273,0",
    );
    assert_eq!(same.pixels(), image.pixels());
    for option in [
        "--bounces 1",
        "--light point:278,300,200",
        "--look-at 278,100,0",
        "--fov 60",
    ] {
        assert_ne!(
            render(folder.path(), option).pixels(),
            image.pixels(),
            "{option}"
        );
    }
}

#[test]
fn plans_are_explained() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.toml"), ROOM).unwrap();
    let arguments = [
        "render",
        "scene.toml",
        "--explain",
        "--size",
        "8x8",
        "--spp",
        "1",
    ];
    let words = succeeds(run_in(folder.path(), &arguments, ""));
    let shadows = words
        .lines()
        .find(|line| line.contains("shadow rays"))
        .unwrap();
    assert!(
        shadows.contains("off") && shadows.contains("a plane is between"),
        "{shadows}"
    );
}

/// A mesh file is searched in the folder of the scene, and its floor gives the picture of the quad.
#[test]
fn a_mesh_file_is_the_room_of_quads() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.toml"), ROOM).unwrap();
    let options = "--size 12x12 --spp 4 --bounces 2";
    let quads = render(folder.path(), options);
    let floor = "v 0 0 0\nv 556 0 0\nv 556 0 559.2\nv 0 0 559.2\nf 1 2 3 4\n";
    fs::create_dir(folder.path().join("meshes")).unwrap();
    fs::write(folder.path().join("meshes/floor.obj"), floor).unwrap();
    let quad = "shape = \"quad\"\ncorner = [0, 0, 0]\nedge_u = [556, 0, 0]\nedge_v = [0, 0, 559.2]";
    assert!(ROOM.contains(quad));
    let text = ROOM.replace(quad, "shape = \"mesh\"\nfile = \"meshes/floor.obj\"");
    fs::write(folder.path().join("scene.toml"), text).unwrap();
    let mesh = render(folder.path(), options);
    for (a, b) in quads.pixels().iter().zip(mesh.pixels()) {
        assert!(
            (*a - *b).abs().max_element() < 0.02 * a.max_element() + 1e-4,
            "{a} {b}"
        );
    }
}

#[test]
fn faults_are_told_with_their_line() {
    let folder = tempfile::tempdir().unwrap();
    for (from, to, words) in [
        (
            "look_at",
            "lookat",
            "line 8: there is no key \"lookat\" here; did you mean \"look_at\"?",
        ),
        (
            "kind = \"area\"",
            "kind = \"aera\"",
            "did you mean \"area\"?",
        ),
        (
            "shape = \"quad\"",
            "shape = \"mesh\"\nfile = \"x.obj\"",
            "corner has no meaning",
        ),
        ("[256, 256]", "[256, 0]", "0"),
        (
            "material = \"red\"",
            "material = \"rad\"",
            "did you mean \"red\"?",
        ),
        ("fov = 39.3", "fov = 180", "field of view"),
    ] {
        let text = ROOM.replace(from, to);
        assert_ne!(text, ROOM);
        fs::write(folder.path().join("scene.toml"), text).unwrap();
        let error = fails(run_in(folder.path(), &["render", "scene.toml"], ""));
        assert!(error.contains(words), "{to}: {error}");
    }
    fs::write(folder.path().join("scene.toml"), ROOM).unwrap();
    let error = fails(run_in(
        folder.path(),
        &["render", "scene.toml", "nickel"],
        "",
    ));
    assert!(error.contains("name the scene file alone"), "{error}");
    let error = fails(run_in(
        folder.path(),
        &["render", "scene.toml", "--elevation", "9"],
        "",
    ));
    assert!(error.contains("--eye"), "{error}");
}
