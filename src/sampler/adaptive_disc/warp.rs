//! Trees that are drawn from without rejection: a hierarchical warp of the unit square (Clarberg et al. 2005), and from the
//! square to the disc by the concentric map.
//!
//! At every node the point's x chooses a half and is stretched to the unit interval again, then y within that half, down to
//! a leaf, where what is left places the point. The map is continuous along each axis and takes two numbers in all, so
//! well-spread points stay well spread. The square is mapped to the disc rather than laid over it: that way the rim is an
//! edge of the quadtree, and no leaf loses draws outside the disc. The concentric map preserves area, so a leaf's density per
//! projected solid angle is its probability over its area. Draws have exactly this density, even where the masses that
//! the probabilities came from are inexact.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4, PI};

use glam::{DVec2, DVec3, Vec3};

use super::bounds::MaxTable;
use super::quad_cell::{DEEPEST, Rect};
use super::scouts::Scouts;
use super::settings::AdaptiveDiscSettings;
use super::slice::Slice;
use crate::geometry::{concentric_disc, concentric_square};
use crate::sampler::knots::split_unit;

/// A square divided into four, twelve bytes. Child 0..4: bit 0 is the upper half in x, bit 1 in y.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::sampler) struct Node {
    /// Probabilities in units of 1/65535: of the lower half in x, and of the lower half in y within the lower and the upper x.
    pub split: [u16; 3],
    /// Which children are nodes, one bit each; the others are leaves.
    pub inner: u16,
    /// The first child that is a node; the others follow it.
    pub first: u32,
}

/// Draws keep this far from the edge of the square.
const RIM: f64 = 1e-12;
const SHARE: f64 = 1.0 / u16::MAX as f64;

impl Node {
    /// Probability of the lower half in x (axis 0), or in y within the lower (1) or upper half (2) in x.
    #[inline]
    fn share(&self, axis: usize) -> f64 {
        f64::from(self.split[axis]) * SHARE
    }

    /// Probability of child `i` within the node.
    pub(super) fn child_share(&self, i: usize) -> f64 {
        let (right, upper) = (i & 1, i >> 1);
        let (lower_x, lower_y) = (self.share(0), self.share(1 + right));
        let x = if right == 1 { 1.0 - lower_x } else { lower_x };
        let y = if upper == 1 { 1.0 - lower_y } else { lower_y };
        x * y
    }

    /// The node of child `i`, if it is one.
    #[inline]
    pub(super) fn child(&self, i: usize) -> Option<usize> {
        let before = self.inner & ((1 << i) - 1);
        (self.inner >> i & 1 == 1).then(|| (self.first + before.count_ones()) as usize)
    }
}

/// A tree for each angle of `wo`, in one array.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::sampler) struct Warps {
    pub nodes: Vec<Node>,
    /// The root of each tree, and the number of nodes at the end. A tree without nodes has no mass.
    pub starts: Vec<u32>,
}

impl Warps {
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.starts.as_slice())
    }

    #[inline]
    pub fn is_void(&self, k: usize) -> bool {
        self.starts[k] == self.starts[k + 1]
    }

    /// Point of the disc at `u` in [0, 1)². The tree must not be void.
    #[inline]
    pub fn draw(&self, k: usize, mut u: DVec2) -> DVec2 {
        let mut corner = DVec2::ZERO;
        let mut side = 1.0;
        let mut node = Some(self.starts[k] as usize);
        while let Some(n) = node.map(|n| self.nodes[n]) {
            // x chooses a half, then y one within that half. What is left of each is uniform in [0, 1) again.
            let (left, x) = split_unit(u.x, n.share(0));
            let (low, y) = split_unit(u.y, n.share(1 + usize::from(!left)));
            (u, side) = (DVec2::new(x, y), side * 0.5);
            let child = usize::from(!left) | usize::from(!low) << 1;
            corner += side * DVec2::new((child & 1) as f64, (child >> 1) as f64);
            node = n.child(child);
        }
        // The rim itself is the horizon, where a draw would fail.
        concentric_disc((corner + side * u).clamp(DVec2::splat(RIM), DVec2::splat(1.0 - RIM)))
    }

    /// Density at a point of the disc per unit area. The tree must not be void.
    #[inline]
    pub fn density(&self, k: usize, p: DVec2) -> f64 {
        let mut at = concentric_square(p);
        // 1/π on the whole disc, times 4·P(child) a level, as a child has a quarter of its parent's area.
        let mut density = FRAC_1_PI;
        let mut node = Some(self.starts[k] as usize);
        while let Some(n) = node.map(|n| self.nodes[n]) {
            at *= 2.0;
            let (right, high) = (at.x >= 1.0, at.y >= 1.0);
            let lower = [n.share(0), n.share(1 + usize::from(right))];
            density *= if right { 1.0 - lower[0] } else { lower[0] } * 2.0;
            density *= if high { 1.0 - lower[1] } else { lower[1] } * 2.0;
            at -= DVec2::new(f64::from(u8::from(right)), f64::from(u8::from(high)));
            node = n.child(usize::from(right) | usize::from(high) << 1);
        }
        density
    }

    /// Adds a tree.
    pub(super) fn push(&mut self, tree: &Tree) {
        if self.starts.is_empty() {
            self.starts.push(0);
        }
        if let (true, Some(children)) = (tree.mass > 0.0, &tree.children) {
            // Breadth first: a node's children that are nodes become neighbours, so that one index finds all of them. The
            // first of them comes after this node and all that wait.
            let mut open = std::collections::VecDeque::from([children]);
            while let Some(children) = open.pop_front() {
                let inner = (0..4).filter(|&i| children[i].children.is_some());
                self.nodes.push(Node {
                    split: splits(&children.each_ref().map(|c| c.mass)),
                    inner: inner.map(|i| 1 << i).sum(),
                    first: (self.nodes.len() + 1 + open.len()) as u32,
                });
                open.extend(children.iter().filter_map(|c| c.children.as_ref()));
            }
        }
        self.starts.push(self.nodes.len() as u32);
    }
}

