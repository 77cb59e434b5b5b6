//! What every experiment works with.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use merlkit::material::Loaded;
use merlkit::sampler::{AdaptiveDisc, Sampler, SamplerSpec};
use merlkit::{Error, Result};

use super::pieces::PieceFolder;
use super::plan::ThesisPlan;
use crate::measure::cost::{Seconds, time};

/// Bytes of the thesis's KB.
pub(super) const KB: f64 = 1024.0;
/// Bytes of the thesis's tree that is not subdivided, and of each subdivision: its tables 6.5 and 6.6 go in such steps.
const ROOT_BYTES: f64 = 106.0;
const SUBDIVISION_BYTES: f64 = 558.0;

/// A plan, and the pieces of it that are finished.
#[derive(Debug)]
pub struct ThesisBench {
    /// How much is run.
    pub plan: ThesisPlan,
    /// What is finished.
    pub pieces: PieceFolder,
}

impl ThesisBench {
    /// The piece called `key`, measured now unless it is finished.
    pub(super) fn piece<T: Serialize + DeserializeOwned>(
        &mut self,
        key: &str,
        measure: impl FnOnce(&ThesisPlan) -> Result<T>,
    ) -> Result<T> {
        let plan = &self.plan;
        self.pieces.recall_or(key, || measure(plan))
    }
}

/// What building a sampler costs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct BuildCost {
    /// Time.
    pub seconds: Seconds,
    /// Bytes of its tables.
    pub bytes: usize,
}

/// Builds a sampler and says what that cost.
pub(super) fn build(material: &Loaded, spec: &SamplerSpec) -> Result<(Sampler, BuildCost)> {
    let (sampler, seconds) = time(|| spec.build(material));
    let sampler = sampler?;
    let bytes = sampler.bytes();
    Ok((sampler, BuildCost { seconds, bytes }))
}

/// What the quadtrees of a disc came to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct TreeCounts {
    /// Trees over the polar angle, all of which were counted, at the first azimuth.
    pub trees: usize,
    /// Azimuths that have trees.
    pub azimuths: usize,
    /// Subdivisions a tree, mean.
    pub subdivisions: f64,
    /// Leaves with light a tree, mean.
    pub leaves: f64,
    /// Trials of a draw, mean.
    pub trials: f64,
}

impl TreeCounts {
    /// Counts the trees of an adaptive disc.
    ///
    /// # Errors
    /// [`Error::Argument`] for another method.
    pub fn new(sampler: &Sampler) -> Result<Self> {
        let disc = sampler.downcast::<AdaptiveDisc>();
        let disc = disc.ok_or_else(|| Error::argument("no adaptive disc", "report this"))?;
        let trees = disc.settings().tables;
        let (mut subdivisions, mut leaves) = (0, 0);
        for k in 0..trees {
            // The trees lie at equal steps of the polar angle.
            let theta = k as f64 * std::f64::consts::FRAC_PI_2 / (trees.max(2) - 1) as f64;
            let cells = disc.subdivision(theta).cells;
            // Each subdivision replaces a square by four.
            subdivisions += (cells.len() - 1) / 3;
            leaves += cells.iter().filter(|cell| cell.share > 0.0).count();
        }
        Ok(Self {
            trees,
            azimuths: disc.settings().azimuths.unwrap_or(1),
            subdivisions: subdivisions as f64 / trees as f64,
            leaves: leaves as f64 / trees as f64,
            trials: disc.mean_trials(),
        })
    }

    /// Nodes a tree: four a subdivision, and the root.
    pub fn nodes(&self) -> f64 {
        4.0 * self.subdivisions + 1.0
    }

    /// KB a tree at the thesis's bytes a subdivision.
    pub fn published_kb(&self) -> f64 {
        (ROOT_BYTES + SUBDIVISION_BYTES * self.subdivisions) / KB
    }

    /// All trees.
    pub fn count(&self) -> f64 {
        (self.trees * self.azimuths) as f64
    }
}

/// Subdivisions of a tree that takes so many of the thesis's KB.
pub(super) fn subdivisions_of_kb(kb: f64) -> f64 {
    ((kb * KB - ROOT_BYTES) / SUBDIVISION_BYTES).max(0.0)
}

/// The adaptive disc as published, of so many trees from an image of so many pixels a side, with further settings, which begin with a
/// comma. A material that is not isotropic has two azimuths, the fewest, where the thesis had one.
pub(super) fn published_disc(
    [trees, image]: [usize; 2],
    material: &Loaded,
    more: &str,
) -> Result<SamplerSpec> {
    let azimuths = match material.facts().is_isotropic() {
        true => "",
        false => ",azimuths=2",
    };
    format!("adaptive-disc:published,tables={trees},grid={image}{azimuths}{more}").parse()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_of_the_thesis_are_those_of_subdivisions() {
        let counts = TreeCounts {
            trees: 60,
            azimuths: 1,
            subdivisions: 26.0,
            leaves: 79.0,
            trials: 1.5,
        };
        // Nickel's 846 KB are 60 trees of 26 subdivisions (table 6.23).
        assert!((60.0 * counts.published_kb() - 846.15).abs() < 15.0);
        assert!((subdivisions_of_kb(counts.published_kb()) - 26.0).abs() < 1e-9);
        assert_eq!(counts.nodes(), 105.0);
    }
}
