//! The thesis's experiments, in the smallest sizes.

use std::fs;
use std::path::Path;

use crate::run::{fails, json, run, run_in, succeeds};

/// Names of the pieces that are finished.
fn pieces(folder: &Path) -> Vec<String> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder.join("t/pieces")).unwrap() {
        let name = entry.unwrap().file_name();
        names.push(name.to_str().unwrap().to_owned());
    }
    names.sort();
    names
}

#[test]
fn finished_pieces_are_not_measured_again() {
    let folder = tempfile::tempdir().unwrap();
    let command = ["thesis", "5.9", "--quick", "-o", "t", "--side", "4"];
    let text = succeeds(run_in(folder.path(), &command, ""));
    assert!(text.contains("Table 5.9"), "{text}");
    assert!(
        text.ends_with("3 pieces measured, 0 were finished before\n"),
        "{text}"
    );
    let expected = [
        "5.9-100x32.json",
        "5.9-16x64.json",
        "5.9-64x100.json",
        "plan.json",
    ];
    assert_eq!(pieces(folder.path()), expected);
    let page = fs::read_to_string(folder.path().join("t/thesis.html")).unwrap();
    let tree = roxmltree::Document::parse_with_options(
        &page,
        roxmltree::ParsingOptions {
            allow_dtd: true,
            ..Default::default()
        },
    );
    assert!(tree.unwrap().descendants().any(|n| n.has_tag_name("table")));
    for figure in ["8320", "82500", "323200"] {
        assert!(page.contains(figure), "{figure}, as printed");
    }

    // A piece that was cut off is measured again, and nothing else.
    let cut = folder.path().join("t/pieces/5.9-16x64.json");
    fs::write(&cut, "{\"seconds\":").unwrap();
    let more = [&command[..], &["--json", "-"]].concat();
    let document = json(&succeeds(run_in(folder.path(), &more, "")));
    let rows = &document["results"]["experiments"][0]["tables"][0]["rows"];
    assert_eq!(rows[0][1], 8320.0);
    // The thesis's memory is that of the formula.
    assert_eq!(rows[0][1], rows[0][2]);
    assert!(rows[0][4].as_f64().unwrap() > 0.0);
    assert!(!document["results"]["plan"]["quick"].is_null());
    assert!(fs::read(&cut).unwrap().len() > 20);
    let text = succeeds(run_in(folder.path(), &command, ""));
    assert!(
        text.ends_with("0 pieces measured, 3 were finished before\n"),
        "{text}"
    );
}

#[test]
fn pieces_of_other_options_are_refused_and_other_files_kept() {
    let folder = tempfile::tempdir().unwrap();
    let command = ["thesis", "5.9", "--quick", "-o", "t"];
    fs::create_dir_all(folder.path().join("t")).unwrap();
    fs::write(folder.path().join("t/thesis.html"), "mine").unwrap();
    let error = fails(run_in(folder.path(), &command, ""));
    assert!(error.contains("thesis.html"), "{error}");
    succeeds(run_in(
        folder.path(),
        &[&command[..], &["--force"]].concat(),
        "",
    ));
    let other = [&command[..], &["--seed", "2"]].concat();
    let error = fails(run_in(folder.path(), &other, ""));
    assert!(
        error.contains("other options") && error.contains("--force"),
        "{error}"
    );
    fs::write(folder.path().join("t/pieces/plan.json"), "[[[[").unwrap();
    assert!(fails(run_in(folder.path(), &command, "")).contains("other options"));
}

#[test]
fn unknown_experiments_have_neighbours() {
    for (name, nearest) in [
        ("scene-22", "scene-2"),
        ("algoritm-15", "algorithm-15"),
        ("table-6.44", "6.4"),
        ("../../6.4", "thesis --list"),
        ("", "thesis --list"),
    ] {
        let error = fails(run(&["thesis", name], ""));
        let (_, fix) = error.split_once("did you mean").expect(&error);
        assert!(fix.contains(nearest), "{name}: {error}");
    }
    let list = succeeds(run(&["thesis", "--list"], ""));
    for name in ["5.10", "6.24", "scene-5"] {
        assert!(list.lines().any(|l| l.starts_with(name)), "{list}");
    }
}

/// The smallest scene: six spheres of four pixels a side.
#[test]
fn scenes_have_references_and_ratios() {
    let folder = tempfile::tempdir().unwrap();
    let command = [
        "thesis", "scene-5", "--quick", "-o", "t", "--side", "4", "--json", "-",
    ];
    let document = json(&succeeds(run_in(folder.path(), &command, "")));
    let scene = &document["results"]["experiments"][0];
    let rows = scene["tables"][0]["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 9);
    for row in rows {
        for error in [&row[5], &row[6]] {
            assert!(error.as_f64().unwrap() > 0.0, "{row}");
        }
    }
    // A reference and the pictures of two samplers for each of three lights and materials.
    assert_eq!(scene["pictures"].as_array().unwrap().len(), 9);
}

/// A tetrahedron in place of the displaced sphere. Its pieces are those of no other mesh.
#[test]
fn scene_3_takes_any_mesh_and_keeps_pieces_apart() {
    let folder = tempfile::tempdir().unwrap();
    let vertices = "v 0 0 0\nv 9 0 0\nv 0 90 0\nv 0 0 9\n";
    let faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    let file = folder.path().join("tip.obj");
    fs::write(&file, format!("{vertices}{faces}")).unwrap();
    let quick = ["thesis", "scene-3", "--quick", "-o", "t", "--side", "4"];
    let command = |mesh: &[&str]| run_in(folder.path(), &[&quick[..], mesh].concat(), "");
    let missing = fails(command(&["--mesh", "tap.obj"]));
    assert!(missing.contains("tap.obj"), "{missing}");
    // A mesh that can't be read is refused before anything is begun.
    assert!(!folder.path().join("t").exists());
    let document = json(&succeeds(command(&["--mesh", "tip.obj", "--json", "-"])));
    let mesh = &document["results"]["plan"]["mesh"];
    assert_eq!(
        (&mesh["file"], &mesh["faces"]),
        (&"tip.obj".into(), &4.into())
    );
    let sum = mesh["sha256"].as_str().unwrap();
    let scene = &document["results"]["experiments"][0];
    let method = scene["method"].as_str().unwrap();
    assert!(
        method.contains("tip.obj") && method.contains(sum),
        "{method}"
    );
    assert_eq!(
        scene["pictures"][0]["caption"]
            .as_str()
            .unwrap()
            .find("mesh"),
        Some(0)
    );
    let page = fs::read_to_string(folder.path().join("t/thesis.html")).unwrap();
    assert!(page.contains("<dt>Mesh of scene 3</dt>") && page.contains(sum));
    // The same mesh goes on; another one, under the same name or none at all, does not.
    assert!(
        succeeds(command(&["--mesh", "tip.obj"]))
            .ends_with("0 pieces measured, 1 were finished before\n")
    );
    fs::write(&file, format!("{vertices}{}", &faces[..20])).unwrap();
    for other in [&["--mesh", "tip.obj"][..], &[]] {
        let error = fails(command(other));
        assert!(
            error.contains("other options") && error.contains("--force"),
            "{error}"
        );
    }
}
