//! Clouds of values in FIT files, and directions on environments.

use crate::run::{fails, run_in, succeeds};

#[test]
fn a_cloud_that_was_written_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let in_folder = |command: &str| {
        let arguments: Vec<&str> = command.split(' ').collect();
        run_in(folder.path(), &arguments, "")
    };
    let draw = "sample phong --sampler cosine --theta 50 --phi 30 --count 40 --fit";
    let degrees = succeeds(in_folder(draw));
    let thesis = succeeds(in_folder(&format!("{draw} --fit-units thesis")));
    assert!(thesis.contains("viewer (0.8726646"), "{thesis}");
    for (name, text) in [("degrees.fit", &degrees), ("thesis.fit", &thesis)] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let info = succeeds(in_folder("info thesis.fit"));
    assert!(
        info.contains("| 40 ") && info.contains("50.0000°"),
        "{info}"
    );
    let plots = ["degrees.fit", "thesis.fit --fit-units thesis"]
        .map(|file| succeeds(in_folder(&format!("plot --kind disc --fit {file} -o -"))));
    for plot in &plots {
        assert!(
            plot.contains("40 directions") && plot.contains("θ = 50.0000°"),
            "{plot}"
        );
    }
    let csv = succeeds(in_folder(
        "plot --kind disc --fit degrees.fit -o a.csv --csv -",
    ));
    assert_eq!(
        csv.lines()
            .filter(|line| line.starts_with("direction,"))
            .count(),
        40
    );
    for (command, complaint) in [
        (
            "plot --kind disc --fit thesis.fit",
            "pass --fit-units thesis",
        ),
        ("plot --kind lobe --fit degrees.fit", "choose --kind disc"),
        (
            "plot nickel --kind disc --fit degrees.fit",
            "cannot be used with",
        ),
        ("info missing.fit", "missing.fit"),
    ] {
        let message = fails(in_folder(command));
        assert!(message.contains(complaint), "{command}: {message}");
    }
}

#[test]
fn environments_show_where_strategies_draw() {
    let folder = tempfile::tempdir().unwrap();
    let in_folder = |command: &str| {
        let arguments: Vec<&str> = command.split(' ').collect();
        run_in(folder.path(), &arguments, "")
    };
    let places = |options: &str| {
        let command = format!("plot {options} --kind environment --light studio --samples 50");
        succeeds(in_folder(&format!("{command} -o a.svg --force --csv -")))
    };
    let light = places("--strategy light");
    let brdf = places("phong --sampler cosine --strategy brdf --theta 40 --phi 20");
    let ris = places("phong --sampler cosine --strategy ris --theta 40 --phi 20 --candidates 500");
    assert!(light != brdf && brdf != ris);
    for text in [&light, &brdf, &ris] {
        assert_eq!(text.lines().count(), 51, "{text}");
    }
    // Directions from the surface are above the horizon.
    let latitude = |line: &str| line.split(',').nth(1).unwrap().parse::<f64>().unwrap();
    assert!(brdf.lines().skip(1).all(|line| latitude(line) >= 0.0));
    let svg = std::fs::read_to_string(folder.path().join("a.svg")).unwrap();
    assert!(svg.contains("50 kept of 500") && svg.matches("data:image/png").count() == 2);
    for extension in ["png", "pdf"] {
        let command = format!("plot --kind environment --light lamps -o b.{extension}");
        succeeds(in_folder(&command));
    }
    for (command, complaint) in [
        (
            "plot --kind environment --light studio phong",
            "has no effect on --strategy light",
        ),
        (
            "plot --kind environment --light studio --strategy ris",
            "name one material",
        ),
        (
            "plot phong --kind lobe --light studio",
            "choose --kind environment",
        ),
        (
            "plot --kind environment --light sky",
            "no environment is called",
        ),
        (
            "plot --kind environment --light studio --candidates 5",
            "pass --strategy ris",
        ),
    ] {
        let message = fails(in_folder(command));
        assert!(message.contains(complaint), "{command}: {message}");
    }
}
