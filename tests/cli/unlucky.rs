//! Paths that are no ordinary files, and files whose first lines lie: every reader refuses them, with words, and at once.
#![cfg(unix)]

use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

use assert_cmd::cargo::cargo_bin;
use merlkit::color::Rgb;
use merlkit::files::Overwrite;
use merlkit::image::{Image, decode_exr, read_exr, write_exr};
use merlkit::material::merl::load;
use merlkit::material::{LookupRule, Material};
use merlkit::sampler::store::SamplerFile;

/// What each reader says of `path`.
fn refusals(path: &Path) -> [String; 4] {
    let text = |e: merlkit::Error| e.to_string();
    [
        load(path).map(drop).map_err(text).unwrap_err(),
        SamplerFile::open(path).map(drop).map_err(text).unwrap_err(),
        read_exr(path).map(drop).map_err(text).unwrap_err(),
        Material::resolve(&path.to_string_lossy())
            .and_then(|m| m.load(LookupRule::Floor))
            .map(drop)
            .map_err(text)
            .unwrap_err(),
    ]
}

fn assert_all_say(path: &Path, word: &str) {
    for message in refusals(path) {
        assert!(
            message.contains(word) && message.contains(&*path.to_string_lossy()),
            "{message}"
        );
        assert!(!message.contains('\n'), "{message}");
    }
}

#[test]
fn folders_pipes_and_devices_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    assert_all_say(folder.path(), "a folder is not supported");
    // Opening a pipe without a writer would wait for ever.
    let pipe = folder.path().join("pipe.exr");
    assert!(
        Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    assert_all_say(&pipe, "a pipe or device is not supported");
    assert_all_say(Path::new("/dev/zero"), "a pipe or device is not supported");
    let path = pipe.to_str().unwrap();
    for arguments in [
        &["info", path][..],
        &["sample", path, "--theta", "1", "--count", "1"],
        &[
            "render", "nickel", "--light", path, "--size", "8x8", "--spp", "1", "-o", "x",
        ],
    ] {
        let output = Command::new(cargo_bin!("merlkit"))
            .args(arguments)
            .current_dir(folder.path())
            .output()
            .unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(text.contains("a pipe or device is not supported"), "{text}");
    }
    assert!(!folder.path().join("x.exr").exists());
}

#[test]
fn empty_and_missing_files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("empty.binary");
    std::fs::write(&path, "").unwrap();
    assert_all_say(&path, "expected");
    std::fs::remove_file(&path).unwrap();
    assert_all_say(&path, "cannot open");
}

#[test]
fn a_file_without_permission_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("secret.binary");
    std::fs::write(&path, "x").unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o000)).unwrap();
    // The superuser may read everything.
    if std::fs::File::open(&path).is_err() {
        assert_all_say(&path, "cannot open");
    }
}

/// Longer than any memory, and without a block on the disk.
#[test]
fn enormous_files_are_refused_before_memory_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hole.binary");
    let file = std::fs::File::create(&path).unwrap();
    if file.set_len(1 << 43).is_err() {
        return; // not every file system has holes
    }
    for message in refusals(&path) {
        assert!(
            message.contains("expected") || message.contains("at most"),
            "{message}"
        );
    }
}

/// A small picture whose header claims a large one.
#[test]
fn pictures_larger_than_their_file_can_hold_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    write_exr(
        &path,
        &Image::from_fn(4, 4, |_, _| Rgb::ONE).unwrap(),
        Overwrite::Refuse,
    )
    .unwrap();
    let good = std::fs::read(&path).unwrap();
    for (width, height, word) in [
        (8000i32, 8000i32, "can't hold it"),
        (16_384, 8192, "can't hold it"),
        (65_536, 65_536, "not supported"),
        (i32::MAX, i32::MAX, "expected"),
        (-1, -1, "a"),
        (0, 0, "a"),
        (i32::MIN, i32::MIN, "a"),
    ] {
        let mut lie = good.clone();
        for window in [&b"dataWindow\0box2i\0"[..], b"displayWindow\0box2i\0"] {
            let at =
                lie.windows(window.len()).position(|w| w == window).unwrap() + window.len() + 4 + 8;
            lie[at..at + 4].copy_from_slice(&width.wrapping_sub(1).to_le_bytes());
            lie[at + 4..at + 8].copy_from_slice(&height.wrapping_sub(1).to_le_bytes());
        }
        let message = decode_exr(&lie, Path::new("lie.exr"))
            .unwrap_err()
            .to_string();
        assert!(
            message.starts_with("lie.exr: ") && message.contains(word),
            "{width} × {height}: {message}"
        );
    }
}

/// Black compresses best: a real picture is never refused for its size.
#[test]
fn large_black_pictures_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("black.exr");
    write_exr(
        &path,
        &Image::from_fn(4096, 1024, |_, _| Rgb::ZERO).unwrap(),
        Overwrite::Refuse,
    )
    .unwrap();
    assert_eq!(read_exr(&path).unwrap().width(), 4096);
}
