//! Choosing `wi` for a given `wo`, each method with the density of what it chooses.

mod adaptive_disc;
mod by_azimuth;
mod cascade_cdf;
mod cosine;
mod factored;
mod half_vector_table;
mod knots;
mod lobe;
mod spec;
pub mod store;

pub use adaptive_disc::{
    AdaptiveDisc, AdaptiveDiscSettings, Carry, Cell, Construction, LeafChoice, Subdivision,
};
pub use by_azimuth::{ByAzimuth, ByAzimuthSettings};
pub use cascade_cdf::{CascadeCdf, CascadeCdfSettings, ShownCdf, ThetaSpacing};
pub use cosine::Cosine;
pub use factored::{Factored, FactoredSettings, Factors};
pub use half_vector_table::{HalfVectorSettings, HalfVectorTable};
pub(crate) use half_vector_table::{NODE_UNIT, ROW_UNIT, Stored};
pub use knots::TableChoice;
pub use lobe::{LEAST_DIFFUSE, Lobe, LobeKind, LobeParameters, LobeSettings};
pub use spec::{Sampler, SamplerSpec};

use glam::Vec3;

use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::geometry::is_upper;

/// What was drawn, with its density; `None` where it is not above the horizon or has no density.
fn with_density(sampler: &impl DirectionSampler, wo: Vec3, wi: Vec3) -> Option<DirectionSample> {
    if !is_upper(wi) {
        return None;
    }
    let pdf = sampler.pdf(wo, wi);
    (pdf > 0.0).then_some(DirectionSample { wi, pdf })
}
