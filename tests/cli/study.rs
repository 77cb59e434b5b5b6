//! Studies in parts, by any number of processes, some of which are killed.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use assert_cmd::cargo::cargo_bin;
use merlkit::image::read_exr;
use serde_json::Value;

use crate::run::{fails, json, run, run_in, succeeds};

const STUDY: &str = r#"
materials = ["lambert:reflectance=0.5", "ggx:ax=0.2,ay=0.2"]
samplers = ["half-vector:2KB", "cosine"]
thetas = [10, 60.5]
seeds = 2
draws = 2000
checks = true
models = ["ggx"]
[pictures]
lights = ["studio", "point"]
size = [50, 30]
tile = 20
spp = 4
bounces = 3
seed = 5
"#;

/// For each of two materials two samplers with four estimates, two checks and six tiles, and a fit.
const TASKS: usize = 2 * (2 * (4 + 2 + 6) + 1);

/// A folder with the plan of the study.
fn planned() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("study.toml"), STUDY).unwrap();
    let plan = ["study", "plan", "study.toml", "-o", "s"];
    let text = succeeds(run_in(folder.path(), &plan, ""));
    assert_eq!(text, format!("s/plan.json: {TASKS} tasks\n"));
    folder
}

/// Starts a part of the study.
fn start(folder: &Path, more: &[&str]) -> std::process::Child {
    Command::new(cargo_bin!("merlkit"))
        .args(["study", "run", "s"])
        .args(more)
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::inherit())
        .spawn()
        .unwrap()
}

/// Results by name, without temporary files.
fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder.join("s/results")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if !name.starts_with('.') {
            all.insert(name, fs::read(path).unwrap());
        }
    }
    all
}

fn merge(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    succeeds(run_in(folder, &["study", "merge", "s", "-o", "merged"], ""));
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder.join("merged")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        all.insert(name, fs::read(path).unwrap());
    }
    all
}

/// Runs a part until `count` results are there, and kills it, so that nothing can be tidied up.
fn kill_midway(folder: &Path, count: usize) {
    let mut child = start(folder, &["--threads", "1"]);
    let begun = Instant::now();
    while !folder.join("s/results").exists() || results(folder).len() < count {
        assert!(begun.elapsed() < Duration::from_secs(120), "no results");
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let there = results(folder);
    assert!(
        there.len() >= count && there.len() < TASKS,
        "{}",
        there.len()
    );
    for text in there.values() {
        json(std::str::from_utf8(text).unwrap());
    }
}

#[test]
fn any_processes_give_the_same_bytes_and_one_may_be_killed() {
    let alone = planned();
    assert!(
        start(alone.path(), &["--threads", "1"])
            .wait()
            .unwrap()
            .success()
    );
    let expected = results(alone.path());
    assert_eq!(expected.len(), TASKS);

    let shared = planned();
    kill_midway(shared.path(), 3);
    let mut parts = Vec::new();
    for shard in ["1/3", "2/3", "3/3"] {
        parts.push(start(shared.path(), &["--shard", shard, "--threads", "2"]));
    }
    for mut part in parts {
        assert!(part.wait().unwrap().success());
    }
    assert!(results(shared.path()) == expected);
    let merged = merge(shared.path());
    assert!(merged == merge(alone.path()));
    let text = succeeds(run_in(shared.path(), &["study", "run", "s"], ""));
    assert_eq!(text, format!("s: 0 tasks run, {TASKS} were done before\n"));

    check_documents(shared.path(), &merged);
    check_pictures(shared.path(), &merged);
    check_missing(shared.path(), &expected);
}

/// Plan, results and table have their schemas, and the numbers are those of a sampler that is right.
fn check_documents(folder: &Path, merged: &BTreeMap<String, Vec<u8>>) {
    json(&fs::read_to_string(folder.join("s/plan.json")).unwrap());
    let table = json(std::str::from_utf8(&merged["study.json"]).unwrap());
    let records = table["results"].as_array().unwrap();
    // Six tiles are one picture.
    assert_eq!(records.len(), TASKS - 4 * 5);
    let mut estimates = 0;
    for record in records {
        let (task, result) = (&record["task"], &record["result"]);
        match task["kind"].as_str().unwrap() {
            "estimate" => {
                let number = |name: &str| result[name][0].as_f64().unwrap();
                let error = (number("mean") - number("albedo")).abs();
                let spread = number("deviation") / 2000f64.sqrt();
                assert!(error < 5.0 * spread + 1e-4, "{record}");
                estimates += 1;
            }
            "check" => assert_eq!(result["passed"], Value::Bool(true), "{record}"),
            "fit" => assert_eq!(result["fits"].as_array().unwrap().len(), 1),
            _ => assert!(result["picture"].as_str().unwrap().ends_with(".exr")),
        }
    }
    assert_eq!(estimates, 16);
    let csv = std::str::from_utf8(&merged["study.csv"]).unwrap();
    assert_eq!(csv.lines().count(), 1 + records.len());
    assert!(
        csv.lines()
            .nth(1)
            .unwrap()
            .starts_with("estimate,lambert:reflectance=0.5,floor,half-vector:2KB,10.0,1,2000,")
    );
}

/// Pictures have the pixels that `render` draws, and their headers name its command.
fn check_pictures(folder: &Path, merged: &BTreeMap<String, Vec<u8>>) {
    let mut pictures = 0;
    for name in merged.keys().filter(|name| name.ends_with(".exr")) {
        let picture = folder.join("merged").join(name);
        let header = merlkit::image::Image::read_comment(&picture)
            .unwrap()
            .unwrap();
        let command = header
            .lines()
            .find_map(|line| line.strip_prefix("command: merlkit "));
        let words: Vec<&str> = command.unwrap().split(' ').collect();
        succeeds(run_in(folder, &[&words[..], &["--force"]].concat(), ""));
        let drawn = crate::run::pixels(folder);
        assert_eq!(
            drawn.pixels(),
            read_exr(&picture).unwrap().pixels(),
            "{header}"
        );
        pictures += 1;
    }
    assert_eq!(pictures, 4);
}

/// What is missing is named by commands that make it.
fn check_missing(folder: &Path, expected: &BTreeMap<String, Vec<u8>>) {
    for name in expected.keys().take(2) {
        fs::remove_file(folder.join("s/results").join(name)).unwrap();
    }
    let output = run_in(folder, &["study", "merge", "s", "-o", "m"], "");
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(
        text.contains(&format!("2 of {TASKS} results are missing")),
        "{text}"
    );
    assert!(text.contains(": merlkit study run s\n"), "{text}");
    let commands = text
        .lines()
        .filter_map(|line| line.strip_prefix("merlkit study "));
    let mut made = 0;
    for command in commands {
        let words: Vec<&str> = command.split(' ').collect();
        let text = succeeds(run_in(folder, &[&["study"], &words[..]].concat(), ""));
        assert_eq!(text, "s: 1 tasks run, 0 were done before\n");
        made += 1;
    }
    assert_eq!(made, 2);
    assert!(results(folder) == *expected);
    // A file that holds something else is found, and says so.
    let (name, other) = (
        expected.keys().next().unwrap(),
        expected.values().last().unwrap(),
    );
    fs::write(folder.join("s/results").join(name), other).unwrap();
    let text = fails(run_in(folder, &["study", "merge", "s", "-o", "m"], ""));
    assert!(text.contains(name) && text.contains("remove it"), "{text}");
}

#[test]
fn studies_that_nobody_can_run_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("study.toml");
    let plan = ["study", "plan", "study.toml", "-o", "s"];
    for (from, to, words) in [
        (
            "seeds = 2",
            "seeds = 9000000000000000000",
            "more than 1000000 tasks",
        ),
        ("seeds = 2", "seeds = -2", "is no study"),
        ("seeds = 2", "seed = 2", "unknown field `seed`"),
        ("tile = 20", "tile = 0", "more than 1000000 tasks"),
        (
            "[50, 30]",
            "[900000000000, 900000000000]",
            "more than 1000000 tasks",
        ),
        ("60.5", "nan", "polar angle"),
        ("60.5", "10", "twice"),
        ("spp = 4", "spp = 0", "0 paths"),
        ("\"cosine\"", "\"file\"", "merlkit: "),
        ("\"cosine\"", "\"no-such\"", "no-such"),
        (
            "[\"lambert:reflectance=0.5\"",
            "[\"/etc/no-such\"",
            "/etc/no-such",
        ),
        ("materials", "materials = [", "is no study"),
    ] {
        let bad = STUDY.replacen(from, to, 1);
        assert_ne!(bad, STUDY);
        fs::write(&path, bad).unwrap();
        let text = fails(run_in(folder.path(), &plan, ""));
        assert!(text.contains(words), "{to}: {text}");
        assert!(!folder.path().join("s").exists());
    }
}

