//! The command line as a user types it.

use std::io::Write;
use std::path::Path;
use std::process::{Output, Stdio};

use assert_cmd::cargo::cargo_bin;

/// Runs `merlkit` in `folder` with `input` on standard input.
fn run_in(folder: &Path, arguments: &[&str], input: &str) -> Output {
    let mut child = std::process::Command::new(cargo_bin!("merlkit"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    // Beside reading the output: a command that has filled its pipe reads no further.
    std::thread::scope(|scope| {
        // A command that stops early closes its input, which is no concern of these tests.
        scope.spawn(move || stdin.write_all(input.as_bytes()).ok());
        child.wait_with_output().unwrap()
    })
}

fn run(arguments: &[&str], input: &str) -> Output {
    run_in(Path::new("."), arguments, input)
}

/// Standard output of a command that succeeds and has nothing to complain about.
fn succeeds(output: Output) -> String {
    let complaints = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{complaints}");
    assert_eq!(complaints, "");
    String::from_utf8(output.stdout).unwrap()
}

/// Standard error of a command that ends with status 2.
fn fails(output: Output) -> String {
    assert_eq!(output.status.code(), Some(2));
    String::from_utf8(output.stderr).unwrap()
}

fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn list_names_the_hundred_materials() {
    let text = succeeds(run(&["list"], ""));
    assert_eq!(text.lines().count(), 100);
    assert!(text.lines().any(|l| l == "red-plastic"));
    let document = json(&succeeds(run(&["list", "--json"], "")));
    assert_eq!((&document["schema"], &document["kind"]), (&1.into(), &"list".into()));
    let names: Vec<_> = document["results"].as_array().unwrap().iter().map(|n| n.as_str().unwrap()).collect();
    assert_eq!(names, text.lines().collect::<Vec<_>>());
}

#[test]
fn the_version_is_the_packages() {
    let version = format!("merlkit {}", env!("CARGO_PKG_VERSION"));
    assert_eq!(succeeds(run(&["-V"], "")).trim(), version);
    let text = succeeds(run(&["--version"], ""));
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], version);
    assert_eq!(lines[1], "features: cli");
    assert!(
        lines[2].starts_with(&format!("target: {} {}", std::env::consts::ARCH, std::env::consts::OS)),
        "{text}"
    );
    assert_eq!(lines[3].contains("debug"), cfg!(debug_assertions), "{text}");
}

#[test]
fn every_command_has_help() {
    let help = succeeds(run(&["--help"], ""));
    assert!(help.contains("Exit status"));
    let commands = help.split("Commands:").nth(1).unwrap().split("Options:").next().unwrap();
    let names: Vec<_> = commands.lines().filter(|l| l.starts_with("  ") && !l.starts_with("   ")).collect();
    assert!(names.len() >= 5, "{commands}");
    for line in names {
        let name = line.split_whitespace().next().unwrap();
        let about = line.split_whitespace().nth(1);
        assert!(about.is_some(), "{name} is not described");
        let text = succeeds(run(&["help", name], ""));
        assert!(text.contains("--threads") || name == "help", "{name}");
    }
}

#[test]
fn wrong_usage_is_status_two() {
    for arguments in
        [&["no-such-command"][..], &["info"], &["decode", "-o", "x"], &["list", "--threads", "0"]]
    {
        assert!(fails(run(arguments, "")).contains("Usage") || arguments.contains(&"0"), "{arguments:?}");
    }
    assert!(fails(run(&["eval", "nickel", "--lookup", "cubic"], "")).contains("[possible values: floor"));
    assert!(fails(run(&["list", "--threads", "60000"], "")).contains("1..=1024"));
}

