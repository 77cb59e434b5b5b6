//! Drawing from the tree of one direction.

use glam::{DVec2, Vec2};

use super::density::KnotDraw;
use super::disc::{AdaptiveDisc, PlacedTree, TreeView};
use super::settings::LeafChoice;
use super::tree::{Drawn, Forest};
use super::trees::Trees;
use super::warp;
use crate::geometry::cosine_hemisphere;
use crate::points::Stream;
use crate::sampler::knots::split_unit;

/// Trials after which a draw is given up, half a millisecond, which `pdf` does not know of. The mean is near `n_max`, and no
/// tree that needs more than [`super::build::MOST_TRIALS`] is kept, so that one draw in 10⁸ fails at most.
pub(super) const MAX_TRIALS: u32 = 20_000;

/// A point of a leaf that is accepted with the probability f/M, M being the leaf's bound.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeafTrial {
    pub(super) leaf: Drawn,
    /// Relative position in the leaf.
    pub(super) point: DVec2,
}

impl LeafTrial {
    /// The first point of a draw, which chooses the leaf by its x.
    #[inline(always)]
    pub(super) fn new(forest: &Forest, tree: PlacedTree, mut point: DVec2) -> Self {
        let leaf = forest.draw(tree.index, point.x);
        point.x = leaf.rest;
        Self { leaf, point }
    }

    /// Another point after a rejection: an envelope chooses its leaf anew; one that was chosen by its integral is kept until a
    /// point is accepted.
    #[inline(always)]
    pub(super) fn start_anew(
        &mut self,
        forest: &Forest,
        tree: PlacedTree,
        leaves: LeafChoice,
        random: &mut Stream,
    ) {
        let point = DVec2::new(random.next_f64(), random.next_f64());
        if leaves == LeafChoice::Envelope {
            *self = Self::new(forest, tree, point);
        } else {
            self.point = point;
        }
    }
}

/// The random numbers that a point of the unit square determines, and the point itself in full precision.
#[inline(always)]
pub(super) fn refine_point(u: Vec2) -> (DVec2, Stream) {
    let mut random = Stream::from_point(u);
    // A point of 24 bits a side would name only 2²⁴ leaves; the stream fills the lower bits.
    let fine = 1.0 / f64::from(1u32 << 24);
    let u = u.as_dvec2() + fine * DVec2::new(random.next_f64(), random.next_f64());
    (u, random)
}

impl AdaptiveDisc {
    /// A draw from a tree for its own direction.
    pub(super) fn draw(
        &self,
        tree: PlacedTree,
        point: DVec2,
        random: &mut Stream,
    ) -> Option<KnotDraw> {
        match &self.trees {
            Trees::Rejecting(forest) if forest.integral(tree.index) > 0.0 => {
                self.accepted(forest, tree, point, random)
            }
            _ => Some(self.draw_without_trials(tree, point)),
        }
    }

    /// A draw from a warped tree, or from one without mass, for its own direction.
    pub(super) fn draw_without_trials(&self, tree: PlacedTree, point: DVec2) -> KnotDraw {
        let wi = match &self.trees {
            Trees::Warped(warps) if !warps.is_void(tree.index) => {
                warp::direction(warps.draw(tree.index, point), tree.turn)
            }
            _ => cosine_hemisphere(point).as_vec3(),
        };
        let density = self.knot_density(tree, wi);
        KnotDraw { wi, density }
    }

    /// A draw that was accepted under its leaf's bound.
    fn accepted(
        &self,
        forest: &Forest,
        tree: PlacedTree,
        point: DVec2,
        random: &mut Stream,
    ) -> Option<KnotDraw> {
        let mut trial = LeafTrial::new(forest, tree, point);
        for _ in 0..MAX_TRIALS {
            if let Some(wi) = trial.leaf.direction(trial.point, tree.turn) {
                let level = random.next_f64() * f64::from(trial.leaf.bound);
                let value = self.value(tree, wi);
                if level < value {
                    let density = self.density_of_value(forest, tree, wi, value);
                    return Some(KnotDraw { wi, density });
                }
            }
            trial.start_anew(forest, tree, self.settings.leaves, random);
        }
        None
    }

    /// The tree that a point of the unit square chooses, and the point within it; `None` where it chooses the floor.
    #[inline(always)]
    pub(super) fn choose(&self, view: &TreeView, u: DVec2) -> (Option<usize>, DVec2) {
        let (ignore_brdf, x) = split_unit(u.x, self.settings.floor);
        if ignore_brdf {
            return (None, DVec2::new(x, u.y));
        }
        let (first_azimuth, x) = split_unit(x, 1.0 - view.weights[0]);
        let (first_polar, y) = split_unit(u.y, 1.0 - view.weights[1]);
        let slot = 2 * usize::from(!first_azimuth) + usize::from(!first_polar);
        (Some(slot), DVec2::new(x, y))
    }
}
