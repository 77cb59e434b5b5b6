//! Choosing `wi` for a given `wo`, with the density of what is chosen.

use glam::{Vec2, Vec3};

use crate::points::PointSet;

/// A sampled direction and its density.
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
pub trait DirectionSampler: Send + Sync {
    /// Draws a direction from a point of the unit square. `None` is a failed draw, which counts as a sample of weight 0.
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample>;

    /// Density per solid angle of drawing `wi`, in sr⁻¹; 0 where it can't be drawn. Its integral over the hemisphere is
    /// one minus the probability of a failed draw.
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32;

    /// Bytes of memory held by the sampler's own tables, counted; a BRDF it refers to is not included.
    fn bytes(&self) -> usize;

    /// [`Self::sample`] for each of `points`, with what depends on `wo` alone done once where that saves time.
    fn sample_batch(&self, wo: Vec3, points: &[Vec2]) -> Vec<Option<DirectionSample>> {
        points.iter().map(|&u| self.sample(wo, u)).collect()
    }

    /// [`Self::sample`] for many pairs: `out[k]` becomes `sample(wo[k], points[k])`, to the bit. As many as the shortest slice
    /// holds are drawn; what is left of a longer `out` stays as it was.
    fn sample_pairs(&self, wo: &[Vec3], points: &[Vec2], out: &mut [Option<DirectionSample>]) {
        for ((out, &wo), &u) in out.iter_mut().zip(wo).zip(points) {
            *out = self.sample(wo, u);
        }
    }

    /// [`Self::pdf`] for many pairs: `out[k]` becomes `pdf(wo[k], wi[k])`, to the bit. As many as the shortest slice holds are
    /// evaluated; what is left of a longer `out` stays as it was.
    fn pdf_pairs(&self, wo: &[Vec3], wi: &[Vec3], out: &mut [f32]) {
        for ((out, &wo), &wi) in out.iter_mut().zip(wo).zip(wi) {
            *out = self.pdf(wo, wi);
        }
    }

    /// Draws `count` directions that are stratified together, as well as the method can; each alone has density `pdf`.
    fn sample_many(&self, wo: Vec3, count: usize, seed: u64) -> Vec<Option<DirectionSample>> {
        self.sample_batch(wo, &well_spread(count, seed))
    }
}

/// The first `count` Owen-scrambled Sobol points of a seed.
pub(crate) fn well_spread(count: usize, seed: u64) -> Vec<Vec2> {
    (0..count as u64)
        .map(|i| PointSet::Sobol.point(seed, i, 0))
        .collect()
}
