//! `docs/architecture.md` names files that exist, and no more of them than it promises.

use std::path::Path;

use crate::ROOT;

/// The most files that an addition may touch.
const MOST_FILES: usize = 6;

#[test]
fn every_addition_touches_few_files_and_all_that_exist_are_there() {
    let text = std::fs::read_to_string(format!("{ROOT}/docs/architecture.md")).unwrap();
    let mut additions = 0;
    for section in text.split("\n### To add ").skip(1) {
        let (title, body) = section.split_once('\n').unwrap();
        let body = body.split("\n## ").next().unwrap();
        let rows: Vec<&str> = body.lines().filter(|l| l.starts_with("| `")).collect();
        assert!(
            !rows.is_empty() && rows.len() <= MOST_FILES,
            "{title}: {} files",
            rows.len()
        );
        for row in rows {
            let path = row.split('`').nth(1).unwrap();
            // NAME stands for what is added.
            let known = path.split("NAME").next().unwrap();
            let known = if path.contains("NAME") {
                known.rsplit_once('/').unwrap().0
            } else {
                known
            };
            assert!(
                Path::new(ROOT).join(known).exists(),
                "{title}: {path} is not there"
            );
        }
        additions += 1;
    }
    assert_eq!(additions, 5, "sampler, format, formula, light, export");
}

#[test]
fn every_path_on_the_page_exists() {
    let text = std::fs::read_to_string(format!("{ROOT}/docs/architecture.md")).unwrap();
    let mut paths = 0;
    for word in text.split('`').skip(1).step_by(2) {
        let in_the_repository = ["src/", "tools/", "tests/", "docs/", "examples/"]
            .iter()
            .any(|folder| word.starts_with(folder));
        if in_the_repository && !word.contains("NAME") {
            assert!(Path::new(ROOT).join(word).exists(), "{word} is not there");
            paths += 1;
        }
    }
    assert!(paths > 15, "{paths} paths");
}
