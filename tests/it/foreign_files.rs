//! Files that are no materials are named as what they are, with the remedy that follows.

use std::path::Path;

use merlkit::material::Material;
use merlkit::material::merl::Header;

/// What loading a file of these bytes answers.
fn answer(folder: &Path, bytes: &[u8]) -> String {
    let path = folder.join("some.binary");
    std::fs::write(&path, bytes).unwrap();
    let material = Material::resolve(path.to_str().unwrap()).unwrap();
    let facts = material.facts().unwrap_err().to_string();
    let load = material.load(Default::default()).unwrap_err().to_string();
    assert_eq!(facts, load);
    facts
}

#[test]
fn files_of_other_kinds_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&[u8], &str, &str); 14] = [
        (
            b"PK\x03\x04 and so on, many bytes",
            "a zip archive",
            "unzip",
        ),
        (
            b"\x1f\x8b\x08\0\0\0\0\0\0\0\0\0\0\0",
            "a gzip file",
            "unpack",
        ),
        (
            b"<!DOCTYPE html><html><head>",
            "a web page",
            "fetch the file itself",
        ),
        (
            b"version https://git-lfs.github.com/spec/v1\n",
            "Git LFS",
            "git lfs pull",
        ),
        (
            b"\x93NUMPY\x01\0v\0{'descr': '<f8'",
            "a numpy array",
            "merlkit import",
        ),
        (
            b"\x89HDF\r\n\x1a\n\0\0\0\0\0\0",
            "an HDF5 file",
            "docs/import.md",
        ),
        (
            b"MATLAB 5.0 MAT-file, Platform",
            "a MATLAB file",
            "docs/import.md",
        ),
        (
            b"SCATFUN\x01\0\0\0\0\0\0\0",
            "a SCATFUN file",
            "measurements",
        ),
        (
            b"\x76\x2f\x31\x01\x02\0\0\0channels",
            "an OpenEXR picture",
            "--light",
        ),
        (
            b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe",
            "a Radiance picture",
            "--light",
        ),
        (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "a PNG picture", "--light"),
        (
            b"\x50\0\0\0\0\0\0\0{\"__metadata__\":{}}",
            "a sampler file",
            "merlkit info",
        ),
        (b"about these files\n", "a text file", "a MERL binary"),
        (
            b"\xff\xd8\xff\xe0\0\x10JFIF\0\x01\x01",
            "a JPEG picture",
            "name a material",
        ),
    ];
    for (bytes, what, fix) in cases {
        let text = answer(folder.path(), bytes);
        assert!(
            text.contains(what) && text.contains(fix) && text.contains("some.binary"),
            "{text}"
        );
    }
    // Bytes that mean nothing are told as what a MERL binary would have there.
    let text = answer(folder.path(), &[7; 40]);
    assert!(text.contains("expected dimensions 90 × 90 × 180"), "{text}");
}

#[test]
fn tables_in_other_number_formats_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let header = Header { phi_d_bins: 180 };
    let single = 12 + 3 * 4 * header.cells();
    let mut bytes = header.to_bytes().to_vec();
    bytes.resize(single, 0);
    let text = answer(folder.path(), &bytes);
    assert!(
        text.contains("in single precision") && text.contains("64-bit"),
        "{text}"
    );
    // One byte less is a file that is cut off.
    let text = answer(folder.path(), &bytes[..single - 1]);
    assert!(text.contains("cut off"), "{text}");
    let mut swapped = header.to_bytes();
    for dimension in swapped.chunks_exact_mut(4) {
        dimension.reverse();
    }
    let text = answer(folder.path(), &swapped);
    assert!(
        text.contains("big-endian") && text.contains("reverse the bytes"),
        "{text}"
    );
}

#[test]
fn a_path_to_nothing_is_answered_by_what_is_embedded() {
    let text = Material::resolve("merl/black-oxidized-steel.binary")
        .unwrap_err()
        .to_string();
    assert!(
        text.contains("no such file") && text.contains("is called black-oxidized-steel"),
        "{text}"
    );
    let text = Material::resolve("merl/other.binary")
        .unwrap_err()
        .to_string();
    assert!(text.contains("os error 2"), "{text}");
}
