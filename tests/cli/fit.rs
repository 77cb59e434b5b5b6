//! `merlkit fit`

use crate::run::{fails, json, run, run_in, succeeds};

const PAINT: &str = "lambert:reflectance=0.4/0.1/0.05+ggx:ax=0.2,ay=0.2,nreal=1.5,nimag=0";

#[test]
fn a_fit_is_a_material_again() {
    let arguments = ["fit", PAINT, "--model", "ggx,blinn", "--pairs", "500"];
    let document = json(&succeeds(run(
        &[&arguments[..], &["--json", "-"]].concat(),
        "",
    )));
    assert_eq!(document["kind"], "fit");
    let fits = &document["results"]["materials"][0]["fits"];
    assert!(fits[0]["error"].as_f64().unwrap() < 1e-3, "{fits}");
    assert!(fits[1]["error"].as_f64().unwrap() > fits[0]["error"].as_f64().unwrap());
    let text = fits[0]["material"].as_str().unwrap();
    let pair = ["--wo", "30,0", "--wi", "30,180"];
    let [ours, theirs] =
        [PAINT, text].map(|m| succeeds(run(&[&["eval", m][..], &pair].concat(), "")));
    let number = |text: &str| -> f64 { text.split(',').next().unwrap().trim().parse().unwrap() };
    let [a, b] = [&ours, &theirs].map(|text| number(text.lines().last().unwrap()));
    assert!((a / b - 1.0).abs() < 0.01, "{ours} {theirs}");
    let shown = succeeds(run(&arguments, ""));
    for word in ["pinned down", "Best model: ggx", "lobe:ggx", "holds"] {
        assert!(shown.contains(word), "{word}: {shown}");
    }
}

#[test]
fn results_are_the_same_for_any_number_of_threads() {
    let arguments = [
        "fit", PAINT, "--model", "ggx,ward", "--pairs", "300", "--json", "-",
    ];
    let [one, three] = ["1", "3"].map(|n| {
        let threads = ["--threads", n];
        succeeds(run(&[&arguments[..], &threads].concat(), ""))
    });
    assert_eq!(one, three);
}

#[test]
fn files_are_written_and_never_replaced_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let common = ["fit", PAINT, "--model", "ggx", "--pairs", "200"];
    for (format, word) in [
        ("materialx", "open_pbr_surface"),
        ("gltf", "pbrMetallicRoughness"),
        ("mitsuba", "roughconductor"),
        ("pbrt", "MakeNamedMaterial"),
        ("json", "\"kind\": \"fit\""),
    ] {
        let arguments = [&common[..], &["--format", format, "-o", format]].concat();
        let output = run_in(folder.path(), &arguments, "");
        assert_eq!(output.status.code(), Some(0), "{format}");
        let text = std::fs::read_to_string(folder.path().join(format)).unwrap();
        assert!(text.contains(word), "{format}: {text}");
        assert!(fails(run_in(folder.path(), &arguments, "")).contains("--force"));
    }
    // Stored as JSON a fit is a material itself.
    let pair = ["--wo", "30,0", "--wi", "30,180"];
    let stored = run_in(folder.path(), &[&["eval", "json"][..], &pair].concat(), "");
    assert!(!succeeds(stored).is_empty());
    let arguments = [&common[..], &["--format", "sampler", "-o", "lobe"]].concat();
    assert_eq!(run_in(folder.path(), &arguments, "").status.code(), Some(0));
    let shown = succeeds(run_in(folder.path(), &["info", "lobe"], ""));
    assert!(shown.contains("lobe:ggx"), "{shown}");
    let arguments = [&common[..], &["--page", "page.html"]].concat();
    succeeds(run_in(folder.path(), &arguments, ""));
    let page = std::fs::read_to_string(folder.path().join("page.html")).unwrap();
    roxmltree::Document::parse_with_options(
        &page,
        roxmltree::ParsingOptions {
            allow_dtd: true,
            ..Default::default()
        },
    )
    .unwrap();
    assert_eq!(page.matches("<img ").count(), 3);
}

#[test]
fn mistakes_have_one_answer_with_the_nearest_names_and_domains() {
    for (arguments, words) in [
        (&["nickel", "--model", "gxg"][..], "did you mean ggx"),
        (&["nickel", "--model", "ggx,ggx"], "twice"),
        (&["nickel", "--model", "ggx+ggx+ggx+ggx"], "at most 3"),
        (&["nickle"], "nickel"),
        (
            &[
                "nickel",
                "--model",
                "ggx+sheen",
                "--format",
                "pbrt",
                "-o",
                "x",
            ],
            "--format materialx or gltf",
        ),
        (&["ggx:ax=nan"], "0.001 to 1"),
        (&["lambert:reflectance=0.5+ggx:ax=7"], "0.001 to 1"),
        (&["lambert:reflectance=0.5+gxg:ax=0.1"], "ggx"),
        (&["nickel", "--pairs", "3"], "50"),
        (&["nickel", "--metric", "square"], "cube-root"),
        (
            &["nickel", "--model", "ward", "--format", "gltf", "-o", "x"],
            "--model ggx",
        ),
    ] {
        let message = fails(run(&[&["fit"], arguments].concat(), ""));
        assert!(message.contains(words), "{arguments:?}: {message}");
    }
}

#[test]
fn several_materials_make_a_table_and_a_ranking() {
    let arguments = [
        "fit",
        "lambert",
        PAINT,
        "--model",
        "ggx,blinn",
        "--pairs",
        "200",
    ];
    let shown = succeeds(run(&arguments, ""));
    for word in ["| best", "mean rank", "best for"] {
        assert!(shown.contains(word), "{word}: {shown}");
    }
}
