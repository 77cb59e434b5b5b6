//! Settings of the adaptive disc.

use std::ops::Bound;

use super::AdaptiveDisc;
use super::quad_cell::DEEPEST;
use crate::brdf::Importance;
use crate::sampler::settings::{floor, importance, table_choice};
use crate::sampler::{Field, Preset, Settings, TableChoice};
use crate::{Error, Result};

/// How the values behind a tree are gathered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Construction {
    /// Points in each node, finer only where nodes split, and bounds from the BRDF's own table: no value exceeds them.
    Refined,
    /// One image of this many pixels a side over the disc (thesis 6.3.3): bounds hold for the pixels only.
    Grid(u32),
}

/// In proportion to what a leaf is drawn, and what a rejection does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LeafChoice {
    /// Its bound times its area; a rejection starts again from the root. Draws are proportional to f_r whatever the error
    /// of the leaves' integrals.
    Envelope,
    /// Its integral; a rejection stays in the leaf (thesis 6.2.2). An error in a leaf's integral is an error of its share.
    Integral,
    /// Without rejection: a hierarchical warp to the leaf and to the place in it, so that two numbers are enough and
    /// well-spread points stay well spread. The density is that of the warp, constant in each leaf.
    Warp,
}

/// What keeps its place when a tree serves a `wo` beside its own.
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
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct AdaptiveDiscSettings {
    /// Trees over the polar angle of `wo`, 1 to 4096.
    pub tables: usize,
    /// Mean number of trials allowed in a leaf, > 1; the largest value over the mean where nothing is rejected.
    pub n_max: f64,
    /// Subdivisions from the whole disc to the smallest leaf, 0 to 14; without any, draws are rejected on the whole disc.
    pub depth: u32,
    /// A leaf is not split when the trials it wastes are less than this share of the whole tree's, or, with
    /// [`LeafChoice::Warp`], when it adds less than a hundredth of this share to the squared relative deviation of weights; 0
    /// splits by `n_max` alone.
    pub waste: f64,
    /// Where values and bounds come from.
    pub construction: Construction,
    /// How leaves are drawn.
    pub leaves: LeafChoice,
    /// What serves a `wo` between two trees.
    pub choice: TableChoice,
    /// What keeps its place between trees.
    pub carry: Carry,
    /// Share of draws that ignore the BRDF and follow the cosine, so that no direction is left out; 0 to 1.
    pub floor: f64,
    /// The scalar that draws are proportional to.
    pub importance: Importance,
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
        }
    }
}

impl AdaptiveDiscSettings {
    /// What the thesis used for its tables 6.23 and 6.24.
    pub fn as_published() -> Self {
        Self {
            tables: 60,
            depth: 10,
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

impl Settings for AdaptiveDiscSettings {
    type Method = AdaptiveDisc;

    fn fields() -> Vec<Field<Self>> {
        vec![
            Field::count(
                "tables",
                1..=4096,
                "trees over the polar angle of wo",
                |s| s.tables,
                |s, value| s.tables = value,
            ),
            Field::count(
                "depth",
                0..=DEEPEST as usize,
                "subdivisions down to the smallest leaf; 0 rejects draws on the whole disc",
                |s| s.depth as usize,
                |s, value| s.depth = value as u32,
            ),
            Field::real(
                "n-max",
                (Bound::Excluded(1.0), Bound::Unbounded),
                "mean number of trials allowed in a leaf",
                |s| s.n_max,
                |s, value| s.n_max = value,
            ),
            Field::real(
                "waste",
                0.0..1.0,
                "a leaf that wastes less than this fraction of all trials is not split",
                |s| s.waste,
                |s, value| s.waste = value,
            ),
            leaves(),
            Field::choice(
                "carry",
                &[
                    ("half-vector", Carry::HalfVector),
                    ("direction", Carry::Direction),
                ],
                "what keeps its place when a tree serves a wo beside its own",
                |s| s.carry,
                |s, value| s.carry = value,
            ),
            Field::optional_count(
                "grid",
                "none",
                8..=4096,
                "pixels a side of an image that trees are built from; none refines where needed",
                |s| match s.construction {
                    Construction::Refined => None,
                    Construction::Grid(side) => Some(side as usize),
                },
                |s, value| s.construction = construction(value),
            ),
            table_choice(|s: &Self| s.choice, |s, value| s.choice = value),
            floor(|s: &Self| s.floor, |s, value| s.floor = value),
            importance(|s: &Self| s.importance, |s, value| s.importance = value),
        ]
    }

    fn presets() -> Vec<Preset<Self>> {
        vec![
            Preset::new(
                "published",
                "the settings of the 2008 thesis, with the flaws that `merlkit check` shows",
                Self::as_published(),
            ),
            Preset::new(
                "rejection",
                "rejection on the whole disc, under the largest value for each tree's wo",
                Self::rejection(),
            ),
        ]
    }

    fn check_together(&self) -> Result<()> {
        if let (Construction::Grid(_), LeafChoice::Warp) = (self.construction, self.leaves) {
            return Err(Error::argument(
                "trees of adaptive-disc without rejection from a grid of pixels",
                "add grid=none, or choose other leaves",
            ));
        }
        Ok(())
    }
}

/// The setting of how leaves are drawn, of which the one that does not reject stands alone.
fn leaves() -> Field<AdaptiveDiscSettings> {
    Field::choice(
        "leaves",
        &[
            ("envelope", LeafChoice::Envelope),
            ("integral", LeafChoice::Integral),
            ("rejection-free", LeafChoice::Warp),
        ],
        "how a leaf is drawn: under its bound, by its integral, or by a warp that rejects nothing",
        |s: &AdaptiveDiscSettings| s.leaves,
        |s, value| s.leaves = value,
    )
    .standing_alone(&["rejection-free"])
}

/// Where values come from: a grid of so many pixels a side, or points in each node.
fn construction(side: Option<usize>) -> Construction {
    match side {
        Some(side) => Construction::Grid(side as u32),
        None => Construction::Refined,
    }
}
