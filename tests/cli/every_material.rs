//! Every command with every kind of material: a result, or the one refusal that names the fix.

use std::path::Path;

use merlkit::brdf::Brdf;
use merlkit::files::Overwrite;
use merlkit::geometry::{Symmetry, spherical};
use merlkit::material::merl::{decode_embedded, write};
use merlkit::material::rgl::{BsdfSize, tabulate};
use merlkit::material::{LookupRule, MerlBrdf, RglBrdf};
use tempfile::TempDir;

use crate::brushed::{Brushed, Resolution, bsdf_of};
use crate::run::{fails, json, run_in, succeeds};

const TABLE: &str = "nickel.binary";
const ISOTROPIC: &str = "paint.bsdf";
const ANISOTROPIC: &str = "brushed.bsdf";
const FORMULA: &str = "lambert:reflectance=0.8/0.5/0.2";
const ALL: [&str; 4] = [TABLE, ISOTROPIC, ANISOTROPIC, FORMULA];

/// What a command does with a material.
#[derive(Clone, Copy, PartialEq)]
enum Answer {
    Result,
    /// Exit status 2, with this in the message.
    Refused(&'static str),
}
use Answer::{Refused, Result};

const NO_TABLE: Answer = Refused("needs a MERL table");
const NO_AZIMUTH: Answer = Refused("is anisotropic");

/// Commands with MATERIAL in the place of the material, and their answers in the order of [`ALL`].
const COMMANDS: [(&str, [Answer; 4]); 22] = [
    ("info MATERIAL", [Result; 4]),
    ("eval MATERIAL --wo 30,10 --wi 20,170", [Result; 4]),
    (
        "build MATERIAL --sampler half-vector:2KB -o out",
        [Result; 4],
    ),
    (
        "build MATERIAL --sampler adaptive-disc:depth=2,tables=2 -o out",
        [Result; 4],
    ),
    ("build MATERIAL --sampler lobe:ggx -o out", [Result; 4]),
    (
        "sample MATERIAL --theta 30 --count 3 --sampler half-vector:2KB",
        [Result; 4],
    ),
    (
        "sample MATERIAL --theta 30 --count 3 --sampler file",
        [
            Refused("needs a .bsdf file"),
            Result,
            Result,
            Refused("needs a .bsdf file"),
        ],
    ),
    ("check MATERIAL --draws 1000 --sampler cosine", [Result; 4]),
    ("report MATERIAL --draws 100 --sampler cosine", [Result; 4]),
    (
        "render MATERIAL --spp 1 --size 16x12 --sampler cosine -o out",
        [Result; 4],
    ),
    ("plot MATERIAL --kind lobe -o out.svg", [Result; 4]),
    (
        "plot MATERIAL --kind lobe-polar --sampler half-vector:2KB -o out.svg",
        [Result; 4],
    ),
    (
        "plot MATERIAL --kind slice -o out.svg",
        [Result, NO_TABLE, NO_TABLE, NO_TABLE],
    ),
    (
        "plot MATERIAL --kind disc --sampler cosine -o out.svg",
        [Result; 4],
    ),
    ("plot MATERIAL --kind albedo -o out.svg", [Result; 4]),
    (
        "export MATERIAL --format bsdf --size 0.4MB --variant rgb -o out",
        [Result, Result, NO_AZIMUTH, Result],
    ),
    (
        "export MATERIAL --format header --sampler half-vector:2KB -o out",
        [Result, NO_TABLE, NO_TABLE, NO_TABLE],
    ),
    (
        "export MATERIAL --format runtime --sampler half-vector:2KB -o out",
        [Result, NO_TABLE, NO_TABLE, NO_TABLE],
    ),
    (
        "export MATERIAL --format npz --sampler half-vector:2KB -o out",
        [Result, NO_TABLE, NO_TABLE, NO_TABLE],
    ),
    (
        "decode MATERIAL -o out",
        [Result, NO_TABLE, NO_TABLE, NO_TABLE],
    ),
    (
        "import MATERIAL -o out",
        [
            Refused("is already a MERL table"),
            Result,
            NO_AZIMUTH,
            Result,
        ],
    ),
    (
        "tune MATERIAL --target-error 50% --max-bytes 3000",
        [Result; 4],
    ),
];

/// A folder with a MERL binary, an isotropic and an anisotropic file.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let nickel = decode_embedded("nickel").unwrap();
    write(&nickel, &path(TABLE), Overwrite::Refuse).unwrap();
    let size = BsdfSize {
        name: "",
        angles: 6,
        side: 16,
    };
    let glossy = MerlBrdf::new(nickel.into(), LookupRule::Linear);
    tabulate(|wo, wi| glossy.eval(wo, wi), size, "test".into())
        .write(&path(ISOTROPIC), Overwrite::Refuse)
        .unwrap();
    let metal = Brushed {
        turned: 0.5,
        ..Brushed::STRONG
    };
    bsdf_of(&metal, Symmetry::Half, Resolution::COARSE)
        .write(&path(ANISOTROPIC), Overwrite::Refuse)
        .unwrap();
    folder
}