#[test]
fn plans_that_were_changed_are_refused() {
    let folder = planned();
    let plan = folder.path().join("s/plan.json");
    let text = fs::read_to_string(&plan).unwrap();
    let key = text
        .split('"')
        .find(|word| word.starts_with("estimate-lambert-"))
        .unwrap();
    for (from, to) in [
        (key, "../../outside"),
        (key, "/tmp/outside"),
        ("\"draws\":2000", "\"draws\":2001"),
    ] {
        fs::write(&plan, text.replacen(from, to, 1)).unwrap();
        let error = fails(run_in(folder.path(), &["study", "run", "s"], ""));
        assert!(error.contains("is not its task's"), "{error}");
    }
    fs::write(&plan, text).unwrap();
    let refused = fails(run_in(
        folder.path(),
        &["study", "plan", "study.toml", "-o", "s"],
        "",
    ));
    assert!(refused.contains("--force"), "{refused}");
    let unknown = ["study", "run", "s", "--task", "../../outside"];
    assert!(fails(run_in(folder.path(), &unknown, "")).contains("no task"));
    for shard in ["0/3", "4/3", "1/0", "3"] {
        fails(run_in(
            folder.path(),
            &["study", "run", "s", "--shard", shard],
            "",
        ));
    }
    assert!(fails(run(&["study", "run", "no-such-folder"], "")).contains("no-such-folder"));
}

#[test]
fn a_material_that_is_damaged_keeps_no_other_from_being_done() {
    let folder = tempfile::tempdir().unwrap();
    let decode = ["decode", "nickel", "-o", "."];
    succeeds(run_in(folder.path(), &decode, ""));
    let study =
        r#"{"materials": ["nickel.binary", "lambert"], "samplers": ["cosine"], "thetas": [30]}"#;
    fs::write(folder.path().join("study.json"), study).unwrap();
    succeeds(run_in(
        folder.path(),
        &["study", "plan", "study.json", "-o", "s"],
        "",
    ));
    fs::write(folder.path().join("nickel.binary"), "no table").unwrap();
    let output = run_in(folder.path(), &["study", "run", "s"], "");
    let words = String::from_utf8(output.stdout.clone()).unwrap();
    assert_eq!(words, "s: 1 tasks run, 0 were done before, 1 failed\n");
    assert!(fails(output).contains("nickel.binary"));
    let mut all = results(folder.path()).into_keys();
    assert!(all.next().unwrap().starts_with("estimate-lambert-"));
    assert_eq!(all.next(), None);
}
