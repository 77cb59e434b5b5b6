//! Drawing from the trees of the directions about `wo`, and the density of what is drawn.

use std::f64::consts::FRAC_1_PI;

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::build::{self, Subject};
use super::settings::{AdaptiveDiscSettings, Carry, LeafChoice};
use super::tree::Forest;
use super::trees::Trees;
use super::warp;
use crate::Result;
use crate::direction_sampler::{DirectionSample, DirectionSampler};
use crate::geometry::{cosine_hemisphere, is_upper, unit_upper};
use crate::material::Loaded;
use crate::points::Stream;
use crate::sampler::Settings;
use crate::sampler::azimuth_knots::check_azimuths;
use crate::sampler::direction_knots::DirectionKnots;
use crate::sampler::knots::split_unit;

/// Quadtrees on the disc and the BRDF that draws are accepted under.
///
/// See [`SamplerSpec`](crate::sampler::SamplerSpec) for an example that builds a sampler.
#[derive(Clone, Debug)]
pub struct AdaptiveDisc {
    material: Loaded,
    pub(super) settings: AdaptiveDiscSettings,
    pub(super) knots: DirectionKnots,
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

/// One tree, and where it is used.
#[derive(Clone, Copy)]
pub(super) struct PlacedTree {
    /// Its number among all trees.
    pub(super) index: usize,
    /// The knot of its polar angle.
    knot: usize,
    /// Cosine and sine of the azimuth of its direction.
    pub(super) turn: DVec2,
}

/// `wo` as the trees see it: among the azimuths that have trees, with its neighbours among the knots of both angles.
pub(super) struct TreeView {
    wo: DVec3,
    /// The mirror signs that bring `wo` there; the same bring `wi`.
    signs: Vec3,
    /// The trees of each of the two azimuths, at the two polar angles.
    trees: [[PlacedTree; 2]; 2],
    /// Weights of the second azimuth and of the second polar angle.
    weights: [f64; 2],
}

impl TreeView {
    /// The trees with their probabilities, which sum to 1.
    pub(super) fn shares(&self) -> [(PlacedTree, f64); 4] {
        let [azimuth, polar] = self.weights;
        let [[a, b], [c, d]] = self.trees;
        [
            (a, (1.0 - azimuth) * (1.0 - polar)),
            (b, (1.0 - azimuth) * polar),
            (c, azimuth * (1.0 - polar)),
            (d, azimuth * polar),
        ]
    }
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

/// The directions that have trees.
fn knots(settings: &AdaptiveDiscSettings, material: &Loaded) -> Result<DirectionKnots> {
    let AdaptiveDiscSettings {
        tables,
        choice,
        azimuths,
        ..
    } = *settings;
    DirectionKnots::new(tables, choice, material.symmetry(), azimuths)
}

/// The foot of `wi` on the disc in the frame of a tree, whose direction has the azimuth 0 there.
#[inline]
fn turned_back(tree: PlacedTree, wi: Vec3) -> DVec2 {
    DVec2::new(tree.turn.x, -tree.turn.y).rotate(wi.truncate().as_dvec2())
}

impl AdaptiveDisc {
    /// Builds the trees on the threads of the current pool; the result does not depend on their number.
    ///
    /// # Errors
    /// [`crate::Error::Argument`] for settings outside their domains, and for azimuths of an isotropic material.
    pub fn build(material: &Loaded, settings: AdaptiveDiscSettings) -> Result<Self> {
        settings.check()?;
        check_azimuths(settings.azimuths, material.symmetry())?;
        let knots = knots(&settings, material)?;
        let settings = AdaptiveDiscSettings {
            azimuths: knots.azimuths.setting(),
            ..settings
        };
        let trees = build::trees(&Subject::new(material, &settings), &settings, knots);
        Self::from_parts(material, settings, trees)
    }

    /// Puts a sampler together from trees that were grown or, if stored, validated. The settings name the azimuths.
    pub(super) fn from_parts(
        material: &Loaded,
        settings: AdaptiveDiscSettings,
        trees: Trees,
    ) -> Result<Self> {
        let knots = knots(&settings, material)?;
        let mut directions = Vec::with_capacity(knots.polar.count());
        for k in 0..knots.polar.count() {
            let (sin, cos) = knots.polar.theta(k).sin_cos();
            directions.push([sin as f32, cos as f32]);
        }
        Ok(Self {
            material: material.clone(),
            settings,
            knots,
            directions,
            trees,
        })
    }

    /// The settings it was built with.
    pub fn settings(&self) -> &AdaptiveDiscSettings {
        &self.settings
    }

    /// Trials that a draw takes on average, over the trees; 1 where nothing is rejected.
    pub fn mean_trials(&self) -> f64 {
        let Trees::Rejecting(forest) = &self.trees else {
            return 1.0;
        };
        let count = forest.integrals.len();
        let sum: f64 = (0..count).map(|k| forest.trials(k).max(1.0)).sum();
        sum / count.max(1) as f64
    }

