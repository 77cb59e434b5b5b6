//! Memory of whole processes, as the system counts it: loading, building, a report of many materials, and a render.
#![cfg(target_os = "linux")]

use std::path::Path;
use std::process::{Command, Stdio};

use assert_cmd::cargo::cargo_bin;

/// A table of 90 × 90 × 180 cells of four `f32`.
const TABLE: u64 = 90 * 90 * 180 * 16;
const MB: u64 = 1 << 20;
/// All else: code, threads, the allocator's slack.
const PROGRAM: u64 = 24 * MB;

/// Runs `merlkit` and returns the most memory that it held, in bytes.
///
/// The system keeps the peak, so that looking now and then misses only what grows in the last two milliseconds of a command
/// that spends far longer on what comes after its tables.
fn peak(folder: &Path, arguments: &[&str]) -> u64 {
    let mut child = Command::new(cargo_bin!("merlkit"))
        .args(arguments)
        .args(["--threads", "2"])
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    loop {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let kilobytes = text
            .lines()
            .find_map(|l| l.strip_prefix("VmHWM:"))
            .and_then(|l| {
                l.trim()
                    .strip_suffix(" kB")
                    .and_then(|n| n.parse::<u64>().ok())
            });
        peak = peak.max(kilobytes.unwrap_or_default() << 10);
        if let Some(status) = child.try_wait().unwrap() {
            assert!(status.success(), "{arguments:?}");
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    println!("{:.1} MB: {}", peak as f64 / 1e6, arguments.join(" "));
    assert!(peak > 0, "the system tells no peak");
    peak
}

/// The table and what it is read through, whatever the file's length.
#[test]
fn a_loaded_material_takes_its_table() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| peak(folder.path(), arguments);
    assert!(
        run(&["decode", "nickel", "-o", "."]) > TABLE,
        "the measure sees a table"
    );
    let loaded = run(&["info", "nickel.binary"]);
    assert!(loaded > TABLE && loaded < TABLE + PROGRAM, "{loaded}");
}

#[test]
fn built_samplers_stay_small() {
    let folder = tempfile::tempdir().unwrap();
    for sampler in ["adaptive-disc", "cascade-cdf"] {
        assert!(
            peak(
                folder.path(),
                &["build", "nickel", "--sampler", sampler, "-o", sampler]
            ) < 160 * MB
        );
    }
}

/// Finished materials leave their figures and nothing else.
#[test]
fn a_report_of_many_materials_takes_no_more_than_one_of_few() {
    let folder = tempfile::tempdir().unwrap();
    let names = [
        "nickel",
        "red-plastic",
        "pvc",
        "teflon",
        "beige-fabric",
        "chrome",
        "aluminium",
        "alum-bronze",
    ];
    let options = [
        "--draws",
        "100",
        "--sampler",
        "cosine",
        "--sampler",
        "cascade-cdf:tables=2",
    ];
    let report = |count: usize| {
        peak(
            folder.path(),
            &[&["report"], &names[..count], &options[..]].concat(),
        )
    };
    let (few, many) = (report(2), report(8));
    assert!(
        many < few + TABLE,
        "{few} bytes for 2 materials, {many} for 8"
    );
    assert!(many < 300_000_000, "{many}");
}

#[test]
fn a_render_holds_one_table_a_material_of_a_scene() {
    let folder = tempfile::tempdir().unwrap();
    let render = |materials: &[&str]| {
        let options = [
            "--light", "point", "--size", "240x80", "--spp", "64", "--force",
        ];
        peak(
            folder.path(),
            &[&["render"], materials, &options[..]].concat(),
        )
    };
    let one = render(&["nickel"]);
    let same = render(&["nickel", "nickel", "nickel"]);
    let three = render(&["nickel", "red-plastic", "pvc", "--together"]);
    let apart = render(&["nickel", "red-plastic", "pvc"]);
    assert!(
        same < one + TABLE / 2,
        "{one} bytes for one ball, {same} for three of one material"
    );
    assert!(
        three > one + 3 * TABLE / 2,
        "{one} bytes for one material, {three} for three"
    );
    // The table of a sphere that is drawn, and of the next while it is loaded.
    assert!(
        apart < one + 3 * TABLE / 2,
        "{one} bytes for one material, {apart} for three apart"
    );
    // An embedded material's colours stand beside its table while it is decoded.
    let decoding = TABLE / 4 * 3;
    assert!(
        three < 3 * TABLE + decoding + PROGRAM,
        "{three} bytes for three materials"
    );
}
