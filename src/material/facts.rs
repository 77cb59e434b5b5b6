//! What is known of a material before it is loaded, so that impossible requests are refused before any work.

use crate::geometry::Symmetry;

/// What a material is, apart from its values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaterialFacts {
    /// Which azimuths of `wo` stand for all others.
    pub symmetry: Symmetry,
    /// Whether it is a MERL table.
    pub has_table: bool,
    /// Whether its source holds a sampler of its own.
    pub has_own_sampler: bool,
}
