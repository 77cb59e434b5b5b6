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
/// [`Error::Argument`] if `path` exists and `overwrite` refuses; [`Error::Io`] if its folder is missing or the disk is full;
/// whatever `fill` returns.
pub fn write_new(
    path: &Path,
    overwrite: Overwrite,
    fill: impl FnOnce(&mut dyn WriteSeek) -> Result<()>,
) -> Result<()> {
    check_writable(path, overwrite)?;
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".merlkit-").suffix(".tmp");
    open_to_all(&mut builder);
    let mut temporary =
        builder.tempfile_in(folder).map_err(|e| Error::io(path, "create a temporary file beside", e))?;
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

/// Refuses early what [`write_new`] would refuse after the work is done: an existing file.
///
/// # Errors
/// [`Error::Argument`] if `path` exists and `overwrite` refuses.
pub fn check_writable(path: &Path, overwrite: Overwrite) -> Result<()> {
    if overwrite == Overwrite::Refuse && path.exists() { Err(exists(path)) } else { Ok(()) }
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
