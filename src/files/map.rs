//! Maps of files that nobody can shorten meanwhile. The crate's only `unsafe` lives here; [`super`] says why it is sound.

use super::RegularFile;

/// Why a file is read instead of being mapped, for people.
pub(crate) type WhyRead = &'static str;

/// A promise of the system, while this lives, that nobody writes to or shortens a file.
pub(crate) struct Lease<'a> {
    file: &'a RegularFile,
}

/// A stretch of a file in memory, which can't outlive the lease.
pub(crate) struct MappedWindow<'a> {
    map: memmap2::Mmap,
    _lease: &'a Lease<'a>,
}

impl MappedWindow<'_> {
    /// The bytes of the stretch.
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.map
    }
}

#[cfg(target_os = "linux")]
mod system {
    use std::ffi::{c_int, c_long};
    use std::os::fd::AsRawFd;

    use super::{Lease, MappedWindow, RegularFile, WhyRead};

    /// Of asm-generic/fcntl.h; `libc` has it for some targets alone.
    const F_SETSIG: c_int = 10;

    /// File systems of this machine whose files change through this system's calls alone, which heed leases: ext2 to ext4, XFS,
    /// Btrfs, F2FS and memory.
    const LOCAL: [u32; 5] = [
        0x0000_ef53,
        0x5846_5342,
        0x9123_683e,
        0xf2f5_2010,
        0x0102_1994,
    ];

    impl<'a> Lease<'a> {
        /// Takes the lease, or says why there is none.
        pub(crate) fn take(file: &'a RegularFile) -> Result<Self, WhyRead> {
            if !is_local(file) {
                return Err("its file system gives no lease");
            }
            // A writer's arrival is told by a signal. That of the system's choice would end a process that doesn't expect it; this
            // one is ignored unless somebody waits for it.
            if command(file, F_SETSIG, libc::SIGURG) < 0 {
                return Err("the system gives no lease");
            }
            if command(file, libc::F_SETLEASE, libc::F_RDLCK) < 0 {
                return Err(match std::io::Error::last_os_error().raw_os_error() {
                    Some(libc::EAGAIN) => "another program has it open for writing",
                    Some(libc::EACCES | libc::EPERM) => "it belongs to another user",
                    _ => "the system gives no lease",
                });
            }
            let lease = Self { file };
            // What happened before the lease is seen now, and nothing happens after it.
            let same_length = file
                .file()
                .metadata()
                .is_ok_and(|metadata| metadata.len() == file.len());
            if same_length {
                Ok(lease)
            } else {
                Err("its length was changed meanwhile")
            }
        }

        /// Whether nobody has asked for the file since the lease was taken. The system lets those who ask wait, but not for
        /// ever.
        pub(crate) fn is_held(&self) -> bool {
            command(self.file, libc::F_GETLEASE, 0) == libc::F_RDLCK
        }

        /// Maps `len` > 0 bytes from `offset` on and reads them in.
        #[allow(unsafe_code)]
        pub(crate) fn map(&self, offset: u64, len: usize) -> Result<MappedWindow<'_>, WhyRead> {
            let end = offset.checked_add(len as u64);
            if len == 0 || end.is_none_or(|end| end > self.file.len()) {
                return Err("it is too short");
            }
            // SAFETY: the stretch lies within the file. While the lease is held, nobody can open the file for writing or shorten it,
            // and nobody has it open for writing or mapped as shared and writable. The map does not outlive the lease.
            let map = unsafe {
                memmap2::MmapOptions::new()
                    .offset(offset)
                    .len(len)
                    .map(self.file.file())
            };
            let map = map.map_err(|_| "the system doesn't map it")?;
            // A disk that fails is an error here, where it would be a signal at the first touch.
            map.advise(memmap2::Advice::PopulateRead)
                .map_err(|_| "the system doesn't read a map in beforehand")?;
            Ok(MappedWindow { map, _lease: self })
        }
    }

    impl Drop for Lease<'_> {
        fn drop(&mut self) {
            // Nobody holds it then, whether that succeeds or the system took it back before.
            command(self.file, libc::F_SETLEASE, libc::F_UNLCK);
        }
    }

    #[allow(unsafe_code)]
    fn command(file: &RegularFile, command: c_int, argument: c_int) -> c_int {
        // SAFETY: the descriptor is open as long as `file` lives; these commands take an integer and touch no memory.
        unsafe { libc::fcntl(file.file().as_raw_fd(), command, c_long::from(argument)) }
    }

    #[allow(unsafe_code)]
    fn is_local(file: &RegularFile) -> bool {
        let mut facts = std::mem::MaybeUninit::<libc::statfs>::uninit();
        // SAFETY: the descriptor is open, and the memory is as large as what is written there.
        let status = unsafe { libc::fstatfs(file.file().as_raw_fd(), facts.as_mut_ptr()) };
        if status != 0 {
            return false;
        }
        // SAFETY: the call that succeeded has written all of it.
        let facts = unsafe { facts.assume_init() };
        // The type's width differs between architectures; magic numbers have 32 bits.
        LOCAL.contains(&(facts.f_type as u32))
    }
}

