//! `merlkit export --format header|npz` on the command line.

use std::path::Path;
use std::process::{Command, Output};

use assert_cmd::cargo::cargo_bin;
use merlkit::material::merl::Header;

fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(cargo_bin!("merlkit"))
        .arg("export")
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn succeeds(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    assert!(
        output.status.success(),
        "{arguments:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).unwrap()
}

fn fails(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    assert_eq!(
        (output.status.code(), output.stdout.len()),
        (Some(2), 0),
        "{arguments:?}"
    );
    String::from_utf8(output.stderr).unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = folder
        .read_dir()
        .into_iter()
        .flatten()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn options_of_other_formats_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for format in ["header", "runtime", "npz"] {
        for option in [
            ["--variant", "rgb"],
            ["--size", "6MB"],
            ["--target-error", "0.1%"],
        ] {
            let said = fails(
                folder.path(),
                &[
                    "nickel", "--format", format, option[0], option[1], "-o", "out",
                ],
            );
            let expected = format!("{} does not apply to --format {format}", option[0]);
            assert!(
                said.contains(&expected) && said.contains("--format bsdf"),
                "{said}"
            );
        }
    }
    let said = fails(
        folder.path(),
        &[
            "nickel",
            "--format",
            "bsdf",
            "--sampler",
            "half-vector:2KB",
            "-o",
            "out",
        ],
    );
    assert!(
        said.contains("--sampler does not apply to --format bsdf"),
        "{said}"
    );
    assert!(
        said.contains("choose --format header, runtime or npz"),
        "{said}"
    );
    let said = fails(
        folder.path(),
        &[
            "nickel",
            "--format",
            "header",
            "--sampler",
            "half-vector:3KB",
            "-o",
            "out",
        ],
    );
    assert!(said.contains("called 3KB; did you mean"), "{said}");
    assert!(
        fails(folder.path(), &["nickel", "--format", "h", "-o", "out"])
            .contains("bsdf, npz, header, runtime")
    );
    assert!(names(folder.path()).is_empty());
}

#[test]
fn files_are_named_described_and_replaced_only_by_force() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("new/out");
    let arguments = [
        "nickel",
        "--format",
        "header",
        "--sampler",
        "half-vector:2kb",
        "-o",
        "new/out",
    ];
    std::fs::create_dir(folder.path().join("new")).unwrap();
    let said = succeeds(folder.path(), &arguments);
    assert_eq!(names(&out), ["nickel.f32", "nickel.h"]);
    let rows: Vec<Vec<&str>> = said
        .lines()
        .skip(2)
        .map(|l| l.trim_matches('|').split('|').map(str::trim).collect())
        .collect();
    assert_eq!(rows.len(), 2, "{said}");
    assert!(
        rows[0][0].ends_with("nickel.f32") && rows[0][1..] == ["17.50", "f_r for eval", "-"],
        "{said}"
    );
    assert!(
        rows[1][0].ends_with("nickel.h") && rows[1][2] == "sample, pdf, eval",
        "{said}"
    );
    let spread: Vec<f64> = rows[1][3]
        .split(" to ")
        .map(|x| x.parse().unwrap())
        .collect();
    // Of mean RGB, as `report` has it; that of luminance ends at 0.171.
    assert!(said.contains("relstd of mean RGB"), "{said}");
    assert_eq!(spread, [0.048, 0.176], "{said}");

    // One of two that exist is enough, and nothing is touched.
    std::fs::write(out.join("nickel.h"), "mine").unwrap();
    std::fs::remove_file(out.join("nickel.f32")).unwrap();
    let refused = fails(folder.path(), &arguments);
    assert!(
        refused.contains("nickel.h exists; pass --force"),
        "{refused}"
    );
    assert_eq!(
        (
            names(&out).len(),
            std::fs::read(out.join("nickel.h")).unwrap()
        ),
        (1, b"mine".to_vec())
    );
    assert_eq!(
        succeeds(folder.path(), &[&arguments[..], &["--force"]].concat()),
        said
    );
    assert_eq!(names(&out), ["nickel.f32", "nickel.h"]);
    assert_eq!(
        out.join("nickel.f32").metadata().unwrap().len(),
        4 * 3 * 90 * 90 * 180
    );

    // The rule is floor unless another is named; an archive goes beside the header.
    let header = || std::fs::read_to_string(out.join("nickel.h")).unwrap();
    assert!(header().contains("by the floor lookup"));
    succeeds(
        folder.path(),
        &[&arguments[..], &["--force", "--lookup", "linear"]].concat(),
    );
    assert!(header().contains("by the linear lookup"));
    let said = succeeds(
        folder.path(),
        &[
            "nickel",
            "--format",
            "npz",
            "--sampler",
            "half-vector:2KB",
            "-o",
            "new/out",
        ],
    );
    assert!(
        said.contains("nickel.npz") && said.contains("half-vector table, f_r"),
        "{said}"
    );
    assert_eq!(names(&out), ["nickel.f32", "nickel.h", "nickel.npz"]);
    assert!(
        fails(
            folder.path(),
            &["nickel", "--format", "npz", "-o", "new/out"]
        )
        .contains("nickel.npz exists")
    );
}

