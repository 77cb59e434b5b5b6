//! The trees of all knots, of either kind.

use super::tree::Forest;
use super::warp::Warps;

/// The trees of all knots.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Trees {
    /// Whose draws are accepted under bounds.
    Rejecting(Forest),
    /// Whose draws all count.
    Warped(Warps),
}

impl Trees {
    pub fn bytes(&self) -> usize {
        match self {
            Self::Rejecting(forest) => forest.bytes(),
            Self::Warped(warps) => warps.bytes(),
        }
    }
}
