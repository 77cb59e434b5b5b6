//! `merlkit sheet`.

use std::fs;
use std::path::Path;

use merlkit::image::{Image, read_exr};

use crate::run::{fails, run_in, succeeds};

const QUICK: &str = "--sampler cosine --size 24 --spp 4";

fn sheet(folder: &Path, materials: &str, more: &str) -> Image {
    let command = format!("sheet {materials} {QUICK} {more} -o s");
    let arguments: Vec<&str> = command.split_whitespace().collect();
    succeeds(run_in(folder, &arguments, ""));
    read_exr(&folder.join("s.exr")).unwrap()
}

/// The pixels of a tile, whose upper left corner is given.
fn tile(sheet: &Image, left: usize, top: usize) -> Vec<[f32; 3]> {
    let mut pixels = Vec::new();
    for y in 0..24 {
        for x in 0..24 {
            pixels.push(sheet.pixel(left + x, top + y).to_array());
        }
    }
    pixels
}

#[test]
fn a_sphere_has_the_same_pixels_beside_any_neighbours() {
    let folder = tempfile::tempdir().unwrap();
    let three = "lambert:reflectance=0.2 lambert:reflectance=0.8 ward";
    let grid = sheet(folder.path(), three, "--columns 2");
    // Two columns and rows of 24 pixels with gaps of 4, and 12 more for each name.
    assert_eq!((grid.width(), grid.height()), (60, 84));
    let alone = sheet(folder.path(), "ward", "--force --no-labels");
    assert_eq!((alone.width(), alone.height()), (32, 32));
    assert_eq!(tile(&alone, 4, 4), tile(&grid, 4, 44));
    assert!(tile(&grid, 4, 4) != tile(&grid, 32, 4));
    assert!(folder.path().join("s.png").exists());
    assert!(!folder.path().join("s.tiles").exists());
}

/// A mistake leaves nothing in the way of the next run.
#[test]
fn a_sheet_that_fails_leaves_no_folder() {
    let folder = tempfile::tempdir().unwrap();
    for mistake in [
        ["--light", "nonsense"],
        ["--light", "nowhere.exr"],
        ["--sampler", "file"],
    ] {
        let command = [&["sheet", "lambert", "-o", "s"][..], &mistake].concat();
        fails(run_in(folder.path(), &command, ""));
        assert!(!folder.path().join("s.tiles").exists(), "{mistake:?}");
    }
}

#[cfg(unix)]
#[test]
fn a_stopped_sheet_goes_on_to_the_same_bytes() {
    use std::time::Duration;

    use crate::writing::Running;

    let folder = tempfile::tempdir().unwrap();
    let spheres: Vec<String> = (1..=9)
        .map(|i| format!("lambert:reflectance=0.{i}"))
        .collect();
    let command = format!(
        "sheet {} --sampler cosine --size 160 --spp 64 -o s",
        spheres.join(" ")
    );
    let arguments: Vec<&str> = command.split(' ').collect();
    let running = Running::start(folder.path(), &arguments);
    let tiles = folder.path().join("s.tiles");
    // The settings and the first sphere.
    while fs::read_dir(&tiles).map_or(0, Iterator::count) < 2 {
        std::thread::sleep(Duration::from_millis(2));
    }
    let (_, messages) = running.signal("-INT", 130);
    assert!(messages.contains("of 9 spheres are kept"), "{messages}");

    let again = fails(run_in(folder.path(), &arguments, ""));
    assert!(again.contains("continue with --resume"), "{again}");
    let other = [&arguments[..], &["--resume", "--seed", "1"]].concat();
    assert!(fails(run_in(folder.path(), &other, "")).contains("other settings"));
    let resumed = [&arguments[..], &["--resume"]].concat();
    succeeds(run_in(folder.path(), &resumed, ""));
    let bytes = || ["s.exr", "s.png"].map(|name| fs::read(folder.path().join(name)).unwrap());
    let kept = bytes();
    succeeds(run_in(
        folder.path(),
        &[&arguments[..], &["--force"]].concat(),
        "",
    ));
    assert!(bytes() == kept);
    assert!(fails(run_in(folder.path(), &resumed, "")).contains("nothing to resume"));
}
