//! Which format a picture has: its first bytes say it, whatever its name is.

use std::path::Path;

use crate::{Error, Result};

/// A format that pictures are read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PictureFormat {
    OpenExr,
    Radiance,
    Pfm,
    Png,
}

/// First bytes that are enough to recognise every format below.
pub(super) const HEAD: usize = 64;

/// What mends a file that is no picture of ours.
enum Remedy {
    /// Eight bits a channel, no light above 1: PNG holds all of it.
    ToPng,
    /// The format may hold radiance, which only OpenEXR keeps.
    ToExr,
    /// A command that unpacks it.
    Unpack(&'static str),
    /// It stands in for the file that was wanted.
    Fetch,
}

/// A format that is not read: where its mark begins, the mark, its name, and what to do.
type Stranger = (usize, &'static [u8], &'static str, Remedy);

const STRANGERS: [Stranger; 24] = [
    (0, b"\xff\xd8\xff", "a JPEG picture", Remedy::ToPng),
    (0, b"GIF8", "a GIF picture", Remedy::ToPng),
    (0, b"BM", "a BMP picture", Remedy::ToPng),
    (8, b"WEBP", "a WebP picture", Remedy::ToPng),
    (4, b"ftypavif", "an AVIF picture", Remedy::ToPng),
    (4, b"ftyphei", "a HEIF picture", Remedy::ToPng),
    (0, b"P2\n", "a PGM picture", Remedy::ToPng),
    (0, b"P3\n", "a PPM picture", Remedy::ToPng),
    (0, b"P5\n", "a PGM picture", Remedy::ToPng),
    (0, b"P6\n", "a PPM picture", Remedy::ToPng),
    (0, b"II*\0", "a TIFF picture", Remedy::ToExr),
    (0, b"MM\0*", "a TIFF picture", Remedy::ToExr),
    (0, b"\xff\x0a", "a JPEG XL picture", Remedy::ToExr),
    (4, b"JXL \r\n", "a JPEG XL picture", Remedy::ToExr),
    (0, b"8BPS", "a Photoshop document", Remedy::ToExr),
    (0, b"DDS ", "a DDS texture", Remedy::ToExr),
    (0, b"\xabKTX ", "a KTX texture", Remedy::ToExr),
    (0, b"PK\x03\x04", "a zip archive", Remedy::Unpack("unzip")),
    (0, b"\x1f\x8b", "a gzip file", Remedy::Unpack("gunzip")),
    (
        0,
        b"\x28\xb5\x2f\xfd",
        "a zstd file",
        Remedy::Unpack("unzstd"),
    ),
    (0, b"\xfd7zXZ", "an xz file", Remedy::Unpack("unxz")),
    (0, b"<", "a web page or XML text", Remedy::Fetch),
    (
        0,
        b"version https://git-lfs",
        "a pointer of Git LFS",
        Remedy::Fetch,
    ),
    (0, b"%PDF", "a PDF document", Remedy::Fetch),
];

/// The format of a file that begins with `head`, all of it or [`HEAD`] bytes; `path` is for messages.
///
/// # Errors
/// [`Error::Unsupported`] for other formats that are known, by their names; [`Error::Invalid`] for others.
pub(super) fn recognise(head: &[u8], path: &Path) -> Result<PictureFormat> {
    let space = |i: usize| head.get(i).is_some_and(u8::is_ascii_whitespace);
    if head.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        return Ok(PictureFormat::OpenExr);
    }
    if head.starts_with(b"#?") {
        return Ok(PictureFormat::Radiance);
    }
    if (head.starts_with(b"PF") || head.starts_with(b"Pf")) && space(2) {
        return Ok(PictureFormat::Pfm);
    }
    if head.starts_with(b"\x89PNG\r\n\x1a\n") {
        return Ok(PictureFormat::Png);
    }
    for (offset, mark, name, remedy) in &STRANGERS {
        if head.get(*offset..).is_some_and(|at| at.starts_with(mark)) {
            return Err(Error::Unsupported {
                path: path.to_owned(),
                what: (*name).into(),
                fix: describe(remedy, path),
            });
        }
    }
    Err(unknown(head, path))
}

fn describe(remedy: &Remedy, path: &Path) -> String {
    let from = path.display();
    match remedy {
        Remedy::ToPng => format!(
            "convert it: magick {from} {} (neither holds light above 1; an .exr or .hdr of the same place does)",
            path.with_extension("png").display()
        ),
        Remedy::ToExr => format!(
            "convert it: oiiotool {from} -o {}",
            path.with_extension("exr").display()
        ),
        Remedy::Unpack(command) => format!("unpack it: {command} {from}"),
        Remedy::Fetch => "fetch the picture itself: this came in its place".into(),
    }
}

fn unknown(head: &[u8], path: &Path) -> Error {
    let expected = "an OpenEXR, Radiance (.hdr), PFM or PNG picture";
    if head.is_empty() {
        return Error::invalid(path, 0, expected, "an empty file", "fetch the file again");
    }
    let mut bytes = String::new();
    for byte in head.iter().take(8) {
        bytes.push_str(&format!(" {byte:02x}"));
    }
    Error::invalid(
        path,
        0,
        expected,
        format!("the bytes{bytes}, with which none of them begins"),
        "name a picture of one of these formats, or convert it to OpenEXR",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(head: &[u8]) -> String {
        recognise(head, Path::new("a/sky.jpg"))
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn formats_are_recognised_by_their_first_bytes() {
        let format = |head: &[u8]| recognise(head, Path::new("sky.jpg")).unwrap();
        assert_eq!(format(b"\x76\x2f\x31\x01\x02"), PictureFormat::OpenExr);
        assert_eq!(format(b"#?RADIANCE\n"), PictureFormat::Radiance);
        assert_eq!(format(b"#?RGBE\n"), PictureFormat::Radiance);
        assert_eq!(format(b"PF\n1 1\n"), PictureFormat::Pfm);
        assert_eq!(format(b"Pf 1 1"), PictureFormat::Pfm);
        assert_eq!(format(b"\x89PNG\r\n\x1a\n"), PictureFormat::Png);
    }

    #[test]
    fn strangers_are_named_with_what_mends_them() {
        for (head, name, remedy) in [
            (
                &b"\xff\xd8\xff\xe0"[..],
                "a JPEG",
                "magick a/sky.jpg a/sky.png",
            ),
            (b"II*\0\x08", "a TIFF", "oiiotool a/sky.jpg -o a/sky.exr"),
            (b"RIFF\0\0\0\0WEBPVP8 ", "a WebP", "magick"),
            (b"\x1f\x8b\x08", "a gzip file", "gunzip a/sky.jpg"),
            (b"<!DOCTYPE html>", "a web page", "fetch"),
            (b"version https://git-lfs.github.com", "Git LFS", "fetch"),
        ] {
            let text = message(head);
            assert!(text.starts_with("a/sky.jpg: "), "{text}");
            assert!(text.contains(name) && text.contains(remedy), "{text}");
        }
        assert!(message(b"").contains("an empty file"));
        assert!(message(b"PFx").contains("50 46 78, with which none"));
    }
}
