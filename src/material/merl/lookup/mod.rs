//! From a pair of directions to the cells of a table: which bin holds them, or which neighbours and with which weights.

pub(super) mod batch;
mod bins;
mod compact;
pub(super) mod coordinates;
pub(super) mod half_diff_tan2;
mod rule;
pub(super) mod trilinear;

pub use bins::BinIndex;
pub use rule::LookupRule;