#[test]
fn arguments_without_meaning_are_refused_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, expected) in [
        (&["render", "nickel", "--exposure", "nan"][..], "finite number of stops"),
        (&["render", "nickel", "--light", "point", "-o", "no/such/x"], "there is no folder no/such"),
        (&["info", "nickel", "--json", ".", "--force"], ". is a folder"),
        (&["report", "nickel", "--draws", "0"], "0 draws"),
        (&["report", "nickel", "--json", "-", "--csv", "-"], "the same output"),
        (
            &[
                "sample",
                "nickel",
                "--theta",
                "1",
                "--count",
                "1",
                "--sampler",
                "cascade-cdf",
                "--uncompressed",
            ]
            .into_iter()
            .chain(["--resolution", "8192x8192", "--tables", "64"])
            .collect::<Vec<_>>(),
            "64 tables of 8192 × 8192 cells",
        ),
    ] {
        let output = run_in(folder.path(), arguments, "");
        assert!(output.stdout.is_empty(), "{arguments:?}");
        let text = fails(output);
        assert!(text.contains(expected), "{arguments:?}: {text}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_sampler_file_tells_when_its_material_is_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| run_in(folder.path(), arguments, "");
    succeeds(run(&["decode", "nickel", "-o", "there"]));
    succeeds(run(&[&["build", "there/nickel.binary", "-o", "s"][..], &QUICK].concat()));
    let sample = ["sample", "s", "--theta", "5", "--count", "3"];
    let before = succeeds(run(&sample));
    std::fs::rename(folder.path().join("there/nickel.binary"), folder.path().join("moved.binary")).unwrap();
    let text = fails(run(&sample));
    assert!(text.contains("there/nickel.binary") && text.contains("--material"), "{text}");
    assert_eq!(before, succeeds(run(&[&sample[..], &["--material", "moved.binary"]].concat())));
}

#[test]
fn misspelt_materials_are_answered_with_the_nearest() {
    for command in ["info", "eval"] {
        let text = fails(run(&[command, "nikel"], ""));
        assert!(text.starts_with("merlkit: no file and no embedded material is called \"nikel\""), "{text}");
        assert!(text.contains("did you mean nickel"), "{text}");
    }
}

#[test]
fn decoded_materials_have_the_facts_of_the_embedded() {
    let folder = tempfile::tempdir().unwrap();
    succeeds(run_in(folder.path(), &["decode", "nickel", "teflon", "-o", "out/deep"], ""));
    let file = folder.path().join("out/deep/nickel.binary");
    assert_eq!(file.metadata().unwrap().len(), 34_992_012);
    assert!(folder.path().join("out/deep/teflon.binary").exists());
    let facts = |material: &str| {
        let document = json(&succeeds(run_in(folder.path(), &["info", material, "--json", "-"], "")));
        assert_eq!((&document["schema"], &document["kind"]), (&1.into(), &"info".into()));
        let mut facts = document["results"][0].clone();
        facts["source"].take();
        facts
    };
    let embedded = facts("nickel");
    assert_eq!(embedded, facts("out/deep/nickel.binary"));
    assert_eq!(embedded["table"]["dimensions"], serde_json::json!([90, 90, 180]));
    assert_eq!(embedded["table"]["table_bytes"], 23_328_000);
    let albedo = embedded["albedo"][1]["rgb"][0].as_f64().unwrap();
    assert!((0.2..0.22).contains(&albedo), "{albedo}");
}

#[test]
fn existing_files_are_replaced_only_with_force() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| run_in(folder.path(), arguments, "");
    let file = folder.path().join("nickel.binary");
    std::fs::write(&file, "mine").unwrap();
    let text = fails(run(&["decode", "nickel", "-o", "."]));
    assert!(text.contains("nickel.binary exists; pass --force"), "{text}");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "mine");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing else is left behind");
    succeeds(run(&["decode", "nickel", "-o", ".", "--force"]));
    assert_eq!(file.metadata().unwrap().len(), 34_992_012);
    succeeds(run(&["list", "--json", "names.json"]));
    assert!(fails(run(&["list", "--json", "names.json"])).contains("--force"));
    succeeds(run(&["list", "--json", "names.json", "--force"]));
    let refused = run(&["info", "nickel", "--json", "names.json"]);
    assert!(refused.stdout.is_empty(), "refused before the work");
    assert!(fails(refused).contains("names.json exists"));
}

