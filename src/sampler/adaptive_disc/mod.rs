//! The adaptive disc (thesis 6.2 and 6.3): a quadtree over the unit disc for each of a few angles of `wo`, whose leaves
//! bound the BRDF; a leaf is drawn and the draw accepted under its bound.
//!
//! A MERL table bounds its own values. For any other BRDF the bounds are those of points with a margin, and a draw is accepted
//! with the probability min(f, bound)/bound, whose density is known too ([`masses`]). An anisotropic material has trees at a few
//! azimuths of `wo` too.
//!
//! On the disc dx dy is projected solid angle, so drawing in proportion to f_r(wo, ·) there draws in proportion to
//! f_r·cosθ over the hemisphere, exactly, at the angles that have a tree.

mod bounds;
mod build;
mod codec;
mod contents;
mod disc;
mod fields;
mod grower;
mod masses;
mod quad_cell;
mod sampled;
mod scouts;
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

use super::azimuth_knots::{check_azimuths, check_stored_azimuths};
use super::store::{TensorWriter, Tensors};
use super::{Method, Needs};
use crate::Result;
use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::material::{Loaded, MaterialFacts};

impl Method for AdaptiveDisc {
    const NAME: &'static str = "adaptive-disc";
    const SUMMARY: &'static str =
        "quadtrees over the disc, whose draws are accepted under bounds or warped";
    const NEEDS: Needs = Needs::AnyMaterial;
    type Settings = AdaptiveDiscSettings;

    fn check_facts(settings: &AdaptiveDiscSettings, facts: &MaterialFacts) -> Result<()> {
        check_azimuths(settings.azimuths, facts.symmetry)
    }

    fn build(material: &Loaded, settings: &AdaptiveDiscSettings) -> Result<Self> {
        Self::build(material, *settings)
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

    fn agree(asked: &AdaptiveDiscSettings, used: &AdaptiveDiscSettings) -> bool {
        let azimuths = asked.azimuths.or(used.azimuths);
        AdaptiveDiscSettings { azimuths, ..*asked } == *used
    }

    fn read(tensors: &Tensors, settings: AdaptiveDiscSettings, material: &Loaded) -> Result<Self> {
        check_stored_azimuths(settings.azimuths, material.symmetry(), tensors)?;
        let may_exceed = material.table().is_none();
        let trees = codec::read(tensors, &settings, may_exceed)?;
        Self::from_parts(material, settings, trees)
    }
}
