//! The adaptive disc (thesis 6.2 and 6.3): a quadtree over the unit disc for each of a few angles of `wo`, whose leaves
//! bound the BRDF; a leaf is drawn and the draw accepted under its bound.
//!
//! On the disc dx dy is projected solid angle, so drawing in proportion to f_r(wo, ·) there draws in proportion to
//! f_r·cosθ over the hemisphere, exactly, at the angles that have a tree.

mod bounds;
mod build;
mod many;
mod square;
mod tree;

pub(super) use square::DEEPEST;
pub(super) use tree::{Forest, Leaf, MOST_LEAVES, WHOLE};

use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

use glam::{DVec2, Vec2, Vec3};

use super::knots::{Neighbours, TableChoice, ThetaKnots, split_unit};
use super::{DirectionSample, DirectionSampler};
use crate::brdf::{Brdf, Importance, Measured};
use crate::geom::{cosine_hemisphere, is_upper};
use crate::points::Stream;
use crate::{Error, Result};

/// How the values behind a tree are gathered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Construction {
    /// Points in each node, finer only where nodes split, and bounds from the BRDF's own table: no value exceeds them.
    Refined,
    /// One image of this many pixels a side over the disc (thesis 6.3.3): bounds hold for the pixels only.
    Grid(u32),
}

/// In proportion to what a leaf is drawn, and what a rejection does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LeafChoice {
    /// Its bound times its area; a rejection starts again from the root. Draws are proportional to f_r whatever the error
    /// of the leaves' integrals.
    Envelope,
    /// Its integral; a rejection stays in the leaf (thesis 6.2.2). An error in a leaf's integral is an error of its share.
    Integral,
}

/// Settings of [`AdaptiveDisc::build`].
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct AdaptiveDiscSettings {
    /// Trees over the polar angle of `wo`, 1 to 4096.
    pub tables: usize,
    /// Mean number of trials allowed in a leaf, > 1.
    pub n_max: f64,
    /// Subdivisions from the whole disc to the smallest leaf, 1 to 14.
    pub depth: u32,
    /// A leaf is not split when the trials it wastes are less than this share of the whole tree's; 0 splits by `n_max` alone.
    pub waste: f64,
    /// Where values and bounds come from.
    pub construction: Construction,
    /// How leaves are drawn.
    pub leaves: LeafChoice,
    /// What serves a `wo` between two trees.
    pub choice: TableChoice,
    /// Share of draws that ignore the BRDF and follow the cosine, so that no direction is left out; 0 to 1.
    pub floor: f64,
    /// The scalar that draws are proportional to.
    pub importance: Importance,
}

impl Default for AdaptiveDiscSettings {
    fn default() -> Self {
        Self {
            tables: 60,
            n_max: 2.0,
            depth: 14,
            waste: 1e-4,
            construction: Construction::Refined,
            leaves: LeafChoice::Envelope,
            choice: TableChoice::Mixture,
            floor: 1e-3,
            importance: Importance::Mean,
        }
    }
}

impl AdaptiveDiscSettings {
    /// What the thesis used for its tables 6.23 and 6.24.
    pub fn as_published() -> Self {
        Self {
            depth: 10,
            waste: 0.0,
            construction: Construction::Grid(800),
            leaves: LeafChoice::Integral,
            choice: TableChoice::Nearest,
            floor: 0.0,
            ..Self::default()
        }
    }

    fn check(&self) -> Result<()> {
        let refuse = |what: String, fix: &str| Err(Error::argument(what, fix));
        if !(self.n_max > 1.0 && self.n_max.is_finite()) {
            return refuse(
                format!("n_max is {}", self.n_max),
                "choose a mean number of trials above 1, such as 2",
            );
        }
        if !(1..=DEEPEST).contains(&self.depth) {
            return refuse(format!("depth is {}", self.depth), "choose 1 to 14 subdivisions");
        }
        if !(0.0..=1.0).contains(&self.floor) || !(0.0..1.0).contains(&self.waste) {
            return refuse(
                format!("floor is {}, waste {}", self.floor, self.waste),
                "choose shares between 0 and 1",
            );
        }
        if let Construction::Grid(side) = self.construction
            && !(8..=4096).contains(&side)
        {
            return refuse(format!("the grid has {side} pixels a side"), "choose 8 to 4096");
        }
        Ok(())
    }
}

/// Quadtrees on the disc and the BRDF that draws are accepted under.
#[derive(Clone, Debug)]
pub struct AdaptiveDisc {
    brdf: Arc<Measured>,
    settings: AdaptiveDiscSettings,
    knots: ThetaKnots,
    forest: Forest,
}

/// Trials after which a draw is given up, half a millisecond, which `pdf` does not know of. The mean is near `n_max`; only
/// trees that are not allowed to be deep need as many as the peak of f exceeds its mean, and lose draws when that is
/// thousands.
const MAX_TRIALS: u32 = 20_000;

/// `wo` as the trees see it: turned into the plane of φ = 0, with its neighbours among the knots.
struct View {
    /// Cosine and sine of the azimuth of `wo`.
    turn: DVec2,
    near: Neighbours,
}

impl AdaptiveDisc {
    /// Builds the trees on the threads of the current pool; the result does not depend on their number.
    ///
    /// # Errors
    /// [`Error::Argument`] for settings outside their domains.
    pub fn build(brdf: Arc<Measured>, settings: AdaptiveDiscSettings) -> Result<Self> {
        settings.check()?;
        let knots = ThetaKnots::new(settings.tables, settings.choice)?;
        let forest = build::forest(&brdf, &settings, knots);
        Ok(Self { brdf, settings, knots, forest })
    }

