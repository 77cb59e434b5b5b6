//! `merlkit import` of grids of directions, and `--invalid` in the commands that read tables.

use std::f64::consts::FRAC_1_PI;
use std::path::Path;

use merlkit::files::Overwrite;
use merlkit::material::merl::{Header, MerlTable, write};

use crate::grid_files::{pbsdf_fields, tensor_file, utia_file};
use crate::run::{fails, run_in};

/// Standard output and standard error of a command that succeeds.
fn answers(folder: &Path, command: &str) -> (String, String) {
    let arguments: Vec<&str> = command.split(' ').collect();
    let output = run_in(folder, &arguments, "");
    let [out, notes] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    assert_eq!(output.status.code(), Some(0), "{command}: {notes}");
    (out, notes)
}

#[test]
fn polarised_files_are_imported_without_their_polarisation() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = tensor_file(&pbsdf_fields([13, 7, 7], &|_, _, _| FRAC_1_PI));
    std::fs::write(folder.path().join("grey.pbsdf"), bytes).unwrap();
    let (out, notes) = answers(folder.path(), "import grey.pbsdf -o grey.binary");
    assert!(notes.contains("polarisation was left out"), "{notes}");
    assert!(
        out.contains(
            "median difference between the measurements and the table under floor lookup: 0.000 %"
        ),
        "{out}"
    );
    let (value, _) = answers(folder.path(), "eval grey.binary --wo 20,0 --wi 60,130");
    assert!(
        value.contains("0.31830987,0.31830987,0.31830987"),
        "{value}"
    );
    for command in ["info grey.pbsdf", "eval grey.pbsdf --wo 0,0 --wi 0,0"] {
        let arguments: Vec<&str> = command.split(' ').collect();
        let text = fails(run_in(folder.path(), &arguments, ""));
        assert!(
            text.contains("(.pbsdf) is not supported; `merlkit import`"),
            "{text}"
        );
    }
    let with_unit = ["import", "grey.pbsdf", "-o", "b", "--angles", "degrees"];
    assert!(fails(run_in(folder.path(), &with_unit, "")).contains("is not a list"));
}

#[test]
fn utia_files_are_imported_without_their_anisotropy() {
    let folder = tempfile::tempdir().unwrap();
    let grey = utia_file(&|_, wi| [if wi.x > 0.1 { 0.3 } else { 0.1 }; 3]);
    std::fs::write(folder.path().join("m001.bin"), grey).unwrap();
    let (out, notes) = answers(folder.path(), "import m001.bin --fill -o m001.binary");
    assert!(
        notes.contains("anisotropy was left out") && notes.contains("nothing was measured beyond"),
        "{notes}"
    );
    assert!(notes.contains("were filled in from others"), "{notes}");
    assert!(out.contains("measured directions: 82944"), "{out}");
    let text = fails(run_in(folder.path(), &["info", "m001.bin"], ""));
    assert!(
        text.contains("UTIA") && text.contains("`merlkit import`"),
        "{text}"
    );
}

/// A table of 0.2 whose blue is invalid in all cells of the first ten bins of θh.
fn write_blue_gap(folder: &Path) {
    let path = folder.join("torn.binary");
    let table = MerlTable::from_fn(Header { phi_d_bins: 180 }, |_, _, _| [0.2; 3]);
    write(&table, &path, Overwrite::Refuse).unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    let blue = 12 + 8 * 2 * 90 * 90 * 180;
    for cell in 0..10 * 90 * 180 {
        bytes[blue + 8 * cell..][..8].copy_from_slice(&(-1f64).to_le_bytes());
    }
    std::fs::write(&path, bytes).unwrap();
}

#[test]
fn invalid_channels_are_read_as_the_option_says() {
    let folder = tempfile::tempdir().unwrap();
    write_blue_gap(folder.path());
    let pair = "--wo 20,0 --wi 20,180";
    let torn = "162000 cells (11.11 % of the table) with unusable values in some channels";
    for (option, value, rule) in [
        ("", "\n0.0,0.0,0.0\n", "cell"),
        (" --invalid cell", "\n0.0,0.0,0.0\n", "cell"),
        (" --invalid channel", "\n0.2,0.2,0.0\n", "channel"),
    ] {
        let (out, notes) = answers(folder.path(), &format!("eval torn.binary {pair}{option}"));
        assert!(out.contains(value), "{option}: {out}");
        assert!(
            notes.contains(torn) && notes.contains(&format!("as --invalid {rule} says")),
            "{notes}"
        );
        let (info, _) = answers(folder.path(), &format!("info torn.binary{option}"));
        let line = match rule {
            "cell" => "162000 (invalid as a whole)",
            _ => "162000 (invalid in these channels alone)",
        };
        assert!(info.contains(line), "{info}");
    }
    let (json, _) = answers(folder.path(), "info torn.binary --invalid channel --json -");
    assert!(
        json.contains("\"mixed_cells\": 162000") && json.contains("\"channels_apart\": true"),
        "{json}"
    );
    // A copy keeps the channels, and what is filled is the blue alone.
    answers(
        folder.path(),
        "decode torn.binary --invalid channel -o copy",
    );
    let copied = format!("eval copy/torn.binary {pair} --invalid channel");
    assert!(
        answers(folder.path(), &copied)
            .0
            .contains("\n0.2,0.2,0.0\n")
    );
    answers(
        folder.path(),
        "import torn.binary --fill --invalid channel -o filled.binary",
    );
    let filled = answers(folder.path(), &format!("eval filled.binary {pair}")).0;
    assert!(filled.contains("\n0.2,0.2,0.2\n"), "{filled}");
}

#[test]
fn every_command_that_reads_tables_takes_the_option() {
    let folder = tempfile::tempdir().unwrap();
    write_blue_gap(folder.path());
    for command in [
        "sample torn.binary --theta 20 --count 3",
        "build torn.binary --sampler half-vector:2KB -o torn.table",
        "report torn.binary --sampler cosine --draws 100",
        "plot torn.binary --kind lobe -o lobe.svg",
        "render torn.binary --size 8x8 --spp 1 -o picture",
        "export torn.binary --format npz --sampler half-vector:2KB -o out",
        "check torn.binary --sampler cosine --draws 1000",
        "tune torn.binary --target-error 50% --max-bytes 3000",
    ] {
        let (_, notes) = answers(folder.path(), &format!("{command} --invalid channel"));
        assert!(
            notes.contains("as --invalid channel says"),
            "{command}: {notes}"
        );
    }
    // A sampler file brings its own reading.
    let (out, _) = answers(folder.path(), "info torn.table");
    assert!(out.contains("channel"), "{out}");
    answers(folder.path(), "sample torn.table --theta 20 --count 3");
    let other = "sample torn.table --theta 20 --count 3 --invalid cell";
    let arguments: Vec<&str> = other.split(' ').collect();
    let text = fails(run_in(folder.path(), &arguments, ""));
    assert!(text.contains("omit --invalid"), "{text}");
    let linear = "export torn.binary --format header --lookup linear --invalid channel -o out";
    let arguments: Vec<&str> = linear.split(' ').collect();
    let text = fails(run_in(folder.path(), &arguments, ""));
    assert!(text.contains("cannot keep the channels"), "{text}");
}
