//! The adaptive disc (thesis 6.2 and 6.3): a quadtree over the unit disc for each of a few angles of `wo`, whose leaves
//! bound the BRDF; a leaf is drawn and the draw accepted under its bound.
//!
//! On the disc dx dy is projected solid angle, so drawing in proportion to f_r(wo, ·) there draws in proportion to
//! f_r·cosθ over the hemisphere, exactly, at the angles that have a tree.

mod bounds;
mod build;
mod codec;
mod disc;
mod fields;
mod quad_cell;
mod settings;
mod slice;
mod stratified;
mod subdivision;
mod tree;
mod trees;
mod warp;

pub use disc::AdaptiveDisc;
pub use settings::{AdaptiveDiscSettings, Carry, Construction, LeafChoice};
pub use subdivision::{Cell, Subdivision};

use std::sync::Arc;

use glam::Vec3;

use super::store::{TensorWriter, Tensors};
use super::{Method, Needs};
use crate::Result;
use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::material::Loaded;

impl Method for AdaptiveDisc {
    const NAME: &'static str = "adaptive-disc";
    const SUMMARY: &'static str =
        "quadtrees over the disc, whose draws are accepted under bounds or warped";
    const NEEDS: Needs = Needs::MerlTable;
    type Settings = AdaptiveDiscSettings;

    fn build(material: &Loaded, settings: &AdaptiveDiscSettings) -> Result<Self> {
        let table = material.require_table("the adaptive disc")?;
        Self::build(table.clone(), *settings)
    }

    fn settings(&self) -> AdaptiveDiscSettings {
        *self.settings()
    }

    fn sampler(self: Arc<Self>) -> Arc<dyn DirectionSampler> {
        self
    }

    fn draw_own_strata(
        &self,
        wo: Vec3,
        count: usize,
        seed: u64,
    ) -> Option<Vec<Option<DirectionSample>>> {
        Some(self.draw_stratified(wo, count, seed))
    }

    fn write(&self, out: &mut TensorWriter) -> Result<()> {
        codec::write(&self.trees, out);
        Ok(())
    }

    fn read(tensors: &Tensors, settings: AdaptiveDiscSettings, material: &Loaded) -> Result<Self> {
        let table = material.require_table("the adaptive disc")?;
        let trees = codec::read(tensors, &settings)?;
        Self::from_parts(table.clone(), settings, trees)
    }
}