    /// Puts a sampler together from stored leaves, each tree's start and integral, validated beforehand.
    pub(super) fn from_parts(
        brdf: Arc<Measured>,
        settings: AdaptiveDiscSettings,
        leaves: Vec<Leaf>,
        starts: Vec<u32>,
        integrals: Vec<f32>,
    ) -> Result<Self> {
        settings.check()?;
        let knots = ThetaKnots::new(settings.tables, settings.choice)?;
        let forest = Forest::new(leaves, starts, integrals, knots);
        Ok(Self { brdf, settings, knots, forest })
    }

    /// The settings it was built with.
    pub fn settings(&self) -> &AdaptiveDiscSettings {
        &self.settings
    }

    pub(super) fn forest(&self) -> &Forest {
        &self.forest
    }

    fn view(&self, wo: Vec3) -> View {
        let xy = wo.truncate().as_dvec2();
        View { turn: xy.try_normalize().unwrap_or(DVec2::X), near: self.knots.neighbours(wo) }
    }

    /// Direction of knot `k` at the azimuth of `wo`.
    fn knot_direction(&self, k: usize, turn: DVec2) -> Vec3 {
        let (sin, cos) = self.forest.knot(k);
        (turn * sin).extend(cos).as_vec3()
    }

    /// f at knot `k`, as the scalar that trees are built on.
    #[inline]
    fn value(&self, k: usize, turn: DVec2, wi: Vec3) -> f64 {
        f64::from(self.settings.importance.of(self.brdf.eval(self.knot_direction(k, turn), wi)))
    }

    /// Density per projected solid angle of the tree at knot `k`, given its value at `wi`. A tree without mass stands for
    /// the uniform disc.
    fn projected_density(&self, k: usize, value: f64) -> f64 {
        match self.forest.integral(k) {
            i if i > 0.0 => value / i,
            _ => FRAC_1_PI,
        }
    }

    /// Density per solid angle of the mixture of the trees at `view`; `known` spares an evaluation already made.
    fn density(&self, view: &View, wi: Vec3, known: Option<(usize, f64)>) -> f32 {
        let of = |k: usize| match known {
            Some((table, value)) if table == k => self.projected_density(k, value),
            _ => self.projected_density(k, self.value(k, view.turn, wi)),
        };
        let Neighbours { first, second, share } = view.near;
        let first_density = if share < 1.0 { (1.0 - share) * of(first) } else { 0.0 };
        let trees = first_density + if share > 0.0 { share * of(second) } else { 0.0 };
        let floor = self.settings.floor;
        let projected = (1.0 - floor) * trees + floor * FRAC_1_PI;
        (projected * f64::from(wi.z)).min(f64::from(f32::MAX)) as f32
    }

    /// A draw from the tree at knot `k`: a direction and its value there.
    fn draw(&self, k: usize, turn: DVec2, mut point: DVec2, random: &mut Stream) -> Option<(Vec3, f64)> {
        if self.forest.integral(k) <= 0.0 {
            return Some((cosine_hemisphere(point).as_vec3(), 0.0));
        }
        let mut leaf = self.forest.draw(k, point.x);
        point.x = leaf.rest;
        for _ in 0..MAX_TRIALS {
            if let Some(wi) = leaf.direction(point, turn) {
                let value = self.value(k, turn, wi);
                if random.next_f64() * f64::from(leaf.bound) < value {
                    return Some((wi, value));
                }
            }
            point = DVec2::new(random.next_f64(), random.next_f64());
            if self.settings.leaves == LeafChoice::Envelope {
                leaf = self.forest.draw(k, point.x);
                point.x = leaf.rest;
            }
        }
        None
    }
}

impl DirectionSampler for AdaptiveDisc {
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        if !is_upper(wo) {
            return None;
        }
        let mut random = Stream::from_point(u);
        // A point of 24 bits a side would name only 2²⁴ leaves; the stream fills the lower bits.
        let fine = 1.0 / f64::from(1u32 << 24);
        let u = u.as_dvec2() + fine * DVec2::new(random.next_f64(), random.next_f64());
        let (ignore_brdf, x) = split_unit(u.x, self.settings.floor);
        let view = self.view(wo);
        let (wi, known) = if ignore_brdf {
            (cosine_hemisphere(DVec2::new(x, u.y)).as_vec3(), None)
        } else {
            let (first, y) = split_unit(u.y, 1.0 - view.near.share);
            let k = if first { view.near.first } else { view.near.second };
            let (wi, value) = self.draw(k, view.turn, DVec2::new(x, y), &mut random)?;
            (wi, Some((k, value)).filter(|_| self.forest.integral(k) > 0.0))
        };
        self.finish(&view, wi, known)
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if !is_upper(wo) || !is_upper(wi) {
            return 0.0;
        }
        self.density(&self.view(wo), wi, None)
    }

    fn bytes(&self) -> usize {
        self.forest.bytes()
    }

    /// One descent that shares the draws over the leaves (thesis 6.3.2, algorithms 17 and 18).
    fn sample_many(&self, wo: Vec3, count: usize, seed: u64) -> Vec<Option<DirectionSample>> {
        many::sample_many(self, wo, count, seed)
    }
}

impl AdaptiveDisc {
    fn finish(&self, view: &View, wi: Vec3, known: Option<(usize, f64)>) -> Option<DirectionSample> {
        if !is_upper(wi) {
            return None;
        }
        let pdf = self.density(view, wi, known);
        (pdf > 0.0).then_some(DirectionSample { wi, pdf })
    }
}