/// Probabilities of the lower halves, in x and then in y within each half.
fn splits(mass: &[f64; 4]) -> [u16; 3] {
    [
        split(mass[0] + mass[2], mass[1] + mass[3]),
        split(mass[0], mass[2]),
        split(mass[1], mass[3]),
    ]
}

/// Probability of the lower of two halves in units of 1/`u16::MAX`; a half that has mass keeps at least one unit.
fn split(low: f64, high: f64) -> u16 {
    let units = (low / (low + high) * f64::from(u16::MAX)).round() as u16;
    units.clamp(u16::from(low > 0.0), u16::MAX - u16::from(high > 0.0))
}

/// A tree as it grows.
pub(super) struct Tree {
    mass: f64,
    children: Option<Box<[Tree; 4]>>,
}

impl Tree {
    /// A tree without mass.
    pub const fn void() -> Self {
        Self {
            mass: 0.0,
            children: None,
        }
    }
}

/// Values of ∫ f that f32 holds with all digits, the mean of what it is divided into included. Beyond, the uniform disc serves.
pub(super) const USABLE: std::ops::RangeInclusive<f64> = 1e-30..=1e38;
/// Points along each side of a square.
const POINTS: usize = 4;
/// Squares above this depth are divided unseen.
const COARSEST: u32 = 3;
/// A leaf may add this part of `waste` to the squared relative deviation of weights.
const VARIANCE: f64 = 0.01;
/// Most nodes of a tree: 786 KB. Where `waste` asks for more, as on white noise, it is raised until they are enough.
const MOST_NODES: usize = 1 << 16;
/// How often `waste` is raised fourfold before the depth is held to one at which a full tree fits.
const RAISES: i32 = 16;
const FULL: u32 = 8;

/// The largest value that a cell of the square may hold.
pub(super) trait CellBounds {
    fn over_cell(&self, cell: Rect) -> f64;
}

/// Bounds of a MERL table for one `wo`.
pub(super) struct TableBounds<'a> {
    pub table: &'a MaxTable,
    pub wo: DVec3,
}

impl CellBounds for TableBounds<'_> {
    fn over_cell(&self, cell: Rect) -> f64 {
        f64::from(self.table.over(self.wo, box_on_disc(cell)))
    }
}

/// What scouts met: no bound for certain, and a warp needs none.
impl CellBounds for Scouts {
    fn over_cell(&self, cell: Rect) -> f64 {
        self.largest(cell.low, cell.high.x - cell.low.x)
    }
}

/// Divides squares until f is even enough in each.
pub(super) struct WarpGrower<'a, B> {
    pub settings: &'a AdaptiveDiscSettings,
    pub slice: &'a Slice<'a>,
    pub bounds: &'a B,
    /// ∫ f over the disc.
    pub integral: f64,
}

/// The bounds that a tree must keep as it grows; `nodes` is what is left of them.
struct Allowance {
    waste: f64,
    depth: u32,
    nodes: usize,
}

