//! JSON documents against the schemas of `docs/schema`.

use std::path::Path;

use boon::{Compiler, Schemas};
use serde_json::{Value, json};

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
    let origin = json!({"version": "0.1.0", "command": "merlkit list"});
    let good = json!({"schema": 3, "kind": "list", "provenance": origin, "results": ["nickel"]});
    assert_eq!(check(&good, "list"), Ok(()));
    for bad in [
        json!({"schema": 3, "kind": "list", "provenance": origin}),
        json!({"schema": 3, "kind": "list", "results": ["nickel"]}),
        json!({"schema": 3, "kind": "list", "provenance": origin, "results": ["nickel"], "more": 1}),
        json!({"schema": 3, "kind": "list", "provenance": origin, "results": [1]}),
        json!({"schema": 2, "kind": "list", "provenance": origin, "results": ["nickel"]}),
    ] {
        assert!(check(&bad, "list").is_err(), "{bad}");
    }
}
