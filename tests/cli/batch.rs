//! Many materials at once: folders, and files that can't be read.
#![cfg(unix)]

use std::path::Path;

use merlkit::files::Overwrite;
use merlkit::material::merl::{Header, MerlTable, decode_embedded, write};
use tempfile::TempDir;

use crate::run::{run_in, without_timing};

/// A folder of five tables, three broken ones and a text.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let tables = folder.path().join("merl");
    std::fs::create_dir(&tables).unwrap();
    let header = Header { phi_d_bins: 180 };
    for k in 1..=4u32 {
        let table = MerlTable::from_fn(header, |_, _, _| [0.05 * f64::from(k); 3]);
        let path = tables.join(format!("grey-{k}.binary"));
        write(&table, &path, Overwrite::Refuse).unwrap();
    }
    let nickel = decode_embedded("nickel").unwrap();
    write(&nickel, &tables.join("nickel.binary"), Overwrite::Refuse).unwrap();
    let whole = std::fs::read(tables.join("grey-1.binary")).unwrap();
    std::fs::write(tables.join("cut.binary"), &whole[..1_000_000]).unwrap();
    std::fs::write(tables.join("empty.binary"), "").unwrap();
    std::fs::write(tables.join("page.binary"), "<html>not found</html>").unwrap();
    std::fs::write(tables.join("Readme.txt"), "about these files\n").unwrap();
    folder
}

/// Runs a command that ends with status 2 though it did what it could; returns what it printed and what it complained of.
fn partly(folder: &Path, command: &str) -> (String, String) {
    let arguments: Vec<&str> = command.split(' ').collect();
    let output = run_in(folder, &arguments, "");
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let (printed, complaints) = (text(output.stdout), text(output.stderr));
    assert_eq!(output.status.code(), Some(2), "{command}: {complaints}");
    (printed, complaints)
}

#[test]
fn a_batch_goes_on_past_bad_files() {
    let folder = folder();
    for command in [
        "info merl",
        "decode merl -o decoded",
        "build merl --sampler half-vector:2KB -o built",
        "report merl --sampler cosine --draws 100",
        "check merl --sampler cosine --draws 1000",
        "export merl --format npz --sampler half-vector:2KB -o exported",
    ] {
        let (_, complaints) = partly(folder.path(), command);
        let lines = without_timing(&complaints);
        assert_eq!(lines.len(), 5, "{command}: {complaints}");
        assert!(
            lines[0].contains("skipped files that are not materials: Readme.txt"),
            "{complaints}"
        );
        for (line, says) in lines[1..4].iter().zip(["cut off", "empty", "a web page"]) {
            assert!(
                line.starts_with("merlkit: merl/") && line.contains(says),
                "{complaints}"
            );
        }
        assert_eq!(lines[4], "merlkit: 3 of 8 materials could not be read");
    }
    for (made, count) in [("decoded", 5), ("built", 5), ("exported", 5)] {
        let files = std::fs::read_dir(folder.path().join(made)).unwrap();
        assert_eq!(files.count(), count, "{made}");
    }
    let (printed, _) = partly(folder.path(), "info merl/cut.binary merl/nickel.binary");
    assert!(printed.contains("| nickel"), "{printed}");
}

#[test]
fn a_folder_without_materials_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    let (_, complaints) = partly(folder.path(), "info empty");
    assert!(
        complaints.contains("empty has no materials in it"),
        "{complaints}"
    );
}
