//! Distributions over an interval and a square, each with `sample`, `pdf` and `invert`.
//!
//! What their axes mean (pixels of an environment, angles of a half vector) is their user's business.

mod piecewise;

pub use piecewise::Piecewise2d;
