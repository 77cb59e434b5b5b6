//! `report` and `check`.

use crate::run::{json, run, succeeds};
use crate::samplers::QUICK;

#[test]
fn report_puts_the_thesis_beside_the_measured_figures() {
    let arguments = ["report", "nickel", "--draws", "1000", "--json", "-"];
    let document = json(&succeeds(run(&[&arguments[..], &QUICK].concat(), "")));
    assert_eq!(
        (&document["schema"], &document["kind"]),
        (&3.into(), &"report".into())
    );
    let nickel = &document["results"][0];
    assert_eq!(
        (&nickel["material"], &nickel["lookup"]),
        (&"nickel".into(), &"floor".into())
    );
    assert_eq!(nickel["material_bytes"], 23_328_000);
    let samplers = nickel["samplers"].as_array().unwrap();
    assert_eq!(samplers.len(), 1);
    assert_eq!(samplers[0]["spec"], "cascade-cdf:tables=3");
    let table = samplers[0]["table_bytes"].as_u64().unwrap();
    assert!((1..samplers[0]["file_bytes"].as_u64().unwrap()).contains(&table));
    assert!(samplers[0]["build"]["wall"].as_f64().unwrap() > 0.0);
    assert_eq!(samplers[0]["angles"].as_array().unwrap().len(), 7);
    for angle in samplers[0]["angles"].as_array().unwrap() {
        let relstd = angle["spread"]["relstd"].as_f64().unwrap();
        assert!(relstd > 0.0 && relstd < 20.0, "{angle}");
    }
    let thesis = nickel["thesis"].as_array().unwrap();
    assert_eq!(thesis.len(), 4);
    assert!(
        thesis
            .iter()
            .all(|t| t["method"].as_str().unwrap().starts_with("thesis (")),
        "{thesis:?}"
    );
    assert_eq!(
        (&thesis[0]["memory_kb"], &thesis[0]["precompute_s"]),
        (&846.15.into(), &71.36.into())
    );
}

#[test]
fn report_in_csv_has_a_line_for_each_sampler_and_angle() {
    let arguments = [
        "report",
        "nickel",
        "chrome",
        "--draws",
        "500",
        "--sampler",
        "adaptive-disc:tables=3",
        "--csv",
        "-",
    ];
    let text = succeeds(run(&[&arguments[..], &QUICK].concat(), ""));
    let lines: Vec<_> = text.lines().collect();
    assert!(
        lines[0].starts_with("material,lookup,source,sampler,table_bytes,file_bytes,"),
        "{text}"
    );
    for (material, thesis) in [("nickel", 4), ("chrome", 0)] {
        let count = |sampler: &str| {
            let start = format!("{material},floor,measured,{sampler}");
            lines.iter().filter(|l| l.starts_with(&start)).count()
        };
        assert_eq!(
            (
                count("adaptive-disc:tables=3,"),
                count("cascade-cdf:tables=3,")
            ),
            (7, 7),
            "{text}"
        );
        let printed = lines
            .iter()
            .filter(|l| l.starts_with(&format!("{material},,thesis,")))
            .count();
        assert_eq!(printed, thesis, "{text}");
    }
    assert_eq!(lines.len(), 1 + 2 * 2 * 7 + 4);
}

#[test]
fn report_words_its_tables() {
    let arguments = ["report", "nickel", "--draws", "1000"];
    // Sentences are broken into lines.
    let text = succeeds(run(&[&arguments[..], &QUICK].concat(), "")).replace('\n', " ");
    for word in [
        "floor lookup",
        "cascade-cdf:tables=3",
        "thesis (6.23, 6.24)",
        "they were not measured here",
    ] {
        assert!(text.contains(word), "{word} is missing in\n{text}");
    }
}

#[test]
fn check_tells_right_from_wrong_by_its_status() {
    let check = ["check", "teflon", "--draws", "2000", "--sampler"];
    let text = succeeds(run(&[&check[..], &["cascade-cdf"]].concat(), ""));
    assert_eq!(text.matches("13 ok").count(), 7, "{text}");
    assert!(!text.contains("FAILED"), "{text}");
    let published = run(&[&check[..], &["cascade-cdf:published"]].concat(), "");
    assert_eq!(published.status.code(), Some(1));
    let text = String::from_utf8(published.stdout).unwrap();
    // Some angles have holes.
    let before = text.split(" of 13 FAILED").next().unwrap();
    let failures: usize = before.rsplit(' ').next().unwrap().parse().expect(&text);
    assert_eq!(
        text.matches("positivity").count(),
        1 + failures,
        "a column, and a row for each failure:\n{text}"
    );
    let document = run(
        &[&check[..], &["cascade-cdf:published", "--json", "-"]].concat(),
        "",
    );
    assert_eq!(document.status.code(), Some(1));
    let document = json(&String::from_utf8(document.stdout).unwrap());
    assert_eq!(
        (&document["schema"], &document["kind"]),
        (&3.into(), &"check".into())
    );
    let outcomes = document["results"][0]["outcomes"].as_array().unwrap();
    assert_eq!(outcomes.len(), 13 * 7);
    let failed: Vec<_> = outcomes
        .iter()
        .filter(|o| o["pass"] == false)
        .map(|o| &o["check"])
        .collect();
    assert_eq!(failed, ["positivity", "positivity"]);
}
