//! Mutated inputs, a million and more a parser: no panic, no hang, no memory beyond a multiple of the input.
//!
//! Inputs are pure functions of a seed and a number, so that a failure comes again. One that fails is written to the target's
//! temporary folder; copied to `tests/crashes/PARSER/` it is tried for ever. `MERLKIT_FUZZ=N` tries N inputs a parser
//! instead; `fuzz/` searches further, guided by coverage.

#[path = "../support/exercise.rs"]
mod exercise;
mod pictures;
mod sampler_files;
mod scenes;
#[path = "../support/watch.rs"]
mod watch;

use merlkit::color::Rgb;
use merlkit::files::Overwrite;
use merlkit::image::{Image, write_exr};
use merlkit::material::Material;
use merlkit::points::Stream;
use merlkit::sampler::store::encode;
use merlkit::sampler::{
    AdaptiveDiscSettings, CascadeCdfSettings, FactoredSettings, Factors, HalfVectorSettings,
    LeafChoice, LobeKind, LobeParameters, LobeSettings, SamplerSpec,
};
use rayon::prelude::*;
use safetensors::{Dtype, SafeTensors};
use sha2::{Digest, Sha256};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use watch::Watch;

/// Counts what the current thread holds, and its peak.
struct Counting;

thread_local! {
    static HELD: Cell<(isize, isize)> = const { Cell::new((0, 0)) };
}

fn count(change: isize) {
    // A thread that is ending has no counter any more.
    let _ = HELD.try_with(|held| {
        let now = held.get().0 + change;
        held.set((now, held.get().1.max(now)));
    });
}

