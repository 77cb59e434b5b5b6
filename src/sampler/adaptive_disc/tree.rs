//! Trees as flat arrays of nodes.

use glam::{DVec2, Vec3};

use super::square::{Rect, Square};
use crate::sampler::knots::ThetaKnots;

/// A node of twelve bytes. Children of a node stand together in the order of [`Square::child`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::sampler) struct Node {
    /// What the node is drawn in proportion to: the sum over its leaves of bound × area, or of their integrals.
    pub weight: f32,
    /// Upper bound of f in a leaf; 0 in an inner node.
    pub bound: f32,
    /// Position of the first child; 0 for a leaf.
    pub children: u32,
}

/// A tree for each angle of `wo`, in one array.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::sampler) struct Forest {
    /// Nodes of all trees; each tree starts with its root, and positions count from the array's start.
    pub nodes: Vec<Node>,
    /// Position of each tree's root.
    pub roots: Vec<u32>,
    /// ∫ f dx dy over the disc at each knot: what a value is divided by to become a density.
    pub integrals: Vec<f32>,
    /// Sine and cosine of each knot's angle.
    pub directions: Vec<[f32; 2]>,
}

/// A leaf reached by a descent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaf {
    pub rect: Rect,
    pub bound: f32,
}

impl Forest {
    /// Bytes held by the arrays.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
            + size_of_val(self.roots.as_slice())
            + size_of_val(self.integrals.as_slice())
            + size_of_val(self.directions.as_slice())
    }

    pub fn leaves(&self) -> usize {
        self.nodes.iter().filter(|n| n.children == 0).count()
    }

    /// ∫ f dx dy of tree `k`; 0 for a material without light.
    #[inline]
    pub fn integral(&self, k: usize) -> f64 {
        f64::from(self.integrals[k])
    }

    /// Sine and cosine of knot `k`.
    pub fn knot(&self, k: usize) -> (f64, f64) {
        let [sin, cos] = self.directions[k];
        (f64::from(sin), f64::from(cos))
    }

    /// Arrays for the angles of `knots`.
    pub fn new(nodes: Vec<Node>, roots: Vec<u32>, integrals: Vec<f32>, knots: ThetaKnots) -> Self {
        let directions = (0..knots.count())
            .map(|k| {
                let (sin, cos) = knots.theta(k).sin_cos();
                [sin as f32, cos as f32]
            })
            .collect();
        Self { nodes, roots, integrals, directions }
    }

    /// Puts trees together whose positions count from their own starts, each with its integral.
    pub fn join(trees: &[(Vec<Node>, f64)], knots: ThetaKnots) -> Self {
        let (mut nodes, mut roots) = (Vec::new(), Vec::new());
        for (tree, _) in trees {
            let start = nodes.len() as u32;
            roots.push(start);
            let moved = |children: u32| if children == 0 { 0 } else { children + start };
            nodes.extend(tree.iter().map(|n| Node { children: moved(n.children), ..*n }));
        }
        Self::new(nodes, roots, trees.iter().map(|t| t.1 as f32).collect(), knots)
    }

    /// Weights of the four children of a node.
    #[inline]
    pub fn child_weights(&self, node: &Node) -> [f64; 4] {
        let first = node.children as usize;
        std::array::from_fn(|i| f64::from(self.nodes[first + i].weight))
    }

    /// Draws a leaf of tree `k` by `point.x` and leaves in `point` a point that is uniform again.
    ///
    /// The tree must have a positive weight.
    #[inline]
    pub(super) fn descend(&self, k: usize, point: &mut DVec2) -> Leaf {
        let mut node = self.nodes[self.roots[k] as usize];
        let mut square = Square::ROOT;
        let mut r = point.x * f64::from(node.weight);
        while node.children != 0 {
            let weights = self.child_weights(&node);
            let below = [0.0, weights[0], weights[0] + weights[1], weights[0] + weights[1] + weights[2]];
            let mut chosen =
                usize::from(r >= below[1]) + usize::from(r >= below[2]) + usize::from(r >= below[3]);
            // Weights are rounded, so `r` may run past the last child that has any; step back to it.
            while weights[chosen] <= 0.0 && chosen > 0 {
                chosen -= 1;
            }
            r = (r - below[chosen]).min(weights[chosen]);
            square = square.child(chosen);
            node = self.nodes[node.children as usize + chosen];
        }
        point.x = (r / f64::from(node.weight)).clamp(0.0, 1.0f64.next_down());
        Leaf::new(square, &node)
    }
}

impl Leaf {
    pub fn new(square: Square, node: &Node) -> Self {
        let rect = square.inside_disc().unwrap_or(Rect { low: square.corner, high: square.corner });
        Self { rect, bound: node.bound }
    }

    /// Direction at relative position `t` of the leaf, turned by the azimuth whose cosine and sine are `turn`; `None`
    /// outside the disc.
    #[inline]
    pub fn direction(&self, t: DVec2, turn: DVec2) -> Option<Vec3> {
        let p = self.rect.at(t);
        let z2 = 1.0 - p.length_squared();
        (z2 > 0.0).then(|| turn.rotate(p).extend(z2.sqrt()).as_vec3())
    }
}
