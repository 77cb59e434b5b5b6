//! Distributions over an interval or a square, and the curves they are inverted by.
//!
//! What their axes mean (pixels of an environment, angles of a half vector) is their user's business.

mod curves;
mod piecewise;
mod polyline;

pub use curves::{Curves, Segment, WHOLE};
pub use piecewise::Piecewise2d;
pub use polyline::simplify;
