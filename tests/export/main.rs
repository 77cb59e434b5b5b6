//! Exported headers and arrays do what the library does.

mod command;
mod glsl;
mod header;
mod numpy;
mod program;
mod runtime;
mod shaders;
#[path = "../support/mod.rs"]
mod support;

use std::io::Write;
use std::process::Command;

/// Whether a program of the test is there; says so if not.
fn has(program: &str, arguments: &[&str]) -> bool {
    let found = Command::new(program)
        .args(arguments)
        .output()
        .is_ok_and(|o| o.status.success());
    if !found {
        // Not by a macro, whose output the test harness would keep to itself.
        let note = format!("skipped: no {program} for {arguments:?}\n");
        std::io::stderr().write_all(note.as_bytes()).unwrap();
    }
    found
}

/// The folder of the repository.
const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
