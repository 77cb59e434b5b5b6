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
        &[
            "geometry",
            "color",
            "distribution",
            "lanes",
            "error",
            "image",
        ],
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
    let all = paths(&code(text));
    let modules = all.iter().filter_map(|path| path.strip_prefix("crate::"));
    let names = modules.map(|path| path.split("::").next().unwrap());
    names
        .filter(|name| !name.is_empty())
        .map(|name| match name {
            "Error" | "Result" => "error".to_owned(),
            _ => name.to_owned(),
        })
        .collect()
}

/// A file without its comments and tests. Where something is visible, as in `pub(in crate::sampler)`, is no import either.
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]").next().unwrap();
    let lines = text.lines().map(|l| l.split("//").next().unwrap());
    let code = lines.collect::<Vec<_>>().join("\n");
    code.replace("pub(in crate::", "pub(in ")
}

/// All paths and single names in code, those in the groups of a `use` with what stands in front of the group.
fn paths(code: &str) -> Vec<String> {
    let (mut path, mut groups, mut out) = (String::new(), Vec::<String>::new(), Vec::new());
    for c in code.chars() {
        if c.is_alphanumeric() || matches!(c, '_' | ':') {
            path.push(c);
            continue;
        }
        let whole = groups.last().cloned().unwrap_or_default() + path.as_str();
        match c {
            // What follows a group's brace continues the path in front of it; other braces hold code.
            '{' if path.ends_with("::") => groups.push(whole),
            '{' => groups.push(String::new()),
            _ if !path.is_empty() => out.push(whole),
            _ => {}
        }
        if c == '}' {
            groups.pop();
        }
        path.clear();
    }
    out
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
fn files_do_not_import_each_other_in_circles() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let files: BTreeMap<String, File> = sources(&root)
        .into_iter()
        .map(|file| {
            let text = std::fs::read_to_string(&file).unwrap();
            (module_path(&file, &root), File::read(&text))
        })
        .filter(|(module, _)| module != "lib")
        .collect();
    let graph = import_graph(&files);
    // The reader of imports works: these are certain.
    for (module, import) in [
        ("sampler::spec", "sampler::half_vector_table"),
        (
            "sampler::half_vector_table",
            "sampler::half_vector_table::codec",
        ),
        ("render::budget", "render::budget::rendering"),
        ("render::budget::even", "render::film"),
        ("material::merl::brdf", "material::merl::lookup::bins"),
    ] {
        assert!(
            graph[module].contains(import),
            "{module} → {import} was not seen"
        );
    }
    if let Some(circle) = find_circle(&graph) {
        panic!("a circle of imports: {}", circle.join(" → "));
    }
}