fn remove_output(folder: &Path) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path
            .file_name()
            .unwrap()
            .to_string_lossy()
            .starts_with("out")
        {
            if path.is_dir() {
                std::fs::remove_dir_all(path).unwrap();
            } else {
                std::fs::remove_file(path).unwrap();
            }
        }
    }
}

#[test]
fn every_command_takes_every_material_or_says_why_not() {
    let folder = folder();
    for (command, answers) in COMMANDS {
        for (material, answer) in ALL.into_iter().zip(answers) {
            let words = command.split(' ');
            let arguments: Vec<&str> = words
                .map(|word| if word == "MATERIAL" { material } else { word })
                .collect();
            let output = run_in(folder.path(), &arguments, "");
            let status = output.status.code();
            let message = String::from_utf8(output.stderr).unwrap();
            match answer {
                Result => assert!(
                    matches!(status, Some(0 | 1)) && !message.contains("panicked"),
                    "{arguments:?}: {status:?} {message}"
                ),
                Refused(why) => {
                    assert_eq!(status, Some(2), "{arguments:?}: {message}");
                    // What, and after the semicolon what to do about it; before any file is made.
                    assert!(
                        message.contains(why) && message.contains("; "),
                        "{arguments:?}: {message}"
                    );
                    let made = std::fs::read_dir(folder.path()).unwrap().count();
                    assert_eq!(made, 3, "{arguments:?}");
                }
            }
            remove_output(folder.path());
        }
    }
}

/// `eval` prints the file's own values: tabulated first, they would differ in the first digits.
#[test]
fn isotropic_files_keep_their_values() {
    let folder = folder();
    let file = merlkit::material::rgl::BsdfFile::open(&folder.path().join(ISOTROPIC)).unwrap();
    let rgl = RglBrdf::new(file);
    let angle = |theta: f64, phi: f64| spherical(theta.to_radians(), phi.to_radians()).as_vec3();
    for (theta, phi) in [(40.0, 180.0), (35.0, 170.0), (70.0, 20.0)] {
        let wi = format!("{theta},{phi}");
        let arguments = ["eval", ISOTROPIC, "--wo", "40,0", "--wi", &wi];
        let text = succeeds(run_in(folder.path(), &arguments, ""));
        let line = text.lines().nth(1).unwrap();
        let found: Vec<f32> = line.split(',').map(|x| x.parse().unwrap()).collect();
        let expected = rgl.eval(angle(40.0, 0.0), angle(theta, phi)).to_array();
        for (found, expected) in found.iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
        }
    }
    let info = json(&succeeds(run_in(
        folder.path(),
        &["info", ISOTROPIC, "--json", "-"],
        "",
    )));
    let facts = &info["results"][0];
    assert!(facts["table"].is_null() && facts["lookup"].is_null());
    assert_eq!(facts["reading"], "values of the file");
    assert_eq!(facts["symmetry"], "isotropic");
}

/// A sampler file of a formula or of an isotropic file comes back, whichever lookup rule was named.
#[test]
fn samplers_of_other_materials_than_tables_come_back_from_their_files() {
    let folder = folder();
    let run = |arguments: &[&str]| succeeds(run_in(folder.path(), arguments, ""));
    for material in [ISOTROPIC, FORMULA] {
        for sampler in ["half-vector", "lobe:ggx"] {
            let build = ["build", material, "--sampler", sampler, "-o", "tables"];
            run(&[&build[..], &["--lookup", "linear", "--force"]].concat());
            let draws = ["--theta", "30", "--count", "10"];
            let stored = run(&[&["sample", "tables"], &draws[..]].concat());
            let built = [&["sample", material, "--sampler", sampler], &draws[..]].concat();
            assert_eq!(stored, run(&built), "{material} {sampler}");
        }
    }
    let text = fails(run_in(
        folder.path(),
        &[
            "eval",
            "lambert:reflectance=2",
            "--wo",
            "0,0",
            "--wi",
            "0,0",
        ],
        "",
    ));
    assert!(
        text.contains("reflectance=2") && text.contains("0 to 1"),
        "{text}"
    );
}

#[test]
fn comparisons_leave_out_what_a_material_does_not_support() {
    let folder = folder();
    let arguments = ["compare", FORMULA, "--quick", "-o", "out"];
    succeeds(run_in(folder.path(), &arguments, ""));
    let text = std::fs::read_to_string(folder.path().join("out/compare.json")).unwrap();
    let curves = json(&text)["results"]["materials"][0]["curves"].clone();
    let labels: Vec<String> = curves
        .as_array()
        .unwrap()
        .iter()
        .map(|c| c["label"].as_str().unwrap().to_owned())
        .collect();
    assert!(labels.iter().any(|l| l == "half-vector:64KB"), "{labels:?}");
    assert!(labels.iter().any(|l| l == "adaptive-disc"), "{labels:?}");
    assert!(!labels.iter().any(|l| l == "file"), "{labels:?}");
}
