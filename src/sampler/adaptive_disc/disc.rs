//! Drawing from the trees of the two angles about `wo`, and the density of what is drawn.

use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::build;
use super::settings::{AdaptiveDiscSettings, Carry, LeafChoice};
use super::tree::Forest;
use super::trees::Trees;
use super::warp;
use crate::Result;
use crate::brdf::Brdf;
use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::geometry::{cosine_hemisphere, is_upper, unit_upper};
use crate::material::merl::MerlBrdf;
use crate::points::Stream;
use crate::sampler::Settings;
use crate::sampler::knots::{KnotPair, ThetaKnots, split_unit};

/// Quadtrees on the disc and the BRDF that draws are accepted under.
///
/// See [`SamplerSpec`](crate::sampler::SamplerSpec) for an example that builds a sampler.
#[derive(Clone, Debug)]
pub struct AdaptiveDisc {
    brdf: Arc<MerlBrdf>,
    pub(super) settings: AdaptiveDiscSettings,
    pub(super) knots: ThetaKnots,
    /// Sine and cosine of each knot's angle.
    directions: Vec<[f32; 2]>,
    pub(super) trees: Trees,
}

/// Trials after which a draw is given up, half a millisecond, which `pdf` does not know of. The mean is near `n_max`, and no
/// tree that needs more than [`build::MOST_TRIALS`] is kept, so that one draw in 10⁸ fails at most.
pub(super) const MAX_TRIALS: u32 = 20_000;

/// Fraction of its density that a draw must keep when it is carried over and rounded to f32. The change of angles alone leaves
/// more than a hundredth.
const LEAST_LEFT: f64 = 1e-4;

/// `wo` as the trees see it: turned into the plane of φ = 0, with its neighbours among the knots.
pub(super) struct TreeView {
    wo: DVec3,
    /// Cosine and sine of the azimuth of `wo`.
    pub(super) turn: DVec2,
    pub(super) near: KnotPair,
}

/// Shortest sum of two unit vectors whose direction f64 knows: to 10⁻⁴, for its components are known to 10⁻¹⁶.
const LEAST_SUM: f64 = 1e-12;

/// wo + wi' for the direction wi' below the horizon that `wi` was turned up from; `None` where it has no direction.
///
/// Next to the mirror direction wi' all but opposes `wo`, and what is left of their sum is perpendicular to `wo`, for
/// |wo + wi'|² = 2 wo·(wo + wi') holds between vectors of equal length alone. The roundings of components to f32 make
/// lengths differ by 10⁻⁷: the sum would be as likely along `wo` and find the density of any half vector there, which the
/// change of variables multiplies by up to 1/|wo + wi'|. So both are brought to unit length in f64 first.
#[inline]
fn turned_up_sum(wo: DVec3, wi: DVec3) -> Option<DVec3> {
    let sum = wo.normalize() + DVec3::new(wi.x, wi.y, -wi.z).normalize();
    (sum.length_squared() > LEAST_SUM * LEAST_SUM).then_some(sum)
}

impl AdaptiveDisc {
    /// Builds the trees on the threads of the current pool; the result does not depend on their number.
    ///
    /// # Errors
    /// [`crate::Error::Argument`] for settings outside their domains.
    pub fn build(brdf: Arc<MerlBrdf>, settings: AdaptiveDiscSettings) -> Result<Self> {
        settings.check()?;
        let knots = ThetaKnots::new(settings.tables, settings.choice)?;
        let trees = build::trees(&brdf, &settings, knots);
        Ok(Self::new(brdf, settings, knots, trees))
    }

    /// Puts a sampler together from stored trees, validated beforehand.
    pub(super) fn from_parts(
        brdf: Arc<MerlBrdf>,
        settings: AdaptiveDiscSettings,
        trees: Trees,
    ) -> Result<Self> {
        let knots = ThetaKnots::new(settings.tables, settings.choice)?;
        Ok(Self::new(brdf, settings, knots, trees))
    }

    fn new(
        brdf: Arc<MerlBrdf>,
        settings: AdaptiveDiscSettings,
        knots: ThetaKnots,
        trees: Trees,
    ) -> Self {
        let mut directions = Vec::with_capacity(knots.count());
        for k in 0..knots.count() {
            let (sin, cos) = knots.theta(k).sin_cos();
            directions.push([sin as f32, cos as f32]);
        }
        Self {
            brdf,
            settings,
            knots,
            directions,
            trees,
        }
    }

