//! What shells and `man` are given, made of the same definitions as the help.

use crate::run::{fails, run, run_in, succeeds};

/// The commands that the overview lists.
pub fn command_names() -> Vec<String> {
    let overview = succeeds(run(&["--help"], ""));
    let commands = overview.split("Commands:").nth(1).unwrap();
    let mut names = Vec::new();
    for line in commands.lines().skip(1) {
        if line.trim().is_empty() {
            break;
        }
        if line.starts_with("  ") && !line.starts_with("   ") {
            names.extend(line.split_whitespace().next().map(str::to_owned));
        }
    }
    names
}

#[test]
fn completions_name_every_command() {
    for shell in ["bash", "zsh", "fish"] {
        let script = succeeds(run(&["completions", shell], ""));
        for name in command_names() {
            assert!(script.contains(&name), "{shell}: {name}");
        }
        assert!(script.contains("target-error"), "{shell}");
    }
    assert!(fails(run(&["completions", "dash"], "")).contains("possible values"));
}

#[test]
fn there_is_a_manual_page_for_each_command() {
    let page = succeeds(run(&["man", "render"], ""));
    assert!(page.contains(".TH merlkit-render 1"), "{page}");
    assert!(page.contains(r"\-\-target\-error"));
    assert!(succeeds(run(&["man"], "")).contains(".TH merlkit 1"));
    assert!(fails(run(&["man", "rendr"], "")).contains("no command rendr"));

    let folder = tempfile::tempdir().unwrap();
    let written = succeeds(run_in(folder.path(), &["man", "-o", "man1"], ""));
    for name in command_names() {
        let file = folder.path().join(format!("man1/merlkit-{name}.1"));
        assert!(file.exists(), "{name}");
        assert!(written.contains(&format!("merlkit-{name}.1")));
    }
    assert!(fails(run_in(folder.path(), &["man", "-o", "man1"], "")).contains("--force"));
    succeeds(run_in(folder.path(), &["man", "-o", "man1", "--force"], ""));
}

#[test]
fn every_help_has_an_example_whose_options_exist() {
    for name in command_names() {
        if name == "help" {
            continue;
        }
        let help = succeeds(run(&["help", &name], ""));
        let examples: Vec<&str> = help
            .lines()
            .filter_map(|line| line.strip_prefix("  merlkit "))
            .collect();
        assert!(!examples.is_empty(), "{name} has no example");
        for example in examples {
            // Unknown options are refused before --help is answered. What follows belongs to the shell.
            let end = example.find(['>', '<', '|', '#']).unwrap_or(example.len());
            let mut words: Vec<&str> = example[..end].split_whitespace().collect();
            words.push("--help");
            assert_eq!(words[0], name, "{example}");
            succeeds(run(&words, ""));
        }
    }
}
