//! What the header of a picture's file says about it.

use std::io::BufReader;
use std::path::Path;

use super::Image;
use super::exr::read_header_comment;
#[cfg(feature = "png")]
use super::png_input::read_png_comment;
use crate::Result;
use crate::files::RegularFile;

/// Longest text that is taken from a header.
const MOST_BYTES: usize = 1 << 20;

impl Image {
    /// The text that [`Self::with_comment`] left in the header of an OpenEXR or PNG file; `None` if there is none or the file is of
    /// another kind. Pixels are not read. Texts beyond a megabyte, and those that are compressed, are left out.
    ///
    /// # Errors
    /// [`Error::Io`](crate::Error::Io) if the file can't be read; [`Error::Invalid`](crate::Error::Invalid) if its header is damaged.
    pub fn read_comment(path: &Path) -> Result<Option<String>> {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        let file = RegularFile::open(path)?;
        let len = file.len();
        let source = BufReader::new(file);
        let comment = match extension.to_str() {
            Some("exr") => read_header_comment(source, len, path)?,
            #[cfg(feature = "png")]
            Some("png") => read_png_comment(source, path)?,
            _ => None,
        };
        Ok(comment.filter(|text| text.len() <= MOST_BYTES))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::files::Overwrite;
    use crate::image::write_exr;

    #[test]
    fn comments_come_back_and_damage_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let image = Image::new(2, 1, vec![Rgb::ONE; 2]).unwrap();
        let text = "merlkit\ncommand: merlkit render \u{fc}ber";
        let said = image.clone().with_comment(text);
        let exr = folder.path().join("a.exr");
        write_exr(&exr, &said, Overwrite::Refuse).unwrap();
        assert_eq!(Image::read_comment(&exr).unwrap().as_deref(), Some(text));
        write_exr(&exr, &image, Overwrite::Replace).unwrap();
        assert_eq!(Image::read_comment(&exr).unwrap(), None);
        std::fs::write(&exr, b"\x76\x2f\x31\x01cut off").unwrap();
        assert!(Image::read_comment(&exr).is_err());
        #[cfg(feature = "png")]
        {
            let png = folder.path().join("a.png");
            crate::image::write_png(&png, &said, 0.0, Overwrite::Refuse).unwrap();
            assert_eq!(Image::read_comment(&png).unwrap().as_deref(), Some(text));
            std::fs::write(&png, b"\x89PNG\r\n\x1a\n").unwrap();
            assert!(Image::read_comment(&png).is_err());
        }
    }
}
