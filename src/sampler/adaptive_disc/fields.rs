//! The settings of the adaptive disc as text: keys, domains, presets.

use std::ops::Bound;

use super::AdaptiveDisc;
use super::quad_cell::DEEPEST;
use super::settings::{AdaptiveDiscSettings, Carry, Construction, LeafChoice};
use crate::sampler::azimuth_knots::azimuths_field;
use crate::sampler::settings::{floor, importance, table_choice};
use crate::sampler::{Field, Preset, Settings};
use crate::{Error, Result};

impl Settings for AdaptiveDiscSettings {
    type Method = AdaptiveDisc;

    fn fields() -> Vec<Field<Self>> {
        let mut fields = subdivision();
        fields.push(azimuths_field(
            |s: &Self| s.azimuths,
            |s, value| s.azimuths = value,
        ));
        fields.extend([leaves(), carry(), grid()]);
        fields.push(table_choice(
            |s: &Self| s.choice,
            |s, value| s.choice = value,
        ));
        fields.push(floor(|s: &Self| s.floor, |s, value| s.floor = value));
        fields.push(importance(
            |s: &Self| s.importance,
            |s, value| s.importance = value,
        ));
        fields
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
                "adaptive-disc cannot draw without rejection from trees that are built on a grid of pixels",
                "add grid=none, or choose other leaves",
            ));
        }
        Ok(())
    }
}

/// The settings of how many trees there are, and where a leaf is split.
fn subdivision() -> Vec<Field<AdaptiveDiscSettings>> {
    vec![
        Field::count(
            "tables",
            1..=4096,
            "trees over the polar angle of wo",
            |s: &AdaptiveDiscSettings| s.tables,
            |s, value| s.tables = value,
        ),
        Field::count(
            "depth",
            0..=DEEPEST as usize,
            "subdivisions down to the smallest leaf; 0 rejects draws on the whole disc",
            |s: &AdaptiveDiscSettings| s.depth as usize,
            |s, value| s.depth = value as u32,
        ),
        Field::real(
            "n-max",
            (Bound::Excluded(1.0), Bound::Unbounded),
            "mean number of trials allowed in a leaf",
            |s: &AdaptiveDiscSettings| s.n_max,
            |s, value| s.n_max = value,
        ),
        Field::real(
            "waste",
            0.0..1.0,
            "a leaf that wastes less than this fraction of all trials is not split",
            |s: &AdaptiveDiscSettings| s.waste,
            |s, value| s.waste = value,
        ),
    ]
}

/// The setting of what is held fixed between two tables.
fn carry() -> Field<AdaptiveDiscSettings> {
    Field::choice(
        "carry",
        &[
            ("half-vector", Carry::HalfVector),
            ("direction", Carry::Direction),
        ],
        "what is held fixed when a tree is used for a nearby wo",
        |s: &AdaptiveDiscSettings| s.carry,
        |s, value| s.carry = value,
    )
}

/// The setting of the image that trees are built from.
fn grid() -> Field<AdaptiveDiscSettings> {
    Field::optional_count(
        "grid",
        "none",
        8..=4096,
        "pixels per side of an image that trees are built from; none refines where needed",
        |s: &AdaptiveDiscSettings| match s.construction {
            Construction::Refined => None,
            Construction::Grid(side) => Some(side as usize),
        },
        |s, value| s.construction = construction(value),
    )
}

/// The setting of how leaves are drawn. The word for draws without rejection may be given without the key.
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
