//! Names that a reader can trust: a type's name means one type, and no function is named by a preposition.

use std::collections::BTreeMap;
use std::path::Path;

use crate::ROOT;
use crate::layering::sources;

/// The libraries: names are unique in each.
const LIBRARIES: [&str; 2] = ["src", "tools/evaluate/src"];
/// The command.
const COMMAND: &str = "tools/merlkit";

/// Words that say nothing when they stand alone.
const EMPTY_WORDS: [&str; 10] = [
    "of", "at", "about", "with", "on", "in", "by", "to", "place", "beside",
];

/// The word behind each `keyword` in the code of a file, without comments and unit tests.
fn words_after<'a>(code: &'a str, keyword: &str) -> Vec<&'a str> {
    let mut words = Vec::new();
    for line in code.lines() {
        let line = line.split("//").next().unwrap();
        for (position, _) in line.match_indices(keyword) {
            let before = line[..position].chars().next_back();
            if before.is_none_or(|c| !c.is_alphanumeric() && c != '_' && c != '\'') {
                let rest = &line[position + keyword.len()..];
                let end = rest
                    .find(|c: char| !c.is_alphanumeric() && c != '_')
                    .unwrap_or(rest.len());
                words.push(&rest[..end]);
            }
        }
    }
    words
}

/// The code of a file up to its unit tests.
fn without_tests(text: &str) -> &str {
    text.split("#[cfg(test)]\nmod ").next().unwrap()
}

#[test]
fn a_types_name_is_unique_in_its_library() {
    for library in LIBRARIES {
        let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for file in sources(&Path::new(ROOT).join(library)) {
            let text = std::fs::read_to_string(&file).unwrap();
            for keyword in ["struct ", "enum ", "trait "] {
                for name in words_after(without_tests(&text), keyword) {
                    let file = file.display().to_string();
                    places.entry(name.to_owned()).or_default().push(file);
                }
            }
        }
        assert!(places.len() > 50, "{library}: {} types", places.len());
        places.retain(|name, files| files.len() > 1 && name.starts_with(char::is_uppercase));
        assert!(places.is_empty(), "{places:#?}");
    }
}

#[test]
fn no_function_is_named_by_a_preposition() {
    for folder in LIBRARIES.into_iter().chain([COMMAND]) {
        for file in sources(&Path::new(ROOT).join(folder)) {
            let text = std::fs::read_to_string(&file).unwrap();
            for name in words_after(without_tests(&text), "fn ") {
                let named = !EMPTY_WORDS.contains(&name);
                assert!(named, "{}: fn {name}", file.display());
            }
        }
    }
}

#[test]
fn names_are_found_where_they_are_defined() {
    let code = "pub struct A;\n// struct B\nfn of(x: u8) {}\nlet myfn at = 0;\n    pub(super) fn at<T>() {}";
    assert_eq!(words_after(code, "struct "), ["A"]);
    assert_eq!(words_after(code, "fn "), ["of", "at"]);
}
