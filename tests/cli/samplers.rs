//! `build` and `sample`, and the settings of samplers.

use std::path::Path;

use crate::run::{fails, json, pixels, run, run_in, succeeds};

#[test]
fn a_sampler_file_tells_when_its_material_is_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| run_in(folder.path(), arguments, "");
    succeeds(run(&["decode", "nickel", "-o", "there"]));
    succeeds(run(&[
        &["build", "there/nickel.binary", "-o", "s"][..],
        &QUICK,
    ]
    .concat()));
    let sample = ["sample", "s", "--theta", "5", "--count", "3"];
    let before = succeeds(run(&sample));
    std::fs::rename(
        folder.path().join("there/nickel.binary"),
        folder.path().join("moved.binary"),
    )
    .unwrap();
    let text = fails(run(&sample));
    assert!(
        text.contains("there/nickel.binary") && text.contains("--material"),
        "{text}"
    );
    assert_eq!(
        before,
        succeeds(run(&[&sample[..], &["--material", "moved.binary"]].concat()))
    );
}

/// Few tables, so that a sampler is built in no time.
pub const QUICK: [&str; 2] = ["--sampler", "cascade-cdf:tables=3"];

#[test]
fn a_built_file_draws_what_the_material_draws() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| run_in(folder.path(), arguments, "");
    let draws = [
        "--theta", "33", "--phi", "-70", "--count", "500", "--seed", "9",
    ];
    let cases: [&[&str]; 4] = [
        &QUICK,
        &["--sampler", "half-vector:2KB,tables=3"],
        &[
            "--sampler",
            "cascade-cdf:uniform,tables=2",
            "--lookup",
            "centred",
        ],
        &["--sampler", "adaptive-disc:tables=5,nearest,luminance"],
    ];
    for settings in cases {
        let file = ["build", "nickel", "-o", "s.safetensors", "--force"];
        let told = succeeds(run(&[&file, settings].concat()));
        let bytes = folder
            .path()
            .join("s.safetensors")
            .metadata()
            .unwrap()
            .len();
        assert!(
            told.starts_with("s.safetensors: ") && told.contains(&format!("{bytes} bytes")),
            "{told}"
        );
        for points in ["random", "sobol"] {
            let points = ["--points", points];
            let stored = succeeds(run(
                &[&["sample", "s.safetensors"][..], &draws, &points].concat()
            ));
            let direct = succeeds(run(
                &[&["sample", "nickel"][..], &draws, &points, settings].concat()
            ));
            assert_eq!(stored, direct, "{settings:?}");
            assert_eq!(stored.lines().count(), 501);
        }
    }
}

#[test]
fn sampled_lines_are_directions_with_density_and_value() {
    let arguments = [
        "sample", "nickel", "--theta", "85", "--phi", "20", "--count", "4000",
    ];
    let text = succeeds(run(&[&arguments[..], &QUICK].concat(), ""));
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("wi_x,wi_y,wi_z,pdf,f_r,f_g,f_b"));
    let (mut failed, mut pairs) = (0, String::new());
    let (wo, mut values) = (
        (85f64.to_radians().sin_cos(), 20f64.to_radians().sin_cos()),
        Vec::new(),
    );
    for line in lines {
        let x: Vec<f32> = line.split(',').map(|x| x.parse().unwrap()).collect();
        assert_eq!(x.len(), 7);
        if line == "0,0,0,0,0,0,0" {
            failed += 1;
            continue;
        }
        let length = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
        assert!(
            (length - 1.0).abs() < 1e-5 && x[2] > 0.0 && x[3] > 0.0 && x[3].is_finite(),
            "{line}"
        );
        let ((sin, cos), (sin_phi, cos_phi)) = wo;
        pairs += &format!(
            "{:?},{:?},{:?},",
            (sin * cos_phi) as f32,
            (sin * sin_phi) as f32,
            cos as f32
        );
        pairs += &format!("{:?},{:?},{:?}\n", x[0], x[1], x[2]);
        values.push(line.splitn(5, ',').nth(4).unwrap().to_owned());
    }
    // Half vectors that reflect below the horizon: some at grazing, but not many.
    assert!((1..400).contains(&failed), "{failed} draws failed");
    let evaluated = succeeds(run(&["eval", "nickel"], &pairs));
    assert_eq!(values, evaluated.lines().skip(1).collect::<Vec<_>>());
}

