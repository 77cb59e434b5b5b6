//! `decode` and `info`.

use crate::run::{fails, json, run, run_in, succeeds};

#[test]
fn decoded_materials_have_the_facts_of_the_embedded() {
    let folder = tempfile::tempdir().unwrap();
    succeeds(run_in(
        folder.path(),
        &["decode", "nickel", "teflon", "-o", "out/deep"],
        "",
    ));
    let file = folder.path().join("out/deep/nickel.binary");
    assert_eq!(file.metadata().unwrap().len(), 34_992_012);
    assert!(folder.path().join("out/deep/teflon.binary").exists());
    let facts = |material: &str| {
        let document = json(&succeeds(run_in(
            folder.path(),
            &["info", material, "--json", "-"],
            "",
        )));
        assert_eq!(
            (&document["schema"], &document["kind"]),
            (&3.into(), &"info".into())
        );
        let mut facts = document["results"][0].clone();
        facts["source"].take();
        facts["read"].take();
        facts
    };
    let embedded = facts("nickel");
    assert_eq!(embedded, facts("out/deep/nickel.binary"));
    assert_eq!(
        embedded["table"]["dimensions"],
        serde_json::json!([90, 90, 180])
    );
    assert_eq!(embedded["table"]["table_bytes"], 23_328_000);
    let albedo = embedded["albedo"][1]["rgb"][0].as_f64().unwrap();
    assert!((0.2..0.22).contains(&albedo), "{albedo}");
}

#[test]
fn existing_files_are_replaced_only_with_force() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| run_in(folder.path(), arguments, "");
    let file = folder.path().join("nickel.binary");
    std::fs::write(&file, "mine").unwrap();
    let text = fails(run(&["decode", "nickel", "-o", "."]));
    assert!(
        text.contains("nickel.binary exists; pass --force"),
        "{text}"
    );
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "mine");
    assert_eq!(
        std::fs::read_dir(folder.path()).unwrap().count(),
        1,
        "nothing else is left behind"
    );
    succeeds(run(&["decode", "nickel", "-o", ".", "--force"]));
    assert_eq!(file.metadata().unwrap().len(), 34_992_012);
    succeeds(run(&["list", "--json", "names.json"]));
    assert!(fails(run(&["list", "--json", "names.json"])).contains("--force"));
    succeeds(run(&["list", "--json", "names.json", "--force"]));
    let refused = run(&["info", "nickel", "--json", "names.json"]);
    assert!(refused.stdout.is_empty(), "refused before the work");
    assert!(fails(refused).contains("names.json exists"));
}

#[test]
fn one_name_for_two_files_is_refused() {
    assert!(
        fails(run(&["decode", "nickel", "nickel", "-o", "unused"], "")).contains("named twice")
    );
}

#[test]
fn info_words_each_material() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = [
        "info",
        "nickel",
        "teflon",
        "--lookup",
        "linear",
        "--json",
        "facts.json",
    ];
    let text = succeeds(run_in(folder.path(), &arguments, ""));
    for word in [
        "nickel",
        "teflon",
        "90 × 90 × 180",
        "34992012",
        "linear",
        "albedo at 80°",
        "φd asymmetry",
    ] {
        assert!(text.contains(word), "{word} is missing in\n{text}");
    }
    assert!(!text.contains('\u{1b}'), "no colour");
    let document = json(&std::fs::read_to_string(folder.path().join("facts.json")).unwrap());
    assert_eq!(document["results"].as_array().unwrap().len(), 2);
    assert_eq!(document["results"][1]["lookup"], "linear");
}

#[test]
fn facts_do_not_depend_on_threads() {
    let facts = |n: &str| succeeds(run(&["info", "chrome", "--json", "-", "--threads", n], ""));
    assert_eq!(facts("1"), facts("3"));
}

#[test]
fn a_broken_file_is_named_with_its_offset() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("short.binary"),
        [90u8, 0, 0, 0, 90, 0, 0, 0, 180, 0, 0, 0, 7],
    )
    .unwrap();
    let text = fails(run_in(folder.path(), &["info", "short.binary"], ""));
    let expected = "merlkit: short.binary: at byte 13: expected 34992012 bytes for 90 × 90 × 180, found 13 bytes";
    assert!(text.starts_with(expected), "{text}");
}
