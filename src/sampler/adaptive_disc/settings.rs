//! Settings of the adaptive disc.

use crate::brdf::Importance;
use crate::sampler::TableChoice;

/// How the values behind a tree are gathered.
///
/// The example of [`SamplerSpec`](crate::sampler::SamplerSpec) reads settings from text and lists them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Construction {
    /// Points in each node, finer only where nodes split. A MERL table's bins bound its values; for other BRDFs the bound is
    /// the largest of the points with a margin, and values beyond it are drawn as often as the bound.
    Refined,
    /// One image of this many pixels a side over the disc (thesis 6.3.3): bounds hold for the pixels only.
    Grid(u32),
}

/// In proportion to what a leaf is drawn, and what a rejection does.
///
/// The example of [`SamplerSpec`](crate::sampler::SamplerSpec) reads settings from text and lists them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LeafChoice {
    /// Its bound times its area; a rejection starts again from the root. Draws are proportional to f_r even where
    /// the leaves' integrals are inexact.
    Envelope,
    /// Its integral; a rejection stays in the leaf (thesis 6.2.2). An error in a leaf's integral is an error of its probability.
    Integral,
    /// Without rejection: a hierarchical warp to the leaf and to the place in it, so that two numbers are enough and
    /// well-spread points stay well spread. The density is that of the warp, constant in each leaf.
    Warp,
}

/// What is held fixed when a tree is used for a `wo` other than its own.
///
/// The example of [`SamplerSpec`](crate::sampler::SamplerSpec) reads settings from text and lists them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Carry {
    /// The half vector: a direction drawn for the tree's own angle is reflected anew, so that highlights follow `wo`. What
    /// ends below the horizon is turned up, and the density is the sum over both ways there.
    HalfVector,
    /// The direction (thesis 6.3.1): highlights stay where the tree's own angle has them.
    Direction,
}

/// Settings of the adaptive disc.
///
/// The example of [`SamplerSpec`](crate::sampler::SamplerSpec) reads settings from text and lists them.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct AdaptiveDiscSettings {
    /// Trees over the polar angle of `wo`, 1 to 4096.
    pub tables: usize,
    /// Mean number of trials allowed in a leaf, > 1; the largest value over the mean where nothing is rejected.
    pub n_max: f64,
    /// Subdivisions from the whole disc to the smallest leaf, 0 to 14; without any, draws are rejected on the whole disc.
    pub depth: u32,
    /// A leaf is not split when the trials it wastes are less than this fraction of the whole tree's, or, with
    /// [`LeafChoice::Warp`], when it adds less than a hundredth of it to the squared relative deviation of weights; 0
    /// splits by `n_max` alone.
    pub waste: f64,
    /// Where values and bounds come from.
    pub construction: Construction,
    /// How leaves are drawn.
    pub leaves: LeafChoice,
    /// What is used for a `wo` between two trees.
    pub choice: TableChoice,
    /// What keeps its place between trees.
    pub carry: Carry,
    /// Fraction of draws that ignore the BRDF and follow the cosine, so that no direction is left out; 0 to 1.
    pub floor: f64,
    /// The scalar that draws are proportional to.
    pub importance: Importance,
    /// Azimuths of `wo` that have trees, 2 to 256, equally spaced over those that the material's symmetry leaves; `None` for
    /// isotropic materials, which need one azimuth only, and for 8 of anisotropic ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub azimuths: Option<usize>,
}

impl Default for AdaptiveDiscSettings {
    fn default() -> Self {
        Self {
            tables: 20,
            n_max: 2.0,
            depth: 14,
            waste: 1e-3,
            construction: Construction::Refined,
            leaves: LeafChoice::Envelope,
            choice: TableChoice::Mixture,
            carry: Carry::HalfVector,
            floor: 1e-3,
            importance: Importance::Mean,
            azimuths: None,
        }
    }
}

impl AdaptiveDiscSettings {
    /// Trees over both angles of `wo`.
    pub(super) fn trees(&self) -> usize {
        self.tables.saturating_mul(self.azimuths.unwrap_or(1))
    }

    /// What the thesis used for its tables 6.23 and 6.24. It prints a depth of 5; its memory fits trees of five levels with the
    /// root, which are four subdivisions.
    pub fn as_published() -> Self {
        Self {
            tables: 60,
            depth: 4,
            waste: 0.0,
            construction: Construction::Grid(800),
            leaves: LeafChoice::Integral,
            choice: TableChoice::Nearest,
            carry: Carry::Direction,
            floor: 0.0,
            ..Self::default()
        }
    }

    /// Rejection on the whole disc, under the largest value for each tree's `wo` (thesis 5.1.1, 4.3.2): trees without
    /// subdivisions.
    pub fn rejection() -> Self {
        Self {
            depth: 0,
            ..Self::default()
        }
    }
}