#[test]
fn a_fit_cloud_has_the_shape_of_the_thesis() {
    let arguments = [
        "sample", "teflon", "--theta", "60", "--phi", "45", "--count", "50", "--fit",
    ];
    let text = succeeds(run(&[&arguments[..], &QUICK].concat(), ""));
    let lines: Vec<_> = text.lines().collect();
    assert_eq!(
        lines[..3],
        ["measured \"teflon\"", "viewer (60, 45)", "begin"]
    );
    assert_eq!(lines[lines.len() - 1], "end");
    let points = &lines[3..lines.len() - 1];
    assert!((40..=50).contains(&points.len()), "{text}");
    for point in points {
        let (direction, value) = point.strip_prefix("  (").unwrap().split_once(") ").unwrap();
        let w: Vec<f32> = direction.split(',').map(|x| x.parse().unwrap()).collect();
        assert!(
            w.len() == 3 && w[2] > 0.0 && value.parse::<f32>().unwrap() > 0.0,
            "{point}"
        );
    }
}

#[test]
fn bad_samplers_are_answered_with_what_there_is() {
    let sample = ["sample", "nickel", "--count", "1", "--theta", "10"];
    for (sampler, expected) in [
        ("cosine:tables=4", "no setting of cosine is called tables"),
        (
            "adaptive-disc:2KB",
            "no setting of adaptive-disc is called 2KB",
        ),
        ("cascade-cdf:dept=4", "no setting of cascade-cdf is called"),
        ("half-vector:tables=0", "choose 1 to 1024"),
        ("half-vector:rows=80", "choose 2 to 79"),
        ("half-vector:3KB", "did you mean"),
        ("adaptive-disc:floor=2", "choose 0 to 1"),
        ("adaptive-disc:n-max=1", "choose above 1"),
        ("adaptive-disc:depth=40", "choose 0 to 14"),
        ("cascade-cdf:cells=1024", "such as 1024x512"),
        ("magic", "choose half-vector, adaptive-disc, cascade-cdf"),
        ("ggx", "lobe:ggx"),
        ("disc-rejection", "adaptive-disc:rejection"),
    ] {
        let output = run(&[&sample[..], &["--sampler", sampler]].concat(), "");
        assert!(output.stdout.is_empty(), "{sampler}");
        let text = fails(output);
        assert!(text.contains(expected), "{sampler}: {text}");
    }
    // The options that settings had before are gone from every command.
    for command in ["build", "sample", "report", "check", "plot", "render"] {
        let text = fails(run(&[command, "nickel", "--table-size", "2KB"], ""));
        assert!(
            text.contains("unexpected argument '--table-size'"),
            "{text}"
        );
    }
    for theta in ["90", "-1", "nan"] {
        let text = fails(run(
            &["sample", "nickel", "--count", "1", "--theta", theta],
            "",
        ));
        assert!(text.contains("--theta"), "{text}");
    }
    let text = fails(run(&["check", "nickel", "--significance", "0"], ""));
    assert!(text.contains("significance 0"), "{text}");
}

/// What `merlkit samplers` lists is what `--sampler` takes.
#[test]
fn samplers_and_their_settings_are_listed() {
    let all = succeeds(run(&["samplers"], ""));
    for name in [
        "half-vector:64KB",
        "adaptive-disc",
        "cascade-cdf",
        "lobe:ggx",
        "factored",
        "cosine",
        "file",
        "any material",
    ] {
        assert!(all.contains(&format!("| {name} ")), "{name}: {all}");
    }
    let disc = succeeds(run(&["samplers", "adaptive-disc"], ""));
    for word in [
        "| depth ",
        "0 to 14",
        "rejection-free",
        "| published ",
        "Example: --sampler",
    ] {
        assert!(disc.contains(word), "{word}: {disc}");
    }
    let document = json(&succeeds(run(&["samplers", "--json"], "")));
    assert_eq!(document["kind"], "samplers");
    let samplers = document["results"].as_array().unwrap();
    assert_eq!(samplers.len(), 7);
    let sample = ["sample", "nickel", "--count", "1", "--theta", "10"];
    for sampler in samplers.iter().filter(|s| s["name"] != "file") {
        let example = sampler["example"].as_str().unwrap();
        if sampler["name"] != "factored" {
            succeeds(run(&[&sample[..], &["--sampler", example]].concat(), ""));
        }
        for setting in sampler["settings"].as_array().unwrap() {
            assert!(!setting["domain"].as_str().unwrap().is_empty(), "{setting}");
        }
    }
    assert!(fails(run(&["samplers", "ggx"], "")).contains("lobe:ggx"));
}

