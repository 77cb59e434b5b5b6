//! The mixture of terms that is drawn from.

use std::f64::consts::{FRAC_1_PI, TAU};

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::settings::{FactoredSettings, Factors};
use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::distribution::Curves;
use crate::geometry::{
    Symmetry, cosine_hemisphere, reflect_about, spherical, to_spherical, unit_upper,
};
use crate::sampler::ThetaSpacing;
use crate::sampler::cascade_cdf::ThetaAxis;
use crate::sampler::direction_knots::{DirectionKnots, DirectionNeighbours};
use crate::sampler::draws::with_density;
use crate::sampler::knots::{TableChoice, split_unit};
use crate::{Error, Result};

/// The terms of the sum.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Terms {
    /// Probability of each term, `[table][term]`; a row adds up to 1, or to 0 where the material is black.
    pub weights: Vec<f32>,
    /// One curve over θw a term, with a knot at every edge of a cell.
    pub theta: Curves,
    /// One curve over φw a term, likewise.
    pub phi: Curves,
}

/// A BRDF's factors.
///
/// See [`SamplerSpec`](crate::sampler::SamplerSpec) for an example that builds a sampler.
#[derive(Clone, Debug)]
pub struct Factored {
    settings: FactoredSettings,
    pub(super) factors: Factors,
    knots: DirectionKnots,
    axis: ThetaAxis,
    pub(super) terms: Terms,
}

impl Factored {
    /// Puts a sampler together from terms that have been validated; the settings must name the factors.
    pub(super) fn from_parts(
        settings: FactoredSettings,
        symmetry: Symmetry,
        terms: Terms,
    ) -> Result<Self> {
        let factors = settings.factors.ok_or_else(|| {
            Error::argument("a factored sampler without factors", "build it again")
        })?;
        let (tables, azimuths) = (settings.tables, settings.azimuths);
        let knots = DirectionKnots::new(tables, TableChoice::Mixture, symmetry, azimuths)?;
        let axis = ThetaAxis::new(ThetaSpacing::Merl, factors.theta);
        Ok(Self {
            settings,
            factors,
            knots,
            axis,
            terms,
        })
    }

    /// The settings it was built with, and the factors chosen.
    pub fn settings(&self) -> &FactoredSettings {
        &self.settings
    }

    /// Probability of term `l` at `wo`, before the floor.
    #[inline]
    fn share(&self, near: &DirectionNeighbours, l: usize) -> f64 {
        let (count, polar) = (self.factors.terms(), near.polar);
        // (1 − t)·F_first + t·F_second at either azimuth.
        let each = near.starts.map(|start| {
            let first = f64::from(self.terms.weights[(start + polar.first) * count + l]);
            let second = f64::from(self.terms.weights[(start + polar.second) * count + l]);
            (1.0 - polar.share) * first + polar.share * second
        });
        (1.0 - near.weight) * each[0] + near.weight * each[1]
    }

    /// The direction in the plane from which azimuths of w count: that of `wo`, or the surface's x.
    fn axis_of(&self, near: &DirectionNeighbours) -> DVec2 {
        if self.knots.azimuths.is_isotropic() {
            near.axes[0].try_normalize().unwrap_or(DVec2::X)
        } else {
            DVec2::X
        }
    }

