//! Files that the page sends. They are kept in a folder of their own under names of our own until the session ends.

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use merlkit::Error;
use merlkit::material::Material;
use merlkit::material::merl::Header;
use tempfile::TempDir;

use crate::refusal::Refusal;

/// Longer files are refused.
pub(crate) const LARGEST_UPLOAD: usize = 64_000_000;
/// More files are not kept.
const MOST_UPLOADS: usize = 16;
/// The first bytes of a `.bsdf` file.
const BSDF_MAGIC: &[u8] = b"tensor_file\0";
/// Longer names are cut.
const LONGEST_NAME: usize = 60;

/// The folder, once there is a file, and how many it holds.
#[derive(Default)]
pub(crate) struct Uploads(Mutex<Option<(TempDir, usize)>>);

impl Uploads {
    /// Stores the bytes of a MERL binary or a `.bsdf` file, and resolves them as a material. The file's name is a number.
    pub fn store(&self, bytes: &[u8]) -> Result<Material, Refusal> {
        let extension = recognise(bytes)?;
        let path = self.write(bytes, extension)?;
        let argument = path.to_str().ok_or_else(|| {
            Refusal::new(500, "the folder for temporary files has no name in UTF-8")
        })?;
        Ok(Material::resolve(argument)?)
    }

    /// Removes the folder with all files.
    pub fn remove(&self) {
        let mut folder = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        *folder = None;
    }

    fn write(&self, bytes: &[u8], extension: &str) -> Result<PathBuf, Refusal> {
        let mut folder = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if folder.is_none() {
            *folder = Some((TempDir::new().map_err(cannot_keep)?, 0));
        }
        let Some((folder, count)) = folder.as_mut() else {
            return Err(Refusal::new(500, "there is no folder for files"));
        };
        if *count >= MOST_UPLOADS {
            let message = format!("there are {MOST_UPLOADS} files already; start again");
            return Err(Refusal::new(503, message));
        }
        *count += 1;
        let path = folder.path().join(format!("upload-{count}.{extension}"));
        std::fs::write(&path, bytes).map_err(cannot_keep)?;
        Ok(path)
    }
}

/// The extension of a file by its first bytes; what is neither a MERL binary nor a `.bsdf` file is refused.
fn recognise(bytes: &[u8]) -> Result<&'static str, Refusal> {
    if bytes.starts_with(BSDF_MAGIC) {
        return Ok("bsdf");
    }
    let name = PathBuf::from("the file");
    Header::parse(bytes, bytes.len() as u64, &name).map_err(describe)?;
    Ok("binary")
}

fn describe(error: Error) -> Refusal {
    Refusal::bad(error.to_string())
}

fn cannot_keep(error: std::io::Error) -> Refusal {
    Refusal::new(500, format!("the file can't be kept: {error}"))
}

/// What a file is called for people: its name without folders and extension, and letters, digits, `-`, `_`, `.` and blanks alone.
pub(crate) fn display_name(name: &str) -> String {
    let base = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let stem = base.rsplit_once('.').map_or(base, |(stem, _)| stem);
    let mut shown = String::new();
    for c in stem.chars().take(LONGEST_NAME) {
        let is_plain = c.is_alphanumeric() || "-_. ".contains(c);
        shown.push(if is_plain { c } else { '-' });
    }
    match shown.trim() {
        "" => "upload".into(),
        trimmed => trimmed.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lose_their_folders_and_signs() {
        assert_eq!(display_name("chrome.binary"), "chrome");
        assert_eq!(display_name("../../etc/passwd"), "passwd");
        assert_eq!(display_name("C:\\a\\<b>.bsdf"), "-b-");
        assert_eq!(display_name("..."), "..");
        assert_eq!(display_name(""), "upload");
    }

    #[test]
    fn other_files_are_refused() {
        for bytes in [&b""[..], b"{\"kind\": \"fit\"}", b"\x7fELF........"] {
            assert_eq!(Uploads::default().store(bytes).unwrap_err().status, 400);
        }
    }
}
