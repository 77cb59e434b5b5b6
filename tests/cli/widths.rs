//! What is printed fits a terminal of 100 columns.

use super::run::{run, succeeds};

const COLUMNS: usize = 100;

/// Asserts that no line is longer.
fn assert_narrow(text: &str) {
    for line in text.lines() {
        let columns = line.chars().count();
        assert!(columns <= COLUMNS, "{columns} columns:\n{line}\nin\n{text}");
    }
}

#[test]
fn a_report_is_narrow_and_explains_its_words_once() {
    for materials in [&["nickel"][..], &["nickel", "teflon", "chrome"]] {
        let mut arguments = vec!["report"];
        arguments.extend(materials);
        arguments.extend(["--draws", "1000", "--sampler", "cosine"]);
        arguments.extend(["--sampler", "half-vector:2KB"]);
        let text = succeeds(run(&arguments, ""));
        assert_narrow(&text);
        for words in ["relstd: relative", "holes: fraction", "were not measured"] {
            assert_eq!(text.replace('\n', " ").matches(words).count(), 1, "{text}");
        }
        for name in materials {
            let tables = text.matches(&format!("\n| {name} ")).count();
            assert_eq!(tables, 2, "{name} in\n{text}");
        }
    }
}

#[test]
fn lists_and_other_tables_are_narrow() {
    for arguments in [
        &["samplers"][..],
        &[
            "report",
            "teflon",
            "--draws",
            "1000",
            "--sampler",
            "adaptive-disc:depth=4,tables=4",
        ],
        &["samplers", "adaptive-disc"],
        &["models"],
        &["models", "ggx"],
        &["info", "nickel", "ggx"],
        &["check", "lambert", "--sampler", "cosine", "--draws", "1000"],
        &["fit", "nickel", "teflon", "--pairs", "1000"],
        &["tune", "nickel", "--target-error", "5%"],
    ] {
        assert_narrow(&succeeds(run(arguments, "")));
    }
}
