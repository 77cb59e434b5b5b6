//! Files that another program cuts short while they are read: an error, and no signal ends the process.

use std::fs::OpenOptions;
use std::io::Write;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use merlkit::Error;
use merlkit::color::Rgb;
use merlkit::files::{Overwrite, RegularFile};
use merlkit::image::{Image, read_exr, write_exr};
use merlkit::material::LookupRule;
use merlkit::material::Material;
use merlkit::material::merl::{decode_embedded, load, write};
use merlkit::sampler::store::{SamplerFile, save};
use merlkit::sampler::{HalfVectorSettings, SamplerSpec};

/// Cuts `path` and lengthens it again, all the while `work` runs `rounds` times; returns how often it failed.
fn while_shrinking(path: &Path, rounds: usize, work: impl Fn() -> Result<(), Error>) -> usize {
    let stop = AtomicBool::new(false);
    let file = OpenOptions::new().write(true).open(path).unwrap();
    let len = file.metadata().unwrap().len();
    let mut failed = 0;
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !stop.load(Ordering::Relaxed) {
                for part in [0, len / 3, len * 9 / 10] {
                    file.set_len(part).unwrap();
                    file.set_len(len).unwrap();
                }
                std::thread::yield_now();
            }
        });
        for _ in 0..rounds {
            if let Err(error) = work() {
                let known = matches!(
                    error,
                    Error::Invalid { .. } | Error::Argument { .. } | Error::Io { .. }
                );
                assert!(known && !error.to_string().contains('\n'), "{error}");
                failed += 1;
            }
        }
        stop.store(true, Ordering::Relaxed);
    });
    failed
}

/// Holes read as zeros, so that most rounds read a table of zeros or fail. A file that is held open for writing is not mapped; a
/// map would end this process.
#[test]
fn a_merl_binary_that_shrinks_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("nickel.binary");
    write(
        &decode_embedded("nickel").unwrap(),
        &path,
        Overwrite::Refuse,
    )
    .unwrap();
    let material = Material::resolve(&path.to_string_lossy()).unwrap();
    let failed = while_shrinking(&path, 60, || load(&path).map(drop));
    assert!(failed > 0, "the file was never seen short");
    while_shrinking(&path, 20, || material.sha256().map(drop));
}

/// Opened, cut short and closed again and again: some loads hold a lease, and then the writer waits for them.
#[test]
fn a_merl_binary_that_is_rewritten_is_whole_or_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("nickel.binary");
    let nickel = decode_embedded("nickel").unwrap();
    write(&nickel, &path, Overwrite::Refuse).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let (stop, mapped) = (AtomicBool::new(false), AtomicBool::new(false));
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !stop.load(Ordering::Relaxed) {
                std::fs::write(&path, &bytes[..bytes.len() / 3]).unwrap();
                std::fs::write(&path, &bytes).unwrap();
                std::thread::sleep(std::time::Duration::from_millis(30));
            }
        });
        let material = Material::resolve(&path.to_string_lossy()).unwrap();
        for _ in 0..40 {
            match material.load(LookupRule::Floor) {
                Ok(loaded) if loaded.file_access() == Some("mapped") => {
                    let table = loaded.table().unwrap().table();
                    assert!(table.cells().eq(nickel.cells()));
                    mapped.store(true, Ordering::Relaxed);
                }
                Ok(_) | Err(Error::Invalid { .. } | Error::Unsupported { .. }) => {}
                Err(error) => panic!("{error}"),
            }
        }
        stop.store(true, Ordering::Relaxed);
    });
    if !mapped.into_inner() {
        eprintln!("no load was mapped");
    }
}

#[test]
fn a_sampler_file_and_a_picture_that_shrink_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.safetensors");
    let material = Material::resolve("nickel").unwrap();
    let brdf = material.load(LookupRule::Floor).unwrap();
    let sampler = SamplerSpec::new(HalfVectorSettings::default())
        .build(&brdf)
        .unwrap();
    save(&sampler, &material, &path, Overwrite::Refuse).unwrap();
    while_shrinking(&path, 300, || SamplerFile::open(&path).map(drop));
    let path = folder.path().join("sky.exr");
    let sky = Image::from_fn(512, 256, |x, y| Rgb::splat((x * y) as f32)).unwrap();
    write_exr(&path, &sky, Overwrite::Refuse).unwrap();
    while_shrinking(&path, 50, || read_exr(&path).map(drop));
}

/// Without luck: the file is shorter than when it was opened.
#[test]
fn the_place_where_a_shorter_file_ends_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    std::fs::File::create(&path)
        .unwrap()
        .write_all(&[7; 100])
        .unwrap();
    let mut file = RegularFile::open(&path).unwrap();
    OpenOptions::new()
        .write(true)
        .open(&path)
        .unwrap()
        .set_len(60)
        .unwrap();
    let mut out = [0; 50];
    file.read_at(10, &mut out).unwrap();
    match file.read_at(20, &mut out).unwrap_err() {
        Error::Invalid {
            offset,
            expected,
            found,
            ..
        } => {
            assert_eq!(offset, 60);
            assert!(
                expected.contains("70 bytes") && expected.contains("had 100"),
                "{expected}"
            );
            assert!(found.contains("60"), "{found}");
        }
        other => panic!("{other}"),
    }
    assert!(matches!(
        file.read_all(1 << 20),
        Err(Error::Invalid { offset: 60, .. })
    ));
    let file = RegularFile::open(&path).unwrap();
    assert!(matches!(file.read_all(59), Err(Error::Unsupported { .. })));
}