#[cfg(not(target_os = "linux"))]
impl<'a> Lease<'a> {
    /// Elsewhere nothing keeps others from shortening a file.
    pub(crate) fn take(_: &'a RegularFile) -> Result<Self, WhyRead> {
        Err("only Linux gives leases")
    }

    /// See the other.
    pub(crate) fn is_held(&self) -> bool {
        let _ = self.file;
        false
    }

    /// See the other.
    pub(crate) fn map(&self, _: u64, _: usize) -> Result<MappedWindow<'_>, WhyRead> {
        Err("only Linux gives leases")
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::fs::{File, OpenOptions, metadata, write};
    use std::io::Write;
    use std::path::Path;
    use std::process::Command;
    use std::time::{Duration, Instant};

    use super::*;

    const LEN: usize = 1 << 20;

    fn file(path: &Path) -> RegularFile {
        write(path, vec![7; LEN]).unwrap();
        RegularFile::open(path).unwrap()
    }

    /// Runs `check` on a file in the folder for temporary files. Where the system gives no lease there, says so and skips it.
    fn with_leased_file(check: impl FnOnce(&Path, &RegularFile)) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let file = file(&path);
        match Lease::take(&file) {
            Ok(lease) => drop(lease),
            Err(why) => {
                // Not by a macro, whose output the test harness would keep to itself.
                let note = format!("skipped: no lease in {}: {why}\n", folder.path().display());
                std::io::stderr().write_all(note.as_bytes()).unwrap();
                return;
            }
        }
        check(&path, &file);
    }

    #[test]
    fn a_program_that_truncates_waits_for_the_lease() {
        with_leased_file(|path, file| {
            let lease = Lease::take(file).unwrap();
            let window = lease.map(5, LEN - 5).unwrap();
            assert!(lease.is_held());
            let mut child = Command::new("sh")
                .args(["-c", ": > \"$0\""])
                .arg(path)
                .spawn()
                .unwrap();
            let start = Instant::now();
            while lease.is_held() {
                assert!(start.elapsed() < Duration::from_secs(20), "nobody came");
                std::thread::sleep(Duration::from_millis(5));
            }
            std::thread::sleep(Duration::from_millis(50));
            // The signal that a writer has come has ended nothing, and all bytes are there.
            assert!(child.try_wait().unwrap().is_none());
            assert_eq!(metadata(path).unwrap().len(), LEN as u64);
            assert!(window.bytes().iter().all(|b| *b == 7));
            drop(window);
            drop(lease);
            assert!(child.wait().unwrap().success());
            assert_eq!(metadata(path).unwrap().len(), 0);
            assert_eq!(
                Lease::take(file).err(),
                Some("its length was changed meanwhile")
            );
        });
    }

    #[test]
    fn there_is_no_lease_on_what_may_change() {
        with_leased_file(|path, file| {
            let writer = OpenOptions::new().write(true).open(path).unwrap();
            let why = Lease::take(file).err();
            assert_eq!(why, Some("another program has it open for writing"));
            drop(writer);
            assert!(Lease::take(file).is_ok());
            // Not local.
            let status = RegularFile::open(Path::new("/proc/self/status")).unwrap();
            let why = Lease::take(&status).err();
            assert_eq!(why, Some("its file system gives no lease"));
        });
    }

    #[test]
    fn windows_lie_within_the_file() {
        with_leased_file(|path, file| {
            let lease = Lease::take(file).unwrap();
            assert_eq!(lease.map(LEN as u64 - 1, 1).unwrap().bytes(), [7]);
            for (offset, len) in [(0, 0), (0, LEN + 1), (LEN as u64, 1), (u64::MAX, 1)] {
                assert!(lease.map(offset, len).is_err());
            }
            drop(File::open(path));
            assert!(lease.is_held());
        });
    }
}
