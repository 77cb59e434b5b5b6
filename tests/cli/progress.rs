//! What a terminal shows while a command works. `script` of util-linux makes the terminal; the tests skip, saying so, without it.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use assert_cmd::cargo::cargo_bin;

/// What a terminal shows of `merlkit` with these words, or `None` where there is no `script`. Nothing is typed; end of file is.
fn type_in(folder: &Path, words: &str) -> Option<String> {
    let command = format!("{} {words}", cargo_bin!("merlkit").display());
    let output = Command::new("script")
        .args(["--quiet", "--return", "--command", &command, "/dev/null"])
        .current_dir(folder)
        .stdin(Stdio::null())
        .output();
    let Ok(output) = output else {
        eprintln!("skipped: no `script` that makes a terminal");
        return None;
    };
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{text}");
    Some(text)
}

/// A sampler that takes longer than a second to build on one thread, and the verb of each command that builds it.
#[test]
fn work_of_one_part_shows_a_bar_before_it_is_done() {
    let folder = tempfile::tempdir().unwrap();
    let sampler = "--threads 1 --sampler adaptive-disc:tables=800";
    for (words, verb) in [
        (
            format!("build nickel {sampler} -o a.safetensors"),
            "building",
        ),
        (
            format!("plot nickel --kind disc {sampler} -o a.svg"),
            "plotting",
        ),
        (
            format!("render nickel {sampler} --size 32x32 --spp 1 -o a"),
            "loading and building",
        ),
    ] {
        let Some(text) = type_in(folder.path(), &words) else {
            return;
        };
        assert!(shows_unfinished_bar(&text, verb), "{words}: {verb}\n{text}");
        assert!(text.contains("so far") || text.contains(" left"), "{text}");
    }
}

/// Whether a bar of 30 places under `verb` is drawn that is not full.
fn shows_unfinished_bar(text: &str, verb: &str) -> bool {
    for (position, _) in text.match_indices(verb) {
        let bar = text[position + verb.len()..].trim_start();
        let places = bar.bytes().take_while(|b| b"#-".contains(b)).count();
        if places == 30 && bar[..places].ends_with('-') {
            return true;
        }
    }
    false
}

#[test]
fn quick_work_shows_no_bar() {
    let folder = tempfile::tempdir().unwrap();
    let started = Instant::now();
    let Some(text) = type_in(folder.path(), "info lambert") else {
        return;
    };
    assert!(text.contains("lambert"), "{text}");
    // A busy machine may take longer.
    if started.elapsed() < Duration::from_millis(900) {
        assert!(!text.contains("so far"), "{text}");
    }
}

#[test]
fn eval_says_what_it_waits_for() {
    let folder = tempfile::tempdir().unwrap();
    let Some(text) = type_in(folder.path(), "eval lambert") else {
        return;
    };
    assert!(
        text.contains("reading wo_x,wo_y,wo_z,wi_x,wi_y,wi_z lines from standard input"),
        "{text}"
    );
}
