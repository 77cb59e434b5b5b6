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
    assert!(fails(run_in(folder.path(), &other, "")).contains("another run"));

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
    assert_eq!(
        material["curves"][0], first["value"],
        "what was finished was measured again"
    );
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
    assert!(results["proof"]["error"]["rmse"].as_f64().unwrap() <= 0.05);
    let chosen = &results["tried"][results["chosen"].as_u64().unwrap() as usize];
    assert!(chosen["curve"]["table_bytes"].as_u64().unwrap() <= 9000);
    let draws = ["sample", "n.safetensors", "--theta", "30", "--count", "3"];
    assert_eq!(
        succeeds(run_in(folder.path(), &draws, "")).lines().count(),
        4
    );
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
        text.contains("nothing within the limits reaches") && text.contains("is nearest"),
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
