//! What a file is, by its first bytes: for messages about files that are something else than what was expected.

/// First bytes that are enough to recognise every kind below.
pub(crate) const SIGNATURE_BYTES: usize = 64;

/// What a kind of file is for, from which each reader knows what to do about one that it doesn't read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FileClass {
    /// A picture that environments are read from.
    Environment,
    /// A picture of eight bits a channel, which holds no light above 1.
    DisplayPicture,
    /// A picture that may hold radiance, and is not read.
    RadiancePicture,
    /// Unpacked by this command.
    Archive(&'static str),
    /// It came in place of the file that was wanted.
    Placeholder,
    /// An array of numpy.
    Array,
    /// Numbers in a container that is not read.
    Container,
    /// Fourier coefficients of a BSDF (pbrt-v3).
    FourierBsdf,
    /// A sampler file: a length of eight bytes, then JSON.
    SamplerFile,
    /// Text of another kind.
    Text,
    /// Nothing that a reader here could want.
    Useless,
}

/// A kind of file: its name, as "a zip archive", and its class.
pub(crate) type FileKind = (&'static str, FileClass);

/// Where a mark begins, the mark, and what it means.
#[rustfmt::skip]
const SIGNATURES: &[(usize, &[u8], FileKind)] = &[
    (0, b"\x76\x2f\x31\x01", ("an OpenEXR picture", FileClass::Environment)),
    (0, b"#?", ("a Radiance picture", FileClass::Environment)),
    (0, b"PF\n", ("a PFM picture", FileClass::Environment)),
    (0, b"Pf\n", ("a PFM picture", FileClass::Environment)),
    (0, b"\x89PNG\r\n\x1a\n", ("a PNG picture", FileClass::Environment)),
    (0, b"\xff\xd8\xff", ("a JPEG picture", FileClass::DisplayPicture)),
    (0, b"GIF8", ("a GIF picture", FileClass::DisplayPicture)),
    (0, b"BM", ("a BMP picture", FileClass::DisplayPicture)),
    (8, b"WEBP", ("a WebP picture", FileClass::DisplayPicture)),
    (4, b"ftypavif", ("an AVIF picture", FileClass::DisplayPicture)),
    (4, b"ftyphei", ("a HEIF picture", FileClass::DisplayPicture)),
    (0, b"P2\n", ("a PGM picture", FileClass::DisplayPicture)),
    (0, b"P3\n", ("a PPM picture", FileClass::DisplayPicture)),
    (0, b"P5\n", ("a PGM picture", FileClass::DisplayPicture)),
    (0, b"P6\n", ("a PPM picture", FileClass::DisplayPicture)),
    (0, b"II*\0", ("a TIFF picture", FileClass::RadiancePicture)),
    (0, b"MM\0*", ("a TIFF picture", FileClass::RadiancePicture)),
    (0, b"\xff\x0a", ("a JPEG XL picture", FileClass::RadiancePicture)),
    (4, b"JXL \r\n", ("a JPEG XL picture", FileClass::RadiancePicture)),
    (0, b"8BPS", ("a Photoshop document", FileClass::RadiancePicture)),
    (0, b"DDS ", ("a DDS texture", FileClass::RadiancePicture)),
    (0, b"\xabKTX ", ("a KTX texture", FileClass::RadiancePicture)),
    (0, b"PK\x03\x04", ("a zip archive", FileClass::Archive("unzip"))),
    (0, b"\x1f\x8b", ("a gzip file", FileClass::Archive("gunzip"))),
    (0, b"BZh", ("a bzip2 file", FileClass::Archive("bunzip2"))),
    (0, b"\xfd7zXZ", ("an xz file", FileClass::Archive("unxz"))),
    (0, b"\x28\xb5\x2f\xfd", ("a zstd file", FileClass::Archive("unzstd"))),
    (0, b"7z\xbc\xaf\x27\x1c", ("a 7-zip archive", FileClass::Archive("7z x"))),
    (0, b"Rar!", ("a RAR archive", FileClass::Archive("unrar x"))),
    (0, b"<", ("a web page or XML text", FileClass::Placeholder)),
    (0, b"version https://git-lfs", ("a pointer of Git LFS", FileClass::Placeholder)),
    (0, b"\x93NUMPY", ("a numpy array", FileClass::Array)),
    (0, b"\x89HDF", ("an HDF5 file", FileClass::Container)),
    (0, b"MATLAB", ("a MATLAB file", FileClass::Container)),
    (0, b"SCATFUN", ("a SCATFUN file of a pbrt-v3 Fourier BSDF", FileClass::FourierBsdf)),
    (0, b"%PDF", ("a PDF document", FileClass::Useless)),
    (0, b"\x7fELF", ("a program", FileClass::Useless)),
    (8, b"{", ("a sampler file", FileClass::SamplerFile)),
];

/// The kind of a file that begins with `start`, all of it or [`SIGNATURE_BYTES`]; `None` if it is none of the known ones.
pub(crate) fn recognise_kind(start: &[u8]) -> Option<FileKind> {
    for &(offset, mark, kind) in SIGNATURES {
        if start.get(offset..).is_some_and(|at| at.starts_with(mark)) {
            return Some(kind);
        }
    }
    is_text(start).then_some(("a text file", FileClass::Text))
}

/// Bytes of a file of the UTIA BRDF database: three planes of 288 × 288 doubles, without a header.
pub(crate) const UTIA_BYTES: u64 = 3 * 288 * 288 * 8;

/// Whether a number could be a reflectance of the UTIA database: bytes of other files, read as doubles, are mostly far from 1.
pub(crate) fn is_utia_number(value: f64) -> bool {
    value == 0.0 || (1e-30..=1e6).contains(&value.abs())
}

/// Whether a file of `length` bytes that begins with `start` could be one of the UTIA database.
pub(crate) fn looks_like_utia(start: &[u8], length: u64) -> bool {
    if length != UTIA_BYTES {
        return false;
    }
    for bytes in start.as_chunks::<8>().0 {
        if !is_utia_number(f64::from_le_bytes(*bytes)) {
            return false;
        }
    }
    true
}

/// Printable ASCII throughout, at least twelve bytes of it.
fn is_text(start: &[u8]) -> bool {
    start.len() >= 12 && start.iter().all(is_printable)
}

fn is_printable(byte: &u8) -> bool {
    byte.is_ascii_graphic() || byte.is_ascii_whitespace()
}
