//! The trees as squares, to be looked at.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::disc::AdaptiveDisc;
use super::quad_cell::QuadCell;
use super::tree::{Forest, WHOLE};
use super::trees::Trees;
use super::warp::Warps;
use crate::geometry::concentric_disc;

/// A leaf of a tree, or a square outside all leaves, in which nothing is drawn.
///
/// See [`SamplerSpec`](crate::sampler::SamplerSpec) for an example that builds a sampler;
/// [`Sampler::downcast`](crate::sampler::Sampler::downcast) gives the method whose tables these are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Lower corner in [−1, 1]².
    pub corner: DVec2,
    /// Side, 2 for a tree that is one leaf.
    pub side: f64,
    /// Probability that a draw from the tree falls into it; with rejection, that a trial does. 0 outside the leaves.
    pub share: f64,
    /// Upper bound of f_r in a leaf that is drawn with rejection, sr⁻¹, of the scalar that draws follow; 0 for other squares.
    pub bound: f32,
}

/// One tree: squares that cover [−1, 1]² and don't overlap. The plane of incidence is y = 0, `wo` at x > 0.
///
/// See [`SamplerSpec`](crate::sampler::SamplerSpec) for an example that builds a sampler;
/// [`Sampler::downcast`](crate::sampler::Sampler::downcast) gives the method whose tables these are.
#[derive(Clone, Debug, PartialEq)]
pub struct Subdivision {
    /// Polar angle of `wo` that the tree was built for, radians.
    pub theta_o: f64,
    /// The squares; for a material without light, a single one of probability 0.
    pub cells: Vec<Cell>,
    /// Mean number of trials that a draw from the tree takes; 1 without rejection.
    pub trials: f64,
    /// Whether the squares are mapped to the disc by the concentric map rather than laid over it.
    warped: bool,
}

/// Points along each side of a square that is mapped to the disc.
const BENDS: usize = 8;

impl Subdivision {
    /// Outline of a cell on the disc, without repeating the first point. Squares that are laid over the disc may reach beyond.
    pub fn outline(&self, cell: &Cell) -> Vec<DVec2> {
        let corners =
            [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y].map(|c| cell.corner + cell.side * c);
        if !self.warped {
            return corners.to_vec();
        }
        // A side is bent where it crosses a diagonal only, and by less the shorter it is.
        let bends = ((BENDS as f64 * cell.side).ceil() as usize).max(2);
        let mut outline = Vec::with_capacity(4 * bends);
        for i in 0..4 {
            let (from, to) = (corners[i], corners[(i + 1) % 4]);
            for j in 0..bends {
                let point = from.lerp(to, j as f64 / bends as f64);
                outline.push(concentric_disc((point + 1.0) * 0.5));
            }
        }
        outline
    }
}

impl AdaptiveDisc {
    /// The tree whose angle is nearest to the polar angle `theta_o`, radians, at the first azimuth of those that have trees; an
    /// angle that is not finite counts as 0.
    pub fn subdivision(&self, theta_o: f64) -> Subdivision {
        let k = self.knots.polar.nearest(theta_o);
        let (cells, trials, warped) = match &self.trees {
            Trees::Rejecting(forest) => (laid(forest, k), forest.trials(k).max(1.0), false),
            Trees::Warped(warps) => (mapped(warps, k), 1.0, true),
        };
        Subdivision {
            theta_o: self.knots.polar.theta(k),
            cells,
            trials,
            warped,
        }
    }
}

/// The leaves of a tree, and the largest squares of the quadtree that hold none.
fn laid(forest: &Forest, k: usize) -> Vec<Cell> {
    let mut leaves = BTreeMap::new();
    let mut parents = BTreeSet::new();
    let mut below = 0;
    for leaf in forest.tree(k) {
        let share = f64::from(leaf.upper.saturating_sub(below)) / f64::from(WHOLE);
        below = leaf.upper;
        leaves.insert(leaf.code, (share, leaf.bound));
        let mut code = leaf.code;
        let mut depth = leaf.code >> 28;
        while depth > 0 && parents.insert(parent(code)) {
            (code, depth) = (parent(code), depth - 1);
        }
    }
    let mut open = vec![QuadCell::ROOT];
    let mut cells = Vec::new();
    while let Some(square) = open.pop() {
        let code = square.code();
        if !leaves.contains_key(&code) && parents.contains(&code) {
            open.extend((0..4).rev().map(|i| square.child(i)));
        } else {
            let (share, bound) = leaves.get(&code).copied().unwrap_or((0.0, 0.0));
            cells.push(Cell {
                corner: square.corner,
                side: square.side,
                share,
                bound,
            });
        }
    }
    cells
}

/// Code of the square that a square of depth > 0 is a quarter of.
fn parent(code: u32) -> u32 {
    let (column, row) = (code >> 14 & 0x3fff, code & 0x3fff);
    ((code >> 28) - 1) << 28 | (column >> 1) << 14 | row >> 1
}

/// The leaves of a warp.
fn mapped(warps: &Warps, k: usize) -> Vec<Cell> {
    let root = (!warps.is_void(k)).then(|| warps.starts[k] as usize);
    let (mut open, mut cells) = (
        vec![(QuadCell::ROOT, root.map_or(0.0, |_| 1.0), root)],
        Vec::new(),
    );
    while let Some((square, share, node)) = open.pop() {
        let Some(node) = node.map(|n| &warps.nodes[n]) else {
            cells.push(Cell {
                corner: square.corner,
                side: square.side,
                share,
                bound: 0.0,
            });
            continue;
        };
        for i in (0..4).rev() {
            open.push((square.child(i), share * node.child_share(i), node.child(i)));
        }
    }
    cells
}
