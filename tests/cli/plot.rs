//! `plot`.

use crate::run::{fails, run, run_in, succeeds};

const KINDS: [&str; 8] = [
    "lobe",
    "lobe-polar",
    "slice",
    "slice-rgb",
    "disc",
    "cdf",
    "cdf-azimuth",
    "albedo",
];

/// Standard output, parsed.
fn picture(arguments: &[&str]) -> String {
    let svg = succeeds(run(&[&["plot"], arguments, &["-o", "-"]].concat(), ""));
    let document = roxmltree::Document::parse(&svg).unwrap();
    assert_eq!(document.root_element().attribute("role"), Some("img"));
    svg
}

#[test]
fn every_kind_is_a_picture_and_the_same_each_time() {
    for kind in KINDS {
        // Few tables: these pictures show one.
        let tables: &[&str] = match kind {
            "disc" => &["--sampler", "adaptive-disc:tables=3"],
            "cdf" | "cdf-azimuth" => &["--sampler", "cascade-cdf:tables=3"],
            _ => &[],
        };
        let arguments = [&["teflon", "--kind", kind], tables].concat();
        let svg = picture(&arguments);
        assert!(
            svg.contains("<title>teflon: ") && !svg.contains("no data"),
            "{kind}: {}",
            &svg[..400]
        );
        // The others have nothing that threads share.
        if ["disc", "cdf", "cdf-azimuth", "albedo"].contains(&kind) {
            assert_eq!(
                svg,
                picture(&[&arguments[..], &["--threads", "1"]].concat()),
                "{kind}"
            );
        }
    }
}

#[test]
fn options_change_what_is_drawn() {
    let lobe = ["nickel", "--kind", "lobe"];
    let with = |more: &[&str]| picture(&[&lobe, more].concat());
    assert_eq!(with(&[]), with(&["--theta", "30", "--lookup", "floor"]));
    for more in [
        ["--theta", "60"],
        ["--lookup", "centred"],
        ["--sampler", "half-vector"],
    ] {
        assert_ne!(with(&[]), with(&more), "{more:?}");
    }
    assert_ne!(
        with(&["--sampler", "half-vector"]),
        with(&["--sampler", "half-vector:2KB"])
    );
    let several = with(&["--theta", "0,30", "--theta", "60"]);
    assert!(
        ["θ = 0°", "θ = 30°", "θ = 60°"]
            .iter()
            .all(|l| several.contains(&format!(">{l}<"))),
        "{several}"
    );
    let disc = [
        "nickel",
        "--kind",
        "disc",
        "--sampler",
        "adaptive-disc:tables=3",
    ];
    let seeded = picture(&[&disc[..], &["--samples", "40", "--seed", "3"]].concat());
    assert!(seeded.contains("40 directions drawn"), "{seeded}");
    assert_ne!(
        seeded,
        picture(&[&disc[..], &["--samples", "40", "--seed", "4"]].concat())
    );
    let cosine = picture(&[
        "nickel",
        "--kind",
        "disc",
        "--sampler",
        "cosine",
        "--samples",
        "0",
    ]);
    assert!(cosine.contains("no data"), "{cosine}");
}

#[test]
fn files_have_a_default_name_and_are_replaced_with_force_only() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["plot", "teflon", "--kind", "slice"];
    assert_eq!(succeeds(run_in(folder.path(), &arguments, "")), "");
    let path = folder.path().join("teflon-slice.svg");
    let svg = std::fs::read_to_string(&path).unwrap();
    assert_eq!(svg, picture(&arguments[1..]));
    assert!(fails(run_in(folder.path(), &arguments, "")).contains("teflon-slice.svg"));
    std::fs::write(&path, "old").unwrap();
    let forced = [&arguments[..], &["--force"]].concat();
    assert_eq!(succeeds(run_in(folder.path(), &forced, "")), "");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), svg);
}

#[test]
fn mistakes_are_refused_with_what_to_do() {
    for (arguments, expected) in [
        (&["--kind", "lobe", "--theta", "90"][..], "0 to below 90"),
        (&["--kind", "lobe", "--theta", "nan"], "0 to below 90"),
        (&["--kind", "lobe", "--theta=-3"], "0 to below 90"),
        (&["--kind", "lobe", "--theta", "1,2,3,4,5"], "at most 4"),
        (&["--kind", "disc", "--theta", "1,2"], "at most 1"),
        (
            &["--kind", "slice", "--theta", "3"],
            "--theta has no effect",
        ),
        (
            &["--kind", "albedo", "--lookup", "floor"],
            "--lookup has no effect",
        ),
        (
            &["--kind", "cdf", "--sampler", "half-vector"],
            "choose cascade-cdf",
        ),
        (
            &["--kind", "lobe", "--samples", "9"],
            "--samples has no effect",
        ),
        (
            &["--kind", "albedo", "--sampler", "cosine"],
            "--sampler has no effect",
        ),
        (&["--kind", "lobe", "-o", "lobe.jpg"], "SVG or PNG"),
        (&["--kind", "round"], "slice-rgb"),
        (&[], "--kind"),
    ] {
        let text = fails(run(&[&["plot", "teflon"], arguments].concat(), ""));
        assert!(text.contains(expected), "{arguments:?}: {text}");
    }
    assert!(fails(run(&["plot", "nikel", "--kind", "lobe"], "")).contains("nickel"));
}

#[test]
fn png_is_written_by_builds_that_can() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["plot", "teflon", "--kind", "albedo", "-o", "a.png"];
    if cfg!(feature = "png-plots") {
        assert_eq!(succeeds(run_in(folder.path(), &arguments, "")), "");
        assert!(
            std::fs::read(folder.path().join("a.png"))
                .unwrap()
                .starts_with(b"\x89PNG")
        );
    } else {
        assert!(fails(run_in(folder.path(), &arguments, "")).contains("--features png-plots"));
    }
}
