//! `docs/stability.md`: made from the suite, and held to it.

use merlkit_evaluate::report::{HardSheets, Sheet};

use crate::crossing::CROSSING;
use crate::precision;

const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/stability.md");

fn markdown(sheet: &Sheet) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let rule = format!("|{}\n", "---|".repeat(sheet.heading.len()));
    let rows: String = sheet.rows.iter().map(|row| line(row)).collect();
    format!("{}{rule}{rows}\n", line(&sheet.heading))
}

fn precision_sheet() -> Sheet {
    let mut sheet = Sheet::new(&[
        "quantity",
        "largest error, relative",
        "in ulp of f32",
        "bound",
    ]);
    for row in precision::TABLE.iter() {
        let relative = format!("{:.1e}", row.relative);
        sheet.push(vec![
            row.what.trim().into(),
            relative,
            format!("{:.2}", row.ulp),
            format!("{:.0e}", row.bound),
        ]);
    }
    sheet
}

fn page() -> String {
    let sheets = HardSheets::from_outcomes(&CROSSING);
    format!(
        "{}{}{}## Precision\n\nAgainst oracles in f64 (`tests/support`) and compensated sums.\n\n{}{}",
        include_str!("page_head.md"),
        markdown(&sheets.cases),
        markdown(&sheets.samplers),
        markdown(&precision_sheet()),
        include_str!("page_tail.md"),
    )
}

/// First cells of all table rows, and every line that is in no table: what does not depend on the machine.
fn skeleton(page: &str) -> Vec<String> {
    let first = |line: &str| line.split(" | ").next().unwrap_or_default().to_owned();
    page.lines()
        .map(|line| {
            if line.starts_with("| ") {
                first(line)
            } else {
                line.to_owned()
            }
        })
        .collect()
}

#[test]
fn the_page_is_that_of_the_suite() {
    let new = page();
    if std::env::var_os("STABILITY_PAGE").is_some() {
        std::fs::write(PATH, &new).unwrap();
    }
    let old = std::fs::read_to_string(PATH).unwrap();
    assert!(!old.contains("FAILED"), "the page shows failures");
    assert_eq!(
        skeleton(&old),
        skeleton(&new),
        "docs/stability.md is out of date: STABILITY_PAGE=write cargo test --release --test stability page"
    );
}
