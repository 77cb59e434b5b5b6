//! `--table`: the format of cells in the commands that read tables.

use std::path::Path;

use merlkit::files::Overwrite;
use merlkit::material::merl::{Header, MerlTable, write};

use crate::run::{fails, json, run_in};

/// Standard output and standard error of a command that succeeds.
fn answers(folder: &Path, command: &str) -> (String, String) {
    let arguments: Vec<&str> = command.split(' ').collect();
    let output = run_in(folder, &arguments, "");
    let [out, notes] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    assert_eq!(output.status.code(), Some(0), "{command}: {notes}");
    (out, notes)
}

/// Standard error of a command that is refused.
fn refusal(folder: &Path, command: &str) -> String {
    let arguments: Vec<&str> = command.split(' ').collect();
    fails(run_in(folder, &arguments, ""))
}

#[test]
fn info_measures_what_compact_cells_cost() {
    let folder = Path::new(".");
    let (out, notes) = answers(folder, "info nickel --table f16 --json -");
    assert!(notes.contains("the table is kept in f16 cells"), "{notes}");
    let document = json(&out);
    let facts = &document["results"][0];
    let table = &facts["table"];
    assert_eq!(facts["reading"], "floor lookup in f16 cells");
    assert_eq!(table["cell_format"], "f16");
    assert_eq!(table["table_bytes"], 11_664_000);
    for error in table["rounding_errors"].as_array().unwrap() {
        let greatest = error["greatest"].as_f64().unwrap();
        let median = error["median"].as_f64().unwrap();
        assert!(0.0 < median && median < greatest && greatest < 4.9e-4);
        assert_eq!(error["zeroed"], 0);
    }
    let (sheet, _) = answers(folder, "info nickel --table rgb9e5");
    assert!(sheet.contains("relative error, median") && sheet.contains("5832000"));
    let (exact, notes) = answers(folder, "info nickel --table f32 --json -");
    assert!(json(&exact)["results"][0]["table"]["rounding_errors"].is_null());
    assert!(notes.is_empty(), "{notes}");
}

#[test]
fn every_command_that_reads_tables_takes_the_format() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for command in [
        "eval nickel --wo 30,0 --wi 32.5,180 --lookup linear",
        "sample nickel --theta 20 --count 3",
        "build nickel --sampler half-vector:2KB -o nickel.table",
        "decode nickel -o rounded",
        "report nickel --sampler cosine --draws 100",
        "plot nickel --kind lobe -o lobe.svg",
        "render nickel --size 8x8 --spp 1 -o picture",
        "export nickel --format npz --sampler half-vector:2KB -o out",
        "check nickel --sampler half-vector:2KB --draws 10000",
        "tune nickel --target-error 50% --max-bytes 3000",
    ] {
        let (out, notes) = answers(folder, &format!("{command} --table f16"));
        // `decode` says nothing of a material.
        let says = notes.contains("kept in f16 cells") || command.starts_with("decode");
        assert!(says, "{command}: {notes}");
        if command.starts_with("report") {
            let legend = "floor lookup in f16 cells (relative errors";
            assert!(out.contains(legend) && out.contains("11.7 MB"), "{out}");
        }
    }
    // A sampler file brings the format that it was built with.
    let (out, _) = answers(folder, "info nickel.table");
    assert!(out.contains("f16"), "{out}");
    let (_, notes) = answers(folder, "sample nickel.table --theta 20 --count 3");
    assert!(notes.contains("kept in f16 cells"), "{notes}");
    let text = refusal(
        folder,
        "sample nickel.table --theta 20 --count 3 --table f32",
    );
    assert!(text.contains("omit --table"), "{text}");
}

#[test]
fn a_table_with_partial_cells_is_refused_once_and_clearly() {
    let folder = tempfile::tempdir().unwrap();
    let header = Header { phi_d_bins: 180 };
    let table = MerlTable::from_fn(header, |_, _, _| [0.2; 3]);
    let path = folder.path().join("torn.binary");
    write(&table, &path, Overwrite::Refuse).unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    bytes[12..20].copy_from_slice(&(-1f64).to_le_bytes());
    std::fs::write(&path, bytes).unwrap();
    let command = "eval torn.binary --wo 20,0 --wi 20,0 --table f16";
    let text = refusal(folder.path(), &format!("{command} --invalid channel"));
    assert!(
        text.contains("1 cells hold a value in some channels only") && text.contains("--table f32"),
        "{text}"
    );
    answers(folder.path(), command);
}