/// One folder takes files of many materials and has the code once.
#[test]
fn run_time_code_is_written_once_and_replaced_only_by_force() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = |material| {
        let more = ["--format", "runtime", "--sampler", "half-vector:2KB"];
        [&[material][..], &more, &["-o", "."]].concat()
    };
    let said = succeeds(folder.path(), &arguments("nickel"));
    assert!(
        said.contains("nickel.merlkit") && said.contains("merlkit.wgsl"),
        "{said}"
    );
    let said = succeeds(folder.path(), &arguments("teflon"));
    assert!(
        said.contains("teflon.merlkit") && !said.contains("merlkit.h"),
        "{said}"
    );
    let code = ["merlkit.glsl", "merlkit.h", "merlkit.hlsl", "merlkit.wgsl"];
    let all = [&code[..], &["nickel.merlkit", "teflon.merlkit"]].concat();
    assert_eq!(names(folder.path()), all);
    // Code of another version is not replaced in silence, and then nothing else is written.
    let header = folder.path().join("merlkit.h");
    std::fs::write(&header, "mine").unwrap();
    let refused = fails(folder.path(), &arguments("chrome"));
    assert!(
        refused.contains("merlkit.h exists; pass --force"),
        "{refused}"
    );
    assert_eq!(names(folder.path()), all);
    succeeds(
        folder.path(),
        &[&arguments("chrome")[..], &["--force"]].concat(),
    );
    assert_ne!(std::fs::read(&header).unwrap(), b"mine");
}

#[test]
fn headers_that_could_not_be_included_together_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a-b.binary", "a_b.binary"] {
        // A table of zeros, of which the disk holds the header alone.
        let path = folder.path().join(name);
        let header = Header { phi_d_bins: 180 };
        std::fs::write(&path, header.to_bytes()).unwrap();
        let file = std::fs::OpenOptions::new().write(true).open(&path).unwrap();
        file.set_len(header.file_bytes()).unwrap();
    }
    let said = fails(
        folder.path(),
        &["a-b.binary", "a_b.binary", "--format", "header", "-o", "."],
    );
    assert!(
        said.contains("a-b and a_b would have functions of the same names"),
        "{said}"
    );
    assert_eq!(names(folder.path()), ["a-b.binary", "a_b.binary"]);
    // Files that can't be read are named, all of them.
    std::fs::write(folder.path().join("a_b.binary"), "").unwrap();
    std::fs::write(folder.path().join("a-b.binary"), "").unwrap();
    let said = fails(
        folder.path(),
        &["a-b.binary", "a_b.binary", "--format", "npz", "-o", "."],
    );
    assert_eq!(said.matches("12-byte header").count(), 2, "{said}");
    assert_eq!(names(folder.path()), ["a-b.binary", "a_b.binary"]);
}
