//! Mutated inputs, a million and more a parser: no panic, no hang, no memory beyond a multiple of the input.
//!
//! Inputs are pure functions of a seed and a number, so that a failure comes again. One that fails is written to the target's
//! temporary folder; copied to `tests/crashes/PARSER/` it is tried for ever. `MERLKIT_FUZZ=N` tries N inputs a parser
//! instead; `fuzz/` searches further, guided by coverage.

#[path = "../support/exercise.rs"]
mod exercise;
#[path = "../support/watch.rs"]
mod watch;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

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
/// A byte of a Radiance picture may stand for 1024 pixels of 12 bytes, held in rows, joined and as they grow; one of a PNG for
/// 1032 bytes of 8 pixels, unpacked to 4 bytes each.
const PICTURE_FACTOR: usize = 4 * 12 * 1032;

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

/// A sampler file taken apart, to be put together with a checksum that fits.
#[derive(Clone)]
struct Parts {
    tensors: Vec<(String, Dtype, Vec<u8>)>,
    record: serde_json::Value,
}

impl Parts {
    fn of(spec: SamplerSpec) -> Self {
        let material = Material::resolve("red-plastic").unwrap();
        let sampler = spec.build(&exercise::material()).unwrap();
        let bytes = encode(&sampler, &material).unwrap();
        let (_, header) = SafeTensors::read_metadata(&bytes).unwrap();
        let file = SafeTensors::deserialize(&bytes).unwrap();
        let mut tensors: Vec<_> = file
            .iter()
            .map(|(name, v)| (name.to_owned(), v.dtype(), v.data().to_vec()))
            .collect();
        tensors.sort_by(|a, b| a.0.cmp(&b.0));
        let record = serde_json::from_str(&header.metadata().as_ref().unwrap()["merlkit"]).unwrap();
        Self { tensors, record }
    }

    fn write(mut self) -> Vec<u8> {
        let (mut hash, mut data, mut entries) = (Sha256::new(), Vec::new(), Vec::new());
        for (name, dtype, bytes) in &self.tensors {
            hash.update(format!("{name}:{dtype:?}:{}:", bytes.len()));
            hash.update(bytes);
            let (start, length) = (data.len(), bytes.len() * 8 / dtype.bitsize());
            data.extend_from_slice(bytes);
            entries.push(format!(
                "\"{name}\":{{\"dtype\":\"{dtype:?}\",\"shape\":[{length}],\"data_offsets\":[{start},{}]}}",
                data.len()
            ));
        }
        let hex: String = hash.finalize().iter().map(|b| format!("{b:02x}")).collect();
        self.record["payload_sha256"] = hex.into();
        let metadata =
            serde_json::to_string(&HashMap::from([("merlkit", self.record.to_string())])).unwrap();
        let json = format!("{{\"__metadata__\":{metadata},{}}}", entries.join(","));
        [
            &(json.len() as u64).to_le_bytes()[..],
            json.as_bytes(),
            &data,
        ]
        .concat()
    }

    /// One change to a value, a length, a name or a setting.
    fn change(&mut self, random: &mut Stream) {
        let which = below(random, self.tensors.len());
        match below(random, 12) {
            0 => drop(self.tensors.remove(which)),
            1 => self.change_setting(random),
            2 => {
                let (_, dtype, bytes) = &mut self.tensors[which];
                let keep =
                    below(random, bytes.len() * 8 / dtype.bitsize() + 1) * dtype.bitsize() / 8;
                bytes.truncate(keep);
            }
            3 => {
                let (_, _, bytes) = &mut self.tensors[which];
                bytes.extend_from_within(..);
            }
            _ => self.change_value(which, random),
        }
    }

    fn change_value(&mut self, which: usize, random: &mut Stream) {
        let (_, dtype, bytes) = &mut self.tensors[which];
        let width = dtype.bitsize() / 8;
        let count = (bytes.len() / width).max(1);
        let at = width * below(random, count);
        let old = bytes[at.min(bytes.len())..]
            .iter()
            .take(width)
            .rev()
            .fold(0, |v, &b| v << 8 | u64::from(b));
        let new = match below(random, 5) {
            0 => NASTY[below(random, NASTY.len())],
            1 => old.wrapping_add(1),
            2 => old.wrapping_sub(1),
            3 => old ^ 1 << below(random, 8 * width),
            _ => random.next_u64(),
        };
        overwrite(bytes, at, width, new);
    }

    fn change_setting(&mut self, random: &mut Stream) {
        let settings = self.record["settings"].as_object_mut().unwrap();
        let keys: Vec<String> = settings.keys().cloned().collect();
        let value = &mut settings[&keys[below(random, keys.len())]];
        *value = match below(random, 8) {
            0 => 0.into(),
            1 => (-1).into(),
            2 => u64::MAX.into(),
            3 => 1e300.into(),
            4 => serde_json::Value::Null,
            5 => below(random, 300).into(),
            6 => random.next_f64().into(),
            _ => (value.as_u64().unwrap_or(3) + 1).into(),
        };
    }
}

fn drive_sampler(name: &str, spec: SamplerSpec) {
    // They share the reader of the file, and each has a reader of its tensors.
    let share = 7;
    let (good, material) = (Parts::of(spec), exercise::material());
    let whole = good.clone().write();
    assert!(
        exercise::sampler(&whole, &material),
        "{name}: what was not mutated is accepted"
    );
    let make = |random: &mut Stream| {
        if below(random, 4) == 0 {
            let mut bytes = whole.clone();
            scramble(&mut bytes, random);
            return bytes;
        }
        let mut parts = good.clone();
        for _ in 0..1 + below(random, 2) {
            if !parts.tensors.is_empty() {
                parts.change(random);
            }
        }
        parts.write()
    };
    drive(name, SAMPLER_FACTOR, share, make, |input| {
        exercise::sampler(input, &material)
    });
}

