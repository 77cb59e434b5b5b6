//! Pictures of any format that is read.

use std::io::{Read, Seek};
use std::path::Path;

use super::exr::{decode_exr, decode_exr_file};
use super::format::{PictureFormat, recognise};
use super::pfm::decode_pfm;
#[cfg(feature = "png")]
use super::png_input::decode_png;
use super::radiance::decode_radiance;
use super::{Image, MAX_PIXELS};
use crate::files::{RegularFile, SIGNATURE_BYTES};

use crate::{Error, Result};

/// The largest file that is read whole: three values of 32 bits per pixel, and a header.
const MAX_BYTES: u64 = 12 * MAX_PIXELS as u64 + (1 << 20);

/// A picture, and what its file says about it.
pub(crate) struct PictureFile {
    pub(crate) image: Image,
    pub(crate) format: PictureFormat,
    /// By what the file's values were divided, as its header asks.
    pub(crate) exposure: f64,
}

/// Reads an OpenEXR, Radiance (.hdr), PFM or PNG picture, which is recognised by its first bytes. Values are linear and as the
/// file has them: they may be negative, infinite or NaN. An alpha channel of OpenEXR is left out.
///
/// See [`Image`](crate::image::Image) for an example of what is returned.
///
/// # Errors
/// [`Error::Io`] if the file can't be read; [`Error::Invalid`] if it is damaged or of no format that is known;
/// [`Error::Unsupported`] for other formats, by their names, for more than [`MAX_PIXELS`] pixels, and for kinds of a format
/// that are not read.
pub fn read_image(path: &Path) -> Result<Image> {
    Ok(read_picture(path)?.image)
}

/// [`read_image`] from a file's bytes; `path` is for messages.
///
/// See [`Image`](crate::image::Image) for an example of what is returned.
///
/// # Errors
/// As [`read_image`].
pub fn decode_image(bytes: &[u8], path: &Path) -> Result<Image> {
    let format = recognise(&bytes[..bytes.len().min(SIGNATURE_BYTES)], path)?;
    Ok(decode_picture(format, bytes, path)?.image)
}

/// [`read_image`] with what the file says about the picture.
pub(crate) fn read_picture(path: &Path) -> Result<PictureFile> {
    let mut file = RegularFile::open(path)?;
    let mut head = Vec::new();
    file.by_ref()
        .take(SIGNATURE_BYTES as u64)
        .read_to_end(&mut head)
        .map_err(|e| Error::io(path, "read", e))?;
    let format = recognise(&head, path)?;
    if format == PictureFormat::OpenExr {
        file.rewind().map_err(|e| Error::io(path, "read", e))?;
        return Ok(PictureFile::new(decode_exr_file(file)?, format));
    }
    decode_picture(format, &file.read_all(MAX_BYTES)?, path)
}

fn decode_picture(format: PictureFormat, bytes: &[u8], path: &Path) -> Result<PictureFile> {
    let image = match format {
        PictureFormat::OpenExr => decode_exr(bytes, path)?,
        PictureFormat::Pfm => decode_pfm(bytes, path)?,
        PictureFormat::Png => decode_png(bytes, path)?,
        PictureFormat::Radiance => {
            let (image, exposure) = decode_radiance(bytes, path)?;
            return Ok(PictureFile {
                image,
                format,
                exposure,
            });
        }
    };
    Ok(PictureFile::new(image, format))
}

/// Stands in for the decoder where PNG is left out.
#[cfg(not(feature = "png"))]
fn decode_png(_: &[u8], path: &Path) -> Result<Image> {
    Err(Error::Unsupported {
        path: path.to_owned(),
        what: "a PNG, in this build of the library,".into(),
        fix: "build it with the feature `png`, or convert the picture to OpenEXR".into(),
    })
}

impl PictureFile {
    fn new(image: Image, format: PictureFormat) -> Self {
        Self {
            image,
            format,
            exposure: 1.0,
        }
    }
}
