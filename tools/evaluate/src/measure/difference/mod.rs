//! How far a picture is from its reference: relative errors of luminance, and the difference that a person would see.

mod errors;
mod flip;
mod flip_color;
mod flip_filters;
mod pictures;

pub use errors::{LIT_FROM, PictureErrors};
pub(crate) use errors::{luminance_errors, mean};
pub use flip::{FlipMap, flip_display, flip_radiance};
pub use pictures::{PictureDifference, Viewing};
