//! The density of what trees draw for their own directions and carry over to the `wo` at hand.
//!
//! Every step stands alone: which directions of a tree end at `wi`, what a tree's density is there once f is known, and how
//! trees are mixed. Single calls go through the steps pair by pair, batches block by block, with the same bits.

use std::f64::consts::FRAC_1_PI;

use glam::{DVec2, DVec3, Vec3};

use super::disc::{AdaptiveDisc, PlacedTree, TreeView};
use super::settings::Carry;
use super::tree::Forest;
use super::trees::Trees;
use crate::direction_sampler::DirectionSample;
use crate::geometry::is_upper;

/// Fraction of its density that a draw must keep when it is carried over and rounded to f32. The change of angles alone leaves
/// more than a hundredth.
const LEAST_LEFT: f64 = 1e-4;

/// Shortest sum of two unit vectors whose direction f64 knows: to 10⁻⁴, for its components are known to 10⁻¹⁶.
const LEAST_SUM: f64 = 1e-12;

/// A direction that a tree draws for its own, and its density there per solid angle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct KnotDraw {
    pub wi: Vec3,
    pub density: f64,
}

/// A direction that a tree draws for its own and that is carried over to the one asked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct KnotOrigin {
    pub wi: Vec3,
    /// dσ(as drawn)/dσ(as carried over).
    pub stretch: f64,
}

/// A direction asked for, and the half vectors, not of unit length, that lead to it from the `wo` of a view.
#[derive(Clone, Copy, Debug)]
pub(super) struct DensityTarget {
    pub wi: Vec3,
    /// wo + wi.
    sum: DVec3,
    /// wo + wi' for the direction wi' below the horizon that `wi` was turned up from.
    turned_up: Option<DVec3>,
}

impl DensityTarget {
    #[inline(always)]
    pub fn new(view: &TreeView, wi: Vec3) -> Self {
        let exact = wi.as_dvec3();
        Self {
            wi,
            sum: view.wo + exact,
            turned_up: turned_up_sum(view.unit_wo, exact),
        }
    }
}

/// wo + wi' for the direction wi' below the horizon that `wi` was turned up from; `None` where it has no direction.
///
/// Next to the mirror direction wi' all but opposes `wo`, and what is left of their sum is perpendicular to `wo`, for
/// |wo + wi'|² = 2 wo·(wo + wi') holds between vectors of equal length alone. The roundings of components to f32 make
/// lengths differ by 10⁻⁷: the sum would be as likely along `wo` and find the density of any half vector there, which the
/// change of variables multiplies by up to 1/|wo + wi'|. So both are brought to unit length in f64 first.
#[inline(always)]
fn turned_up_sum(unit_wo: DVec3, wi: DVec3) -> Option<DVec3> {
    let sum = unit_wo + DVec3::new(wi.x, wi.y, -wi.z).normalize();
    (sum.length_squared() > LEAST_SUM * LEAST_SUM).then_some(sum)
}

/// The foot of `wi` on the disc in the frame of a tree, whose direction has the azimuth 0 there.
#[inline]
fn turned_back(tree: PlacedTree, wi: Vec3) -> DVec2 {
    DVec2::new(tree.turn.x, -tree.turn.y).rotate(wi.truncate().as_dvec2())
}

/// The direction whose half vector with a tree's own direction, `knot`, lies along `sum`: the reflection of `knot` about it.
#[inline(always)]
fn origin(knot: DVec3, sum: DVec3) -> Option<KnotOrigin> {
    // dσ(wi) = 4 |wo·h| dσ(h) on either side, and h is along wo + wi, or, beyond the horizon, against it.
    let ratio = 2.0 * knot.dot(sum) / sum.length_squared();
    let drawn = ratio * sum - knot;
    (drawn.z > 0.0).then(|| KnotOrigin {
        wi: drawn.as_vec3(),
        stretch: ratio.abs(),
    })
}

impl AdaptiveDisc {
    /// The directions that a tree draws for its own and that end at the target: two at most, for `carry` turns directions below
    /// the horizon up.
    #[inline(always)]
    pub(super) fn origins(
        &self,
        tree: PlacedTree,
        target: &DensityTarget,
    ) -> [Option<KnotOrigin>; 2] {
        if self.settings.carry == Carry::Direction {
            let wi = target.wi;
            return [Some(KnotOrigin { wi, stretch: 1.0 }), None];
        }
        let knot = self.knot_direction(tree);
        let turned_up = match target.turned_up {
            Some(sum) => origin(knot, sum),
            None => None,
        };
        [origin(knot, target.sum), turned_up]
    }

    /// Density per solid angle of a tree for its own direction, where no value of f is needed for it.
    #[inline(always)]
    pub(super) fn density_without_value(&self, tree: PlacedTree, wi: Vec3) -> Option<f64> {
        let k = tree.index;
        // Trees give densities per dx dy = cosθi dσ(wi). A warp is built for azimuth 0, so wi is turned back. A tree
        // without mass has the density of the uniform disc.
        let projected = match &self.trees {
            Trees::Rejecting(forest) if forest.integral(k) > 0.0 => return None,
            Trees::Warped(warps) if !warps.is_void(k) => warps.density(k, turned_back(tree, wi)),
            _ => FRAC_1_PI,
        };
        Some(projected * f64::from(wi.z))
    }

