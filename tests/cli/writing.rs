//! Outputs when the disk is full, the path is wrong, the reader leaves or the user presses Ctrl-C: whole files or none.
#![cfg(unix)]

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

use assert_cmd::cargo::cargo_bin;

fn merlkit(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(cargo_bin!("merlkit"));
    command
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null());
    command
}

fn output(folder: &Path, arguments: &[&str]) -> Output {
    merlkit(folder, arguments).output().unwrap()
}

/// `merlkit` in a shell that lets it write `blocks` of 1024 bytes to a file, as if the disk were full then.
fn on_a_full_disk(folder: &Path, blocks: u32, arguments: &[&str]) -> Output {
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
    let mut command = Command::new("bash");
    command
        .args(["-c", &script])
        .arg(cargo_bin!("merlkit"))
        .args(arguments);
    command.current_dir(folder).output().unwrap()
}

/// The one error of a command that ended with status 2. Notes may precede it: a busy machine is one of their reasons.
fn refused(output: &Output) -> String {
    let text = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(output.status.code(), Some(2), "{text}");
    let mut errors = Vec::new();
    for line in text.lines() {
        if !line.starts_with("merlkit: note: ") {
            errors.push(line);
        }
    }
    assert!(
        errors.len() == 1 && errors[0].starts_with("merlkit: "),
        "{text}"
    );
    errors[0].to_string()
}

/// Names in a folder, temporary ones included.
pub fn names(folder: &Path) -> Vec<String> {
    let name =
        |e: std::io::Result<std::fs::DirEntry>| e.unwrap().file_name().into_string().unwrap();
    let mut all: Vec<String> = std::fs::read_dir(folder).unwrap().map(name).collect();
    all.sort();
    all
}

const NONE: [&str; 0] = [];
const RENDER: [&str; 8] = [
    "render", "nickel", "--light", "point", "--size", "300x200", "--spp", "1",
];
const REPORT: [&str; 6] = ["report", "nickel", "--draws", "1", "--sampler", "cosine"];

#[test]
fn a_full_disk_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let json: Vec<&str> = [&REPORT[..], &["--json", "r.json"]].concat();
    for (arguments, file) in [
        (&["decode", "nickel", "-o", "."][..], "nickel.binary"),
        (
            &[
                "build",
                "nickel",
                "--sampler",
                "cascade-cdf:tables=2",
                "-o",
                "s",
            ],
            "s",
        ),
        (&RENDER, "render.exr"),
        (&json, "r.json"),
        (&["list", "--json", "names.json"], "names.json"),
    ] {
        let blocks = if file.ends_with(".json") { 0 } else { 1 };
        let text = refused(&on_a_full_disk(folder.path(), blocks, arguments));
        assert!(
            text.contains(file) && text.contains("cannot write"),
            "{text}"
        );
        assert_eq!(names(folder.path()), NONE, "{arguments:?}");
    }
}

/// What was there stays there if the new one can't be written.
#[test]
fn a_full_disk_keeps_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("nickel.binary"), "old").unwrap();
    refused(&on_a_full_disk(
        folder.path(),
        8,
        &["decode", "nickel", "-o", ".", "--force"],
    ));
    assert_eq!(
        std::fs::read_to_string(folder.path().join("nickel.binary")).unwrap(),
        "old"
    );
    assert_eq!(names(folder.path()), ["nickel.binary"]);
}

#[test]
fn a_full_standard_output_is_an_error() {
    let full = std::fs::OpenOptions::new()
        .write(true)
        .open("/dev/full")
        .unwrap();
    let output = merlkit(Path::new("."), &["list"])
        .stdout(full)
        .output()
        .unwrap();
    assert!(refused(&output).contains("standard output: cannot write"));
}

#[test]
fn devices_are_not_replaced_by_files() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    assert!(
        Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    for path in ["pipe", "/dev/null", "/dev/stdout"] {
        // As `list` has its output read, standard output is a pipe.
        let text = refused(&output(folder.path(), &["list", "--json", path, "--force"]));
        assert!(text.contains("a pipe or device"), "{text}");
    }
    assert_eq!(names(folder.path()), ["pipe"]);
}

#[test]
fn a_build_goes_on_past_a_broken_file_and_lists_what_it_wrote() {
    let folder = tempfile::tempdir().unwrap();
    assert!(
        output(folder.path(), &["decode", "nickel", "-o", "."])
            .status
            .success()
    );
    std::fs::write(folder.path().join("broken.binary"), "no table").unwrap();
    let arguments = [
        "build",
        "nickel.binary",
        "broken.binary",
        "red-plastic",
        "--sampler",
        "cascade-cdf:tables=2",
        "-o",
        "s",
    ];
    let output = output(
        folder.path(),
        &[&arguments[..], &["--threads", "1"]].concat(),
    );
    assert_eq!(output.status.code(), Some(2));
    let complaints = String::from_utf8(output.stderr).unwrap();
    assert!(
        complaints.starts_with("merlkit: broken.binary: "),
        "{complaints}"
    );
    let text = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let files = [
        "nickel.cascade-cdf.safetensors",
        "red-plastic.cascade-cdf.safetensors",
    ];
    assert_eq!(lines.len(), files.len(), "{text}");
    for (line, file) in lines.iter().zip(files) {
        assert!(line.starts_with(&format!("s/{file}: ")), "{text}");
    }
    assert_eq!(names(&folder.path().join("s")), files);
}