#[test]
fn one_name_for_two_files_is_refused() {
    assert!(fails(run(&["decode", "nickel", "nickel", "-o", "unused"], "")).contains("named twice"));
}

#[test]
fn info_words_each_material() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["info", "nickel", "teflon", "--lookup", "linear", "--json", "facts.json"];
    let text = succeeds(run_in(folder.path(), &arguments, ""));
    for word in ["nickel", "teflon", "90 × 90 × 180", "34992012", "linear", "albedo at 80°", "φd asymmetry"]
    {
        assert!(text.contains(word), "{word} is missing in\n{text}");
    }
    assert!(!text.contains('\u{1b}'), "no colour");
    let document = json(&std::fs::read_to_string(folder.path().join("facts.json")).unwrap());
    assert_eq!(document["results"].as_array().unwrap().len(), 2);
    assert_eq!(document["results"][1]["lookup"], "linear");
}

#[test]
fn facts_do_not_depend_on_threads() {
    let facts = |n: &str| succeeds(run(&["info", "chrome", "--json", "-", "--threads", n], ""));
    assert_eq!(facts("1"), facts("3"));
}

#[test]
fn a_broken_file_is_named_with_its_offset() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("short.binary"), [90u8, 0, 0, 0, 90, 0, 0, 0, 180, 0, 0, 0, 7])
        .unwrap();
    let text = fails(run_in(folder.path(), &["info", "short.binary"], ""));
    let expected =
        "merlkit: short.binary: at byte 13: expected 34992012 bytes for 90 × 90 × 180, found 13 bytes";
    assert!(text.starts_with(expected), "{text}");
}

const HEADING: &str = "wo_x,wo_y,wo_z,wi_x,wi_y,wi_z\n";

#[test]
fn eval_reads_lines_with_or_without_a_heading() {
    let lines = "0.6,0,0.8,-0.6,0,0.8\n\n 0 , 0 , 1 , 0.6,0,0.8\r\n0,0,1,0,0,-1";
    let bare = succeeds(run(&["eval", "nickel"], lines));
    assert_eq!(
        bare,
        succeeds(run(&["eval", "nickel", "--lookup", "floor"], &format!("\n{HEADING}{lines}\n")))
    );
    let rows: Vec<_> = bare.lines().collect();
    assert_eq!(rows.len(), 4);
    assert_eq!((rows[0], rows[3]), ("f_r,f_g,f_b", "0.0,0.0,0.0"));
    for row in &rows[1..3] {
        let values: Vec<f32> = row.split(',').map(|x| x.parse().unwrap()).collect();
        assert!(values.len() == 3 && values.iter().all(|v| *v > 0.0), "{row}");
    }
    assert_ne!(bare, succeeds(run(&["eval", "nickel", "--lookup", "centred"], lines)));
    assert_eq!(succeeds(run(&["eval", "nickel"], "")), "f_r,f_g,f_b\n");
}

#[test]
fn eval_in_degrees_equals_eval_in_vectors() {
    let (s, c) = 30f64.to_radians().sin_cos();
    for (line, wi) in [
        (format!("{s},0,{c},0,{c},{s}"), "60,90"),
        (format!("{s},0,{c},0,-{c},{s}"), "60,-90"),
        // The mirror direction, exactly: θh is 0 and not merely small.
        (format!("{s},0,{c},-{s},0,{c}"), "30,180"),
        (format!("{s},0,{c},{s},0,{c}"), "30,720"),
        (format!("{s},0,{c},1,0,0"), "90,0"),
        (format!("{s},0,{c},0,0,-1"), "180,0"),
    ] {
        let by_vectors = succeeds(run(&["eval", "teflon"], &line));
        assert_eq!(by_vectors, succeeds(run(&["eval", "teflon", "--wo", "30,0", "--wi", wi], "")), "{wi}");
    }
    for angles in ["40", "40,0,0", "x,0", "181,0", "-1,0", "nan,0"] {
        fails(run(&["eval", "teflon", &format!("--wo={angles}"), "--wi", "40,180"], ""));
    }
    fails(run(&["eval", "teflon", "--wo", "40,0"], ""));
}

