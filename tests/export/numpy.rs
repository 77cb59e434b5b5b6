//! The archive, with numpy and without.

use std::io::Read;
use std::path::Path;
use std::process::{Command, Output};

use assert_cmd::cargo::cargo_bin;
use merlkit::export::Export;
use merlkit::files::Overwrite;
use merlkit::material::Material;
use merlkit::material::merl::LookupRule;
use merlkit::material::merl::write;
use merlkit::sampler::HalfVectorSettings;

use crate::has;
use crate::support::noise_table;

const READER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tools/half_vector.py");

fn export(material: &str) -> Export {
    let material = Material::resolve(material).unwrap();
    let loaded = material.load(LookupRule::Floor).unwrap();
    Export::new(&material, &loaded, HalfVectorSettings::PRESETS[0].1).unwrap()
}

fn python(folder: &Path, arguments: &[&str]) -> Output {
    Command::new("python3")
        .arg("-B")
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[test]
fn archives_hold_the_values_after_a_head_and_are_the_same_every_time() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second, values] = ["a.npz", "b.npz", "v"].map(|name| folder.path().join(name));
    let export = export("teflon");
    let bytes = export.write_npz(&first, Overwrite::Refuse).unwrap();
    export.write_npz(&second, Overwrite::Refuse).unwrap();
    export.write_values(&values, Overwrite::Refuse).unwrap();
    let whole = std::fs::read(&first).unwrap();
    assert_eq!(
        (whole.len() as u64, &whole),
        (bytes, &std::fs::read(&second).unwrap())
    );
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(whole)).unwrap();
    assert_eq!(archive.len(), 17);
    let mut array = Vec::new();
    archive
        .by_name("merl.rgb.npy")
        .unwrap()
        .read_to_end(&mut array)
        .unwrap();
    assert_eq!(array[128..], std::fs::read(&values).unwrap());
    let negative = export.values().filter(|v| *v < 0.0);
    assert_eq!(
        negative.count() as u64,
        3 * export.brdf().table().census().invalid()
    );
}

/// Every array's type and shape, and those that are no table in full.
const DESCRIBE: &str = "
import numpy as np, sys
t = np.load(sys.argv[1])
for k in sorted(t.files):
    print(k, t[k].dtype.kind + str(t[k].dtype.itemsize) if t[k].ndim else t[k][()], *t[k].shape)
t['merl.rgb'].tofile('values')
";

#[test]
fn numpy_reads_the_archive() {
    if !has("python3", &["-c", "import numpy"]) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("noisé.binary");
    write(&noise_table(360, 7, 5), &path, Overwrite::Refuse).unwrap();
    let export = export(path.to_str().unwrap());
    export
        .write_npz(&folder.path().join("n.npz"), Overwrite::Refuse)
        .unwrap();
    export
        .write_values(&folder.path().join("v"), Overwrite::Refuse)
        .unwrap();
    let output = python(folder.path(), &["-X", "utf8", "-c", DESCRIBE, "n.npz"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let said = text(&output.stdout);
    let (lines, hash): (Vec<&str>, Vec<&str>) =
        said.lines().partition(|l| !l.starts_with("source_sha256"));
    assert_eq!(
        lines,
        [
            "knot.cosine f4 7",
            "lookup floor",
            "material noisé",
            "merl.rgb f4 90 90 360 3",
            "phi_d f8 360",
            "row.cdf u2 7 22",
            "row.density u2 7 22 4",
            "row.edge u2 23",
            "row.slope i1 7 22",
            "spec.fold True",
            "spec.importance mean",
            "spec.rows 22",
            "spec.segments 3",
            "spec.tables 7",
            "theta_d f8 90",
            "theta_h f8 90",
        ]
    );
    assert_eq!(
        hash,
        [format!(
            "source_sha256 {}",
            Material::resolve(path.to_str().unwrap())
                .unwrap()
                .sha256()
                .unwrap()
        )]
    );
    let [read, written] =
        ["values", "v"].map(|name| std::fs::read(folder.path().join(name)).unwrap());
    assert!(read == written);
}

/// As the reader of sampler files in `tests/cli/python.rs`: within 10⁻⁵ but for one draw in a thousand.
#[test]
fn the_reader_draws_from_archives_what_the_library_draws() {
    if !has("python3", &["-c", "import numpy"]) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let merlkit = |arguments: &[&str]| {
        let output = Command::new(cargo_bin!("merlkit"))
            .args(arguments)
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert!(
            output.status.success(),
            "{arguments:?}: {}",
            text(&output.stderr)
        );
        output.stdout
    };
    for (material, size) in [("nickel", "64KB"), ("teflon", "2KB")] {
        merlkit(&[
            "build",
            material,
            "--sampler",
            &format!("half-vector:{size}"),
            "-o",
            "s",
            "--force",
        ]);
        merlkit(&[
            "export",
            material,
            "--format",
            "npz",
            "--sampler",
            &format!("half-vector:{size}"),
            "-o",
            ".",
        ]);
        let sample = [
            "sample",
            "s",
            "--theta",
            "63",
            "--phi",
            "200",
            "--count",
            "20000",
            "--with-points",
        ];
        std::fs::write(folder.path().join("draws.csv"), merlkit(&sample)).unwrap();
        let output = python(
            folder.path(),
            &[READER, &format!("{material}.npz"), "draws.csv"],
        );
        let said = text(&output.stdout) + &text(&output.stderr);
        assert!(
            output.status.success() && said.starts_with("20000 draws, "),
            "{material} {size}: {said}"
        );
    }
    // Draws from another table are told apart.
    let output = python(folder.path(), &[READER, "nickel.npz", "draws.csv"]);
    assert!(!output.status.success(), "{}", text(&output.stdout));
}
