//! Quadtrees as their leaves in Z-order.
//!
//! Descending a quadtree by its children's conditional CDFs (thesis 6.2.2) is inverting one CDF over the leaves in the order
//! of a depth-first walk. Stored that way a tree needs no inner nodes, and a guide table (Chen and Asau 1974) finds the leaf
//! in a step or two, where the descent takes as many as the tree is deep.

use glam::{DVec2, Vec3};

use super::quad_cell::{QuadCell, Rect, z_place};

/// A leaf of twelve bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::sampler) struct Leaf {
    /// Probability of this leaf and all before it in its tree, in units of 1/[`WHOLE`].
    pub upper: u32,
    /// Upper bound of f in the leaf, > 0.
    pub bound: f32,
    /// The leaf's square: see [`QuadCell::code`].
    pub code: u32,
}

/// A probability of 1.
pub(in crate::sampler) const WHOLE: u32 = u32::MAX;
/// A tree's leaves are counted in 16 bits.
pub(in crate::sampler) const MOST_LEAVES: usize = u16::MAX as usize;

/// A tree for each angle of `wo`, in one array.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::sampler) struct Forest {
    /// Leaves of all trees.
    pub leaves: Vec<Leaf>,
    /// Where each tree's leaves start, and the number of all at the end.
    pub starts: Vec<u32>,
    /// ∫ f dx dy over the disc at each knot: what a value is divided by to become a density.
    pub integrals: Vec<f32>,
    /// For each tree the part of ∫ f that exceeds the leaves' bounds, of a BRDF whose bounds may be exceeded; none for a MERL
    /// table.
    pub excess: Vec<f32>,
    /// For each tree as many entries as leaves: the leaf that holds probability j/n.
    guide: Vec<u16>,
}

/// A tree's leaves in Z-order, and what its values are divided by.
#[derive(Clone, Debug)]
pub(super) struct GrownTree {
    pub leaves: Vec<Grown>,
    /// ∫ f dx dy over the disc, as far as f is within the leaves' bounds.
    pub integral: f64,
    /// The part of ∫ f that exceeds the bounds; `None` for a MERL table.
    pub excess: Option<f64>,
}

/// A leaf before its tree is complete.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grown {
    pub square: QuadCell,
    pub bound: f32,
    /// What the leaf is drawn in proportion to.
    pub weight: f64,
}

impl Grown {
    /// Bound times area.
    pub fn volume(&self) -> f64 {
        self.square
            .inside_disc()
            .map_or(0.0, |rect| rect.area() * f64::from(self.bound))
    }
}

/// A leaf that was drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drawn {
    pub rect: Rect,
    pub bound: f32,
    /// Position of the number drawn within the leaf's probability, uniform in [0, 1).
    pub rest: f64,
}

impl Forest {
    /// Leaves, starts and integrals; the guide is made here.
    pub fn new(leaves: Vec<Leaf>, starts: Vec<u32>, integrals: Vec<f32>, excess: Vec<f32>) -> Self {
        let guide = starts
            .windows(2)
            .flat_map(|w| guide(&leaves[w[0] as usize..w[1] as usize]))
            .collect();
        Self {
            leaves,
            starts,
            integrals,
            excess,
            guide,
        }
    }

    /// Puts trees together.
    pub(super) fn join(trees: &[GrownTree]) -> Self {
        let mut leaves = Vec::new();
        let mut starts = vec![0];
        for GrownTree { leaves: grown, .. } in trees {
            // The CDF over the leaves in fixed point. The last is exactly 1, so that every u < 1 finds a leaf.
            let total: f64 = grown.iter().map(|g| g.weight).sum();
            let mut sum = 0.0;
            leaves.extend(grown.iter().enumerate().map(|(i, g)| {
                sum += g.weight;
                let last = i + 1 == grown.len();
                let upper = if last {
                    WHOLE
                } else {
                    (sum / total * f64::from(WHOLE)) as u32
                };
                Leaf {
                    upper,
                    bound: g.bound,
                    code: g.square.code(),
                }
            }));
            starts.push(leaves.len() as u32);
        }
        let integrals = trees.iter().map(|t| t.integral as f32).collect();
        let excess = trees.iter().filter_map(|t| t.excess);
        Self::new(
            leaves,
            starts,
            integrals,
            excess.map(|e| e as f32).collect(),
        )
    }