/// A running command whose first line of output has come.
pub struct Running {
    child: Child,
    out: BufReader<std::process::ChildStdout>,
}

impl Running {
    pub fn start(folder: &Path, arguments: &[&str]) -> Self {
        let mut child = merlkit(folder, arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let out = BufReader::new(child.stdout.take().unwrap());
        Self { child, out }
    }

    pub fn line(&mut self) -> String {
        let mut line = String::new();
        assert!(
            self.out.read_line(&mut line).unwrap() > 0,
            "the command ended early"
        );
        line
    }

    /// Presses Ctrl-C and returns what is left of the output.
    fn interrupt(self) -> String {
        self.signal("-INT", 130).0
    }

    /// Sends a signal, and returns what is left of the output and all messages.
    pub fn signal(mut self, signal: &str, status: i32) -> (String, String) {
        let id = self.child.id().to_string();
        assert!(
            Command::new("kill")
                .args([signal, &id])
                .status()
                .unwrap()
                .success()
        );
        let mut rest = String::new();
        self.out.read_to_string(&mut rest).unwrap();
        let output = self.child.wait_with_output().unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(status), "{text}");
        assert!(text.ends_with("merlkit: interrupted\n"), "{text}");
        (rest, text)
    }
}

#[test]
fn an_interrupted_report_keeps_the_finished_materials() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = [
        "report",
        "--all",
        "--draws",
        "1000",
        "--sampler",
        "cosine",
        "--json",
        "r.json",
        "--csv",
        "r.csv",
    ];
    let mut running = Running::start(folder.path(), &arguments);
    while !running.line().trim().is_empty() {}
    running.interrupt();
    assert_eq!(names(folder.path()), ["r.csv", "r.json"]);
    let text = std::fs::read_to_string(folder.path().join("r.json")).unwrap();
    let document: serde_json::Value = serde_json::from_str(&text).unwrap();
    let finished = document["results"].as_array().unwrap().len();
    assert!((1..100).contains(&finished), "{finished}");
    let csv = std::fs::read_to_string(folder.path().join("r.csv")).unwrap();
    assert!(csv.ends_with('\n') && csv.lines().count() > 1);
}

#[test]
fn an_interrupted_render_leaves_nothing_half_written() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = [
        "render",
        "nickel",
        "--light",
        "point",
        "--explain",
        "--size",
        "200x200",
        "--spp",
        "100000",
    ];
    let mut running = Running::start(folder.path(), &arguments);
    running.line();
    running.interrupt();
    // If it had begun, it is kept: `resume` looks at that.
    let kept = ["render.exr", "render.partial", "render.png"];
    let names = names(folder.path());
    assert!(names == NONE || names == kept, "{names:?}");
}

#[test]
fn an_interrupted_check_keeps_the_finished_outcomes() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = [
        "check",
        "--all",
        "--draws",
        "1000",
        "--sampler",
        "cosine",
        "--json",
        "c.json",
    ];
    // `check` shows nothing until it is done, so on a slow machine the first waits may be too short for one material.
    let text = [1, 2, 4, 8, 16].into_iter().find_map(|seconds| {
        let running = Running::start(folder.path(), &arguments);
        std::thread::sleep(std::time::Duration::from_secs(seconds));
        running.interrupt();
        std::fs::read_to_string(folder.path().join("c.json")).ok()
    });
    let text = text.expect("no outcome was kept in 16 s");
    let document: serde_json::Value = serde_json::from_str(&text).unwrap();
    let finished = document["results"].as_array().unwrap().len();
    assert!((1..100).contains(&finished), "{finished}");
}

/// In the midst of writing: the temporary file goes, the finished ones stay and are whole.
#[test]
fn a_terminated_decode_keeps_whole_files() {
    let folder = tempfile::tempdir().unwrap();
    let running = Running::start(folder.path(), &["decode", "--all", "-o", "."]);
    let whole = |p: &PathBuf| p.extension().is_some_and(|e| e == "binary");
    let there = || {
        names(folder.path())
            .into_iter()
            .map(|n| folder.path().join(n))
    };
    let being_written = |p: &PathBuf| p.metadata().is_ok_and(|m| m.len() > 0);
    while !(there().any(|p| whole(&p)) && there().any(|p| !whole(&p) && being_written(&p))) {
        std::thread::yield_now();
    }
    running.signal("-TERM", 143);
    for path in there() {
        assert!(whole(&path), "{} was left behind", path.display());
        assert_eq!(
            path.metadata().unwrap().len(),
            34_992_012,
            "{}",
            path.display()
        );
    }
}
