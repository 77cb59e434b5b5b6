//! The mixture of terms that is drawn from.

use std::f64::consts::{FRAC_1_PI, TAU};

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::settings::{FactoredSettings, Factors};
use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::distribution::Curves;
use crate::geometry::{cosine_hemisphere, reflect_about, spherical, to_spherical, unit_upper};
use crate::sampler::ThetaSpacing;
use crate::sampler::cascade_cdf::ThetaAxis;
use crate::sampler::draws::with_density;
use crate::sampler::knots::{KnotPair, TableChoice, ThetaKnots, split_unit};
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
    knots: ThetaKnots,
    axis: ThetaAxis,
    pub(super) terms: Terms,
}

impl Factored {
    /// Puts a sampler together from terms that have been validated; the settings must name the factors.
    pub(super) fn from_parts(settings: FactoredSettings, terms: Terms) -> Result<Self> {
        let factors = settings.factors.ok_or_else(|| {
            Error::argument("a factored sampler without factors", "build it again")
        })?;
        let knots = ThetaKnots::new(settings.tables, TableChoice::Mixture)?;
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
    fn share(&self, near: KnotPair, l: usize) -> f64 {
        let count = self.factors.terms();
        let first = f64::from(self.terms.weights[near.first * count + l]);
        let second = f64::from(self.terms.weights[near.second * count + l]);
        (1.0 - near.share) * first + near.share * second
    }

    pub(super) fn density(&self, wo: Vec3, wi: Vec3) -> f64 {
        let (wo, wi) = (wo.as_dvec3(), wi.as_dvec3());
        let near = self.knots.neighbours(wo.as_vec3());
        // Step 1: the coordinates (a, b) of w, the azimuth counted from that of wo.
        let w = if self.factors.half { wo + wi } else { wi };
        let length = w.length();
        let (theta, azimuth) = to_spherical(turned(w, wo, -1.0));
        let a = self.axis.coordinate(theta);
        let b = (azimuth * (1.0 / TAU)).rem_euclid(1.0);
        let cells = [self.factors.theta as f64, self.factors.phi as f64];
        // Step 2: Σ_l P(l | wo) u_l(a) v_l(b) per cell of the square. Terms without weight are not looked up.
        let (mut sum, mut shares) = (0.0, 0.0);
        for l in 0..self.factors.terms() {
            let share = self.share(near, l);
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

    /// The direction w of a draw from term `l`, whose curves must not be void, in the frame of `wo`.
    fn draw(&self, wo: DVec3, l: usize, u: DVec2) -> DVec3 {
        let a = invert(&self.terms.theta, l, u.x) / self.factors.theta as f64;
        let b = invert(&self.terms.phi, l, u.y) / self.factors.phi as f64;
        turned(spherical(self.axis.theta(a), b * TAU), wo, 1.0)
    }

    /// The term that `u` falls to and what is left of `u`; `None` for the cosine, which has the last part of the unit.
    fn choose(&self, near: KnotPair, u: f64) -> (Option<usize>, f64) {
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

/// `w` turned about the normal by the azimuth of `wo` (`sign` = 1), or back (−1).
fn turned(w: DVec3, wo: DVec3, sign: f64) -> DVec3 {
    let turn = wo.truncate().try_normalize().unwrap_or(DVec2::X);
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
        let (term, x) = self.choose(self.knots.neighbours(wo), f64::from(u.x));
        let u = DVec2::new(x, f64::from(u.y));
        let wi = match term {
            None => cosine_hemisphere(u),
            Some(l) if self.factors.half => {
                reflect_about(wo.as_dvec3(), self.draw(wo.as_dvec3(), l, u))
            }
            Some(l) => self.draw(wo.as_dvec3(), l, u),
        }
        .as_vec3();
        with_density(self, wo, wi)
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