    /// Density per solid angle of a tree with bounds for its own direction, where f is `value`.
    #[inline(always)]
    pub(super) fn density_of_value(
        &self,
        forest: &Forest,
        tree: PlacedTree,
        wi: Vec3,
        value: f64,
    ) -> f64 {
        // Accepted draws have f/∫f under any bounds, or min(f, bound)/∫min(f, bound) where f may exceed its leaf's.
        let drawn = if forest.excess.is_empty() {
            value
        } else {
            let p = turned_back(tree, wi);
            value.min(f64::from(forest.bound_at(tree.index, p)))
        };
        drawn / forest.integral(tree.index) * f64::from(wi.z)
    }

    /// Density per solid angle of a tree for its own direction.
    #[inline]
    pub(super) fn knot_density(&self, tree: PlacedTree, wi: Vec3) -> f64 {
        match (&self.trees, self.density_without_value(tree, wi)) {
            (_, Some(density)) => density,
            (Trees::Rejecting(forest), None) => {
                self.density_of_value(forest, tree, wi, self.value(tree, wi))
            }
            (Trees::Warped(_), None) => 0.0,
        }
    }

    /// Density per solid angle at `wi` of what each tree of a view draws; 0 for a tree without weight, which is not looked up.
    #[inline]
    pub(super) fn tree_densities(&self, view: &TreeView, wi: Vec3) -> [f64; 4] {
        let target = DensityTarget::new(view, wi);
        let mut densities = [0.0; 4];
        for (slot, density) in densities.iter_mut().enumerate() {
            if !view.has_weight(slot) {
                continue;
            }
            let tree = view.tree(slot);
            for origin in self.origins(tree, &target).into_iter().flatten() {
                *density += origin.stretch * self.knot_density(tree, origin.wi);
            }
        }
        densities
    }

    /// Density per solid angle of the mixture of the trees of a view, whose own densities are given, and the floor.
    #[inline(always)]
    pub(super) fn mix(&self, view: &TreeView, densities: &[f64; 4], wi: Vec3) -> f32 {
        // (1 − a)·((1 − t)·p₁ + t·p₂) + a·((1 − t)·p₃ + t·p₄)
        let [azimuth, polar] = view.weights;
        let [p1, p2, p3, p4] = densities;
        let mut trees = 0.0;
        for (pair, weight) in [([p1, p2], 1.0 - azimuth), ([p3, p4], azimuth)] {
            if weight > 0.0 {
                trees += weight * ((1.0 - polar) * pair[0] + polar * pair[1]);
            }
        }
        // pdf = (1 − ε)·trees + ε·cosθ/π
        let floor = self.settings.floor;
        let density = (1.0 - floor) * trees + floor * FRAC_1_PI * f64::from(wi.z);
        density.min(f64::from(f32::MAX)) as f32
    }

    /// The direction that a tree drew for its own, carried over to the `wo` of a view.
    #[inline(always)]
    pub(super) fn carry(&self, tree: PlacedTree, view: &TreeView, drawn: Vec3) -> Vec3 {
        if self.settings.carry == Carry::Direction {
            return drawn;
        }
        // The half vector of knot and drawn direction is kept, and wo is reflected about it: 2 (wo·h) h − wo.
        let sum = self.knot_direction(tree) + drawn.as_dvec3();
        let wi = 2.0 * view.wo.dot(sum) / sum.length_squared() * sum - view.wo;
        DVec3::new(wi.x, wi.y, wi.z.abs()).as_vec3()
    }

    /// Whether a draw from the tree of number `slot` kept its density where it was carried to. Rounding takes one in 10⁵ across
    /// the edge of a bin to where its tree has next to none, if f jumps from nothing to a highlight there: such draws would have
    /// weights beyond all bounds.
    #[inline(always)]
    pub(super) fn keeps_density(
        &self,
        slot: usize,
        drawn: &KnotDraw,
        densities: &[f64; 4],
    ) -> bool {
        self.settings.carry == Carry::Direction || densities[slot] >= LEAST_LEFT * drawn.density
    }

    /// The sample that a draw from the tree of number `slot` becomes at the `wo` of a view.
    pub(super) fn finish_tree(
        &self,
        view: &TreeView,
        slot: usize,
        drawn: KnotDraw,
    ) -> Option<DirectionSample> {
        let wi = self.carry(view.tree(slot), view, drawn.wi);
        if !is_upper(wi) {
            return None;
        }
        let densities = self.tree_densities(view, wi);
        if !self.keeps_density(slot, &drawn, &densities) {
            return None;
        }
        self.sample_with(view, wi, &densities)
    }

    /// The sample of a direction that was drawn without regard to the trees.
    pub(super) fn finish_floor(&self, view: &TreeView, wi: Vec3) -> Option<DirectionSample> {
        if !is_upper(wi) {
            return None;
        }
        self.sample_with(view, wi, &self.tree_densities(view, wi))
    }

    /// The sample at a direction where the trees have these densities, among the directions as they were given.
    #[inline(always)]
    pub(super) fn sample_with(
        &self,
        view: &TreeView,
        wi: Vec3,
        densities: &[f64; 4],
    ) -> Option<DirectionSample> {
        let pdf = self.mix(view, densities, wi);
        let wi = wi * view.signs;
        (pdf > 0.0).then_some(DirectionSample { wi, pdf })
    }
}
