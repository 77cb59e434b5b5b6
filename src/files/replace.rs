//! Outputs are written to the folder of their destination under a temporary name, and renamed when they are complete.

use std::collections::BTreeSet;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::NamedTempFile;

use crate::{Error, Result};

/// What to do when the destination exists.
///
/// See [`write_new`](crate::files::write_new) for an example.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overwrite {
    /// Refuse, naming the file.
    Refuse,
    /// Replace it.
    Replace,
}

/// Writes `path` through `fill`: all of it appears, or nothing does.
///
/// # Examples
/// ```
/// use merlkit::files::{Overwrite, check_writable, write_new};
///
/// let path = std::env::temp_dir().join(format!("merlkit-example-{}.txt", std::process::id()));
/// check_writable(&path, Overwrite::Refuse)?;
/// write_new(&path, Overwrite::Refuse, |out| {
///     out.write_all(b"complete").map_err(|e| merlkit::Error::io(&path, "write", e))
/// })?;
///
/// // It exists now, so that it is replaced only on request.
/// assert!(check_writable(&path, Overwrite::Refuse).is_err());
/// # std::fs::remove_file(&path).map_err(|e| merlkit::Error::io(&path, "remove", e))?;
/// # Ok::<(), merlkit::Error>(())
/// ```
///
/// # Errors
/// As [`check_writable`]; [`Error::Io`] if the disk is full, for example;
/// and the error of `fill`.
pub fn write_new(
    path: &Path,
    overwrite: Overwrite,
    fill: impl FnOnce(&mut dyn WriteSeek) -> Result<()>,
) -> Result<()> {
    check_destination(path, overwrite)?;
    let mut unfinished = Unfinished::create(path)?;
    match unfinished.fill(path, fill) {
        Ok(()) => unfinished.rename(path, overwrite),
        Err(error) => {
            unfinished.discard();
            Err(error)
        }
    }
}

/// Temporary files that are being written now.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn unfinished() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary files of every [`write_new`] that has not finished. None begins or finishes any more: they wait for
/// ever, so that this is for a program that is about to end, on Ctrl-C for example.
///
/// See [`write_new`](crate::files::write_new) for an example.
pub fn abandon_unfinished() {
    let files = unfinished();
    for path in files.iter() {
        // The program is about to end: nobody could act on an error.
        let _ = std::fs::remove_file(path);
    }
    std::mem::forget(files);
}

/// A temporary file in the folder of its destination, which is removed unless it is renamed.
struct Unfinished {
    file: NamedTempFile,
    name: PathBuf,
}

impl Unfinished {
    fn create(path: &Path) -> Result<Self> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".merlkit-").suffix(".tmp");
        open_to_all(&mut builder);
        let mut files = unfinished();
        let file = builder
            .tempfile_in(folder_of(path))
            // The system's answer by its kind alone: the temporary name in it means nothing to a user.
            .map_err(|e| Error::io(folder_of(path), "write into this folder", e.kind().into()))?;
        let name = file.path().to_owned();
        files.insert(name.clone());
        drop(files);
        Ok(Self { file, name })
    }

    fn fill(
        &mut self,
        path: &Path,
        fill: impl FnOnce(&mut dyn WriteSeek) -> Result<()>,
    ) -> Result<()> {
        let mut out = BufWriter::with_capacity(1 << 20, self.file.as_file_mut());
        fill(&mut out)?;
        out.flush().map_err(|e| Error::io(path, "write", e))
    }

    fn discard(self) {
        let mut files = unfinished();
        files.remove(&self.name);
        drop(self.file);
    }

    fn rename(self, path: &Path, overwrite: Overwrite) -> Result<()> {
        let mut files = unfinished();
        files.remove(&self.name);
        let renamed = match overwrite {
            Overwrite::Replace => self.file.persist(path),
            Overwrite::Refuse => self.file.persist_noclobber(path),
        };
        renamed.map(drop).map_err(|e| match e.error.kind() {
            std::io::ErrorKind::AlreadyExists => exists(path),
            _ => Error::io(path, "rename into", e.error),
        })
    }
}

/// Refuses early what [`write_new`] would refuse after the work is done: a missing folder, one without permission to write, or
/// an existing file. A temporary file is made and removed, since nothing else shows what the system permits.
///
/// See [`write_new`](crate::files::write_new) for an example.
///
/// # Errors
/// [`Error::Argument`] if `path` is a folder, pipe or device, its folder is missing, or it exists and `overwrite` refuses;
/// [`Error::Io`] if no file can be made in its folder.
pub fn check_writable(path: &Path, overwrite: Overwrite) -> Result<()> {
    check_destination(path, overwrite)?;
    Unfinished::create(path)?.discard();
    Ok(())
}

/// Refuses what is no place for a file, without touching it.
fn check_destination(path: &Path, overwrite: Overwrite) -> Result<()> {
    if path.is_dir() {
        return Err(Error::argument(
            format!("{} is a folder", path.display()),
            "name a file",
        ));
    }
    if path.metadata().is_ok_and(|m| !m.is_file()) {
        // It would be replaced by a file.
        let what = format!("{} is a pipe or device", path.display());
        return Err(Error::argument(what, "name a file"));
    }
    if !folder_of(path).is_dir() {
        let what = format!(
            "{}: there is no folder {}",
            path.display(),
            folder_of(path).display()
        );
        return Err(Error::argument(
            what,
            "make it first, or name another output",
        ));
    }
    if overwrite == Overwrite::Refuse && path.exists() {
        Err(exists(path))
    } else {
        Ok(())
    }
}

fn folder_of(path: &Path) -> &Path {
    path.parent()
        .filter(|p| !p.as_os_str().is_empty())
        .unwrap_or(Path::new("."))
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
