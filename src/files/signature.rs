//! What a file is, by its first bytes: for messages about files that are something else than what was expected.

/// A kind of file that holds no material, and what to do with one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ForeignKind {
    /// What it is: "a zip archive".
    pub what: &'static str,
    /// What the user can do.
    pub fix: &'static str,
}

const UNPACK: &str = "unpack it, and name what it holds";
const IMPORT: &str = "`merlkit import` makes a MERL binary of it";
const PICTURE: &str = "name a material here; pictures are environments, for --light";

/// Beginnings of files, what they mean, and the remedy.
#[rustfmt::skip]
const SIGNATURES: &[(&[u8], &str, &str)] = &[
    (b"PK\x03\x04", "a zip archive (or an .npz file of numpy)", "unpack it, and name what it holds; `merlkit import` makes a MERL binary of an .npz file"),
    (b"\x1f\x8b", "a gzip-compressed file", UNPACK),
    (b"BZh", "a bzip2-compressed file", UNPACK),
    (b"\xfd7zXZ\0", "an xz-compressed file", UNPACK),
    (b"\x28\xb5\x2f\xfd", "a zstd-compressed file", UNPACK),
    (b"7z\xbc\xaf\x27\x1c", "a 7-zip archive", UNPACK),
    (b"Rar!", "a RAR archive", UNPACK),
    (b"version https://git-lfs", "a pointer of Git LFS in place of the file", "fetch the file itself: git lfs pull"),
    (b"\x93NUMPY", "a numpy array", IMPORT),
    (b"\x89HDF", "an HDF5 file", "write its values as a MERL binary: docs/import.md has the layout"),
    (b"MATLAB", "a MATLAB file", "write its values as a MERL binary: docs/import.md has the layout"),
    (b"SCATFUN", "a SCATFUN file of a pbrt-v3 Fourier BSDF", "use the material's measurements: Fourier coefficients are not read"),
    (b"\x76\x2f\x31\x01", "an OpenEXR picture", PICTURE),
    (b"#?RADIANCE", "a Radiance picture", PICTURE),
    (b"#?RGBE", "a Radiance picture", PICTURE),
    (b"\x89PNG", "a PNG picture", PICTURE),
    (b"\xff\xd8\xff", "a JPEG picture", PICTURE),
    (b"GIF8", "a GIF picture", PICTURE),
    (b"PF\n", "a PFM picture", PICTURE),
    (b"%PDF", "a PDF document", "name a material"),
    (b"\x7fELF", "a program", "name a material"),
    (b"<", "a page of HTML or XML", "fetch the file itself: the download gave a page in its place"),
];

/// The kind of a file that begins with `start`; `None` if it is none of the known ones.
pub(crate) fn recognise_foreign(start: &[u8]) -> Option<ForeignKind> {
    for &(signature, what, fix) in SIGNATURES {
        if start.starts_with(signature) {
            return Some(ForeignKind { what, fix });
        }
    }
    // A length of eight bytes, then JSON.
    if start.get(8) == Some(&b'{') {
        return Some(ForeignKind {
            what: "a sampler file in place of a material",
            fix: "name the material; `merlkit info FILE` says which, and `sample` draws from the file",
        });
    }
    is_text(start).then_some(ForeignKind {
        what: "a text file",
        fix: "name a MERL binary or a .bsdf file; `merlkit import` makes a MERL binary of a list of measurements",
    })
}

/// Printable ASCII throughout, at least twelve bytes of it.
fn is_text(start: &[u8]) -> bool {
    let printable = |b: &u8| b.is_ascii_graphic() || b.is_ascii_whitespace();
    start.len() >= 12 && start.iter().all(printable)
}