    /// The settings it was built with.
    pub fn settings(&self) -> &AdaptiveDiscSettings {
        &self.settings
    }

    pub(super) fn view(&self, wo: Vec3) -> TreeView {
        let xy = wo.truncate().as_dvec2();
        let turn = xy.try_normalize().unwrap_or(DVec2::X);
        TreeView {
            wo: wo.as_dvec3(),
            turn,
            near: self.knots.neighbours(wo),
        }
    }

    /// Direction of knot `k` at the azimuth of `wo`.
    fn knot_direction(&self, k: usize, turn: DVec2) -> DVec3 {
        let [sin, cos] = self.directions[k].map(f64::from);
        (turn * sin).extend(cos)
    }

    /// f at knot `k`, as the scalar that trees are built on.
    #[inline]
    pub(super) fn value(&self, k: usize, turn: DVec2, wi: Vec3) -> f64 {
        let f = self.brdf.eval(self.knot_direction(k, turn).as_vec3(), wi);
        f64::from(self.settings.importance.reduce(f))
    }

    /// Density per solid angle of the tree at knot `k`, for the knot's own direction. A tree without mass has the density
    /// of the uniform disc.
    #[inline]
    fn knot_density(&self, k: usize, turn: DVec2, wi: Vec3) -> f64 {
        // Trees give densities per dx dy = cosθi dσ(wi). Accepted draws have f/∫f under any bounds. A warp is built
        // for azimuth 0, so wi is turned back.
        let projected = match &self.trees {
            Trees::Rejecting(forest) if forest.integral(k) > 0.0 => {
                self.value(k, turn, wi) / forest.integral(k)
            }
            Trees::Warped(warps) if !warps.is_void(k) => warps.density(
                k,
                DVec2::new(turn.x, -turn.y).rotate(wi.truncate().as_dvec2()),
            ),
            _ => FRAC_1_PI,
        };
        projected * f64::from(wi.z)
    }

    /// Density per solid angle at `wi` of what the tree at knot `k` draws for the `wo` of `view`.
    #[inline]
    fn tree_density(&self, k: usize, view: &TreeView, wi: Vec3) -> f64 {
        if self.settings.carry == Carry::Direction {
            return self.knot_density(k, view.turn, wi);
        }
        let knot = self.knot_direction(k, view.turn);
        let wi = wi.as_dvec3();
        // `carry` turns directions below the horizon up, so two directions of the knot may end at wi. Densities add.
        let turned_up = match turned_up_sum(view.wo, wi) {
            Some(sum) => self.carried_density(k, view.turn, knot, sum),
            None => 0.0,
        };
        self.carried_density(k, view.turn, knot, view.wo + wi) + turned_up
    }

    /// Density of draws whose half vector lies along `sum`: the direction that was drawn for the knot is the reflection of the
    /// knot's own about it.
    #[inline]
    fn carried_density(&self, k: usize, turn: DVec2, knot: DVec3, sum: DVec3) -> f64 {
        // dσ(wi) = 4 |wo·h| dσ(h) on either side, and h is along wo + wi, or, beyond the horizon, against it.
        let ratio = 2.0 * knot.dot(sum) / sum.length_squared();
        let drawn = ratio * sum - knot;
        if drawn.z > 0.0 {
            ratio.abs() * self.knot_density(k, turn, drawn.as_vec3())
        } else {
            0.0
        }
    }

    /// A direction drawn for knot `k`, carried over to the `wo` of `view`.
    #[inline]
    fn carry(&self, k: usize, view: &TreeView, drawn: Vec3) -> Vec3 {
        if self.settings.carry == Carry::Direction {
            return drawn;
        }
        // The half vector of knot and drawn direction is kept, and wo is reflected about it: 2 (wo·h) h − wo.
        let sum = self.knot_direction(k, view.turn) + drawn.as_dvec3();
        let wi = 2.0 * view.wo.dot(sum) / sum.length_squared() * sum - view.wo;
        DVec3::new(wi.x, wi.y, wi.z.abs()).as_vec3()
    }

