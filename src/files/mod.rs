//! Reading what others may change meanwhile, and writing without leaving half a file behind.
//!
//! A mapped file that is cut short by another program ends this one with SIGBUS at the next touch of a page that is gone.
//! Nothing prevents that: a check of the length comes before or after the fault, locks are advisory, a private or
//! prefaulted map loses its pages all the same, and a handler for the signal belongs to the program, not to a library. So
//! everything is read by [`RegularFile`], whose reads end with bytes or an error. [`Mapped`] is for callers who own their
//! files, and is asked for by name ([`crate::material::merl::load_mapped`]).

mod map;
mod regular;
mod replace;
mod signature;

pub use map::Mapped;
pub use regular::RegularFile;
pub use replace::{Overwrite, abandon_unfinished, check_writable, write_new};
pub(crate) use signature::{FileClass, SIGNATURE_BYTES, recognise_kind};
pub(crate) use signature::{UTIA_BYTES, is_utia_number, looks_like_utia};
