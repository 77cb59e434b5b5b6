//! Pictures that a signal stops, and `render --resume`.
#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::time::Duration;

use crate::run::{fails, run_in, succeeds};
use crate::writing::{Running, names};

/// Quick to load and long to render: five rounds of 64 paths per pixel or fewer.
const COMMAND: &str = "render lambert:reflectance=0.5 --sampler cosine --size 160x120 --spp 300 --seed 7 --bounces 2 --explain";
const KEPT: [&str; 3] = ["p.exr", "p.partial", "p.png"];

fn arguments<'a>(command: &'a str, more: &'a str) -> Vec<&'a str> {
    command.split(' ').chain(more.split(' ')).collect()
}

/// Starts the command and ends it in the midst of the picture; returns all messages.
fn stop_midway(folder: &Path, arguments: &[&str], signal: &str, status: i32) -> String {
    // How long loading takes is not known: a signal before the first path finds nothing to keep.
    for wait in [30, 100, 300, 900, 2700] {
        let mut running = Running::start(folder, arguments);
        running.line();
        std::thread::sleep(Duration::from_millis(wait));
        let (_, messages) = running.signal(signal, status);
        if !names(folder).is_empty() {
            return messages;
        }
    }
    panic!("it was never stopped in the midst of the picture");
}

/// Whether a file of the picture says that it is unfinished.
fn says(path: &Path, words: &str) -> bool {
    let bytes = fs::read(path).unwrap();
    let words = words.as_bytes();
    bytes.windows(words.len()).any(|w| w == words)
}

#[test]
fn a_stopped_picture_is_kept_and_goes_on_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("whole");
    let stopped = folder.path().join("stopped");
    for folder in [&whole, &stopped] {
        fs::create_dir(folder).unwrap();
    }
    let messages = stop_midway(&stopped, &arguments(COMMAND, "-o p"), "-INT", 130);
    assert!(messages.contains("p.exr has "), "{messages}");
    assert!(
        messages.contains(" of 300 paths per pixel; the same command with --resume finishes it")
    );
    assert_eq!(names(&stopped), KEPT);
    for name in ["p.exr", "p.png"] {
        let path = stopped.join(name);
        assert!(
            says(&path, "unfinished: ")
                && says(
                    &path,
                    "paths per pixel, seed 7; to finish it: merlkit render lambert"
                )
        );
    }
    refuse_all_else(&stopped);

    // Stopped again while it goes on, or finished before that; on other numbers of threads.
    let again = format!("{COMMAND} --resume --threads 3");
    succeeds(run_in(&stopped, &arguments(&again, "-o p"), ""));
    assert_eq!(names(&stopped), ["p.exr", "p.png"]);
    succeeds(run_in(&whole, &arguments(COMMAND, "-o p --threads 1"), ""));
    for name in ["p.exr", "p.png"] {
        let bytes = |folder: &Path| fs::read(folder.join(name)).unwrap();
        assert!(bytes(&stopped) == bytes(&whole), "{name}");
        assert!(!says(&stopped.join(name), "unfinished"));
    }
    let nothing = fails(run_in(&stopped, &arguments(&again, "-o p"), ""));
    assert!(
        nothing.contains("nothing to resume: there is no p.partial"),
        "{nothing}"
    );
}

