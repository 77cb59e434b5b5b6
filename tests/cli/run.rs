//! Runs the program and takes its answers apart.

use std::io::Write;
use std::path::Path;
use std::process::{Output, Stdio};

use assert_cmd::cargo::cargo_bin;

use crate::schemas::assert_documented;

/// Runs `merlkit` in `folder` with `input` on standard input.
pub fn run_in(folder: &Path, arguments: &[&str], input: &str) -> Output {
    let mut child = std::process::Command::new(cargo_bin!("merlkit"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    // Beside reading the output: a command that has filled its pipe reads no further.
    std::thread::scope(|scope| {
        // A command that stops early closes its input, which is no concern of these tests.
        scope.spawn(move || stdin.write_all(input.as_bytes()).ok());
        child.wait_with_output().unwrap()
    })
}

pub fn run(arguments: &[&str], input: &str) -> Output {
    run_in(Path::new("."), arguments, input)
}

/// Notes on measured times, which depend on what else the machine does.
const TIMING_NOTES: [&str; 2] = [
    "the machine was busy",
    "measured times differ from counted ones",
];

/// The lines of standard error that don't depend on the clock.
pub fn without_timing(complaints: &str) -> Vec<&str> {
    let mut lines: Vec<&str> = complaints.lines().collect();
    lines.retain(|line| !TIMING_NOTES.iter().any(|note| line.contains(note)));
    lines
}

/// Standard output of a command that succeeds and has nothing to complain about but the clock.
pub fn succeeds(output: Output) -> String {
    let complaints = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{complaints}");
    assert!(without_timing(&complaints).is_empty(), "{complaints}");
    String::from_utf8(output.stdout).unwrap()
}

/// Standard error of a command that ends with status 2.
pub fn fails(output: Output) -> String {
    assert_eq!(output.status.code(), Some(2));
    String::from_utf8(output.stderr).unwrap()
}

/// What `render` drew there where nothing else was asked for, without what its header says of the command.
pub fn pixels(folder: &Path) -> merlkit::image::Image {
    merlkit::image::read_exr(&folder.join("render.exr")).unwrap()
}

/// JSON that a command printed, which its schema documents.
pub fn json(text: &str) -> serde_json::Value {
    let document = serde_json::from_str(text).unwrap();
    assert_documented(&document);
    document
}

/// A plot as SVG without the line that says which command drew it.
pub fn without_origin(svg: &str) -> String {
    let mut lines: Vec<&str> = svg.lines().collect();
    let all = lines.len();
    lines.retain(|line| !line.starts_with("<metadata>merlkit "));
    assert_eq!(lines.len(), all - 1, "one line says where it comes from");
    lines.join("\n")
}