/// What a sampler file says of its settings, asked for and one by one.
fn spec_in(folder: &Path, file: &str) -> (String, serde_json::Value) {
    let document = json(&succeeds(run_in(
        folder,
        &["info", file, "--json", "-"],
        "",
    )));
    assert_eq!(
        (&document["schema"], &document["kind"]),
        (&3.into(), &"info".into())
    );
    let record = &document["results"][0];
    let spec = record["spec"].as_str().unwrap().to_owned();
    (spec, record["settings"].clone())
}

#[test]
fn the_half_vector_table_is_the_default_and_has_its_settings() {
    let folder = tempfile::tempdir().unwrap();
    let spec = |settings: &[&str]| {
        let build = ["build", "nickel", "-o", "s", "--force"];
        let told = succeeds(run_in(folder.path(), &[&build, settings].concat(), ""));
        assert!(told.starts_with("s: half-vector:"), "{told}");
        spec_in(folder.path(), "s")
    };
    let default = spec(&[]);
    assert_eq!(default.0, "half-vector:64KB");
    assert_eq!(default, spec(&["--sampler", "half-vector:64kb"]));
    let length = folder.path().join("s").metadata().unwrap().len();
    assert!((50_000..70_000).contains(&length), "{length} bytes");
    let (small, mut settings) = spec(&["--sampler", "half-vector:2KB"]);
    assert_eq!(small, "half-vector:2KB");
    assert!(
        settings["fold"] == true && default.1["fold"] == false,
        "{settings} {default:?}"
    );
    let free = "half-vector:tables=3,rows=5,segments=7,folded,luminance";
    let expected = serde_json::json!({
        "tables": 3, "rows": 5, "segments": 7, "fold": true, "importance": "luminance",
    });
    assert_eq!(spec(&["--sampler", free]), (free.to_owned(), expected));
    settings["fold"] = false.into();
    let unfolded = "half-vector:2KB,unfolded";
    assert_eq!(
        spec(&["--sampler", unfolded]),
        (unfolded.to_owned(), settings)
    );
}

#[test]
fn commands_without_a_sampler_draw_by_the_half_vector_table() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| succeeds(run_in(folder.path(), arguments, ""));
    let settings = ["--sampler", "half-vector:64KB"];
    let sample = ["sample", "nickel", "--theta", "50", "--count", "20"];
    assert_eq!(run(&sample), run(&[&sample[..], &settings].concat()));
    let picture = |settings: &[&str]| {
        let render = ["render", "nickel", "--spp", "1", "--size", "8x8", "--force"];
        run(&[&render, settings].concat());
        pixels(folder.path())
    };
    let default = picture(&[]);
    assert!(default == picture(&settings) && default != picture(&["--sampler", "cosine"]));
    let report = run(&["report", "teflon", "--draws", "500"]);
    for sampler in [
        "half-vector:2KB",
        "half-vector:64KB",
        "half-vector:1MB",
        "cosine",
        "adaptive-disc",
        "cascade-cdf:uniform",
        "cascade-cdf",
    ] {
        assert!(report.contains(&format!("| {sampler} ")), "{report}");
    }
}

#[test]
fn info_tells_what_a_sampler_file_is() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| run_in(folder.path(), arguments, "");
    succeeds(run(&[
        "build",
        "nickel",
        "-o",
        "s",
        "--sampler",
        "half-vector:4KB",
        "--lookup",
        "linear",
    ]));
    let text = succeeds(run(&["info", "s", "teflon"]));
    for word in [
        "sampler file",
        "half-vector:4KB",
        "nickel (built in)",
        "linear",
        "albedo at 80°",
    ] {
        assert!(text.contains(word), "{word} is missing in\n{text}");
    }
    let mut bytes = std::fs::read(folder.path().join("s")).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    std::fs::write(folder.path().join("s"), bytes).unwrap();
    assert!(fails(run(&["info", "s"])).contains("damaged or edited"));
}

