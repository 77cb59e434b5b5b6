//! The format of a picture, which is recognised by its first bytes and not by its name.

use std::path::Path;

use crate::files::{FileClass, recognise_kind};
use crate::{Error, Result};

/// A format that pictures are read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PictureFormat {
    OpenExr,
    Radiance,
    Pfm,
    Png,
}

/// The format of a file that begins with `head`, all of it or [`SIGNATURE_BYTES`]; `path` is for messages.
///
/// # Errors
/// [`Error::Unsupported`] for other formats that are known, by their names; [`Error::Invalid`] for others.
pub(super) fn recognise(head: &[u8], path: &Path) -> Result<PictureFormat> {
    if head.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        return Ok(PictureFormat::OpenExr);
    }
    if head.starts_with(b"#?") {
        return Ok(PictureFormat::Radiance);
    }
    let is_pfm = matches!(head, [b'P', b'F' | b'f', space, ..] if space.is_ascii_whitespace());
    if is_pfm {
        return Ok(PictureFormat::Pfm);
    }
    if head.starts_with(b"\x89PNG\r\n\x1a\n") {
        return Ok(PictureFormat::Png);
    }
    match recognise_kind(head) {
        Some((name, class)) if class != FileClass::Text => Err(Error::Unsupported {
            path: path.to_owned(),
            what: name.into(),
            fix: find_remedy(class, path),
        }),
        _ => Err(unknown(head, path)),
    }
}

/// What to do with a file that is no picture of ours.
fn find_remedy(class: FileClass, path: &Path) -> String {
    let from = path.display();
    match class {
        FileClass::DisplayPicture => format!(
            "convert it: magick {from} {} (neither holds light above 1; an .exr or .hdr of the same place does)",
            path.with_extension("png").display()
        ),
        FileClass::RadiancePicture => format!(
            "convert it: oiiotool {from} -o {}",
            path.with_extension("exr").display()
        ),
        FileClass::Archive(command) => format!("unpack it: {command} {from}"),
        FileClass::Placeholder => "fetch the picture itself: this came in its place".into(),
        FileClass::SamplerFile
        | FileClass::Array
        | FileClass::Container
        | FileClass::FourierBsdf
        | FileClass::Text
        | FileClass::Useless
        | FileClass::Environment => "name an OpenEXR, Radiance, PFM or PNG picture".into(),
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