fn small_disc(leaves: LeafChoice) -> SamplerSpec {
    let settings = AdaptiveDiscSettings {
        tables: 2,
        depth: 2,
        leaves,
        ..Default::default()
    };
    SamplerSpec::new(settings)
}

#[test]
fn sampler_files_of_trees() {
    drive_sampler("sampler-trees", small_disc(LeafChoice::Envelope));
}

#[test]
fn sampler_files_of_warps() {
    drive_sampler("sampler-warps", small_disc(LeafChoice::Warp));
}

#[test]
fn sampler_files_of_curves() {
    let small = CascadeCdfSettings {
        tables: 2,
        theta_h: 6,
        phi_h: 4,
        ..Default::default()
    };
    drive_sampler("sampler-curves", SamplerSpec::new(small));
    let whole = CascadeCdfSettings {
        tolerance: None,
        ..small
    };
    drive_sampler("sampler-curves-whole", SamplerSpec::new(whole));
}

#[test]
fn sampler_files_of_half_vectors() {
    let small = HalfVectorSettings {
        tables: 2,
        rows: 4,
        segments: 2,
        ..HalfVectorSettings::PRESETS[0].1
    };
    drive_sampler("sampler-half-vector", SamplerSpec::new(small));
}

#[test]
fn sampler_files_of_lobes_and_factors() {
    let parameters = Some(LobeParameters {
        along: 0.2,
        across: 0.2,
        diffuse: 0.1,
    });
    let lobe = LobeSettings {
        parameters,
        ..LobeSettings::fitted(LobeKind::Ward)
    };
    drive_sampler("sampler-lobe", SamplerSpec::new(lobe));
    let factors = Some(Factors {
        outer: 2,
        inner: 1,
        theta: 4,
        phi: 3,
        half: true,
        floor: 0.01,
    });
    let settings = FactoredSettings {
        tables: 2,
        factors,
        ..Default::default()
    };
    drive_sampler("sampler-factors", SamplerSpec::new(settings));
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

/// Our own file and one of each compression that the reader knows.
fn pictures() -> Vec<Vec<u8>> {
    use exr::prelude::{Blocks, WritableImage};
    use exr::prelude::{
        Compression, Encoding, Layer, LayerAttributes, LineOrder, SpecificChannels, Vec2,
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    write_exr(
        &path,
        &Image::from_fn(3, 2, |x, y| Rgb::splat((x + y) as f32)).unwrap(),
        Overwrite::Refuse,
    )
    .unwrap();
    let mut all = vec![std::fs::read(&path).unwrap()];
    for (compression, blocks) in [
        (Compression::Uncompressed, Blocks::ScanLines),
        (Compression::RLE, Blocks::Tiles(Vec2(2, 2))),
        (Compression::ZIP16, Blocks::ScanLines),
        (Compression::PIZ, Blocks::ScanLines),
        (Compression::PXR24, Blocks::ScanLines),
        (Compression::B44, Blocks::ScanLines),
    ] {
        let encoding = Encoding {
            compression,
            blocks,
            line_order: LineOrder::Increasing,
        };
        let channels = SpecificChannels::rgb(|Vec2(x, y)| (x as f32, y as f32, 0.5f32));
        let layer = Layer::new((4, 3), LayerAttributes::named("l"), encoding, channels);
        let mut bytes = std::io::Cursor::new(Vec::new());
        exr::prelude::Image::from_layer(layer)
            .write()
            .non_parallel()
            .to_buffered(&mut bytes)
            .unwrap();
        all.push(bytes.into_inner());
    }
    all
}

#[test]
fn pictures_as_openexr() {
    let seeds = pictures();
    assert!(seeds.iter().all(|s| exercise::picture(s)));
    let make = |random: &mut Stream| {
        let mut bytes = seeds[below(random, seeds.len())].clone();
        if below(random, 2) == 0 {
            scramble(&mut bytes, random);
        } else {
            // A number of the header: sizes, types, offsets.
            let at = below(random, bytes.len().min(420));
            overwrite(&mut bytes, at, 4, NASTY[below(random, NASTY.len())]);
        }
        bytes
    };
    drive("exr", EXR_FACTOR, 1, make, exercise::picture);
}

#[test]
fn pictures_of_other_formats() {
    let radiance = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y 2 +X 8\n";
    let new_row = [
        2, 2, 0, 8, 130, 7, 6, 1, 2, 3, 4, 5, 6, 136, 9, 136, 10, 136, 129,
    ];
    let old_row = [1, 2, 3, 129, 1, 1, 1, 7];
    let pfm = b"PF\n2 1\n-1.0\n";
    let pixels: Vec<u8> = (0..6).flat_map(|i| (i as f32).to_le_bytes()).collect();
    let png = merlkit::image::encode_png(5, 3, &[99; 45]).unwrap();
    let seeds = [
        [&radiance[..], &new_row, &old_row].concat(),
        [&pfm[..], &pixels].concat(),
        png,
    ];
    assert!(seeds.iter().all(|s| exercise::picture(s)));
    let make = |random: &mut Stream| {
        let mut bytes = seeds[below(random, seeds.len())].clone();
        scramble(&mut bytes, random);
        bytes
    };
    drive("picture", PICTURE_FACTOR, 1, make, exercise::picture);
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
