//! The embedded materials against an independent decoder, and the file format there and back.

use crate::support;
use std::fs::{File, OpenOptions};
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use merlkit::Error;
use merlkit::files::Overwrite;
use merlkit::material::merl::{Census, MerlTable, SCALE, decode_embedded, load, write};
use tempfile::TempDir;

#[test]
fn embedded_materials_decode_to_the_golden_values() {
    let mut worst = 0.0f64;
    let mut tables = std::collections::BTreeMap::new();
    for row in support::golden("golden_decode.csv") {
        let table: &MerlTable = tables
            .entry(row[0].clone())
            .or_insert_with(|| decode_embedded(&row[0]).unwrap());
        let [h, d, p]: [usize; 3] = std::array::from_fn(|i| row[i + 1].parse().unwrap());
        for c in 0..3 {
            let expected: f64 = row[4 + c].parse().unwrap();
            if expected < 0.0 {
                assert!(!table.is_valid(h, d, p), "{row:?}");
            } else {
                // The network's output is ln(1 + f_r); computed in f32, that is where its rounding error is even.
                let decoded = f64::from(table.rgb(h, d, p)[c]).ln_1p();
                worst = worst.max((decoded - (expected * SCALE[c]).ln_1p()).abs());
            }
        }
    }
    assert_eq!(tables.len(), 10);
    assert!(worst < 5e-6, "ln(1 + f_r) differs by {worst:e}");
}

/// A temporary folder and a file in it that says it has the given dimensions and is `length` bytes long, all zero.
fn hollow(dims: [i32; 3], length: u64) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.binary");
    let mut file = File::create(&path).unwrap();
    for d in dims {
        file.write_all(&d.to_le_bytes()).unwrap();
    }
    file.set_len(length).unwrap();
    (folder, path)
}

const BYTES_180: u64 = 34_992_012;

/// The offset, what was expected and what was found.
fn invalid(path: &Path) -> (u64, String, String) {
    match load(path).unwrap_err() {
        Error::Invalid {
            path: named,
            offset,
            expected,
            found,
            fix,
        } => {
            assert_eq!(named, path);
            assert!(!fix.is_empty());
            (offset, expected, found)
        }
        other => panic!("{other}"),
    }
}

#[test]
fn each_number_of_a_file_lands_in_its_cell_and_channel() {
    let (_folder, path) = hollow([90, 90, 180], 12);
    let mut file = BufWriter::new(OpenOptions::new().append(true).open(&path).unwrap());
    let cells = 90 * 90 * 180;
    for number in 0..3 * cells {
        file.write_all(&f64::from(number).to_le_bytes()).unwrap();
    }
    file.into_inner().unwrap();
    let table = load(&path).unwrap();
    let scale = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];
    for (h, d, p) in
        (0..90).flat_map(|h| (0..90).flat_map(move |d| (0..180).map(move |p| (h, d, p))))
    {
        let number = (h * 90 + d) * 180 + p;
        for (c, rgb) in table.rgb(h, d, p).to_array().into_iter().enumerate() {
            let raw = number as f64 + c as f64 * f64::from(cells);
            assert_eq!(rgb, (raw * scale[c]) as f32, "{h} {d} {p} {c}");
            let flat = table.cell(number);
            assert_eq!([flat[c], flat.w], [rgb, 1.0]);
        }
    }
    assert_eq!(table.census(), Census::default());
}

#[test]
fn a_written_table_loads_to_the_same_bits() {
    for bins in [180, 360] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("noise.binary");
        let table = support::noise_table(bins, 4, 2);
        write(&table, &path, Overwrite::Refuse).unwrap();
        assert_eq!(path.metadata().unwrap().len(), table.header().file_bytes());
        let loaded = load(&path).unwrap();
        assert_eq!(loaded.header(), table.header());
        assert_eq!(loaded.census(), table.census());
        assert!(loaded.cells().eq(table.cells()), "{bins}");
        let refused = write(&table, &path, Overwrite::Refuse)
            .unwrap_err()
            .to_string();
        assert!(
            refused.contains("exists") && refused.contains("--force"),
            "{refused}"
        );
        write(&table, &path, Overwrite::Replace).unwrap();
    }
}

