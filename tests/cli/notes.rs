//! What commands say of a material unasked, and tables whose own measured error is absurd.

use std::path::Path;

use merlkit::brdf::Brdf;
use merlkit::files::Overwrite;
use merlkit::material::merl::{Header, MerlTable, decode_embedded, write};
use merlkit::material::rgl::{BsdfFile, BsdfSize, Colour, tabulate};
use merlkit::material::{LookupRule, MerlBrdf};

use crate::run::{run_in, succeeds};

/// A plaster table without values in the first three bins of θh.
fn write_blind_table(folder: &Path) {
    let header = Header { phi_d_bins: 180 };
    let value = |h: usize| {
        if h < 3 {
            -1.0
        } else {
            0.5 / std::f64::consts::PI
        }
    };
    let table = MerlTable::from_fn(header, |h, _, _| [value(h); 3]);
    write(&table, &folder.join("blind.binary"), Overwrite::Refuse).unwrap();
}

/// Standard error of a command that succeeds.
fn notes(folder: &Path, arguments: &str) -> String {
    let arguments: Vec<&str> = arguments.split(' ').collect();
    let output = run_in(folder, &arguments, "");
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{text}");
    text
}

#[test]
fn gaps_are_told_once_by_every_command() {
    let folder = tempfile::tempdir().unwrap();
    write_blind_table(folder.path());
    // Of the first three bins of θh, 90 × 180 cells each, those with a lower corner above the horizon.
    let expected = "merlkit: note: blind: 48600 cells above the horizon (3.33 % of the table) have no value; the floor rule \
                    reads them as 0\n";
    for command in [
        "eval blind.binary --wo 20,0 --wi 20,0",
        "info blind.binary",
        "sample blind.binary --theta 20 --count 3",
        "build blind.binary --sampler half-vector:2KB -o blind.table",
        "report blind.binary --sampler cosine --draws 100",
        "plot blind.binary --kind lobe -o lobe.svg",
        "render blind.binary --size 8x8 --spp 1 -o picture",
        "export blind.binary --format npz --sampler half-vector:2KB -o out",
    ] {
        // `report` may add a note on times that were unsteady.
        let found = notes(folder.path(), command);
        assert!(found.starts_with(expected), "{command}: {found}");
        assert_eq!(found.matches("above the horizon").count(), 1, "{command}");
    }
    let linear = notes(folder.path(), "info blind.binary --lookup linear");
    assert!(
        linear.contains("the linear rule takes the mean"),
        "{linear}"
    );
    let json = succeeds_with_notes(folder.path(), &["info", "blind.binary", "--json", "-"]);
    assert!(
        json.contains("\"notes\": [\n") && json.contains("48600 cells"),
        "{json}"
    );
    assert_eq!(notes(folder.path(), "info nickel"), "");
}

/// Standard output of a command that may print notes.
fn succeeds_with_notes(folder: &Path, arguments: &[&str]) -> String {
    let mut output = run_in(folder, arguments, "");
    output.stderr.clear();
    succeeds(output)
}

/// A file of nickel whose colours at grazing `wo` are a thousand times too bright.
fn write_absurd_file(folder: &Path) {
    let nickel = MerlBrdf::new(
        decode_embedded("nickel").unwrap().into(),
        LookupRule::Linear,
    );
    let size = BsdfSize {
        name: "",
        angles: 6,
        side: 16,
    };
    let mut file: BsdfFile = tabulate(|wo, wi| nickel.eval(wo, wi), size, "test".into());
    let Colour::Rgb(colour) = &mut file.colour else {
        panic!("files of tables have RGB");
    };
    let half = colour.values.len() / 2;
    for value in &mut colour.values[half..] {
        *value *= 1000.0;
    }
    file.write(&folder.join("absurd.bsdf"), Overwrite::Refuse)
        .unwrap();
}

#[test]
fn a_table_with_an_absurd_error_is_written_only_on_request() {
    let folder = tempfile::tempdir().unwrap();
    write_absurd_file(folder.path());
    let table = folder.path().join("t.binary");
    let output = run_in(
        folder.path(),
        &["import", "absurd.bsdf", "-o", "t.binary"],
        "",
    );
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(
        text.starts_with("merlkit: the table is not written: its albedo is off by")
            && text.contains("--accept-error"),
        "{text}"
    );
    assert!(!table.exists());
    let accepted = ["import", "absurd.bsdf", "-o", "t.binary", "--accept-error"];
    let sheet = succeeds(run_in(folder.path(), &accepted, ""));
    assert!(sheet.contains("by forced reciprocity"), "{sheet}");
    assert!(table.exists());
}
