//! What every command has in common: help, versions, wrong usage, names.

use std::io::Write;
use std::process::Stdio;

use assert_cmd::cargo::cargo_bin;

use crate::run::{fails, json, run, run_in, succeeds};
use crate::shell::command_names;

#[test]
fn list_names_the_hundred_materials() {
    let text = succeeds(run(&["list"], ""));
    assert_eq!(text.lines().count(), 100);
    assert!(text.lines().any(|l| l == "red-plastic"));
    let document = json(&succeeds(run(&["list", "--json"], "")));
    assert_eq!(
        (&document["schema"], &document["kind"]),
        (&3.into(), &"list".into())
    );
    let names: Vec<_> = document["results"]
        .as_array()
        .unwrap()
        .iter()
        .map(|n| n.as_str().unwrap())
        .collect();
    assert_eq!(names, text.lines().collect::<Vec<_>>());
}

#[test]
fn the_version_is_the_packages() {
    let version = format!("merlkit {}", env!("CARGO_PKG_VERSION"));
    assert_eq!(succeeds(run(&["-V"], "")).trim(), version);
    let text = succeeds(run(&["--version"], ""));
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], version);
    assert!(
        lines[1].starts_with(&format!(
            "target: {} {}",
            std::env::consts::ARCH,
            std::env::consts::OS
        )),
        "{text}"
    );
    assert!(lines[2].starts_with("cpu features: "), "{text}");
    assert_eq!(lines[3].contains("debug"), cfg!(debug_assertions), "{text}");
}

#[test]
fn every_command_has_help() {
    let help = succeeds(run(&["--help"], ""));
    assert!(help.contains("Exit status"));
    let commands = help
        .split("Commands:")
        .nth(1)
        .unwrap()
        .split("Options:")
        .next()
        .unwrap();
    let names: Vec<_> = commands
        .lines()
        .filter(|l| l.starts_with("  ") && !l.starts_with("   "))
        .collect();
    assert!(names.len() >= 5, "{commands}");
    for line in names {
        let name = line.split_whitespace().next().unwrap();
        let about = line.split_whitespace().nth(1);
        assert!(about.is_some(), "{name} is not described");
        let text = succeeds(run(&["help", name], ""));
        assert!(text.contains("--threads") || name == "help", "{name}");
    }
}

#[test]
fn wrong_usage_is_status_two() {
    for arguments in [
        &["no-such-command"][..],
        &["info"],
        &["decode", "-o", "x"],
        &["list", "--threads", "0"],
    ] {
        assert!(
            fails(run(arguments, "")).contains("Usage") || arguments.contains(&"0"),
            "{arguments:?}"
        );
    }
    assert!(
        fails(run(&["eval", "nickel", "--lookup", "cubic"], ""))
            .contains("[possible values: floor")
    );
    assert!(fails(run(&["list", "--threads", "60000"], "")).contains("1..=1024"));
}

#[test]
fn arguments_without_meaning_are_refused_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, expected) in [
        (
            &["render", "nickel", "--exposure", "nan"][..],
            "finite number of stops",
        ),
        (
            &["render", "nickel", "--light", "point", "-o", "no/such/x"],
            "there is no folder no/such",
        ),
        (
            &["info", "nickel", "--json", ".", "--force"],
            ". is a folder",
        ),
        (&["report", "nickel", "--draws", "0"], "0 draws"),
        (
            &["report", "nickel", "--json", "-", "--csv", "-"],
            "the same output",
        ),
        (
            &[
                "sample",
                "nickel",
                "--theta",
                "1",
                "--count",
                "1",
                "--sampler",
                "cascade-cdf:cells=8192x8192,tables=64,tolerance=none",
            ],
            "64 tables of 8192 × 8192 cells",
        ),
    ] {
        let output = run_in(folder.path(), arguments, "");
        assert!(output.stdout.is_empty(), "{arguments:?}");
        let text = fails(output);
        assert!(text.contains(expected), "{arguments:?}: {text}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn misspelt_materials_are_answered_with_the_nearest() {
    for command in ["info", "eval"] {
        let text = fails(run(&[command, "nikel"], ""));
        assert!(
            text.starts_with("merlkit: no file and no built-in material is called \"nikel\""),
            "{text}"
        );
        assert!(text.contains("did you mean nickel"), "{text}");
    }
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
    let _ = child
        .stdin
        .take()
        .unwrap()
        .write_all("0,0,1,0,0,1\n".repeat(100_000).as_bytes());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
}

/// Lines that the longest help may have: more than two screens, and nobody reads it.
const LONGEST_HELP: usize = 110;

#[test]
fn no_help_is_longer_than_two_screens() {
    let names = command_names();
    assert!(
        names.len() > 10 && names.iter().any(|name| name == "render"),
        "{names:?}"
    );
    for name in names {
        let lines = succeeds(run(&["help", &name], "")).lines().count();
        assert!(lines <= LONGEST_HELP, "{name}: {lines} lines");
    }
}

/// Options other than `--threads` and `--help` that a help may list without headings.
const FEW_OPTIONS: usize = 3;

#[test]
fn many_options_are_grouped_under_headings() {
    for name in command_names() {
        let text = succeeds(run(&["help", &name], ""));
        let Some(options) = text.split("\nOptions:\n").nth(1) else {
            continue;
        };
        let options = options.split("\n\n").flat_map(str::lines);
        let ungrouped = options
            .take_while(|line| line.is_empty() || line.starts_with(' '))
            .filter(|line| line.trim_start().starts_with('-'))
            .count();
        assert!(ungrouped <= FEW_OPTIONS + 2, "{name}: {ungrouped}");
    }
}