#[test]
fn cut_off_files_say_where() {
    for length in [0, 1, 11] {
        let (_folder, path) = hollow([90, 90, 180], length);
        let (offset, expected, found) = invalid(&path);
        assert_eq!(offset, length);
        assert!(
            expected.contains("12-byte header") && found.contains(&length.to_string()),
            "{found}"
        );
    }
    for length in [12, 13, BYTES_180 / 2, BYTES_180 - 1] {
        let (_folder, path) = hollow([90, 90, 180], length);
        let (offset, expected, found) = invalid(&path);
        assert_eq!(offset, length);
        assert!(
            expected.contains("34992012") && found.contains(&length.to_string()),
            "{expected}"
        );
    }
    // With 360 bins of φd, that length is one of single precision.
    let (_folder, path) = hollow([90, 90, 360], BYTES_180);
    let text = load(&path).unwrap_err().to_string();
    assert!(text.contains("single precision"), "{text}");
    let (_folder, path) = hollow([90, 90, 360], BYTES_180 + 8);
    assert_eq!(invalid(&path).0, BYTES_180 + 8);
}

#[test]
fn trailing_bytes_say_where_they_begin() {
    let (_folder, path) = hollow([90, 90, 180], BYTES_180 + 5);
    assert_eq!(invalid(&path).0, BYTES_180);
}

#[test]
fn other_dimensions_are_refused() {
    for dims in [
        [90, 90, 181],
        [180, 90, 90],
        [-90, -90, 180],
        [0, 0, 0],
        [i32::MAX; 3],
        [i32::MIN, 90, 180],
    ] {
        let (_folder, path) = hollow(dims, BYTES_180);
        let (offset, expected, found) = invalid(&path);
        assert_eq!(offset, 0);
        assert!(expected.contains("90 × 90 × 180"), "{expected}");
        assert_eq!(found, format!("{} × {} × {}", dims[0], dims[1], dims[2]));
    }
}

#[test]
fn folders_and_missing_files_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    assert!(matches!(
        load(folder.path()),
        Err(Error::Unsupported { .. })
    ));
    let missing = folder.path().join("missing.binary");
    match load(&missing) {
        Err(Error::Io { path, source, .. }) => {
            assert_eq!(
                (path, source.kind()),
                (missing, std::io::ErrorKind::NotFound)
            );
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn unusable_cells_are_counted_by_kind_and_marked() {
    let (_folder, path) = hollow([90, 90, 180], BYTES_180);
    let mut file = OpenOptions::new().write(true).open(&path).unwrap();
    let cells = 90 * 90 * 180;
    let mut put = |channel: u64, cell: u64, value: f64| {
        file.seek(SeekFrom::Start(12 + 8 * (channel * cells + cell)))
            .unwrap();
        file.write_all(&value.to_le_bytes()).unwrap();
    };
    put(0, 0, f64::NAN);
    put(1, 1, f64::INFINITY);
    put(2, 2, f64::NEG_INFINITY);
    put(0, 3, 1e300); // finite, but not as f32
    put(2, 4, -1.0);
    put(1, 5, -1e-300);
    put(0, 6, f64::NAN); // counted once, by the first reason
    put(1, 6, -1.0);
    put(0, 7, -0.0); // zero is a value
    put(0, 8, 1e-300); // too small for f32: zero
    let table = load(&path).unwrap();
    assert_eq!(
        table.census(),
        Census {
            nan: 2,
            infinite: 3,
            negative: 2
        }
    );
    let valid: Vec<bool> = (0..10).map(|p| table.is_valid(0, 0, p)).collect();
    assert_eq!(
        valid,
        [
            false, false, false, false, false, false, false, true, true, true
        ]
    );
    assert!(
        table
            .cells()
            .all(|c| c.is_finite() && c.min_element() >= 0.0)
    );
}

#[test]
fn a_loaded_table_outlives_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("noise.binary");
    let table = support::noise_table(180, 4, 2);
    write(&table, &path, Overwrite::Refuse).unwrap();
    let loaded = load(&path).unwrap();
    std::fs::write(&path, b"something else").unwrap();
    File::create(&path).unwrap().set_len(0).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert!(loaded.cells().eq(table.cells()));
}
