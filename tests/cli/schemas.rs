//! JSON documents against the schemas of `docs/schema`.

use std::path::Path;

use boon::{Compiler, Schemas};
use serde_json::{Value, json as object};

use crate::run::{json, run, succeeds};

/// Asserts that a document of the command line has the fields that the schema of its kind names, and no others. Other JSON passes.
pub fn assert_documented(document: &Value) {
    let Some(kind) = document["kind"].as_str() else {
        return;
    };
    if let Err(reason) = check(document, kind) {
        panic!("a document of the kind {kind} differs from docs/schema/{kind}.json: {reason}");
    }
}

fn check(document: &Value, kind: &str) -> Result<(), String> {
    let name = format!("docs/schema/{kind}.json");
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(&name);
    let text = std::fs::read_to_string(path).map_err(|e| format!("{name}: {e}"))?;
    let schema: Value = serde_json::from_str(&text).map_err(|e| format!("{name}: {e}"))?;
    let (mut schemas, mut compiler) = (Schemas::new(), Compiler::new());
    compiler
        .add_resource(&name, schema)
        .map_err(|e| e.to_string())?;
    let index = compiler
        .compile(&name, &mut schemas)
        .map_err(|e| e.to_string())?;
    schemas
        .validate(document, index)
        .map_err(|e| format!("{e:#}"))
}

/// Removes or adds a field, or changes its type.
#[test]
fn other_shapes_are_refused() {
    let origin = object!({"version": "0.1.0", "command": "merlkit list"});
    let good = object!({"schema": 3, "kind": "list", "provenance": origin, "results": ["nickel"]});
    assert_eq!(check(&good, "list"), Ok(()));
    for bad in [
        object!({"schema": 3, "kind": "list", "provenance": origin}),
        object!({"schema": 3, "kind": "list", "results": ["nickel"]}),
        object!({"schema": 3, "kind": "list", "provenance": origin, "results": ["nickel"], "more": 1}),
        object!({"schema": 3, "kind": "list", "provenance": origin, "results": [1]}),
        object!({"schema": 2, "kind": "list", "provenance": origin, "results": ["nickel"]}),
    ] {
        assert!(check(&bad, "list").is_err(), "{bad}");
    }
}

/// Only documents with measured times name the day and the machine: the others are the same in every run.
#[test]
fn documents_say_where_they_come_from() {
    let list = json(&succeeds(run(&["list", "--json"], "")));
    let origin = &list["provenance"];
    assert_eq!(origin["command"], "merlkit list");
    assert_eq!(origin["version"], env!("CARGO_PKG_VERSION"));
    let quick = ["lambert", "--sampler", "cosine", "--draws", "1000"];
    for (command, is_timed) in [("check", false), ("report", true)] {
        let arguments = [&[command][..], &quick, &["--json", "-"]].concat();
        let document = json(&succeeds(run(&arguments, "")));
        let origin = &document["provenance"];
        let expected = format!("merlkit {command} {}", quick.join(" "));
        assert_eq!(origin["command"], *expected);
        assert_eq!(origin["seed"], 1);
        let sum = origin["materials"][0]["sha256"].as_str().unwrap();
        assert_eq!(sum.len(), 64, "{sum}");
        assert_eq!(origin.get("date").is_some(), is_timed, "{origin}");
        assert_eq!(origin.get("machine").is_some(), is_timed, "{origin}");
    }
}