    /// [`Self::carry`]; `None` if rounding took the direction across the edge of a bin to where its tree has next to no
    /// density: such draws, one in 10⁵ where f jumps from nothing to a highlight, would have weights beyond all bounds.
    #[inline]
    pub(super) fn carried(&self, k: usize, view: &TreeView, drawn: Vec3) -> Option<Vec3> {
        let wi = self.carry(k, view, drawn);
        let stays = self.settings.carry == Carry::Direction
            || self.tree_density(k, view, wi)
                >= LEAST_LEFT * self.knot_density(k, view.turn, drawn);
        stays.then_some(wi)
    }

    /// Density per solid angle of the mixture of the trees at `view` and the floor.
    fn density(&self, view: &TreeView, wi: Vec3) -> f32 {
        let KnotPair {
            first,
            second,
            share,
        } = view.near;
        let first = if share < 1.0 {
            (1.0 - share) * self.tree_density(first, view, wi)
        } else {
            0.0
        };
        let trees = first
            + if share > 0.0 {
                share * self.tree_density(second, view, wi)
            } else {
                0.0
            };
        // pdf = (1 − ε)·((1 − t)·pdf_first + t·pdf_second) + ε·cosθ/π
        let floor = self.settings.floor;
        let density = (1.0 - floor) * trees + floor * FRAC_1_PI * f64::from(wi.z);
        density.min(f64::from(f32::MAX)) as f32
    }

    /// A draw from the tree at knot `k`, for the knot's own direction.
    fn draw(&self, k: usize, turn: DVec2, point: DVec2, random: &mut Stream) -> Option<Vec3> {
        match &self.trees {
            Trees::Rejecting(forest) if forest.integral(k) > 0.0 => {
                self.accepted(forest, k, turn, point, random)
            }
            Trees::Warped(warps) if !warps.is_void(k) => {
                Some(warp::direction(warps.draw(k, point), turn))
            }
            _ => Some(cosine_hemisphere(point).as_vec3()),
        }
    }

    /// A draw that was accepted under its leaf's bound.
    fn accepted(
        &self,
        forest: &Forest,
        k: usize,
        turn: DVec2,
        mut point: DVec2,
        random: &mut Stream,
    ) -> Option<Vec3> {
        // A point of the leaf is accepted with the probability f/M. After a rejection an envelope chooses its leaf anew. A
        // leaf that was chosen by its integral is kept until a point is accepted.
        let mut leaf = forest.draw(k, point.x);
        point.x = leaf.rest;
        for _ in 0..MAX_TRIALS {
            if let Some(wi) = leaf.direction(point, turn)
                && random.next_f64() * f64::from(leaf.bound) < self.value(k, turn, wi)
            {
                return Some(wi);
            }
            point = DVec2::new(random.next_f64(), random.next_f64());
            if self.settings.leaves == LeafChoice::Envelope {
                leaf = forest.draw(k, point.x);
                point.x = leaf.rest;
            }
        }
        None
    }

    pub(super) fn finish(&self, view: &TreeView, wi: Vec3) -> Option<DirectionSample> {
        if !is_upper(wi) {
            return None;
        }
        let pdf = self.density(view, wi);
        (pdf > 0.0).then_some(DirectionSample { wi, pdf })
    }
}

impl DirectionSampler for AdaptiveDisc {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        let wo = unit_upper(wo)?;
        let mut random = Stream::from_point(u);
        // A point of 24 bits a side would name only 2²⁴ leaves; the stream fills the lower bits.
        let fine = 1.0 / f64::from(1u32 << 24);
        let u = u.as_dvec2() + fine * DVec2::new(random.next_f64(), random.next_f64());
        let (ignore_brdf, x) = split_unit(u.x, self.settings.floor);
        let view = self.view(wo);
        let wi = if ignore_brdf {
            cosine_hemisphere(DVec2::new(x, u.y)).as_vec3()
        } else {
            let (first, y) = split_unit(u.y, 1.0 - view.near.share);
            let k = if first {
                view.near.first
            } else {
                view.near.second
            };
            self.carried(
                k,
                &view,
                self.draw(k, view.turn, DVec2::new(x, y), &mut random)?,
            )?
        };
        self.finish(&view, wi)
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let (Some(wo), Some(wi)) = (unit_upper(wo), unit_upper(wi)) else {
            return 0.0;
        };
        self.density(&self.view(wo), wi)
    }

    fn bytes(&self) -> usize {
        self.trees.bytes() + size_of_val(self.directions.as_slice())
    }
}
