//! Anisotropic `.bsdf` files as MATERIAL: the commands that take them, and what the others say.

use std::path::Path;

use glam::Vec3;
use merlkit::brdf::Brdf;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::files::Overwrite;
use merlkit::geometry::{Symmetry, spherical};
use merlkit::image::read_exr;
use merlkit::material::rgl::RglBrdf;
use merlkit::sampler::HalfVectorSettings;
use tempfile::TempDir;

use crate::brushed::{Brushed, Resolution, bsdf_of};
use crate::run::{fails, json, run, run_in, succeeds};

const NAME: &str = "brushed.bsdf";

/// A folder with the file in it, and the file.
fn folder() -> (TempDir, RglBrdf) {
    let folder = tempfile::tempdir().unwrap();
    let metal = Brushed {
        turned: 0.5,
        ..Brushed::STRONG
    };
    let file = bsdf_of(&metal, Symmetry::Half, Resolution::COARSE);
    file.write(&folder.path().join(NAME), Overwrite::Refuse)
        .unwrap();
    (folder, RglBrdf::new(file))
}

fn numbers(line: &str) -> Vec<f32> {
    line.split(',').map(|x| x.parse().unwrap()).collect()
}

#[test]
fn values_and_draws_are_those_of_the_file() {
    let (folder, rgl) = folder();
    let arguments = ["eval", NAME, "--wo", "40,10", "--wi", "35,200"];
    let text = succeeds(run_in(folder.path(), &arguments, ""));
    let angle = |theta: f64, phi: f64| spherical(theta.to_radians(), phi.to_radians()).as_vec3();
    let expected = rgl.eval(angle(40.0, 10.0), angle(35.0, 200.0)).to_array();
    let found = numbers(text.lines().nth(1).unwrap());
    assert!(
        found
            .iter()
            .zip(expected)
            .all(|(a, b)| (a / b - 1.0).abs() < 1e-4),
        "{found:?} {expected:?}"
    );
    let wo = angle(50.0, 70.0);
    for sampler in ["half-vector", "file", "cosine"] {
        let arguments = [
            "sample",
            NAME,
            "--theta",
            "50",
            "--phi",
            "70",
            "--count",
            "40",
            "--sampler",
            sampler,
        ];
        let text = succeeds(run_in(folder.path(), &arguments, ""));
        let drawn: Vec<_> = text
            .lines()
            .skip(1)
            .map(numbers)
            .filter(|n| n[3] > 0.0)
            .collect();
        assert!(drawn.len() > 20, "{sampler}: {text}");
        for n in drawn {
            let (wi, f) = (
                Vec3::from_slice(&n[..3]),
                rgl.eval(wo, Vec3::from_slice(&n[..3])).x,
            );
            assert!((n[4] / f - 1.0).abs() < 1e-3, "{sampler}: {wi} {n:?} {f}");
            let own = rgl.pdf(wo, wi);
            assert!(
                sampler != "file" || (n[3] / own - 1.0).abs() < 1e-3,
                "{wi}: {n:?} {own}"
            );
        }
    }
}

#[test]
fn built_tables_draw_the_same() {
    let (folder, _) = folder();
    let build = [
        "build",
        NAME,
        "--sampler",
        "half-vector:2KB",
        "-o",
        "tables",
    ];
    let text = succeeds(run_in(folder.path(), &build, ""));
    assert!(
        text.contains("half-vector:2KB for brushed,") && !text.contains("lookup"),
        "{text}"
    );
    let draws = ["--theta", "30", "--phi", "200", "--count", "20"];
    let sample = |source: &[&str]| {
        succeeds(run_in(
            folder.path(),
            &[&["sample"], source, &draws[..]].concat(),
            "",
        ))
    };
    assert_eq!(
        sample(&["tables"]),
        sample(&[NAME, "--sampler", "half-vector:2KB"])
    );
    let info = succeeds(run_in(folder.path(), &["info", "tables"], ""));
    assert!(
        info.contains("half-vector:2KB") && info.contains("none"),
        "{info}"
    );
}

#[test]
fn checks_go_round_the_azimuth() {
    let (folder, _) = folder();
    let arguments = [
        "check",
        NAME,
        "--draws",
        "2000",
        "--sampler",
        "half-vector:azimuths=3",
        "--json",
        "-",
    ];
    let results = json(&succeeds(run_in(folder.path(), &arguments, "")));
    assert_eq!(results["results"][0]["sampler"], "half-vector:azimuths=3");
    let outcomes = results["results"][0]["outcomes"].as_array().unwrap();
    assert_eq!(outcomes.len(), 13 * 5 * 7);
    assert!(
        outcomes
            .iter()
            .any(|o| (o["phi_o_deg"].as_f64().unwrap() - 90.0).abs() < 1e-3)
    );
}