#[test]
fn eval_names_the_line_it_cannot_read() {
    let good = "0,0,1,0,0,1\n";
    for (line, expected) in [
        ("0,0,1,0,0", "line 4: expected 6 numbers wo_x,wo_y,wo_z,wi_x,wi_y,wi_z, found \"0,0,1,0,0\""),
        ("0,0,one,0,0,1", "line 4: expected a number, found \"one\""),
        ("0,0,2,0,0,1", "line 4: expected wo of length 1 within 0.001, found \"length 2\""),
        ("0,0,1,0,0,0", "line 4: expected wi of length 1"),
        ("0,0,1,0,nan,1", "line 4: expected wi of length 1"),
        ("0,0,1,0,0,inf", "line 4: expected wi of length 1"),
        (HEADING.trim(), "line 4: expected a number, found \"wo_x\""),
    ] {
        let output = run(&["eval", "nickel"], &format!("{good}\n{good}{line}\n{good}"));
        assert_eq!(
            String::from_utf8_lossy(&output.stdout).lines().count(),
            3,
            "the lines before it are answered"
        );
        let text = fails(output);
        assert!(text.starts_with("merlkit: standard input, ") && text.contains(expected), "{text}");
    }
    // The other order of directions is not taken for a heading.
    assert!(fails(run(&["eval", "nickel"], "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n")).contains("line 1"));
}