    /// The largest part, over the trees, of ∫ f_r·cosθ that exceeds the leaves' bounds. Draws follow min(f_r, bound) there. 0 for a
    /// MERL table, which bounds its values, and for trees without rejection, which need no bounds.
    pub fn largest_excess(&self) -> f64 {
        match &self.trees {
            Trees::Rejecting(forest) => {
                let largest = forest.excess.iter().copied().fold(0.0, f32::max);
                f64::from(largest)
            }
            Trees::Warped(_) => 0.0,
        }
    }

    pub(super) fn view(&self, wo: Vec3) -> TreeView {
        let near = self.knots.neighbours(wo);
        let turns = near
            .axes
            .map(|axis| axis.try_normalize().unwrap_or(DVec2::X));
        let mut trees = [[near.polar.first, near.polar.second].map(|knot| PlacedTree {
            index: near.starts[0] + knot,
            knot,
            turn: turns[0],
        }); 2];
        for tree in &mut trees[1] {
            tree.index = near.starts[1] + tree.knot;
            tree.turn = turns[1];
        }
        TreeView {
            wo: near.wo.as_dvec3(),
            signs: near.signs,
            trees,
            weights: [near.weight, near.polar.share],
        }
    }

    /// The direction that a tree was built for.
    fn knot_direction(&self, tree: PlacedTree) -> DVec3 {
        let [sin, cos] = self.directions[tree.knot].map(f64::from);
        (tree.turn * sin).extend(cos)
    }

    /// f for the direction of a tree, as the scalar that trees are built on.
    #[inline]
    pub(super) fn value(&self, tree: PlacedTree, wi: Vec3) -> f64 {
        let wo = self.knot_direction(tree).as_vec3();
        let f = self.material.brdf().eval(wo, wi);
        f64::from(self.settings.importance.reduce(f))
    }

    /// The value of f that a direction is drawn in proportion to: f itself, or the bound of its leaf where f exceeds it.
    #[inline]
    fn bounded_value(&self, forest: &Forest, tree: PlacedTree, wi: Vec3) -> f64 {
        let f = self.value(tree, wi);
        if forest.excess.is_empty() {
            return f;
        }
        let p = turned_back(tree, wi);
        f.min(f64::from(forest.bound_at(tree.index, p)))
    }

    /// Density per solid angle of a tree for its own direction. A tree without mass has the density of the uniform disc.
    #[inline]
    fn knot_density(&self, tree: PlacedTree, wi: Vec3) -> f64 {
        let k = tree.index;
        // Trees give densities per dx dy = cosθi dσ(wi). Accepted draws have f/∫f under any bounds. A warp is built
        // for azimuth 0, so wi is turned back.
        let projected = match &self.trees {
            Trees::Rejecting(forest) if forest.integral(k) > 0.0 => {
                self.bounded_value(forest, tree, wi) / forest.integral(k)
            }
            Trees::Warped(warps) if !warps.is_void(k) => warps.density(k, turned_back(tree, wi)),
            _ => FRAC_1_PI,
        };
        projected * f64::from(wi.z)
    }

    /// Density per solid angle at `wi` of what a tree draws for the `wo` of `view`.
    #[inline]
    fn tree_density(&self, tree: PlacedTree, view: &TreeView, wi: Vec3) -> f64 {
        if self.settings.carry == Carry::Direction {
            return self.knot_density(tree, wi);
        }
        let knot = self.knot_direction(tree);
        let wi = wi.as_dvec3();
        // `carry` turns directions below the horizon up, so two directions of the knot may end at wi. Densities add.
        let turned_up = match turned_up_sum(view.wo, wi) {
            Some(sum) => self.carried_density(tree, knot, sum),
            None => 0.0,
        };
        self.carried_density(tree, knot, view.wo + wi) + turned_up
    }

    /// Density of draws whose half vector lies along `sum`: the direction that was drawn for the knot is the reflection of the
    /// knot's own about it.
    #[inline]
    fn carried_density(&self, tree: PlacedTree, knot: DVec3, sum: DVec3) -> f64 {
        // dσ(wi) = 4 |wo·h| dσ(h) on either side, and h is along wo + wi, or, beyond the horizon, against it.
        let ratio = 2.0 * knot.dot(sum) / sum.length_squared();
        let drawn = ratio * sum - knot;
        if drawn.z > 0.0 {
            ratio.abs() * self.knot_density(tree, drawn.as_vec3())
        } else {
            0.0
        }
    }

    /// A direction drawn for a tree's own, carried over to the `wo` of `view`.
    #[inline]
    fn carry(&self, tree: PlacedTree, view: &TreeView, drawn: Vec3) -> Vec3 {
        if self.settings.carry == Carry::Direction {
            return drawn;
        }
        // The half vector of knot and drawn direction is kept, and wo is reflected about it: 2 (wo·h) h − wo.
        let sum = self.knot_direction(tree) + drawn.as_dvec3();
        let wi = 2.0 * view.wo.dot(sum) / sum.length_squared() * sum - view.wo;
        DVec3::new(wi.x, wi.y, wi.z.abs()).as_vec3()
    }

