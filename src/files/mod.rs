//! Reading by mapping and writing without leaving half a file behind.

mod map;
mod replace;

pub use map::Mapped;
pub use replace::{Overwrite, check_writable, write_new};