#[test]
fn a_reader_that_leaves_is_no_error() {
    let mut child = std::process::Command::new(cargo_bin!("merlkit"))
        .args(["eval", "nickel"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    // The command may be gone before it has read everything.
    let _ = child.stdin.take().unwrap().write_all("0,0,1,0,0,1\n".repeat(100_000).as_bytes());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
}

/// Few tables, so that a sampler is built in no time.
const QUICK: [&str; 4] = ["--sampler", "cascade-cdf", "--tables", "3"];

#[test]
fn a_built_file_draws_what_the_material_draws() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| run_in(folder.path(), arguments, "");
    let draws = ["--theta", "33", "--phi", "-70", "--count", "500", "--seed", "9"];
    let cases: [&[&str]; 4] = [
        &QUICK,
        &["--table-size", "2KB", "--tables", "3"],
        &["--sampler", "cascade-cdf", "--tables", "2", "--uncompressed", "--lookup", "centred"],
        &["--sampler", "adaptive-disc", "--tables", "5", "--choice", "nearest", "--importance", "luminance"],
    ];
    for settings in cases {
        let file = ["build", "nickel", "-o", "s.safetensors", "--force"];
        let told = succeeds(run(&[&file, settings].concat()));
        let bytes = folder.path().join("s.safetensors").metadata().unwrap().len();
        assert!(told.starts_with("s.safetensors: ") && told.contains(&format!("{bytes} bytes")), "{told}");
        for points in ["random", "sobol"] {
            let points = ["--points", points];
            let stored = succeeds(run(&[&["sample", "s.safetensors"][..], &draws, &points].concat()));
            let direct = succeeds(run(&[&["sample", "nickel"][..], &draws, &points, settings].concat()));
            assert_eq!(stored, direct, "{settings:?}");
            assert_eq!(stored.lines().count(), 501);
        }
    }
}

#[test]
fn sampled_lines_are_directions_with_density_and_value() {
    let arguments = ["sample", "nickel", "--theta", "85", "--phi", "20", "--count", "4000"];
    let text = succeeds(run(&[&arguments[..], &QUICK].concat(), ""));
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("wi_x,wi_y,wi_z,pdf,f_r,f_g,f_b"));
    let (mut failed, mut pairs) = (0, String::new());
    let (wo, mut values) = ((85f64.to_radians().sin_cos(), 20f64.to_radians().sin_cos()), Vec::new());
    for line in lines {
        let x: Vec<f32> = line.split(',').map(|x| x.parse().unwrap()).collect();
        assert_eq!(x.len(), 7);
        if line == "0,0,0,0,0,0,0" {
            failed += 1;
            continue;
        }
        let length = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
        assert!((length - 1.0).abs() < 1e-5 && x[2] > 0.0 && x[3] > 0.0 && x[3].is_finite(), "{line}");
        let ((sin, cos), (sin_phi, cos_phi)) = wo;
        pairs += &format!("{:?},{:?},{:?},", (sin * cos_phi) as f32, (sin * sin_phi) as f32, cos as f32);
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
    let arguments = ["sample", "teflon", "--theta", "60", "--phi", "45", "--count", "50", "--fit"];
    let text = succeeds(run(&[&arguments[..], &QUICK].concat(), ""));
    let lines: Vec<_> = text.lines().collect();
    assert_eq!(lines[..3], ["measured \"teflon\"", "viewer (60, 45)", "begin"]);
    assert_eq!(lines[lines.len() - 1], "end");
    let points = &lines[3..lines.len() - 1];
    assert!((40..=50).contains(&points.len()), "{text}");
    for point in points {
        let (direction, value) = point.strip_prefix("  (").unwrap().split_once(") ").unwrap();
        let w: Vec<f32> = direction.split(',').map(|x| x.parse().unwrap()).collect();
        assert!(w.len() == 3 && w[2] > 0.0 && value.parse::<f32>().unwrap() > 0.0, "{point}");
    }
}

#[test]
fn bad_settings_name_the_option() {
    let sample = ["sample", "nickel", "--count", "1", "--theta", "10"];
    let cases: [(&[&str], &str); 22] = [
        (&["--sampler", "cosine", "--tables", "4"], "--tables is no setting of cosine"),
        (&["--sampler", "adaptive-disc", "--uncompressed"], "--uncompressed is no setting of adaptive-disc"),
        (&["--sampler", "cascade-cdf", "--depth", "4"], "--depth is no setting of cascade-cdf"),
        (&["--tables", "0"], "0 tables"),
        (&["--tables", "few"], "--tables <N>"),
        (&["--choice", "nearest"], "--choice is no setting of half-vector"),
        (&["--floor", "0.1"], "--floor is no setting of half-vector"),
        (&["--as-published"], "--as-published is no setting of half-vector"),
        (
            &["--sampler", "adaptive-disc", "--table-size", "2KB"],
            "--table-size is no setting of adaptive-disc",
        ),
        (&["--sampler", "cascade-cdf", "--fold"], "--fold is no setting of cascade-cdf"),
        (&["--sampler", "cosine", "--rows", "9"], "--rows is no setting of cosine"),
        (&["--fold", "--no-fold"], "'--fold' cannot be used with '--no-fold'"),
        (&["--table-size", "3KB"], "[possible values: 2KB, 4KB, "),
        (&["--rows", "80"], "80 rows"),
        (&["--segments", "0"], "0 segments"),
        (&["--sampler", "adaptive-disc", "--floor", "2"], "floor is 2"),
        (&["--sampler", "adaptive-disc", "--n-max", "1"], "n_max is 1"),
        (&["--sampler", "adaptive-disc", "--depth", "40"], "depth is 40"),
        (&["--sampler", "adaptive-disc", "--grid", "4"], "4 pixels"),
        (&["--sampler", "cascade-cdf", "--resolution", "1024"], "--resolution <THETAxPHI>"),
        (&["--sampler", "cascade-cdf", "--tolerance", "nan"], "tolerance"),
        (&["--sampler", "magic"], "[possible values: half-vector, adaptive-disc, cascade-cdf, cosine]"),
    ];
    for (settings, expected) in cases {
        let output = run(&[&sample, settings].concat(), "");
        assert!(output.stdout.is_empty(), "{settings:?}");
        let text = fails(output);
        assert!(text.contains(expected), "{settings:?}: {text}");
    }
    for theta in ["90", "-1", "nan"] {
        let text = fails(run(&["sample", "nickel", "--count", "1", "--theta", theta], ""));
        assert!(text.contains("--theta"), "{text}");
    }
    let text = fails(run(&["check", "nickel", "--significance", "0"], ""));
    assert!(text.contains("significance 0"), "{text}");
}

/// What a sampler file says of its settings.
fn spec_in(folder: &Path, file: &str) -> serde_json::Value {
    let document = json(&succeeds(run_in(folder, &["info", file, "--json", "-"], "")));
    assert_eq!((&document["schema"], &document["kind"]), (&1.into(), &"info".into()));
    document["results"][0]["spec"].clone()
}

#[test]
fn the_half_vector_table_is_the_default_and_has_its_settings() {
    let folder = tempfile::tempdir().unwrap();
    let spec = |settings: &[&str]| {
        let build = ["build", "nickel", "-o", "s", "--force"];
        let told = succeeds(run_in(folder.path(), &[&build, settings].concat(), ""));
        assert!(told.starts_with("s: half-vector for nickel"), "{told}");
        spec_in(folder.path(), "s")
    };
    let default = spec(&[]);
    assert_eq!(default, spec(&["--sampler", "half-vector", "--table-size", "64kb"]));
    let length = folder.path().join("s").metadata().unwrap().len();
    assert!((50_000..70_000).contains(&length), "{length} bytes");
    let small = spec(&["--table-size", "2KB"]);
    assert!(small != default && small["fold"] == true && default["fold"] == false, "{small} {default}");
    let free = ["--tables", "3", "--rows", "5", "--segments", "7", "--fold", "--importance", "luminance"];
    let expected = serde_json::json!({
        "sampler": "half-vector", "tables": 3, "rows": 5, "segments": 7, "fold": true, "importance": "luminance",
    });
    assert_eq!(spec(&free), expected);
    let mut unfolded = small;
    unfolded["fold"] = false.into();
    assert_eq!(spec(&["--table-size", "2KB", "--no-fold"]), unfolded);
}

#[test]
fn commands_without_a_sampler_draw_by_the_half_vector_table() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| succeeds(run_in(folder.path(), arguments, ""));
    let settings = ["--sampler", "half-vector"];
    let sample = ["sample", "nickel", "--theta", "50", "--count", "20"];
    assert_eq!(run(&sample), run(&[&sample[..], &settings].concat()));
    let picture = |settings: &[&str]| {
        let render = ["render", "nickel", "--spp", "1", "--size", "8x8", "--force"];
        run(&[&render, settings].concat());
        std::fs::read(folder.path().join("render.exr")).unwrap()
    };
    let default = picture(&[]);
    assert!(default == picture(&settings) && default != picture(&["--sampler", "cosine"]));
    let report = run(&["report", "nickel", "--tables", "2", "--draws", "500"]);
    assert_eq!(report.matches("| half-vector 2×").count(), 3, "three sizes:\n{report}");
}