    /// Bytes held by the arrays.
    pub fn bytes(&self) -> usize {
        size_of_val(self.leaves.as_slice())
            + size_of_val(self.starts.as_slice())
            + size_of_val(self.integrals.as_slice())
            + size_of_val(self.excess.as_slice())
            + size_of_val(self.guide.as_slice())
    }

    /// Leaves of tree `k`, in Z-order.
    #[inline]
    pub fn tree(&self, k: usize) -> &[Leaf] {
        &self.leaves[self.starts[k] as usize..self.starts[k + 1] as usize]
    }

    /// ∫ f dx dy of tree `k`; 0 for a material without light.
    #[inline]
    pub fn integral(&self, k: usize) -> f64 {
        f64::from(self.integrals[k])
    }

    /// Bound of the leaf of tree `k` that holds the point `p` of the disc, in the tree's own frame; 0 where there is none.
    #[inline]
    pub(super) fn bound_at(&self, k: usize, p: DVec2) -> f32 {
        // Leaves are in Z-order, so the last that begins at or before the point holds it, or none does.
        let place = z_place((p + 1.0) * 0.5);
        let leaves = self.tree(k);
        let after = leaves.partition_point(|leaf| QuadCell::z_range(leaf.code).0 <= place);
        let Some(leaf) = after.checked_sub(1).map(|i| &leaves[i]) else {
            return 0.0;
        };
        let (first, count) = QuadCell::z_range(leaf.code);
        if place - first < count {
            leaf.bound
        } else {
            0.0
        }
    }

    /// Trials that a draw from tree `k` takes on average, ΣV/∫f with V = M·A of a leaf; 0 for a tree without leaves.
    pub(super) fn trials(&self, k: usize) -> f64 {
        let mut volume = 0.0;
        for leaf in self.tree(k) {
            volume += f64::from(leaf.bound) * Drawn::new(leaf, 0.0).rect.area();
        }
        if volume > 0.0 {
            volume / self.integral(k)
        } else {
            0.0
        }
    }

    /// The leaf of tree `k` at probability `u` in [0, 1). The tree must have leaves.
    #[inline(always)]
    pub(super) fn draw(&self, k: usize, u: f64) -> Drawn {
        let leaves = self.tree(k);
        debug_assert!((0.0..=1.0).contains(&u) && !leaves.is_empty());
        // The guide's leaf holds ⌊u·n⌋/n ≤ u, so the leaf of u is that one or a later one.
        let r = u * f64::from(WHOLE);
        let start = self.starts[k] as usize;
        let mut i = usize::from(
            self.guide[start + ((u * leaves.len() as f64) as usize).min(leaves.len() - 1)],
        );
        while i + 1 < leaves.len() && f64::from(leaves[i].upper) <= r {
            i += 1;
        }
        // (u − F(i − 1))/(F(i) − F(i − 1)) is uniform again, and places the point in the leaf.
        let below = if i == 0 {
            0.0
        } else {
            f64::from(leaves[i - 1].upper)
        };
        let share = f64::from(leaves[i].upper) - below;
        let rest = if share > 0.0 {
            ((r - below) / share).clamp(0.0, 1.0f64.next_down())
        } else {
            0.0
        };
        Drawn::new(&leaves[i], rest)
    }
}

/// The leaf that holds probability j/n, for each j of n leaves.
fn guide(leaves: &[Leaf]) -> Vec<u16> {
    let n = leaves.len();
    let mut i = 0;
    (0..n)
        .map(|j| {
            let r = j as f64 / n as f64 * f64::from(WHOLE);
            while i + 1 < n && f64::from(leaves[i].upper) <= r {
                i += 1;
            }
            i as u16
        })
        .collect()
}

impl Drawn {
    pub fn new(leaf: &Leaf, rest: f64) -> Self {
        let square = QuadCell::of_code(leaf.code);
        let rect = square.inside_disc().unwrap_or(Rect {
            low: square.corner,
            high: square.corner,
        });
        Self {
            rect,
            bound: leaf.bound,
            rest,
        }
    }

    /// Direction at relative position `t` of the leaf, turned by the azimuth whose cosine and sine are `turn`; `None`
    /// outside the disc.
    #[inline]
    pub fn direction(&self, t: DVec2, turn: DVec2) -> Option<Vec3> {
        let p = self.rect.point(t);
        let z2 = 1.0 - p.length_squared();
        (z2 > 0.0).then(|| turn.rotate(p).extend(z2.sqrt()).as_vec3())
    }
}
