//! Hard cases on the command line.

use std::process::{Command, Output};

use assert_cmd::cargo::cargo_bin;
use merlkit::material::merl::{HardCase, load};

fn run(arguments: &[&str]) -> Output {
    Command::new(cargo_bin!("merlkit"))
        .args(arguments)
        .output()
        .unwrap()
}

#[test]
fn decode_writes_hard_cases() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().to_str().unwrap();
    let arguments = [
        "decode",
        "--hard-case",
        "poisoned",
        "--hard-case",
        "asymmetric-360",
        "-o",
        to,
    ];
    assert_eq!(run(&arguments).status.code(), Some(0));
    for name in ["poisoned", "asymmetric-360"] {
        let table = load(&folder.path().join(format!("{name}.binary"))).unwrap();
        assert_eq!(
            table.census(),
            HardCase::named(name).unwrap().table().census()
        );
    }
    let again = run(&arguments);
    assert_eq!(again.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&again.stderr).contains("--force"));
    assert_eq!(
        run(&[&arguments[..], &["--force"]].concat()).status.code(),
        Some(0)
    );
}

#[test]
fn wrong_names_are_answered_with_all_of_them() {
    let wrong = run(&["decode", "--hard-case", "nosuch", "-o", "."]);
    assert_eq!(wrong.status.code(), Some(2));
    let message = String::from_utf8_lossy(&wrong.stderr).into_owned();
    assert!(
        HardCase::ALL.iter().all(|case| message.contains(case.name)),
        "{message}"
    );
}

#[test]
fn hard_checks_take_no_materials() {
    assert_eq!(run(&["check", "--hard", "nickel"]).status.code(), Some(2));
    assert_eq!(
        run(&["decode", "--hard-case", "black", "nickel", "-o", "."])
            .status
            .code(),
        Some(2)
    );
}
