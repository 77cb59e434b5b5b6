//! `compare` and `tune`.

use std::process::{Command, Stdio};

use assert_cmd::cargo::cargo_bin;

use crate::run::{fails, json, run_in, succeeds};

/// A run that is stopped midway goes on where it was, and is complete in the end.
#[test]
fn a_stopped_comparison_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["compare", "teflon", "--quick", "-o", "o"];
    let journal = folder.path().join("o/compare.partial.jsonl");
    let mut child = Command::new(cargo_bin!("merlkit"))
        .args(arguments)
        .current_dir(folder.path())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let lines = || std::fs::read_to_string(&journal).map_or(0, |text| text.lines().count());
    while lines() < 4 {
        assert!(child.try_wait().unwrap().is_none(), "it ended early");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let kept: Vec<String> = std::fs::read_to_string(&journal)
        .unwrap()
        .lines()
        .take(4)
        .map(str::to_owned)
        .collect();
    assert!(fails(run_in(folder.path(), &arguments, "")).contains("--resume"));
    let other = [
        "compare", "teflon", "--quick", "-o", "o", "--seed", "2", "--resume",
    ];
    assert!(fails(run_in(folder.path(), &other, "")).contains("a run with other options"));

    let text = succeeds(run_in(
        folder.path(),
        &[&arguments[..], &["--resume"]].concat(),
        "",
    ));
    assert!(
        text.contains("teflon: ") && text.contains("compare.html"),
        "{text}"
    );
    assert!(!journal.exists());
    let document = json(&std::fs::read_to_string(folder.path().join("o/compare.json")).unwrap());
    assert_eq!(
        (&document["kind"], &document["results"]["plan"]["quick"]),
        (&"compare".into(), &true.into())
    );
    let material = &document["results"]["materials"][0];
    let first: serde_json::Value = json(&kept[2]);
    // Times come last, of all in turn; everything else is as it was kept.
    let mut curve = material["curves"][0].clone();
    let cost = curve["ns_per_sample"].clone();
    assert!(
        cost["low"].as_f64() > Some(0.0) && cost["low"].as_f64() <= cost["high"].as_f64(),
        "{cost}"
    );
    curve["ns_per_sample"] = first["value"]["ns_per_sample"].clone();
    assert_eq!(
        curve, first["value"],
        "what was finished was measured again"
    );
    assert!(material["notes"].is_array() && material["verdict"]["ties"].is_array());
    let csv = std::fs::read_to_string(folder.path().join("o/compare.csv")).unwrap();
    assert!(csv.starts_with("experiment,material,scene,who,points,samples,figure,value,unit\n"));
    for experiment in ["point,", "picture,", "setting,"] {
        assert!(
            csv.lines().any(|line| line.starts_with(experiment)),
            "{experiment}"
        );
    }
    assert!(fails(run_in(folder.path(), &arguments, "")).contains("--force"));
}

#[test]
fn tune_writes_the_sampler_it_chose() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = [
        "tune",
        "nickel",
        "--target-error",
        "5%",
        "--max-bytes",
        "9000",
        "-o",
        "n.safetensors",
    ];
    let output = run_in(
        folder.path(),
        &[&arguments[..], &["--json", "t.json"]].concat(),
        "",
    );
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains("→ ") && text.contains("reaches 5 % with"),
        "{text}"
    );
    let tuning = json(&std::fs::read_to_string(folder.path().join("t.json")).unwrap());
    let results = &tuning["results"];
    assert!(results["proof"]["error"]["high"].as_f64().unwrap() <= 0.05);
    assert!(results["notes"].is_array() && text.contains("per estimate (counted)"));
    let chosen = &results["tried"][results["chosen"].as_u64().unwrap() as usize];
    assert!(chosen["curve"]["table_bytes"].as_u64().unwrap() <= 9000);
    let draws = ["sample", "n.safetensors", "--theta", "30", "--count", "3"];
    assert_eq!(
        succeeds(run_in(folder.path(), &draws, "")).lines().count(),
        4
    );
}

/// Of one machine, every run says the same but for the measured times, whatever else runs.
#[test]
fn tune_says_the_same_twice_on_a_busy_machine() {
    let folder = tempfile::tempdir().unwrap();
    let choose = || {
        let arguments = ["tune", "teflon", "--target-error", "5%", "--json", "-"];
        let tuning = json(&succeeds(run_in(folder.path(), &arguments, "")));
        let results = &tuning["results"];
        let named = |key: &str| match results[key].as_u64() {
            Some(i) => results["tried"][i as usize]["curve"]["label"].clone(),
            None => serde_json::Value::Null,
        };
        let proof = results["proof"].clone();
        (named("chosen"), named("cheaper"), named("better"), proof)
    };
    let mut other = Command::new("sh")
        .args(["-c", "while :; do :; done"])
        .spawn()
        .unwrap();
    let busy = choose();
    other.kill().unwrap();
    other.wait().unwrap();
    assert!(busy.0.is_string(), "{busy:?}");
    assert_eq!(busy, choose());
}

/// 5 is 500 %: nobody means that, and it is not taken for 5 %.
#[test]
fn a_target_above_the_whole_is_asked_about() {
    let folder = tempfile::tempdir().unwrap();
    for command in [
        &["tune", "nickel"][..],
        &["render", "nickel", "-o", "r", "--light", "point"],
        &["export", "nickel", "--format", "bsdf", "-o", "e"],
    ] {
        let arguments = [command, &["--target-error", "5"]].concat();
        let message = fails(run_in(folder.path(), &arguments, ""));
        assert!(message.contains("did you mean 5%?"), "{message}");
        let arguments = [command, &["--target-error", "500%"]].concat();
        assert!(fails(run_in(folder.path(), &arguments, "")).contains("above the maximum of 100%"));
    }
}

#[test]
fn tune_says_how_near_one_gets() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = [
        "tune",
        "chrome",
        "--target-error",
        "1e-7",
        "--max-bytes",
        "2500",
    ];
    let output = run_in(folder.path(), &arguments, "");
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains("no sampler within the limits reaches") && text.contains("is closest"),
        "{text}"
    );
    assert!(
        fails(run_in(
            folder.path(),
            &["tune", "nickel", "--target-error", "0"],
            ""
        ))
        .contains("0")
    );
}
