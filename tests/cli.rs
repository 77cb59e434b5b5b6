//! The command line as a user types it.

use std::io::Write;
use std::path::Path;
use std::process::{Output, Stdio};

use assert_cmd::cargo::cargo_bin;

/// Runs `merlkit` in `folder` with `input` on standard input.
fn run_in(folder: &Path, arguments: &[&str], input: &str) -> Output {
    let mut child = std::process::Command::new(cargo_bin!("merlkit"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // A command that stops early closes its input, which is no concern of these tests.
    let _ = child.stdin.take().unwrap().write_all(input.as_bytes());
    child.wait_with_output().unwrap()
}

fn run(arguments: &[&str], input: &str) -> Output {
    run_in(Path::new("."), arguments, input)
}

/// Standard output of a command that succeeds and has nothing to complain about.
fn succeeds(output: Output) -> String {
    let complaints = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{complaints}");
    assert_eq!(complaints, "");
    String::from_utf8(output.stdout).unwrap()
}

/// Standard error of a command that ends with status 2.
fn fails(output: Output) -> String {
    assert_eq!(output.status.code(), Some(2));
    String::from_utf8(output.stderr).unwrap()
}

fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn list_names_the_hundred_materials() {
    let text = succeeds(run(&["list"], ""));
    assert_eq!(text.lines().count(), 100);
    assert!(text.lines().any(|l| l == "red-plastic"));
    let document = json(&succeeds(run(&["list", "--json"], "")));
    assert_eq!((&document["schema"], &document["kind"]), (&1.into(), &"list".into()));
    let names: Vec<_> = document["results"].as_array().unwrap().iter().map(|n| n.as_str().unwrap()).collect();
    assert_eq!(names, text.lines().collect::<Vec<_>>());
}

#[test]
fn the_version_is_the_packages() {
    let text = succeeds(run(&["--version"], ""));
    assert_eq!(text.trim(), format!("merlkit {}", env!("CARGO_PKG_VERSION")));
}

#[test]
fn every_command_has_help() {
    let help = succeeds(run(&["--help"], ""));
    assert!(help.contains("Exit status"));
    let commands = help.split("Commands:").nth(1).unwrap().split("Options:").next().unwrap();
    let names: Vec<_> = commands.lines().filter(|l| l.starts_with("  ") && !l.starts_with("   ")).collect();
    assert!(names.len() >= 5, "{commands}");
    for line in names {
        let name = line.split_whitespace().next().unwrap();
        let about = line.split_whitespace().nth(1);
        assert!(about.is_some(), "{name} is not described");
        succeeds(run(&["help", name], ""));
    }
}

#[test]
fn wrong_usage_is_status_two() {
    for arguments in
        [&["no-such-command"][..], &["info"], &["decode", "-o", "x"], &["list", "--threads", "0"]]
    {
        assert!(fails(run(arguments, "")).contains("Usage") || arguments.contains(&"0"), "{arguments:?}");
    }
    assert!(fails(run(&["eval", "nickel", "--lookup", "cubic"], "")).contains("[possible values: floor"));
}

#[test]
fn misspelt_materials_are_answered_with_the_nearest() {
    for command in ["info", "eval"] {
        let text = fails(run(&[command, "nikel"], ""));
        assert!(text.starts_with("merlkit: no file and no embedded material is called \"nikel\""), "{text}");
        assert!(text.contains("did you mean nickel"), "{text}");
    }
}

#[test]
fn decoded_materials_have_the_facts_of_the_embedded() {
    let folder = tempfile::tempdir().unwrap();
    succeeds(run_in(folder.path(), &["decode", "nickel", "teflon", "-o", "out/deep"], ""));
    let file = folder.path().join("out/deep/nickel.binary");
    assert_eq!(file.metadata().unwrap().len(), 34_992_012);
    assert!(folder.path().join("out/deep/teflon.binary").exists());
    let facts = |material: &str| {
        let document = json(&succeeds(run_in(folder.path(), &["info", material, "--json", "-"], "")));
        assert_eq!((&document["schema"], &document["kind"]), (&1.into(), &"info".into()));
        let mut facts = document["results"][0].clone();
        facts["source"].take();
        facts
    };
    let embedded = facts("nickel");
    assert_eq!(embedded, facts("out/deep/nickel.binary"));
    assert_eq!(embedded["table"]["dimensions"], serde_json::json!([90, 90, 180]));
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
    assert!(text.contains("nickel.binary exists; pass --force"), "{text}");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "mine");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing else is left behind");
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
    assert!(fails(run(&["decode", "nickel", "nickel", "-o", "unused"], "")).contains("named twice"));
}

#[test]
fn info_words_each_material() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["info", "nickel", "teflon", "--lookup", "linear", "--json", "facts.json"];
    let text = succeeds(run_in(folder.path(), &arguments, ""));
    for word in ["nickel", "teflon", "90 × 90 × 180", "34992012", "linear", "albedo at 80°", "φd asymmetry"]
    {
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
    std::fs::write(folder.path().join("short.binary"), [90u8, 0, 0, 0, 90, 0, 0, 0, 180, 0, 0, 0, 7])
        .unwrap();
    let text = fails(run_in(folder.path(), &["info", "short.binary"], ""));
    let expected =
        "merlkit: short.binary: at byte 13: expected 34992012 bytes for 90 × 90 × 180, found 13 bytes";
    assert!(text.starts_with(expected), "{text}");
}

const HEADING: &str = "wo_x,wo_y,wo_z,wi_x,wi_y,wi_z\n";

#[test]
fn eval_reads_lines_with_or_without_a_heading() {
    let lines = "0.6,0,0.8,-0.6,0,0.8\n\n 0 , 0 , 1 , 0.6,0,0.8\r\n0,0,1,0,0,-1";
    let bare = succeeds(run(&["eval", "nickel"], lines));
    assert_eq!(
        bare,
        succeeds(run(&["eval", "nickel", "--lookup", "floor"], &format!("\n{HEADING}{lines}\n")))
    );
    let rows: Vec<_> = bare.lines().collect();
    assert_eq!(rows.len(), 4);
    assert_eq!((rows[0], rows[3]), ("f_r,f_g,f_b", "0.0,0.0,0.0"));
    for row in &rows[1..3] {
        let values: Vec<f32> = row.split(',').map(|x| x.parse().unwrap()).collect();
        assert!(values.len() == 3 && values.iter().all(|v| *v > 0.0), "{row}");
    }
    assert_ne!(bare, succeeds(run(&["eval", "nickel", "--lookup", "centred"], lines)));
    assert_eq!(succeeds(run(&["eval", "nickel"], "")), "f_r,f_g,f_b\n");
}

#[test]
fn eval_in_degrees_equals_eval_in_vectors() {
    let (s, c) = 30f64.to_radians().sin_cos();
    for (line, wi) in [
        (format!("{s},0,{c},0,{c},{s}"), "60,90"),
        (format!("{s},0,{c},0,-{c},{s}"), "60,-90"),
        // The mirror direction, exactly: θh is 0 and not merely small.
        (format!("{s},0,{c},-{s},0,{c}"), "30,180"),
        (format!("{s},0,{c},{s},0,{c}"), "30,720"),
        (format!("{s},0,{c},1,0,0"), "90,0"),
        (format!("{s},0,{c},0,0,-1"), "180,0"),
    ] {
        let by_vectors = succeeds(run(&["eval", "teflon"], &line));
        assert_eq!(by_vectors, succeeds(run(&["eval", "teflon", "--wo", "30,0", "--wi", wi], "")), "{wi}");
    }
    for angles in ["40", "40,0,0", "x,0", "181,0", "-1,0", "nan,0"] {
        fails(run(&["eval", "teflon", &format!("--wo={angles}"), "--wi", "40,180"], ""));
    }
    fails(run(&["eval", "teflon", "--wo", "40,0"], ""));
}

#[test]
fn eval_names_the_line_it_cannot_read() {
    let good = "0,0,1,0,0,1\n";
    for (line, expected) in [
        ("0,0,1,0,0", "line 4: expected 6 numbers wo_x,wo_y,wo_z,wi_x,wi_y,wi_z, found \"0,0,1,0,0\""),
        ("0,0,one,0,0,1", "line 4: expected a number, found \"one\""),
        ("0,0,2,0,0,1", "line 4: expected wo of length 1 within 0.001, found \"length 2\""),
        ("0,0,1,0,0,0", "line 4: expected wi of length 1"),
        ("0,0,1,0,nan,1", "line 4: expected wi of length 1"),
        ("0,0,1,0,0,inf", "line 4: expected wi of length 1"),
        (HEADING.trim(), "line 4: expected a number, found \"wo_x\""),
    ] {
        let output = run(&["eval", "nickel"], &format!("{good}\n{good}{line}\n{good}"));
        assert_eq!(
            String::from_utf8_lossy(&output.stdout).lines().count(),
            3,
            "the lines before it are answered"
        );
        let text = fails(output);
        assert!(text.starts_with("merlkit: standard input, ") && text.contains(expected), "{text}");
    }
    // The other order of directions is not taken for a heading.
    assert!(fails(run(&["eval", "nickel"], "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n")).contains("line 1"));
}

#[test]
fn a_reader_that_leaves_is_no_error() {
    let mut child = std::process::Command::new(cargo_bin!("merlkit"))
        .args(["eval", "nickel"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    // The command may be gone before it has read everything.
    let _ = child.stdin.take().unwrap().write_all("0,0,1,0,0,1\n".repeat(100_000).as_bytes());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
}
