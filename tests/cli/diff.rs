//! `merlkit diff`.

use std::path::Path;
use std::process::Output;

use crate::run::{fails, json, run_in, succeeds};

fn in_folder(folder: &Path, arguments: &[&str]) -> Output {
    run_in(folder, arguments, "")
}

/// Renders a small picture with a number of paths into `name` of a folder.
fn render(folder: &Path, name: &str, paths: &str) {
    let lit = ["render", "teflon", "--size", "48x32", "--spp"];
    succeeds(in_folder(
        folder,
        &[&lit[..], &[paths, "-o", name]].concat(),
    ));
}

/// More paths come nearer to the reference by each metric, and the tolerance decides the exit status.
#[test]
fn pictures_are_judged_against_a_reference() {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), "few.exr", "1");
    render(folder.path(), "many.exr", "64");
    render(folder.path(), "reference.exr", "512");
    let measure = |picture: &str| {
        let text = succeeds(in_folder(
            folder.path(),
            &["diff", picture, "reference.exr", "--json", "-"],
        ));
        json(&text)["results"].clone()
    };
    let (few, many) = (measure("few.exr"), measure("many.exr"));
    for metric in ["flip", "rel_mse", "mean_relative"] {
        let [few, many] = [&few, &many].map(|r| r[metric].as_f64().unwrap());
        assert!(few > 2.0 * many && many > 0.0, "{metric}: {few} {many}");
    }
    let same = measure("reference.exr");
    assert_eq!(
        (same["flip"].as_f64(), same["rel_mse"].as_f64()),
        (Some(0.0), Some(0.0))
    );

    let strict = ["diff", "few.exr", "reference.exr", "--tolerance", "0.1%"];
    let output = in_folder(folder.path(), &strict);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stdout).contains("EXCEEDED"));
    let loose = [
        "--tolerance",
        "50%",
        "--metric",
        "relative",
        "-o",
        "map.png",
    ];
    let kept = succeeds(in_folder(
        folder.path(),
        &[&["diff", "many.exr", "reference.exr"][..], &loose].concat(),
    ));
    assert!(kept.contains("kept"), "{kept}");
    assert!(folder.path().join("map.png").exists());
}

#[test]
fn what_can_not_be_compared_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), "a.exr", "1");
    let wide = [
        "render", "teflon", "--size", "49x32", "--spp", "1", "-o", "b.exr",
    ];
    succeeds(in_folder(folder.path(), &wide));
    let message = fails(in_folder(folder.path(), &["diff", "a.exr", "b.exr"]));
    assert!(
        message.contains("48×32") && message.contains("49×32"),
        "{message}"
    );
    let message = fails(in_folder(folder.path(), &["diff", "a.exr", "nowhere.exr"]));
    assert!(message.contains("nowhere.exr"), "{message}");
}
