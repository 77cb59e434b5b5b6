//! Which module may import which: the architecture, held.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const TABLE: &[(&str, &[&str])] = &[
    ("error", &[]),
    ("color", &[]),
    ("points", &[]),
    ("geometry", &["error"]),
    ("files", &["error"]),
    ("distribution", &["error"]),
    ("batch", &[]),
    ("lanes", &["geometry"]),
    ("brdf", &["batch", "geometry", "color"]),
    ("direction_sampler", &["batch", "points"]),
    (
        "material",
        &[
            "geometry",
            "color",
            "error",
            "files",
            "batch",
            "lanes",
            "brdf",
            "direction_sampler",
        ],
    ),
    (
        "sampler",
        &[
            "geometry",
            "color",
            "distribution",
            "batch",
            "lanes",
            "brdf",
            "direction_sampler",
            "error",
            "files",
            "points",
            "material",
        ],
    ),
    (
        "export",
        &["geometry", "brdf", "error", "files", "material", "sampler"],
    ),
    (
        "light",
        &["geometry", "color", "distribution", "error", "points"],
    ),
    ("image", &["color", "error", "files"]),
    (
        "render",
        &[
            "geometry",
            "color",
            "distribution",
            "batch",
            "brdf",
            "direction_sampler",
            "error",
            "files",
            "points",
            "material",
            "sampler",
            "light",
            "image",
        ],
    ),
];

#[test]
fn modules_import_only_what_lies_below_them() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut seen = BTreeSet::new();
    for file in sources(&root) {
        let module = module_of(&file, &root);
        if module == "lib" {
            continue;
        }
        let (_, allowed) = TABLE
            .iter()
            .find(|(name, _)| *name == module)
            .unwrap_or_else(|| panic!("{module} has no line in the table of imports"));
        for import in imports(&std::fs::read_to_string(&file).unwrap()) {
            seen.insert((module.clone(), import.clone()));
            let inside = import == module || allowed.contains(&import.as_str());
            assert!(
                inside,
                "{}: {module} must not import {import}",
                file.display()
            );
        }
    }
    // The reader of imports works: these are certain.
    for (module, import) in [
        ("material", "files"),
        ("sampler", "brdf"),
        ("render", "light"),
    ] {
        assert!(
            seen.contains(&(module.into(), import.into())),
            "{module} → {import} was not seen"
        );
    }
}

#[test]
fn imports_are_read_in_every_spelling() {
    let text = "use crate::a::X;\nuse crate::{Error, b::{Y, Z}, c};\nlet x = crate::d::f();\n\
                /// [`crate::doc`]\n//! crate::doc\n#[cfg(test)]\nmod tests { use crate::test::T; }";
    let expected = ["a", "b", "c", "d", "error"].map(String::from);
    assert_eq!(imports(text), BTreeSet::from(expected));
}

/// Modules that a file names after `crate::`, comments and its tests aside. `Error` and `Result` are module `error`'s.
fn imports(text: &str) -> BTreeSet<String> {
    let text = text.split("#[cfg(test)]").next().unwrap();
    let code: String = text
        .lines()
        .map(|l| l.split("//").next().unwrap())
        .collect::<Vec<_>>()
        .join("\n");
    let mut out = BTreeSet::new();
    for after in code.split("crate::").skip(1) {
        let names = match after.strip_prefix('{') {
            Some(group) => top_level(group),
            None => vec![first_word(after)],
        };
        out.extend(names.into_iter().map(|n| match n.as_str() {
            "Error" | "Result" => "error".to_owned(),
            _ => n,
        }));
    }
    out
}

/// First words of a brace group's items.
fn top_level(group: &str) -> Vec<String> {
    let (mut depth, mut start, mut out) = (0, 0, Vec::new());
    for (i, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth > 0 => depth -= 1,
            ',' | '}' if depth == 0 => {
                out.push(first_word(group[start..i].trim()));
                start = i + 1;
                if c == '}' {
                    break;
                }
            }
            _ => {}
        }
    }
    out.retain(|w| !w.is_empty());
    out
}

fn first_word(text: &str) -> String {
    text.chars()
        .take_while(|c| c.is_alphanumeric() || *c == '_')
        .collect()
}

fn module_of(file: &Path, root: &Path) -> String {
    let first = file
        .strip_prefix(root)
        .unwrap()
        .components()
        .next()
        .unwrap();
    first
        .as_os_str()
        .to_string_lossy()
        .trim_end_matches(".rs")
        .to_owned()
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut out = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            out.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
    out
}
