//! Distributions over intervals and squares, without any notion of light.

mod curves;
mod polyline;

pub use curves::{Curves, Segment};
pub use polyline::simplify;
