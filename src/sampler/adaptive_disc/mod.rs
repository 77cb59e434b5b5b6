//! The adaptive disc (thesis 6.2 and 6.3): a quadtree over the unit disc for each of a few angles of `wo`, whose leaves
//! bound the BRDF; a leaf is drawn and the draw accepted under its bound.
//!
//! A MERL table bounds its own values. For any other BRDF the bounds are those of points with a margin, and a draw is accepted
//! with the probability min(f, bound)/bound, whose density is known too ([`masses`]). An anisotropic material has trees at a few
//! azimuths of `wo` too.
//!
//! On the disc dx dy is projected solid angle, so drawing in proportion to f_r(wo, ·) there draws in proportion to
//! f_r·cosθ over the hemisphere, exactly, at the angles that have a tree.

mod batch;
mod bounds;
mod build;
mod codec;
mod contents;
mod density;
mod disc;
mod draw;
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

use glam::{Vec2, Vec3};

use super::azimuth_knots::{check_azimuths, check_stored_azimuths};
use super::store::{TensorWriter, Tensors};
use super::{Method, Needs};
use crate::Result;
use crate::batch::Wo;
use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::geometry::{cosine_hemisphere, unit_upper};
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

impl DirectionSampler for AdaptiveDisc {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        let view = self.view(unit_upper(wo)?);
        let (u, mut random) = draw::refine_point(u);
        let (slot, point) = self.choose(&view, u);
        let Some(slot) = slot else {
            return self.finish_floor(&view, cosine_hemisphere(point).as_vec3());
        };
        let drawn = self.draw(view.tree(slot), point, &mut random)?;
        self.finish_tree(&view, slot, drawn)
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let (Some(wo), Some(wi)) = (unit_upper(wo), unit_upper(wi)) else {
            return 0.0;
        };
        let view = self.view(wo);
        let wi = wi * view.signs;
        self.mix(&view, &self.tree_densities(&view, wi), wi)
    }

    fn bytes(&self) -> usize {
        self.trees.bytes() + size_of_val(self.directions.as_slice())
    }

    fn draw_stratified(&self, wo: Vec3, count: usize, seed: u64) -> Vec<Option<DirectionSample>> {
        Self::draw_stratified(self, wo, count, seed)
    }

    #[track_caller]
    fn sample_batch(&self, wo: Wo<'_>, u: &[Vec2], out: &mut [Option<DirectionSample>]) {
        wo.assert_lanes(u.len(), out.len());
        batch::sample(self, wo, u, out);
    }

    #[track_caller]
    fn pdf_batch(&self, wo: Wo<'_>, wi: &[Vec3], out: &mut [f32]) {
        wo.assert_lanes(wi.len(), out.len());
        batch::pdf(self, wo, wi, out);
    }
}
