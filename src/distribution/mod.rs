//! Distributions over an interval or a square, the curves they are inverted by, and how several are combined.
//!
//! What their axes mean (pixels of an environment, angles of a half vector) is their user's business.

mod combine;
mod curves;
mod integer_cdfs;
mod piecewise;
mod polyline;

pub use combine::{Heuristic, Kept, Reservoir};
pub use curves::{Curves, Segment, WHOLE, cumulated};
pub(crate) use integer_cdfs::{CellPlace, IntegerCdfs, LeafSearch};
pub use piecewise::Piecewise2d;
pub use polyline::simplify;
