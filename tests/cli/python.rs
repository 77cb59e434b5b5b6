//! The reader of half-vector tables in Python agrees with the library.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Output};

use assert_cmd::cargo::cargo_bin;

const READER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tools/half_vector.py");

/// Runs the reader in `folder` on a sampler file and its draws.
fn reader(folder: &Path, file: &str, draws: &str) -> Output {
    Command::new("python3")
        .args(["-B", READER, file, draws])
        .current_dir(folder)
        .output()
        .unwrap()
}

/// Whether there is something to test with; says so if not.
fn has_numpy() -> bool {
    let found = Command::new("python3")
        .args(["-c", "import numpy"])
        .output()
        .is_ok_and(|o| o.status.success());
    if !found {
        // Not by a macro, whose output the test harness would keep to itself.
        std::io::stderr()
            .write_all(b"skipped: no python3 with numpy\n")
            .unwrap();
    }
    found
}

fn merlkit(folder: &Path, arguments: &[&str]) -> String {
    let output = Command::new(cargo_bin!("merlkit"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{arguments:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).unwrap()
}

/// Builds the file `s` and writes 20,000 of its draws to `draws.csv`.
fn build_and_draw(folder: &Path, material: &str, settings: &[&str]) {
    merlkit(
        folder,
        &[&["build", material, "-o", "s", "--force"], settings].concat(),
    );
    let mut draws = String::new();
    for (theta, phi) in [
        ("0", "0"),
        ("0.1", "-90"),
        ("63.3", "200"),
        ("85", "33"),
        ("89.99", "-170"),
    ] {
        let angles = [
            "--theta",
            theta,
            "--phi",
            phi,
            "--count",
            "4000",
            "--with-points",
        ];
        let text = merlkit(folder, &[&["sample", "s"][..], &angles].concat());
        let lines = text.split_once('\n').unwrap();
        assert_eq!(
            lines.0,
            "wo_x,wo_y,wo_z,u_x,u_y,wi_x,wi_y,wi_z,pdf,f_r,f_g,f_b"
        );
        draws += if draws.is_empty() { &text } else { lines.1 };
    }
    assert_eq!(draws.lines().count(), 20_001);
    std::fs::write(folder.join("draws.csv"), draws).unwrap();
}

/// The reader demands 10⁻⁵ of every component of `wi` and, relative, of the density, but for one draw in a thousand, which
/// rounding may put on the other side of a row's edge.
#[test]
fn the_reader_draws_what_the_library_draws() {
    if !has_numpy() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&str, &[&str]); 6] = [
        ("nickel", &["--sampler", "half-vector:2KB"]),
        ("nickel", &["--sampler", "half-vector:64KB"]),
        ("red-plastic", &["--sampler", "half-vector:2KB"]),
        ("red-plastic", &["--sampler", "half-vector:64KB"]),
        (
            "chrome",
            &["--sampler", "half-vector:tables=1,rows=2,segments=1"],
        ),
        (
            "chrome",
            &[
                "--sampler",
                "half-vector:8KB,unfolded,luminance",
                "--lookup",
                "linear",
            ],
        ),
    ];
    for (material, settings) in cases {
        build_and_draw(folder.path(), material, settings);
        let output = reader(folder.path(), "s", "draws.csv");
        let said = [output.stdout, output.stderr]
            .map(|text| String::from_utf8(text).unwrap())
            .concat();
        assert!(output.status.success(), "{material} {settings:?}: {said}");
        assert!(said.starts_with("20000 draws, "), "{said}");
    }
}

#[test]
fn the_reader_rejects_draws_that_differ() {
    if !has_numpy() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    build_and_draw(folder.path(), "nickel", &["--sampler", "half-vector:64KB"]);
    let draws = std::fs::read_to_string(folder.path().join("draws.csv")).unwrap();
    // Columns of wi_z and pdf: too large in every hundredth line, by little more than is allowed.
    for (column, by) in [(7, 3e-5), (8, 0.0)] {
        let spoilt = draws.lines().enumerate().map(|(i, line)| match i % 100 {
            1 => spoil(line, column, by),
            _ => format!("{line}\n"),
        });
        std::fs::write(folder.path().join("spoilt.csv"), spoilt.collect::<String>()).unwrap();
        let output = reader(folder.path(), "s", "spoilt.csv");
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(
            !output.status.success() && said.contains("200 beyond"),
            "column {column}: {said}"
        );
    }
    let path = folder.path().join("s");
    let whole = std::fs::read(&path).unwrap();
    // Any of the five tensors, a tenth of its values about the middle.
    for name in [
        "knot.cosine",
        "row.edge",
        "row.cdf",
        "row.slope",
        "row.density",
    ] {
        let mut bytes = whole.clone();
        last_bytes_about_the_middle(&bytes, name).for_each(|at| bytes[at] ^= 0x10);
        std::fs::write(&path, bytes).unwrap();
        let output = reader(folder.path(), "s", "draws.csv");
        assert!(
            !output.status.success(),
            "{name}: {}",
            String::from_utf8_lossy(&output.stdout)
        );
    }
}

/// A line with a number in it made larger: by `by`, and by 3·10⁻⁵ of itself where that is 0.
fn spoil(line: &str, column: usize, by: f64) -> String {
    let mut fields: Vec<String> = line.split(',').map(String::from).collect();
    let value: f64 = fields[column].parse().unwrap();
    fields[column] = format!(
        "{:?}",
        if by > 0.0 {
            value + by
        } else {
            value * (1.0 + 3e-5)
        }
    );
    fields.join(",") + "\n"
}

/// Places of the last bytes of a tensor's values, for a tenth of them.
fn last_bytes_about_the_middle(bytes: &[u8], name: &str) -> impl Iterator<Item = usize> + use<> {
    let end = 8 + u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize;
    let header: serde_json::Value = serde_json::from_slice(&bytes[8..end]).unwrap();
    let tensor = &header[name];
    let [start, stop] = [0, 1].map(|i| tensor["data_offsets"][i].as_u64().unwrap() as usize);
    let count = tensor["shape"][0].as_u64().unwrap() as usize;
    let size = (stop - start) / count;
    (count * 9 / 20..=count * 11 / 20).map(move |i| end + start + i * size + size - 1)
}
