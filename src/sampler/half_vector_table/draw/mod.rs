//! Draws and densities: from a pair of neighbouring tables, or from a mixture of the two; one at a time, or in lanes.

pub(super) mod batch;
pub(super) mod pair;
mod pair_lanes;
pub(super) mod point_lanes;
pub(super) mod sample;