#[test]
fn info_tells_what_a_sampler_file_is() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| run_in(folder.path(), arguments, "");
    succeeds(run(&["build", "nickel", "-o", "s", "--table-size", "4KB", "--lookup", "linear"]));
    let text = succeeds(run(&["info", "s", "teflon"]));
    for word in ["sampler file", "half-vector 4KB", "nickel (embedded)", "linear", "albedo at 80°"] {
        assert!(text.contains(word), "{word} is missing in\n{text}");
    }
    let mut bytes = std::fs::read(folder.path().join("s")).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    std::fs::write(folder.path().join("s"), bytes).unwrap();
    assert!(fails(run(&["info", "s"])).contains("damaged or edited"));
}

#[test]
fn samples_tell_what_they_were_drawn_from() {
    let sample = ["sample", "nickel", "--theta", "50", "--phi", "20", "--count", "30"];
    let bare = succeeds(run(&sample, ""));
    let text = succeeds(run(&[&sample[..], &["--with-points"]].concat(), ""));
    let (mut first, mut points) = (None, std::collections::BTreeSet::new());
    for (line, bare) in text.lines().zip(bare.lines()) {
        let fields: Vec<&str> = line.splitn(6, ',').collect();
        assert_eq!(fields[5], bare);
        if let [Ok(x), Ok(y), Ok(z), Ok(u), Ok(v)] = [0, 1, 2, 3, 4].map(|i| fields[i].parse::<f32>()) {
            assert_eq!(*first.get_or_insert((x, y, z)), (x, y, z));
            assert!((0.0..1.0).contains(&u) && (0.0..1.0).contains(&v), "{line}");
            points.insert((u.to_bits(), v.to_bits()));
        }
    }
    let (x, y, z) = first.unwrap();
    assert!((z.acos().to_degrees() - 50.0).abs() < 1e-4 && (y.atan2(x).to_degrees() - 20.0).abs() < 1e-4);
    assert_eq!((points.len(), text.lines().count()), (30, 31));
    assert!(fails(run(&[&sample[..], &["--with-points", "--fit"]].concat(), "")).contains("--fit"));
}