#[test]
fn samples_tell_what_they_were_drawn_from() {
    let sample = [
        "sample", "nickel", "--theta", "50", "--phi", "20", "--count", "30",
    ];
    let bare = succeeds(run(&sample, ""));
    let text = succeeds(run(&[&sample[..], &["--with-points"]].concat(), ""));
    let (mut first, mut points) = (None, std::collections::BTreeSet::new());
    for (line, bare) in text.lines().zip(bare.lines()) {
        let fields: Vec<&str> = line.splitn(6, ',').collect();
        assert_eq!(fields[5], bare);
        if let [Ok(x), Ok(y), Ok(z), Ok(u), Ok(v)] =
            [0, 1, 2, 3, 4].map(|i| fields[i].parse::<f32>())
        {
            assert_eq!(*first.get_or_insert((x, y, z)), (x, y, z));
            assert!((0.0..1.0).contains(&u) && (0.0..1.0).contains(&v), "{line}");
            points.insert((u.to_bits(), v.to_bits()));
        }
    }
    let (x, y, z) = first.unwrap();
    assert!(
        (z.acos().to_degrees() - 50.0).abs() < 1e-4
            && (y.atan2(x).to_degrees() - 20.0).abs() < 1e-4
    );
    assert_eq!((points.len(), text.lines().count()), (30, 31));
    assert!(
        fails(run(
            &[&sample[..], &["--with-points", "--fit"]].concat(),
            ""
        ))
        .contains("--fit")
    );
}

#[test]
fn a_sampler_file_brings_its_own_settings() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| run_in(folder.path(), arguments, "");
    succeeds(run(&[&["build", "nickel", "-o", "s"][..], &QUICK].concat()));
    let sample = ["sample", "s", "--theta", "5", "--count", "3"];
    for (extra, expected) in [
        (
            &["--sampler", "cascade-cdf:tables=4"][..],
            "s contains the sampler cascade-cdf:tables=3; omit --sampler",
        ),
        (&["--sampler", "cosine"], "omit --sampler"),
        (&["--lookup", "linear"], "omit --lookup"),
        (&["--material", "teflon"], "the sampler was built from"),
    ] {
        let text = fails(run(&[&sample, extra].concat()));
        assert!(text.contains(expected), "{extra:?}: {text}");
    }
    let alone = succeeds(run(&sample));
    assert_eq!(
        alone,
        succeeds(run(&[&sample[..], &["--material", "nickel"]].concat()))
    );
    assert!(
        fails(run(&[
            "sample",
            "nickel",
            "--material",
            "nickel",
            "--theta",
            "5",
            "--count",
            "3"
        ]))
        .contains("--material")
    );
}

#[test]
fn built_files_are_replaced_only_with_force() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| run_in(folder.path(), &[arguments, &QUICK].concat(), "");
    std::fs::write(folder.path().join("s"), "mine").unwrap();
    let text = fails(run(&["build", "nickel", "-o", "s"]));
    assert!(text.contains("s exists; pass --force"), "{text}");
    assert_eq!(
        std::fs::read_to_string(folder.path().join("s")).unwrap(),
        "mine"
    );
    succeeds(run(&["build", "nickel", "-o", "s", "--force"]));
    succeeds(run(&["build", "nickel", "teflon", "-o", "several"]));
    let names = [
        "nickel.cascade-cdf.safetensors",
        "teflon.cascade-cdf.safetensors",
    ];
    for name in names {
        assert!(folder.path().join("several").join(name).exists(), "{name}");
    }
    // One that exists stops all of them before the work.
    std::fs::remove_file(folder.path().join("several").join(names[1])).unwrap();
    assert!(fails(run(&["build", "teflon", "nickel", "-o", "several"])).contains(names[0]));
    assert!(!folder.path().join("several").join(names[1]).exists());
    std::fs::write(folder.path().join("r.json"), "mine").unwrap();
    for command in ["report", "check"] {
        let output = run(&[command, "nickel", "--draws", "1000", "--json", "r.json"]);
        assert!(output.stdout.is_empty(), "refused before the work");
        assert!(fails(output).contains("r.json exists"));
    }
}

#[test]
fn files_and_draws_do_not_depend_on_threads() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| succeeds(run_in(folder.path(), arguments, ""));
    for sampler in ["half-vector", "adaptive-disc", "cascade-cdf"] {
        let settings = ["--sampler", &format!("{sampler}:tables=5")];
        let results = ["1", "2"].map(|threads| {
            let common = [&settings[..], &["--threads", threads]].concat();
            run(&[&["build", "chrome", "-o", "s", "--force"][..], &common].concat());
            let draws = run(&[
                &["sample", "chrome", "--theta", "50", "--count", "300"][..],
                &common,
            ]
            .concat());
            (std::fs::read(folder.path().join("s")).unwrap(), draws)
        });
        assert!(results[0] == results[1], "{sampler}");
    }
}
