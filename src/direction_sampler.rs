//! Choosing `wi` for a given `wo`, with the density of what is chosen.

use glam::{Vec2, Vec3};

use crate::batch::Wo;
use crate::points::PointSet;

/// A sampled direction and its density.
///
/// The example of [`DirectionSampler`] draws a direction and weights it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionSample {
    /// Towards the light, unit length, above the horizon.
    pub wi: Vec3,
    /// Density per solid angle, sr⁻¹: exactly what `pdf(wo, wi)` returns; finite and > 0.
    pub pdf: f32,
}

/// A method that chooses `wi` given `wo`.
///
/// `wo` is expected above the horizon; for any other, and for NaN, `sample` returns `None` and `pdf` returns 0. Directions of
/// other lengths than 1 are renormalised ([`crate::geometry::unit_upper`]).
///
/// # Examples
/// ```
/// use merlkit::glam::{Vec2, Vec3};
/// use merlkit::{LookupRule, Material, SamplerSpec};
///
/// let material = Material::resolve("lambert:reflectance=0.5")?.load(LookupRule::Floor)?;
/// let sampler = "cosine".parse::<SamplerSpec>()?.build(&material)?;
/// let drawn = sampler.as_dyn().sample(Vec3::Z, Vec2::new(0.3, 0.7)).expect("above the horizon");
/// assert_eq!(drawn.pdf, sampler.as_dyn().pdf(Vec3::Z, drawn.wi));
///
/// // The weight of one draw; its mean over all draws is the albedo.
/// let weight = material.brdf().eval_cos(Vec3::Z, drawn.wi) / drawn.pdf;
/// assert!((weight.x - 0.5).abs() < 1e-5);
/// # Ok::<(), merlkit::Error>(())
/// ```
pub trait DirectionSampler: Send + Sync {
    /// Draws a direction from a point of the unit square. `None` is a failed draw, which counts as a sample of weight 0.
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample>;

    /// Density per solid angle of drawing `wi`, in sr⁻¹; 0 where it can't be drawn. Its integral over the hemisphere is
    /// one minus the probability of a failed draw.
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32;

    /// Bytes of memory held by the sampler's own tables, counted; a BRDF it refers to is not included.
    fn bytes(&self) -> usize;

    /// [`Self::sample`] of a batch: `out[k]` becomes `sample(wo.lane(k), u[k])`, to the bit.
    ///
    /// # Panics
    /// If the slices differ in length ([`Wo::assert_lanes`]).
    #[track_caller]
    fn sample_batch(&self, wo: Wo<'_>, u: &[Vec2], out: &mut [Option<DirectionSample>]) {
        wo.assert_lanes(u.len(), out.len());
        for (lane, (out, &u)) in out.iter_mut().zip(u).enumerate() {
            *out = self.sample(wo.lane(lane), u);
        }
    }

    /// [`Self::pdf`] of a batch: `out[k]` becomes `pdf(wo.lane(k), wi[k])`, to the bit.
    ///
    /// # Panics
    /// If the slices differ in length ([`Wo::assert_lanes`]).
    #[track_caller]
    fn pdf_batch(&self, wo: Wo<'_>, wi: &[Vec3], out: &mut [f32]) {
        wo.assert_lanes(wi.len(), out.len());
        for (lane, (out, &wi)) in out.iter_mut().zip(wi).enumerate() {
            *out = self.pdf(wo.lane(lane), wi);
        }
    }

    /// Draws `count` directions for one `wo` that are spread together as well as the method can: by [`draw_stratified`], or by a way
    /// of its own. One of them that is chosen uniformly has the density `pdf`, so that the mean of g/`pdf` over all is an unbiased
    /// estimate of ∫ g dω; `None` is a failed draw, which counts as 0. The same `seed` gives the same directions.
    fn draw_stratified(&self, wo: Vec3, count: usize, seed: u64) -> Vec<Option<DirectionSample>> {
        draw_stratified(self, wo, count, seed)
    }
}

/// Draws `count` directions for one `wo` from the first `count` Owen-scrambled Sobol points of `seed`, so that they are as
/// evenly spread as the sampler's map from the unit square keeps them. Each alone has the density `pdf`; `None` is a failed
/// draw.
///
/// [`crate::sampler::AdaptiveDisc::draw_stratified`] does the same by the disc's own method.
///
/// See [`DirectionSampler`] for an example of drawing.
pub fn draw_stratified(
    sampler: &(impl DirectionSampler + ?Sized),
    wo: Vec3,
    count: usize,
    seed: u64,
) -> Vec<Option<DirectionSample>> {
    let mut points = Vec::with_capacity(count);
    for index in 0..count as u64 {
        points.push(PointSet::Sobol.point(seed, index, 0));
    }
    let mut draws = vec![None; count];
    sampler.sample_batch(Wo::One(wo), &points, &mut draws);
    draws
}