#[test]
fn a_sampler_file_brings_its_own_settings() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| run_in(folder.path(), arguments, "");
    succeeds(run(&[&["build", "nickel", "-o", "s"][..], &QUICK].concat()));
    let sample = ["sample", "s", "--theta", "5", "--count", "3"];
    for (extra, expected) in [
        (&["--tables", "3"][..], "--tables has no effect on s"),
        (&["--sampler", "cosine"], "leave --sampler out"),
        (&["--lookup", "linear"], "leave --lookup out"),
        (&["--material", "teflon"], "the sampler was built from"),
    ] {
        let text = fails(run(&[&sample, extra].concat()));
        assert!(text.contains(expected), "{extra:?}: {text}");
    }
    let alone = succeeds(run(&sample));
    assert_eq!(alone, succeeds(run(&[&sample[..], &["--material", "nickel"]].concat())));
    assert!(
        fails(run(&["sample", "nickel", "--material", "nickel", "--theta", "5", "--count", "3"]))
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
    assert_eq!(std::fs::read_to_string(folder.path().join("s")).unwrap(), "mine");
    succeeds(run(&["build", "nickel", "-o", "s", "--force"]));
    succeeds(run(&["build", "nickel", "teflon", "-o", "several"]));
    let names = ["nickel.cascade-cdf.safetensors", "teflon.cascade-cdf.safetensors"];
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
        let settings = ["--sampler", sampler, "--tables", "5"];
        let results = ["1", "2"].map(|threads| {
            let common = [&settings[..], &["--threads", threads]].concat();
            run(&[&["build", "chrome", "-o", "s", "--force"][..], &common].concat());
            let draws =
                run(&[&["sample", "chrome", "--theta", "50", "--count", "300"][..], &common].concat());
            (std::fs::read(folder.path().join("s")).unwrap(), draws)
        });
        assert!(results[0] == results[1], "{sampler}");
    }
}

#[test]
fn report_puts_the_thesis_beside_the_measured_figures() {
    let arguments = ["report", "nickel", "--draws", "1000", "--json", "-"];
    let document = json(&succeeds(run(&[&arguments[..], &QUICK].concat(), "")));
    assert_eq!((&document["schema"], &document["kind"]), (&1.into(), &"report".into()));
    let nickel = &document["results"][0];
    assert_eq!((&nickel["material"], &nickel["lookup"]), (&"nickel".into(), &"floor".into()));
    assert_eq!(nickel["material_bytes"], 23_328_000);
    let samplers = nickel["samplers"].as_array().unwrap();
    assert_eq!(samplers.len(), 1);
    assert_eq!(samplers[0]["spec"]["tables"], 3);
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
    assert!(thesis.iter().all(|t| t["method"].as_str().unwrap().starts_with("thesis (")), "{thesis:?}");
    assert_eq!((&thesis[0]["memory_kb"], &thesis[0]["precompute_s"]), (&846.15.into(), &71.36.into()));
}