// SAFETY: every call is the system allocator's; counting allocates nothing.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, place: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // Old and new may both exist for a moment.
        count(size as isize);
        count(-(layout.size() as isize));
        unsafe { System.realloc(place, layout, size) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        count(-(layout.size() as isize));
        unsafe { System.dealloc(place, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Most bytes held at once during `work`.
fn peak_of<T>(work: impl FnOnce() -> T) -> (T, usize) {
    let before = HELD.with(|held| {
        held.set((held.get().0, held.get().0));
        held.get().0
    });
    let result = work();
    (result, (HELD.with(|held| held.get().1) - before) as usize)
}

/// Memory that reading `input` bytes may take: `factor` for each, and a block of a picture.
fn bound(input: usize, factor: usize) -> usize {
    let block = if factor == EXR_FACTOR {
        14 << 20
    } else {
        1 << 16
    };
    block + factor * input
}

/// A sampler file takes its bytes, its header parsed and its tables unpacked.
const SAMPLER_FACTOR: usize = 64;

/// A byte of a picture may stand for 256 pixels of 12 bytes, held packed, unpacked and as colours.
const EXR_FACTOR: usize = 4 * 12 * 256;

fn inputs() -> u64 {
    let asked = std::env::var("MERLKIT_FUZZ")
        .ok()
        .and_then(|n| n.parse().ok());
    asked.unwrap_or(if cfg!(debug_assertions) {
        20_000
    } else {
        1_000_000
    })
}

/// Tries an even `share` of the inputs, made by `make`, on all threads; `read` says whether it accepted an input.
fn drive(
    name: &str,
    factor: usize,
    share: u64,
    make: impl Fn(&mut Stream) -> Vec<u8> + Sync,
    read: impl Fn(&[u8]) -> bool + Sync,
) {
    let tries = inputs() / share;
    let seed = name
        .bytes()
        .fold(7u64, |h, b| h.wrapping_mul(31).wrapping_add(b.into()));
    let input = |i: u64| make(&mut Stream::new(merlkit::points::mix(seed ^ i)));
    let keep = |i: u64| {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{i}.bin"));
        std::fs::write(&path, input(i)).unwrap();
        path
    };
    let watch = Watch::new();
    let trial = |i: u64| {
        let input = input(i);
        let (outcome, peak) = peak_of(|| catch_unwind(AssertUnwindSafe(|| read(&input))));
        if outcome.is_err() || peak > bound(input.len(), factor) {
            return Err(format!(
                "{}: panic {}, {peak} bytes",
                keep(i).display(),
                outcome.is_err()
            ));
        }
        Ok((
            u64::from(outcome.unwrap_or_default()),
            peak as f64 / (input.len().max(1) as f64),
        ))
    };
    let merged = watch.guard(keep, || {
        (0..tries)
            .into_par_iter()
            .map(|i| watch.during(i, || trial(i)))
            .try_reduce(|| (0, 0.0), |a, b| Ok((a.0 + b.0, f64::max(a.1, b.1))))
    });
    let (accepted, ratio) = merged.unwrap_or_else(|failure| panic!("{failure}"));
    println!(
        "{name}: {accepted} of {} accepted, at most {ratio:.0} bytes a byte",
        tries
    );
    assert!(
        accepted > 0,
        "{name}: mutations are too wild to reach what lies behind the first check"
    );
    assert!(accepted < tries, "{name}: nothing was refused");
}

/// A number below `n`.
fn below(random: &mut Stream, n: usize) -> usize {
    (random.next_u64() % n.max(1) as u64) as usize
}

const NASTY: [u64; 12] = [
    0,
    1,
    2,
    0x7f,
    0x80,
    0xff,
    0x7fff,
    0xffff,
    0x7fff_ffff,
    0xffff_ffff,
    0x7ff8 << 48,
    u64::MAX,
];

/// One to four changes that know nothing of a structure.
fn scramble(bytes: &mut Vec<u8>, random: &mut Stream) {
    for _ in 0..1 + below(random, 4) {
        let at = below(random, bytes.len());
        match below(random, 8) {
            0 => bytes.truncate(at),
            1 => bytes.extend((0..1 + at % 9).map(|_| random.next_u64() as u8)),
            2 if !bytes.is_empty() => drop(bytes.remove(at)),
            3 => bytes.insert(at, random.next_u64() as u8),
            4 | 5 => overwrite(
                bytes,
                at,
                1 << below(random, 4),
                NASTY[below(random, NASTY.len())],
            ),
            6 => {
                let from = below(random, bytes.len());
                let piece: Vec<u8> = bytes[from..]
                    .iter()
                    .take(1 + below(random, 16))
                    .copied()
                    .collect();
                bytes.splice(at..(at + piece.len()).min(bytes.len()), piece);
            }
            _ => {
                let flipped = bytes
                    .get(at)
                    .map_or(0, |b| u64::from(b ^ (1 << below(random, 8))));
                overwrite(bytes, at, 1, flipped);
            }
        }
    }
}

fn overwrite(bytes: &mut [u8], at: usize, width: usize, value: u64) {
    for (byte, new) in bytes
        .iter_mut()
        .skip(at)
        .take(width)
        .zip(value.to_le_bytes())
    {
        *byte = new;
    }
}

#[test]
fn merl_headers_and_planes() {
    let good: Vec<u8> = [
        &34_992_012u64.to_le_bytes()[..],
        &[90, 0, 0, 0, 90, 0, 0, 0, 180, 0, 0, 0],
        &(0..18u64)
            .flat_map(|i| (i as f64 * 0.1).to_le_bytes())
            .collect::<Vec<_>>(),
    ]
    .concat();
    let make = |random: &mut Stream| {
        let mut bytes = good.clone();
        match below(random, 3) {
            0 => scramble(&mut bytes, random),
            1 => overwrite(
                &mut bytes,
                4 * below(random, 5),
                4,
                random.next_u64() >> below(random, 60),
            ),
            _ => {
                let at = 20 + 8 * below(random, 18);
                overwrite(&mut bytes, at, 8, random.next_u64());
            }
        }
        bytes
    };
    drive("merl", 8, 1, make, exercise::merl);
}

/// What `merlkit eval` reads.
#[test]
fn lines_of_directions() {
    let good =
        "wo_x,wo_y,wo_z,wi_x,wi_y,wi_z\n0,0,1,0.6,-0.8,0\r\n\n 1e0, 0,-0 ,0.577,0.577,0.577\n";
    let words = [
        "nan", "inf", "-", "1e400", "1e-400", ",", "\n", "\u{feff}", "\0", "1_0", "٣",
    ];
    let make = |random: &mut Stream| {
        let mut bytes = good.as_bytes().to_vec();
        match below(random, 3) {
            0 => scramble(&mut bytes, random),
            1 => {
                let at = below(random, bytes.len());
                bytes.splice(at..at, words[below(random, words.len())].bytes());
            }
            _ => {
                let (from, times) = (below(random, bytes.len()), below(random, 300));
                let piece = bytes[from..].repeat(times);
                bytes.extend(piece);
            }
        }
        bytes
    };
    drive("pairs", 8, 1, make, exercise::pairs);
}

/// The watchdog sees an input that takes too long, and only that.
#[test]
fn a_hang_is_seen() {
    use std::{thread::sleep, time::Duration};
    let watch = Watch::with_limit(Duration::from_millis(50));
    let seen = watch.during(7, || {
        assert_eq!(watch.stuck(), None);
        sleep(Duration::from_millis(120));
        watch.during(8, || assert_eq!(watch.stuck(), None));
        watch.stuck()
    });
    assert_eq!((seen, watch.stuck()), (Some(7), None));
}

/// What once failed.
#[test]
fn kept_crashes_are_refused() {
    let material = exercise::material();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/crashes");
    let files = |parser: &str| -> Vec<PathBuf> {
        std::fs::read_dir(folder.join(parser))
            .into_iter()
            .flatten()
            .map(|e| e.unwrap().path())
            .collect()
    };
    for path in files("merl") {
        exercise::merl(&std::fs::read(path).unwrap());
    }
    for (parser, factor) in [("sampler", SAMPLER_FACTOR), ("exr", EXR_FACTOR)] {
        for path in files(parser) {
            let bytes = std::fs::read(&path).unwrap();
            let read = || {
                if parser == "exr" {
                    exercise::picture(&bytes)
                } else {
                    exercise::sampler(&bytes, &material)
                }
            };
            let (_, peak) = peak_of(read);
            assert!(
                peak <= bound(bytes.len(), factor),
                "{}: {peak} bytes",
                path.display()
            );
        }
    }
}