    /// [`Self::carry`]; `None` if rounding took the direction across the edge of a bin to where its tree has next to no
    /// density: such draws, one in 10⁵ where f jumps from nothing to a highlight, would have weights beyond all bounds.
    #[inline]
    pub(super) fn carried(&self, tree: PlacedTree, view: &TreeView, drawn: Vec3) -> Option<Vec3> {
        let wi = self.carry(tree, view, drawn);
        let stays = self.settings.carry == Carry::Direction
            || self.tree_density(tree, view, wi) >= LEAST_LEFT * self.knot_density(tree, drawn);
        stays.then_some(wi)
    }

    /// Density per solid angle of the mixture of the trees at `view` and the floor.
    fn density(&self, view: &TreeView, wi: Vec3) -> f32 {
        let [azimuth, polar] = view.weights;
        // (1 − a)·((1 − t)·p₁₁ + t·p₁₂) + a·((1 − t)·p₂₁ + t·p₂₂); a tree without weight is not looked up.
        let mut trees = 0.0;
        for (pair, weight) in view.trees.iter().zip([1.0 - azimuth, azimuth]) {
            if weight > 0.0 {
                trees += weight * self.pair_density(*pair, polar, view, wi);
            }
        }
        // pdf = (1 − ε)·trees + ε·cosθ/π
        let floor = self.settings.floor;
        let density = (1.0 - floor) * trees + floor * FRAC_1_PI * f64::from(wi.z);
        density.min(f64::from(f32::MAX)) as f32
    }

    /// Density of the mixture of two trees of one azimuth.
    #[inline]
    fn pair_density(
        &self,
        [first, second]: [PlacedTree; 2],
        weight: f64,
        view: &TreeView,
        wi: Vec3,
    ) -> f64 {
        let first = if weight < 1.0 {
            (1.0 - weight) * self.tree_density(first, view, wi)
        } else {
            0.0
        };
        let second = if weight > 0.0 {
            weight * self.tree_density(second, view, wi)
        } else {
            0.0
        };
        first + second
    }

    /// A draw from a tree for its own direction.
    fn draw(&self, tree: PlacedTree, point: DVec2, random: &mut Stream) -> Option<Vec3> {
        let k = tree.index;
        match &self.trees {
            Trees::Rejecting(forest) if forest.integral(k) > 0.0 => {
                self.accepted(forest, tree, point, random)
            }
            Trees::Warped(warps) if !warps.is_void(k) => {
                Some(warp::direction(warps.draw(k, point), tree.turn))
            }
            _ => Some(cosine_hemisphere(point).as_vec3()),
        }
    }

    /// A draw that was accepted under its leaf's bound.
    fn accepted(
        &self,
        forest: &Forest,
        tree: PlacedTree,
        mut point: DVec2,
        random: &mut Stream,
    ) -> Option<Vec3> {
        // A point of the leaf is accepted with the probability f/M. After a rejection an envelope chooses its leaf anew. A
        // leaf that was chosen by its integral is kept until a point is accepted.
        let mut leaf = forest.draw(tree.index, point.x);
        point.x = leaf.rest;
        for _ in 0..MAX_TRIALS {
            if let Some(wi) = leaf.direction(point, tree.turn)
                && random.next_f64() * f64::from(leaf.bound) < self.value(tree, wi)
            {
                return Some(wi);
            }
            point = DVec2::new(random.next_f64(), random.next_f64());
            if self.settings.leaves == LeafChoice::Envelope {
                leaf = forest.draw(tree.index, point.x);
                point.x = leaf.rest;
            }
        }
        None
    }

    /// The sample of a direction among the azimuths that have trees.
    pub(super) fn finish(&self, view: &TreeView, wi: Vec3) -> Option<DirectionSample> {
        if !is_upper(wi) {
            return None;
        }
        let pdf = self.density(view, wi);
        let wi = wi * view.signs;
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
            let (first, x) = split_unit(x, 1.0 - view.weights[0]);
            let pair = view.trees[usize::from(!first)];
            let (first, y) = split_unit(u.y, 1.0 - view.weights[1]);
            let tree = pair[usize::from(!first)];
            self.carried(tree, &view, self.draw(tree, DVec2::new(x, y), &mut random)?)?
        };
        self.finish(&view, wi)
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let (Some(wo), Some(wi)) = (unit_upper(wo), unit_upper(wi)) else {
            return 0.0;
        };
        let view = self.view(wo);
        self.density(&view, wi * view.signs)
    }

    fn bytes(&self) -> usize {
        self.trees.bytes() + size_of_val(self.directions.as_slice())
    }
}