#[test]
fn circles_are_found_through_every_spelling() {
    let circle = |folder: &str, last: &str| {
        let files = [
            (
                "m",
                format!("mod a;\nmod b;\npub mod c;\npub use c::{{\n    Seen, Z,\n}};\n{folder}"),
            ),
            ("m::a", "use super::{Seen, b::{X, V}};".into()),
            ("m::b", "use crate::m::c::Y;".into()),
            (
                "m::c",
                format!("{last}\n// super::a\n#[cfg(test)]\nmod tests {{ use super::a::T; }}"),
            ),
        ];
        let files = files.map(|(module, text)| (module.into(), File::read(&text)));
        let graph = import_graph(&BTreeMap::from(files));
        assert_eq!(
            graph["m::a"],
            BTreeSet::from(["m::b", "m::c"].map(String::from))
        );
        find_circle(&graph).map(|circle| circle.join(" "))
    };
    // Re-exports, what lies outside and who may see something make no circle.
    assert_eq!(circle("", "use std::fmt;"), None);
    assert_eq!(
        circle("fn f() { a::g(); }", "pub(in crate::m) fn f() {}"),
        None
    );
    // One through a path of the code, two through a folder's own file: by a child's path, and by a name that it re-exports.
    let through_a = "m::a m::b m::c";
    assert_eq!(circle("", "use super::a::W;").as_deref(), Some(through_a));
    assert_eq!(
        circle("", "fn f() { crate::m::a::g() }").as_deref(),
        Some(through_a)
    );
    let own = "pub struct Own;\n";
    for used in ["fn f() { c::g(); }", "fn f() -> Seen { loop {} }"] {
        let found = circle(&format!("{own}{used}"), "use super::Own;");
        assert_eq!(found.as_deref(), Some("m m::c"), "{used}");
    }
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

/// What the file of a module says to other files.
struct File {
    /// Paths that it re-exports.
    exported: Vec<String>,
    /// All other paths in it.
    used: Vec<String>,
}

impl File {
    fn read(text: &str) -> Self {
        let code = code(text);
        let (mut exported, mut used) = (Vec::new(), Vec::new());
        for statement in code.split_inclusive(';') {
            let starts = statement.match_indices('\n').map(|(at, _)| at + 1);
            let mut declarations = std::iter::once(0)
                .chain(starts)
                .filter_map(|at| Some((at, declaration(&statement[at..])?)));
            let (before, declared) = match declarations.next() {
                Some((at, declared)) => (&statement[..at], declared),
                None => (statement, ""),
            };
            used.extend(paths(before));
            exported.extend(paths(declared));
        }
        Self { exported, used }
    }

    fn find_exported(&self, name: &str) -> Option<&String> {
        let mut exported = self.exported.iter();
        exported.find(|path| path.rsplit("::").next() == Some(name))
    }
}

/// What a statement re-exports, empty for `mod name;`; `None` if it is neither.
fn declaration(statement: &str) -> Option<&str> {
    let public = statement.strip_prefix("pub");
    let item = public.map_or(Some(statement), |s| Some(s.split_once(' ')?.1))?;
    let is_name = |text: &str| text.chars().all(|c| c.is_alphanumeric() || c == '_');
    match item.split_once(' ')? {
        ("use", tree) if public.is_some() => Some(tree),
        ("mod", name) if is_name(name.strip_suffix(';')?) => Some(""),
        _ => None,
    }
}

/// Which files each file imports, by a `use` or by a path in its code. Re-exports are no imports, and who imports one imports the
/// file that it leads to.
fn import_graph(files: &BTreeMap<String, File>) -> BTreeMap<String, BTreeSet<String>> {
    let imports = |(module, file): (&String, &File)| {
        let paths = file.used.iter();
        let mut imported: BTreeSet<String> = paths
            .filter_map(|path| defining_file(path, module, files))
            .collect();
        imported.remove(module);
        (module.clone(), imported)
    };
    files.iter().map(imports).collect()
}

/// The file that a path in the code of `module` leads to, through all re-exports; `None` if that lies elsewhere.
fn defining_file(path: &str, module: &str, files: &BTreeMap<String, File>) -> Option<String> {
    let parent = |module: &str| module.rsplit_once("::").map_or("", |m| m.0).to_owned();
    let below = |module: &str, name: &str| {
        format!("{module}::{name}")
            .trim_start_matches("::")
            .to_owned()
    };
    let (first, rest) = path.split_once("::").unwrap_or((path, ""));
    let child = below(module, first);
    let mut at = match first {
        "crate" => String::new(),
        // Alone it is that of `pub(super)`, as a child's name alone is that of a variable.
        "super" if path != first => parent(module),
        _ if path != first && files.contains_key(&child) => child,
        _ => return defining_file(files[module].find_exported(first)?, module, files),
    };
    for name in rest.split("::").filter(|name| !name.is_empty()) {
        let deeper = if name == "super" {
            parent(&at)
        } else {
            below(&at, name)
        };
        if files.contains_key(&deeper) {
            at = deeper;
            continue;
        }
        return match files.get(&at)?.find_exported(name) {
            Some(exported) => defining_file(exported, &at, files),
            None => Some(at),
        };
    }
    files.contains_key(&at).then_some(at)
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
