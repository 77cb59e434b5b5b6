//! Reading what others may change meanwhile, and writing without leaving half a file behind.
//!
//! A mapped file that is cut short by another program ends this one with SIGBUS at the next touch of a page that is gone. A check
//! of the length comes before or after the fault, advisory locks bind nobody, a private or prefaulted map loses its pages all the
//! same, and a handler for the signal belongs to the program, not to a library. So files are read by [`RegularFile`], whose reads
//! end with bytes or an error.
//!
//! MERL binaries, which are large, are mapped where the system itself keeps others away: on Linux a *read lease* (`fcntl`,
//! `F_SETLEASE`) is granted for a file that nobody has open for writing, to its owner. While it is held, whoever opens the file for
//! writing or truncates it waits, or is refused if it asked not to wait. The table is decoded at once, window by window, and the lease
//! given back; nothing stays mapped. Where there is no lease the file is read, and `Loaded::file_access` says why: on other systems,
//! for files of others, for files that are open for writing, and on file systems that others change behind this system's back
//! (network file systems, FUSE, overlays). What is left: the system takes a lease back from a process that keeps somebody waiting for
//! `/proc/sys/fs/lease-break-time`, 45 s if nobody changed it. Decoding takes some milliseconds, so that only a process that is
//! suspended in that very moment, for that long, and whose file is truncated meanwhile, ends by the signal. A disk that fails is
//! noticed without a signal, since each window is read in by `MADV_POPULATE_READ` before it is touched.

mod map;
mod regular;
mod replace;
mod signature;

pub(crate) use map::{Lease, WhyRead};
pub use regular::RegularFile;
pub use replace::{Overwrite, abandon_unfinished, check_writable, write_new};
pub(crate) use signature::{FileClass, SIGNATURE_BYTES, recognise_kind};
pub(crate) use signature::{UTIA_BYTES, is_utia_number, looks_like_utia};
