//! What methods do alike with what they drew.

use glam::Vec3;

use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::geometry::is_upper;

/// What was drawn, with its density; `None` where it is not above the horizon or has no density.
pub(super) fn with_density(
    sampler: &impl DirectionSampler,
    wo: Vec3,
    wi: Vec3,
) -> Option<DirectionSample> {
    if !is_upper(wi) {
        return None;
    }
    let pdf = sampler.pdf(wo, wi);
    (pdf > 0.0).then_some(DirectionSample { wi, pdf })
}