    pub(super) fn density(&self, wo: Vec3, wi: Vec3) -> f64 {
        let near = self.knots.neighbours(wo);
        let (wo, wi) = (near.wo.as_dvec3(), (wi * near.signs).as_dvec3());
        // Step 1: the coordinates (a, b) of w.
        let w = if self.factors.half { wo + wi } else { wi };
        let length = w.length();
        let (theta, azimuth) = to_spherical(turned(w, self.axis_of(&near), -1.0));
        let a = self.axis.coordinate(theta);
        let b = (azimuth * (1.0 / TAU)).rem_euclid(1.0);
        let cells = [self.factors.theta as f64, self.factors.phi as f64];
        // Step 2: Σ_l P(l | wo) u_l(a) v_l(b) per cell of the square. Terms without weight are not looked up.
        let (mut sum, mut shares) = (0.0, 0.0);
        for l in 0..self.factors.terms() {
            let share = self.share(&near, l);
            if share > 0.0 {
                let theta = slope(&self.terms.theta, l, a * cells[0]);
                sum += share * theta * slope(&self.terms.phi, l, b * cells[1]);
                shares += share;
            }
        }
        // dσ(w) = 2π sinθ (dθ/da) da db, and for half vectors dσ(wi) = 4 (wo·h) dσ(h) with wo·h = |wo + wi|/2.
        let sine = w.truncate().length() / length;
        let jacobian = if self.factors.half { 2.0 * length } else { 1.0 };
        let to_solid_angle =
            cells[0] * cells[1] / (TAU * self.axis.solid_angle(a, sine) * jacobian);
        // Step 3: what the terms' probabilities leave of 1, the floor at least, is the probability of the cosine.
        let kept = 1.0 - self.factors.floor;
        kept * sum * to_solid_angle + (1.0 - kept * shares).max(0.0) * wi.z * FRAC_1_PI
    }

    /// The direction w of a draw from term `l`, whose curves must not be void, with azimuths from `axis` on.
    fn draw(&self, axis: DVec2, l: usize, u: DVec2) -> DVec3 {
        let a = invert(&self.terms.theta, l, u.x) / self.factors.theta as f64;
        let b = invert(&self.terms.phi, l, u.y) / self.factors.phi as f64;
        turned(spherical(self.axis.theta(a), b * TAU), axis, 1.0)
    }

    /// The term that `u` falls to and what is left of `u`; `None` for the cosine, which has the last part of the unit.
    fn choose(&self, near: &DirectionNeighbours, u: f64) -> (Option<usize>, f64) {
        let kept = 1.0 - self.factors.floor;
        let mut below = 0.0;
        for l in 0..self.factors.terms() {
            let share = kept * self.share(near, l);
            if u < below + share {
                return (Some(l), split_unit(u - below, share).1);
            }
            below += share;
        }
        (
            None,
            ((u - below) / (1.0 - below)).clamp(0.0, 1.0f64.next_down()),
        )
    }
}

/// `w` turned about the normal by the azimuth of the unit vector `turn` (`sign` = 1), or back (−1).
fn turned(w: DVec3, turn: DVec2, sign: f64) -> DVec3 {
    DVec2::new(turn.x, sign * turn.y)
        .rotate(w.truncate())
        .extend(w.z)
}

/// Density of curve `l` at a coordinate, per cell. Every cell has a knot, so that pieces are one wide.
#[inline(always)]
fn slope(curves: &Curves, l: usize, x: f64) -> f64 {
    let piece = curves.find_segment(l, x);
    piece.c1 - piece.c0
}

/// The coordinate at which curve `l` reaches `u`, in cells.
#[inline(always)]
fn invert(curves: &Curves, l: usize, u: f64) -> f64 {
    let piece = curves.find(l, u);
    piece.x0 + ((u - piece.c0) / (piece.c1 - piece.c0)).clamp(0.0, 1.0)
}

impl DirectionSampler for Factored {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        let wo = unit_upper(wo)?;
        let near = self.knots.neighbours(wo);
        let (term, x) = self.choose(&near, f64::from(u.x));
        let u = DVec2::new(x, f64::from(u.y));
        let wi = match term {
            None => cosine_hemisphere(u),
            Some(l) => {
                let w = self.draw(self.axis_of(&near), l, u);
                match self.factors.half {
                    true => reflect_about(near.wo.as_dvec3(), w),
                    false => w,
                }
            }
        }
        .as_vec3();
        with_density(self, wo, wi * near.signs)
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let (Some(wo), Some(wi)) = (unit_upper(wo), unit_upper(wi)) else {
            return 0.0;
        };
        self.density(wo, wi).min(f64::from(f32::MAX)) as f32
    }

    fn bytes(&self) -> usize {
        size_of_val(self.terms.weights.as_slice())
            + self.terms.theta.bytes()
            + self.terms.phi.bytes()
    }
}