/// What must not touch an unfinished picture.
fn refuse_all_else(folder: &Path) {
    let before = KEPT.map(|name| fs::read(folder.join(name)).unwrap());
    for (more, message) in [
        (
            "-o p",
            "p.partial is the saved state of an interrupted render",
        ),
        ("-o p --force", "continue with --resume, or remove the file"),
        ("-o q --resume", "nothing to resume: there is no q.partial"),
        (
            "-o p --resume --lookup linear",
            "lookup was floor, and is linear",
        ),
        (
            "-o p --resume --invalid channel",
            "invalid was cell, and is channel",
        ),
        ("-o p --resume --table f16", "table was f32, and is f16"),
        (
            "-o p --resume --light lamps",
            "lights was [Environment(Studio)], and is [Environment(BroadLamps)]",
        ),
    ] {
        let text = fails(run_in(folder, &arguments(COMMAND, more), ""));
        assert!(text.contains(message), "{more}: {text}");
    }
    let other_seed = COMMAND.replace("--seed 7", "--seed 8");
    let text = fails(run_in(folder, &arguments(&other_seed, "-o p --resume"), ""));
    assert!(text.contains("seed was 7, and is 8"), "{text}");
    let other_material = COMMAND.replace("0.5", "0.6");
    let text = fails(run_in(
        folder,
        &arguments(&other_material, "-o p --resume"),
        "",
    ));
    assert!(text.contains("material lambert:reflectance=0.6"), "{text}");

    let partial = folder.join("p.partial");
    fs::write(&partial, &before[1][..before[1].len() / 2]).unwrap();
    let text = fails(run_in(folder, &arguments(COMMAND, "-o p --resume"), ""));
    assert!(
        text.contains("the file is damaged: remove it to start again"),
        "{text}"
    );
    fs::write(&partial, &before[1]).unwrap();
    assert!(before == KEPT.map(|name| fs::read(folder.join(name)).unwrap()));
}

/// Spheres that are drawn apart, and frames of them.
#[test]
fn several_spheres_go_on_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let spheres = "lambert:reflectance=0.5 lambert:reflectance=0.1 --size 320x120";
    let command = COMMAND
        .replace("lambert:reflectance=0.5 ", "")
        .replace("--size 160x120", spheres);
    for (more, kept) in [
        ("", &["p.exr", "p.png", "p.tiles"][..]),
        (" --frames 2 --turn light", &["p.tiles"]),
    ] {
        let command = format!("{command}{more}");
        let messages = stop_midway(folder.path(), &arguments(&command, "-o p"), "-INT", 130);
        assert!(
            messages.contains(" spheres are kept in p.tiles"),
            "{messages}"
        );
        assert_eq!(names(folder.path()), kept);
        if more.is_empty() {
            assert!(says(
                &folder.path().join("p.exr"),
                "unfinished: some spheres are missing"
            ));
        }
        let other = command.replace("--bounces 2", "--bounces 3");
        let text = fails(run_in(
            folder.path(),
            &arguments(&other, "-o p --resume"),
            "",
        ));
        assert!(text.contains("other settings: bounces 2"), "{text}");
        let again = format!("{command} --resume --threads 3");
        succeeds(run_in(folder.path(), &arguments(&again, "-o p"), ""));
        let resumed = names(folder.path());
        let bytes = || {
            resumed
                .iter()
                .map(|name| fs::read(folder.path().join(name)).unwrap())
        };
        let resumed_bytes: Vec<Vec<u8>> = bytes().collect();
        assert!(!resumed.iter().any(|name| name == "p.tiles"));
        succeeds(run_in(
            folder.path(),
            &arguments(&command, "-o p --force --threads 1"),
            "",
        ));
        assert!(bytes().eq(resumed_bytes), "{more}");
        for name in resumed {
            fs::remove_file(folder.path().join(name)).unwrap();
        }
    }
}

/// SIGTERM, twice, and a target error.
#[test]
fn a_target_error_goes_on_too() {
    let folder = tempfile::tempdir().unwrap();
    let command = "render lambert:reflectance=0.5 --sampler cosine --size 120x90 --target-error 0.5% --max-spp 2048 --explain";
    let messages = stop_midway(folder.path(), &arguments(command, "-o p"), "-TERM", 143);
    assert!(
        messages.contains(" tiles; the same command with --resume"),
        "{messages}"
    );
    succeeds(run_in(
        folder.path(),
        &arguments(command, "-o p --resume"),
        "",
    ));
    let told = succeeds(run_in(folder.path(), &arguments(command, "-o whole"), ""));
    assert!(told.contains("estimated relative error"), "{told}");
    for extension in ["exr", "png"] {
        let bytes =
            |name: &str| fs::read(folder.path().join(format!("{name}.{extension}"))).unwrap();
        assert!(bytes("p") == bytes("whole"), "{extension}");
    }
}