impl<B: CellBounds> WarpGrower<'_, B> {
    pub fn grow(&self) -> Tree {
        if !USABLE.contains(&self.integral) {
            return Tree::void();
        }
        let root = Rect {
            low: DVec2::ZERO,
            high: DVec2::ONE,
        };
        // The waste is raised fourfold until the nodes are enough; at the last, the depth is held to that of a full tree.
        for raise in 0..=RAISES {
            let waste = match raise {
                0 => self.settings.waste,
                _ => self.settings.waste.max(1e-6) * 4f64.powi(raise),
            };
            let deepest = if raise < RAISES { DEEPEST } else { FULL };
            let mut left = Allowance {
                waste,
                depth: self.settings.depth.min(DEEPEST).min(deepest),
                nodes: MOST_NODES,
            };
            if let Some(tree) = self.visit(root, 0, &mut left) {
                return tree;
            }
        }
        Tree::void()
    }

    /// The tree of a cell; `None` if the nodes run out.
    fn visit(&self, cell: Rect, depth: u32, left: &mut Allowance) -> Option<Tree> {
        // The concentric map takes the unit square, of area 1, to the disc, of area π, with one ratio everywhere.
        let area = PI * cell.area();
        if depth >= COARSEST.min(self.settings.depth) {
            let (mean, square) = self.moments(cell);
            if depth >= left.depth || !self.is_uneven(cell, area, [mean, square], left.waste) {
                return Some(Tree {
                    mass: mean * area,
                    children: None,
                });
            }
        }
        left.nodes = left.nodes.checked_sub(1)?;
        let half = (cell.high - cell.low) * 0.5;
        let mut children = [const { Tree::void() }; 4];
        for (i, child) in (0u32..).zip(&mut children) {
            let low = cell.low + half * DVec2::new(f64::from(i & 1), f64::from(i >> 1));
            let high = low + half;
            *child = self.visit(Rect { low, high }, depth + 1, left)?;
        }
        Some(Tree {
            mass: children.iter().map(|c| c.mass).sum(),
            children: Some(Box::new(children)),
        })
    }

    /// Mean of f and of its square over a cell of the square.
    fn moments(&self, cell: Rect) -> (f64, f64) {
        let (mut sum, mut squares) = (0.0, 0.0);
        for k in 0..POINTS * POINTS {
            // The map takes all points of a cell into the disc, so that each of the midpoints counts.
            let t =
                DVec2::new((k % POINTS) as f64 + 0.5, (k / POINTS) as f64 + 0.5) / POINTS as f64;
            let f = self.slice.value_on_disc(concentric_disc(cell.point(t)));
            sum += f;
            squares += f * f;
        }
        let n = (POINTS * POINTS) as f64;
        (sum / n, squares / n)
    }

    /// Whether the weights of a cell spread enough to matter, or a peak that no point met may hide in it.
    fn is_uneven(&self, cell: Rect, area: f64, [mean, square]: [f64; 2], waste: f64) -> bool {
        // Drawn with the density m/∫f, m = E[f], the leaf adds A·(E[f²]/m − m)/∫f to Var[w]/E[w]² of the weights.
        let spread = if mean > 0.0 {
            (square / mean - mean) * area
        } else {
            0.0
        };
        if spread > VARIANCE * waste * self.integral {
            return true;
        }
        // A peak between the points has at most the mass (M − m)·A, M being the bound. It matters where M is far
        // above m and this mass exceeds the waste.
        let bound = self.bounds.over_cell(cell);
        bound > self.settings.n_max * mean && (bound - mean) * area > waste * self.integral
    }
}

/// Bounding rectangle on the disc of a cell of the square that lies in one of its quadrants.
fn box_on_disc(cell: Rect) -> Rect {
    let centred = Rect {
        low: cell.low * 2.0 - 1.0,
        high: cell.high * 2.0 - 1.0,
    };
    let sign = DVec2::new(
        if centred.low.x < 0.0 { -1.0 } else { 1.0 },
        if centred.low.y < 0.0 { -1.0 } else { 1.0 },
    );
    let (a, b) = (centred.low * sign, centred.high * sign);
    let (near, far) = (a.min(b), a.max(b));
    // The azimuth rises with y and falls with x.
    let least = concentric_azimuth(far.x, near.y);
    let most = concentric_azimuth(near.x.max(1e-300), far.y);
    // The radius is the larger coordinate. In a quadrant x = r·cos φ is least at the inner radius and the largest φ,
    // and y = r·sin φ at the inner radius and the least φ.
    let (inside, outside) = (near.max_element(), far.max_element());
    let low = inside * DVec2::new(most.cos().max(0.0), least.sin());
    let high = outside * DVec2::new(least.cos(), most.sin());
    let (low, high) = (low * sign, high * sign);
    Rect {
        low: low.min(high),
        high: low.max(high),
    }
}

