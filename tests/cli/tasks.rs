//! People's tasks as scripts: they run, and leave the files that they promise. How long they took is printed, never asserted.

use std::path::Path;
use std::process::Command;

use assert_cmd::cargo::cargo_bin;

use crate::run::{json, run_in, succeeds};

/// Runs a script on a folder of two MERL binaries, and gives the folder that it wrote.
fn run_task(name: &str) -> Option<tempfile::TempDir> {
    if !cfg!(unix) {
        eprintln!("skipped: the scripts need bash");
        return None;
    }
    let folder = tempfile::tempdir().unwrap();
    let decode = ["decode", "nickel", "red-plastic", "-o", "brdfs"];
    succeeds(run_in(folder.path(), &decode, ""));
    let script = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/tasks")
        .join(name);
    let output = Command::new("bash")
        .arg(script.join("run.sh"))
        .args(["brdfs", "out"])
        .current_dir(folder.path())
        .env("MERLKIT", cargo_bin!("merlkit"))
        .output()
        .unwrap();
    let printed = String::from_utf8(output.stdout).unwrap();
    let complaints = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{printed}{complaints}");
    for line in printed.lines().filter(|line| line.contains(" s  ")) {
        println!("{name}: {line}");
    }
    Some(folder)
}

/// The lines of a CSV file below its heading.
fn csv_rows(folder: &Path, name: &str) -> Vec<String> {
    let text = std::fs::read_to_string(folder.join("out").join(name)).unwrap();
    text.lines().skip(1).map(str::to_owned).collect()
}

#[test]
fn a_student_makes_figures_of_a_folder() {
    let Some(folder) = run_task("student") else {
        return;
    };
    for (file, begins) in [
        ("lobes.pdf", &b"%PDF-"[..]),
        ("albedo.pdf", b"%PDF-"),
        ("lobes-polar.png", b"\x89PNG"),
        ("solids.png", b"\x89PNG"),
        ("spheres.png", b"\x89PNG"),
        ("rougher.png", b"\x89PNG"),
    ] {
        let bytes = std::fs::read(folder.path().join("out").join(file)).unwrap();
        assert!(bytes.starts_with(begins) && bytes.len() > 2000, "{file}");
    }
    let solids = merlkit::image::read_image(&folder.path().join("out/solids.png")).unwrap();
    assert_eq!(solids.width(), 1600);
}

#[test]
fn a_renderer_author_has_materials_by_name() {
    let compiler = Command::new("c++").arg("--version").output();
    if !compiler.is_ok_and(|found| found.status.success()) {
        eprintln!("skipped: there is no c++");
        return;
    }
    let Some(folder) = run_task("renderer") else {
        return;
    };
    let out = folder.path().join("out");
    let picture = std::fs::read(out.join("picture.pfm")).unwrap();
    // Two spheres beside each other, three floats a pixel.
    let head = b"PF\n192 96\n-1.0\n";
    assert_eq!(picture.len(), head.len() + 12 * 192 * 96);
    assert!(picture.starts_with(head));
    assert!(out.join("red-plastic.merlkit").exists());
}

#[test]
fn a_researcher_makes_tables_of_a_folder() {
    let Some(folder) = run_task("researcher") else {
        return;
    };
    let names = ["nickel", "red-plastic"];
    for (file, rows_of_each) in [("albedos.csv", 4), ("samplers.csv", 4), ("fits.csv", 2)] {
        let rows = csv_rows(folder.path(), file);
        for name in names {
            let own = rows.iter().filter(|row| row.starts_with(name));
            assert!(own.count() >= rows_of_each, "{file}: {name}");
        }
    }
    for file in ["facts.json", "samplers.json", "fits.json"] {
        let text = std::fs::read_to_string(folder.path().join("out").join(file)).unwrap();
        json(&text);
    }
    // A fit in the table is a material.
    let row = csv_rows(folder.path(), "fits.csv").swap_remove(0);
    let fit = row.split('"').nth(1).unwrap();
    let arguments = ["eval", fit, "--wo", "30,0", "--wi", "30,180"];
    succeeds(run_in(folder.path(), &arguments, ""));
}
