//! Which module may import which: the architecture, held.

use std::collections::{BTreeMap, BTreeSet};
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
        &["geometry", "color", "distribution", "error", "image"],
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

pub fn sources(folder: &Path) -> Vec<PathBuf> {
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

#[test]
fn files_of_a_module_do_not_import_each_other_in_circles() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let (mut folders, mut found) = (0, Vec::new());
    for (module, _) in TABLE {
        if !root.join(module).is_dir() {
            continue;
        }
        let files: BTreeMap<String, String> = sources(&root.join(module))
            .into_iter()
            .map(|file| {
                let text = std::fs::read_to_string(&file).unwrap();
                (module_path(&file, &root), text)
            })
            .collect();
        let graph = import_graph(&files);
        assert!(graph.len() > 1, "{module}: {graph:?}");
        folders += 1;
        found.extend(find_circle(&graph));
    }
    assert!(folders > 5);
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn circles_are_found_through_every_spelling() {
    let files = |last: &str| {
        BTreeMap::from([
            (
                "m".into(),
                "mod a;\nmod b;\nmod c;\npub use c::{Seen, Z};".into(),
            ),
            ("m::a".into(), "use super::{Seen, b::X};".into()),
            ("m::b".into(), "use crate::m::c::Y;".into()),
            (
                "m::c".into(),
                format!("{last}\n#[cfg(test)]\nmod tests {{ use super::a::T; }}"),
            ),
        ])
    };
    let graph = import_graph(&files("use std::fmt;"));
    assert_eq!(
        graph["m::a"],
        BTreeSet::from(["m::b", "m::c"].map(String::from))
    );
    assert_eq!(find_circle(&graph), None);
    let circle = find_circle(&import_graph(&files("use super::a::W;"))).unwrap();
    assert!(circle.contains(&"m::a".to_owned()) && circle.contains(&"m::c".to_owned()));
}

/// `render::budget::even` for `src/render/budget/even.rs`; a folder's `mod.rs` has the folder's path.
fn module_path(file: &Path, root: &Path) -> String {
    let relative = file.strip_prefix(root).unwrap().with_extension("");
    let parts: Vec<String> = relative
        .components()
        .map(|c| c.as_os_str().to_string_lossy().into_owned())
        .collect();
    parts.join("::").trim_end_matches("::mod").to_owned()
}

/// Which files each file imports. Re-exports count as what they name; what a folder's `mod.rs` imports of its files is left
/// out, since it is made of them.
fn import_graph(files: &BTreeMap<String, String>) -> BTreeMap<String, BTreeSet<String>> {
    let is_folder = |module: &str| files.keys().any(|m| m.starts_with(&format!("{module}::")));
    let mut graph = BTreeMap::new();
    for (module, text) in files.iter().filter(|(module, _)| !is_folder(module)) {
        let mut imported: BTreeSet<String> = full_paths(text, module)
            .iter()
            .filter_map(|path| defining_file(path, files))
            .collect();
        imported.remove(module);
        graph.insert(module.clone(), imported);
    }
    graph
}

/// All paths after `super::` or `crate::` in a file's code, from the crate's root.
fn full_paths(text: &str, module: &str) -> Vec<String> {
    let text = text.split("#[cfg(test)]").next().unwrap();
    let lines = text.lines().map(|l| l.split("//").next().unwrap());
    let code = lines.collect::<Vec<_>>().join("\n");
    let mut out = Vec::new();
    for (keyword, parent) in [
        ("super::", module.rsplit_once("::").map_or("", |m| m.0)),
        ("crate::", ""),
    ] {
        for after in code.split(keyword).skip(1) {
            let items = match after.strip_prefix('{') {
                Some(group) => group_items(group),
                None => vec![leading_path(after)],
            };
            out.extend(items.iter().map(|item| format!("{parent}::{item}")));
        }
    }
    out.iter()
        .map(|path| path.trim_start_matches("::").to_owned())
        .collect()
}

/// A brace group's items, each up to a group of its own.
fn group_items(text: &str) -> Vec<String> {
    let (mut depth, mut start, mut out) = (0, 0, Vec::new());
    for (i, c) in text.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth > 0 => depth -= 1,
            ',' | '}' if depth == 0 => {
                out.push(leading_path(text[start..i].trim()));
                start = i + 1;
                if c == '}' {
                    break;
                }
            }
            _ => {}
        }
    }
    out
}

fn leading_path(text: &str) -> String {
    text.chars()
        .take_while(|c| c.is_alphanumeric() || matches!(c, '_' | ':'))
        .collect()
}

/// The file that a path leads to, through one re-export of a folder's `mod.rs`; `None` if that lies elsewhere.
fn defining_file(path: &str, files: &BTreeMap<String, String>) -> Option<String> {
    let (mut module, mut rest) = (
        String::new(),
        path.split("::").filter(|p| !p.is_empty()).peekable(),
    );
    while let Some(part) = rest.peek() {
        let deeper = if module.is_empty() {
            (*part).to_owned()
        } else {
            format!("{module}::{part}")
        };
        if !files.contains_key(&deeper) {
            break;
        }
        module = deeper;
        rest.next();
    }
    let text = files.get(&module)?;
    let name = rest.next().unwrap_or_default();
    for statement in text.split("use ").skip(1) {
        let (child, items) = statement
            .split(';')
            .next()?
            .split_once("::")
            .unwrap_or_default();
        let named = items
            .split(|c: char| !(c.is_alphanumeric() || c == '_'))
            .any(|w| w == name);
        let file = format!("{module}::{child}");
        if named && files.contains_key(&file) {
            return Some(file);
        }
    }
    Some(module)
}

/// A circle of imports, if there is one.
fn find_circle(graph: &BTreeMap<String, BTreeSet<String>>) -> Option<Vec<String>> {
    fn walk(
        module: &String,
        graph: &BTreeMap<String, BTreeSet<String>>,
        trail: &mut Vec<String>,
        done: &mut BTreeSet<String>,
    ) -> bool {
        if let Some(first) = trail.iter().position(|m| m == module) {
            trail.drain(..first);
            return true;
        }
        if !done.insert(module.clone()) {
            return false;
        }
        trail.push(module.clone());
        let imported = graph.get(module);
        if imported.is_some_and(|all| all.iter().any(|m| walk(m, graph, trail, done))) {
            return true;
        }
        trail.pop();
        false
    }
    let (mut trail, mut done) = (Vec::new(), BTreeSet::new());
    let found = graph.keys().any(|m| walk(m, graph, &mut trail, &mut done));
    found.then_some(trail)
}