#[test]
fn reports_go_round_the_azimuth() {
    let (folder, rgl) = folder();
    let arguments = [
        "report",
        NAME,
        "--draws",
        "1000",
        "--sampler",
        "half-vector:2KB",
        "--sampler",
        "cosine",
        "--sampler",
        "file",
        "--json",
        "json",
        "--csv",
        "csv",
    ];
    let shown = succeeds(run_in(folder.path(), &arguments, ""));
    assert!(
        shown.contains("values of the file") && shown.contains("four azimuths"),
        "{shown}"
    );
    for name in ["half-vector:2KB", "cosine", "file"] {
        assert!(shown.contains(&format!("| {name} ")), "{shown}");
    }
    let written = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let results = &json(&written("json"))["results"][0];
    assert!(results["lookup"].is_null());
    assert_eq!(
        results["material_bytes"].as_u64().unwrap(),
        rgl.table_bytes() as u64
    );
    let table = HalfVectorSettings::PRESETS[0].1.for_anisotropic();
    for (sampler, bytes) in [(0, 8 * table.bytes()), (2, DirectionSampler::bytes(&rgl))] {
        let figures = &results["samplers"][sampler];
        assert_eq!(figures["angles"].as_array().unwrap().len(), 28);
        assert_eq!(figures["file_bytes"].is_null(), sampler == 2);
        assert_eq!(figures["table_bytes"].as_u64().unwrap(), bytes as u64);
    }
    let csv = written("csv");
    let rows: Vec<Vec<&str>> = csv.lines().map(|l| l.split(',').collect()).collect();
    let column = rows[0].iter().position(|c| *c == "phi_o_deg").unwrap();
    assert!(
        rows.len() == 1 + 3 * 28 && rows[2][column] == "111.7" && rows[2][1].is_empty(),
        "{csv}"
    );
}

/// Mean of a picture's pixels.
fn mean(path: &Path) -> f32 {
    let image = read_exr(path).unwrap();
    image.pixels().iter().map(|p| p.element_sum()).sum::<f32>() / image.pixels().len() as f32
}

#[test]
fn pictures_agree_whatever_draws_the_directions() {
    let (folder, _) = folder();
    let mut means = Vec::new();
    for sampler in ["half-vector", "file", "cosine"] {
        let options = [
            "--sampler",
            sampler,
            "--size",
            "32x24",
            "--spp",
            "1024",
            "-o",
            sampler,
        ];
        succeeds(run_in(
            folder.path(),
            &[&["render", NAME], &options[..]].concat(),
            "",
        ));
        means.push(mean(&folder.path().join(format!("{sampler}.exr"))));
    }
    assert!(
        means.iter().all(|m| (m / means[0] - 1.0).abs() < 0.01),
        "{means:?}"
    );
}

#[test]
fn samplers_that_do_not_fit_are_refused() {
    let (folder, _) = folder();
    let sample = |material: &str, options: &[&str]| {
        let common = ["sample", material, "--theta", "20", "--count", "1"];
        fails(run_in(folder.path(), &[&common[..], options].concat(), ""))
    };
    assert!(sample("nickel", &["--sampler", "file"]).contains("choose half-vector"));
    assert!(
        sample("nickel", &["--sampler", "half-vector:azimuths=4"])
            .contains("leave the azimuths out")
    );
    assert!(
        sample("nickel", &["--sampler", "adaptive-disc:azimuths=4"])
            .contains("leave the azimuths out")
    );
    assert!(sample(NAME, &["--sampler", "half-vector:azimuths=1"]).contains("2 to 256"));
    assert!(sample(NAME, &["--sampler", "file:azimuths=4"]).contains("no setting of file"));
    assert!(
        fails(run(
            &["check", "nickel", "--sampler", "half-vector:azimuths=4"],
            ""
        ))
        .contains("isotropic")
    );
    assert!(
        fails(run(
            &["check", "--hard", "--sampler", "half-vector:2KB"],
            ""
        ))
        .contains("--hard")
    );
}

/// Before the first material is worked on.
#[test]
fn what_one_of_several_materials_can_not_have_is_refused_first() {
    let (folder, _) = folder();
    for arguments in [
        &[
            "build",
            "nickel",
            NAME,
            "--sampler",
            "half-vector:azimuths=4",
            "-o",
            "out",
        ][..],
        &[
            "check",
            "nickel",
            NAME,
            "--sampler",
            "file",
            "--json",
            "out",
        ],
        &[
            "report",
            NAME,
            "nickel",
            "--sampler",
            "file",
            "--json",
            "out",
        ],
        &["export", "nickel", NAME, "--format", "header", "-o", "out"],
        &["export", "nickel", NAME, "--format", "bsdf", "-o", "out"],
        &["decode", "nickel", NAME, "-o", "out"],
    ] {
        fails(run_in(folder.path(), arguments, ""));
        assert!(!folder.path().join("out").exists(), "{arguments:?}");
    }
}
