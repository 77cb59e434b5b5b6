//! Outputs are written beside their destination under a temporary name and renamed when complete.

use std::io::{BufWriter, Write};
use std::path::Path;

use crate::{Error, Result};

/// What to do when the destination exists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overwrite {
    /// Refuse, naming the file.
    Refuse,
    /// Replace it.
    Replace,
}

/// Writes `path` through `fill`: all of it appears, or nothing does.
///
/// # Errors
/// As [`check_writable`]; [`Error::Io`] if the disk is full, for example;
/// whatever `fill` returns.
pub fn write_new(
    path: &Path,
    overwrite: Overwrite,
    fill: impl FnOnce(&mut dyn WriteSeek) -> Result<()>,
) -> Result<()> {
    check_writable(path, overwrite)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".merlkit-").suffix(".tmp");
    open_to_all(&mut builder);
    let mut temporary = builder
        .tempfile_in(folder_of(path))
        .map_err(|e| Error::io(path, "create a temporary file beside", e))?;
    {
        let mut out = BufWriter::with_capacity(1 << 20, temporary.as_file_mut());
        fill(&mut out)?;
        out.flush().map_err(|e| Error::io(path, "write", e))?;
    }
    match overwrite {
        Overwrite::Replace => temporary.persist(path).map_err(|e| Error::io(path, "rename into", e.error))?,
        Overwrite::Refuse => temporary.persist_noclobber(path).map_err(|e| {
            if e.error.kind() == std::io::ErrorKind::AlreadyExists {
                exists(path)
            } else {
                Error::io(path, "rename into", e.error)
            }
        })?,
    };
    Ok(())
}

/// Refuses early what [`write_new`] would refuse after the work is done: a missing folder, or an existing file.
///
/// # Errors
/// [`Error::Argument`] if `path` is a folder, its folder is missing, or it exists and `overwrite` refuses.
pub fn check_writable(path: &Path, overwrite: Overwrite) -> Result<()> {
    if path.is_dir() {
        return Err(Error::argument(format!("{} is a folder", path.display()), "name a file"));
    }
    if !folder_of(path).is_dir() {
        let what = format!("{}: there is no folder {}", path.display(), folder_of(path).display());
        return Err(Error::argument(what, "make it first, or name another output"));
    }
    if overwrite == Overwrite::Refuse && path.exists() { Err(exists(path)) } else { Ok(()) }
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// A sink that image writers can seek in.
pub trait WriteSeek: Write + std::io::Seek {}
impl<T: Write + std::io::Seek> WriteSeek for T {}

fn exists(path: &Path) -> Error {
    Error::argument(
        format!("{} exists", path.display()),
        "pass --force to replace it, or name another output",
    )
}

/// Readable by all, as an ordinary output is; temporary files are private otherwise.
#[cfg(unix)]
fn open_to_all(builder: &mut tempfile::Builder<'_, '_>) {
    let mode: std::fs::Permissions = std::os::unix::fs::PermissionsExt::from_mode(0o644);
    builder.permissions(mode);
}

#[cfg(not(unix))]
fn open_to_all(_: &mut tempfile::Builder<'_, '_>) {}