/// Azimuth on the disc of a point of the first quadrant of the square: π/4 · y/x below the diagonal, π/2 − π/4 · x/y above.
fn concentric_azimuth(x: f64, y: f64) -> f64 {
    if x > y {
        FRAC_PI_4 * y / x
    } else if y > 0.0 {
        FRAC_PI_2 - FRAC_PI_4 * x / y
    } else {
        0.0
    }
}

/// The direction over a point of the disc, turned by the azimuth whose cosine and sine are `turn`.
#[inline]
pub(super) fn direction(p: DVec2, turn: DVec2) -> Vec3 {
    turn.rotate(p)
        .extend((1.0 - p.length_squared()).max(0.0).sqrt())
        .as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::FibonacciLattice;

    fn tree(mass: f64) -> Tree {
        Tree {
            mass,
            children: None,
        }
    }

    fn inner(children: [Tree; 4]) -> Tree {
        Tree {
            mass: children.iter().map(|c| c.mass).sum(),
            children: Some(Box::new(children)),
        }
    }

    fn warps() -> Warps {
        let mut warps = Warps::default();
        warps.push(&tree(0.0));
        let deep = inner([
            tree(1e-9),
            tree(0.0),
            inner([tree(1.0), tree(2.0), tree(0.5), tree(4.0)]),
            tree(3.0),
        ]);
        warps.push(&inner([
            tree(1.0),
            deep,
            tree(0.0),
            inner([tree(1.0), tree(1.0), tree(9.0), tree(0.0)]),
        ]));
        warps
    }

    #[test]
    fn densities_integrate_to_one_and_draws_follow_them() {
        let warps = warps();
        assert!(warps.is_void(0) && !warps.is_void(1));
        assert_eq!(warps.starts, [0, 0, 4]);
        let (mut uniform, mut inverse) = (0.0, 0.0);
        let lattice = FibonacciLattice::at_least(50_000);
        for (x, y) in lattice.points() {
            uniform += warps.density(1, concentric_disc(DVec2::new(x, y))) * PI;
            inverse += 1.0 / (PI * warps.density(1, warps.draw(1, DVec2::new(x, y))));
        }
        let n = lattice.size() as f64;
        assert!((uniform / n - 1.0).abs() < 2e-3, "{}", uniform / n);
        // What is drawn from: without a quarter and two sixteenths of no mass, and one of next to none.
        let (empty, found) = (1.0 / 4.0 + 3.0 / 16.0, inverse / n);
        assert!((found - (1.0 - empty)).abs() < 0.05, "{found}");
    }

    #[test]
    fn the_map_is_continuous_within_leaves_and_stays_inside() {
        let warps = warps();
        for (x, y) in FibonacciLattice::at_least(2000).points() {
            let (u, step) = (DVec2::new(x, y), DVec2::new(1e-9, 1e-9));
            let (p, q) = (
                warps.draw(1, u),
                warps.draw(1, (u + step).min(DVec2::splat(0.999_999_999))),
            );
            assert!(p.length_squared() < 1.0 && warps.density(1, p) > 0.0, "{u}");
            let jump = (p - q).length();
            assert!(
                jump < 1e-3 || warps.density(1, p) != warps.density(1, q),
                "{u}: {jump}"
            );
        }
        for corner in [DVec2::ZERO, DVec2::splat(1.0f64.next_down())] {
            assert!(warps.draw(1, corner).length_squared() < 1.0);
        }
    }

    #[test]
    fn boxes_hold_their_cells() {
        for depth in 1..6 {
            let cells = 1 << depth;
            let side = 1.0 / f64::from(cells);
            for k in 0..cells * cells {
                let low = DVec2::new(f64::from(k % cells), f64::from(k / cells)) * side;
                let cell = Rect {
                    low,
                    high: low + side,
                };
                let bounds = box_on_disc(cell);
                for (x, y) in FibonacciLattice::at_least(50).points() {
                    let p = concentric_disc(cell.point(DVec2::new(x, y)));
                    let inside =
                        p.cmpge(bounds.low - 1e-12).all() && p.cmple(bounds.high + 1e-12).all();
                    assert!(inside, "{cell:?} {bounds:?} {p}");
                }
            }
        }
    }
}