#[test]
fn report_in_csv_has_a_line_for_each_sampler_and_angle() {
    let arguments =
        ["report", "nickel", "chrome", "--draws", "500", "--sampler", "adaptive-disc", "--csv", "-"];
    let text = succeeds(run(&[&arguments[..], &QUICK].concat(), ""));
    let lines: Vec<_> = text.lines().collect();
    assert!(lines[0].starts_with("material,lookup,source,sampler,table_bytes,file_bytes,"), "{text}");
    for (material, thesis) in [("nickel", 4), ("chrome", 0)] {
        let count = |sampler: &str| {
            let start = format!("{material},floor,measured,{sampler}");
            lines.iter().filter(|l| l.starts_with(&start)).count()
        };
        assert_eq!(
            (count("\"adaptive-disc, 3 trees\""), count("cascade-cdf 3×1024×512 ±0.001")),
            (7, 7),
            "{text}"
        );
        let printed = lines.iter().filter(|l| l.starts_with(&format!("{material},,thesis,"))).count();
        assert_eq!(printed, thesis, "{text}");
    }
    assert_eq!(lines.len(), 1 + 2 * 2 * 7 + 4);
}

#[test]
fn report_words_its_tables() {
    let arguments = ["report", "nickel", "--draws", "1000"];
    let text = succeeds(run(&[&arguments[..], &QUICK].concat(), ""));
    for word in
        ["floor lookup", "cascade-cdf 3×1024×512 ±0.001", "thesis (6.23, 6.24)", "none was measured here"]
    {
        assert!(text.contains(word), "{word} is missing in\n{text}");
    }
}

#[test]
fn check_tells_right_from_wrong_by_its_status() {
    let check = ["check", "teflon", "--sampler", "cascade-cdf", "--draws", "2000"];
    let text = succeeds(run(&check, ""));
    assert_eq!(text.matches("13 ok").count(), 7, "{text}");
    assert!(!text.contains("FAILED"), "{text}");
    let published = run(&[&check[..], &["--as-published"]].concat(), "");
    assert_eq!(published.status.code(), Some(1));
    let text = String::from_utf8(published.stdout).unwrap();
    assert!(text.contains("2 of 13 FAILED"), "two angles have holes:\n{text}");
    assert_eq!(text.matches("positivity").count(), 3, "a column, and a row for each failure:\n{text}");
    let document = run(&[&check[..], &["--as-published", "--json", "-"]].concat(), "");
    assert_eq!(document.status.code(), Some(1));
    let document = json(&String::from_utf8(document.stdout).unwrap());
    assert_eq!((&document["schema"], &document["kind"]), (&1.into(), &"check".into()));
    let outcomes = document["results"][0]["outcomes"].as_array().unwrap();
    assert_eq!(outcomes.len(), 13 * 7);
    let failed: Vec<_> = outcomes.iter().filter(|o| o["pass"] == false).map(|o| &o["check"]).collect();
    assert_eq!(failed, ["positivity", "positivity"]);
}

#[test]
fn a_line_without_end_is_refused_while_it_arrives() {
    let text = fails(run(&["eval", "nickel"], &"1".repeat(1 << 20)));
    assert!(text.contains("line 1") && text.contains("without an end"), "{text}");
    // Not text, empty fields, too many fields, numbers that are none.
    for line in [
        "\0\0\0",
        ",,,,,",
        "0,0,1,0,0,1,",
        "nan,0,1,0,0,1",
        "inf,0,1,0,0,1",
        "1e999,0,0,0,0,1",
        "0x0,0,1,0,0,1",
    ] {
        let text = fails(run(&["eval", "nickel"], line));
        assert!(text.contains("line 1"), "{line}: {text}");
    }
}
