//! Growing the trees.

use glam::DVec2;
use rayon::prelude::*;

use super::bounds::MaxTable;
use super::quad_cell::{QuadCell, Rect};
use super::settings::{AdaptiveDiscSettings, Construction, LeafChoice};
use super::slice::Slice;
use super::tree::{Forest, Grown, MOST_LEAVES};
use super::trees::Trees;
use super::warp::{self, WarpGrower, Warps};
use crate::material::merl::MerlBrdf;
use crate::sampler::knots::ThetaKnots;

/// Points along each side of a node in the refined construction. Where leaves are drawn by their bounds, the integral only
/// decides on splits, and a rough one will do.
fn points_a_side(leaves: LeafChoice) -> usize {
    match leaves {
        LeafChoice::Envelope | LeafChoice::Warp => 4,
        LeafChoice::Integral => 8,
    }
}

/// What the differences of two rules for ∫ f may add up to in all bins. Every density is divided by ∫ f, and what that is off by
/// is a bias of every mean weight; it is less than a tenth of the differences, which are those of the poorer rule.
const NORMALISER_TOLERANCE: f64 = 1e-4;
/// How far lattices of ∫ f may differ where it only decides on divisions.
const DIVISION_TOLERANCE: f64 = 5e-3;
/// Values of ∫ f that f32 holds with all digits, the mean of what it is divided into included. Beyond, the uniform disc serves.
const USABLE: std::ops::RangeInclusive<f64> = 1e-30..=1e38;
/// Most trials a draw may need on average. A tree that is not allowed to be deep enough for its material is replaced by
/// the uniform disc.
pub(super) const MOST_TRIALS: f64 = 1000.0;
/// Leaves kept free for the squares that are open when a tree is full: three a level.
const SPARE: usize = 20;
/// Nodes above this depth are split unseen.
const COARSEST: u32 = 3;

/// Builds the trees of all knots, in parallel over knots.
pub(super) fn trees(brdf: &MerlBrdf, settings: &AdaptiveDiscSettings, knots: ThetaKnots) -> Trees {
    match settings.leaves {
        LeafChoice::Warp => Trees::Warped(warps(brdf, settings, knots)),
        LeafChoice::Envelope | LeafChoice::Integral => {
            Trees::Rejecting(forest(brdf, settings, knots))
        }
    }
}

fn warps(brdf: &MerlBrdf, settings: &AdaptiveDiscSettings, knots: ThetaKnots) -> Warps {
    let bounds = MaxTable::new(brdf, settings.importance);
    let trees: Vec<warp::Tree> = (0..knots.count())
        .into_par_iter()
        .map(|k| {
            let slice = Slice::new(brdf, settings, Some(&bounds), knots.theta(k));
            // A warp's density is that of its own probabilities. ∫ f only scales the waste that divisions are compared with.
            let integral = slice.rough_integral(DIVISION_TOLERANCE);
            if USABLE.contains(&integral) {
                WarpGrower {
                    settings,
                    slice: &slice,
                    bounds: &bounds,
                    integral,
                }
                .grow()
            } else {
                warp::Tree::void()
            }
        })
        .collect();
    let mut warps = Warps::default();
    trees.iter().for_each(|tree| warps.push(tree));
    warps
}

fn forest(brdf: &MerlBrdf, settings: &AdaptiveDiscSettings, knots: ThetaKnots) -> Forest {
    let bounds = matches!(settings.construction, Construction::Refined)
        .then(|| MaxTable::new(brdf, settings.importance));
    let trees: Vec<(Vec<Grown>, f64)> = (0..knots.count())
        .into_par_iter()
        .map(|k| {
            let slice = Slice::new(brdf, settings, bounds.as_ref(), knots.theta(k));
            // Step 1: ∫ f, by which accepted draws are normalised.
            let integral = slice.integral(NORMALISER_TOLERANCE);
            // Step 2: the leaves. Where ∫ f is not usable there are none, and the uniform disc is drawn from.
            let leaves = match (&settings.construction, &bounds) {
                _ if !USABLE.contains(&integral) => Vec::new(),
                (Construction::Grid(side), _) => {
                    Grower::new(settings, DiscImage::new(&slice, *side)).grow()
                }
                (_, Some(bounds)) => Grower::new(
                    settings,
                    PointValues {
                        slice: &slice,
                        bounds,
                        integral,
                    },
                )
                .grow(),
                (_, None) => Vec::new(),
            };
            // Step 3: a draw takes ΣV/∫f trials on average, with V = M·A of a leaf. Leaves that are chosen by V have the
            // density f/∫f. Those chosen by their own estimates I of ∫ f are normalised by ΣI.
            let drawn: f64 = leaves.iter().map(|l| l.weight).sum();
            let volume: f64 = leaves.iter().map(Grown::volume).sum();
            match settings.leaves {
                _ if leaves.is_empty() || volume > MOST_TRIALS * integral => (Vec::new(), 0.0),
                LeafChoice::Integral => (leaves, drawn),
                LeafChoice::Envelope | LeafChoice::Warp => (leaves, integral),
            }
        })
        .collect();
    Forest::join(&trees)
}

/// What a node's square holds, as far as it is known.
#[derive(Clone, Copy)]
struct Content {
    integral: f64,
    /// Largest value seen.
    seen: f64,
    area: f64,
}

/// Where the content of squares comes from.
trait Contents {
    /// Whether the square is split before a look at it.
    fn too_coarse(&self, depth: u32) -> bool;
    /// Whether the values allow a further split.
    fn too_fine(&self, square: QuadCell) -> bool;
    /// Integral and largest value over the square's part inside the disc.
    fn content(&self, square: QuadCell, rect: Rect) -> Content;
    /// The bound to draw under: at least `seen`.
    fn bound(&self, rect: Rect, content: &Content) -> f32;
    /// ∫ f over the disc.
    fn total(&self) -> f64;
}

/// Splits squares until each leaf needs at most `n_max` trials on average (algorithm 12), or wastes too few to matter.
struct Grower<'a, C> {
    settings: &'a AdaptiveDiscSettings,
    contents: C,
    wasted: f64,
    leaves: Vec<Grown>,
}

impl<'a, C: Contents> Grower<'a, C> {
    fn new(settings: &'a AdaptiveDiscSettings, contents: C) -> Self {
        let wasted = settings.waste * contents.total();
        Self {
            settings,
            contents,
            wasted,
            leaves: Vec::new(),
        }
    }

    /// The leaves that can be drawn, in Z-order.
    fn grow(mut self) -> Vec<Grown> {
        self.visit(QuadCell::ROOT, 0);
        self.leaves
    }

    fn visit(&mut self, square: QuadCell, depth: u32) {
        let Some(rect) = square.inside_disc() else {
            return;
        };
        // Step 1: near the root squares are split unseen, as few points say little about them.
        let has_room = depth < self.settings.depth && self.leaves.len() + 4 * SPARE < MOST_LEAVES;
        if has_room && self.contents.too_coarse(depth) {
            return self.split(square, depth);
        }
        // Step 2: the largest value seen is at most the bound, so a split that it asks for needs no bound.
        let content = self.contents.content(square, rect);
        let may_split = has_room && !self.contents.too_fine(square);
        if may_split && self.wants_split(&content, content.seen) {
            return self.split(square, depth);
        }
        // Step 3: the same with the true bound, which also finds peaks that no point met.
        let bound = self.contents.bound(rect, &content);
        if may_split && self.wants_split(&content, f64::from(bound)) {
            return self.split(square, depth);
        }
        // Step 4: a leaf, chosen in proportion to I = ∫ f over it or, under an envelope, to V = M·A.
        let weight = match self.settings.leaves {
            LeafChoice::Integral => content.integral,
            LeafChoice::Envelope | LeafChoice::Warp => f64::from(bound) * content.area,
        };
        if weight > 0.0 && bound > 0.0 {
            self.leaves.push(Grown {
                square,
                bound,
                weight,
            });
        }
    }

    /// I/V < 1/n_max (the printed inequality 6.6 is the wrong way round; algorithm 12 is right), with V under `bound`.
    fn wants_split(&self, content: &Content, bound: f64) -> bool {
        let volume = content.area * bound;
        content.integral * self.settings.n_max < volume && volume - content.integral > self.wasted
    }

    fn split(&mut self, square: QuadCell, depth: u32) {
        for i in 0..4 {
            self.visit(square.child(i), depth + 1);
        }
    }
}

/// Values at points of the square itself, bounds from the table.
struct PointValues<'a> {
    slice: &'a Slice<'a>,
    bounds: &'a MaxTable,
    integral: f64,
}

impl Contents for PointValues<'_> {
    fn too_coarse(&self, depth: u32) -> bool {
        depth < COARSEST
    }

    fn too_fine(&self, _: QuadCell) -> bool {
        false
    }

    fn content(&self, _: QuadCell, rect: Rect) -> Content {
        let (mut sum, mut seen) = (0.0, 0.0f64);
        // I = mean of f at the midpoints of a grid, times the area. Points beyond the rim count as 0.
        let side = points_a_side(self.slice.settings.leaves);
        for k in 0..side * side {
            let t = DVec2::new((k % side) as f64 + 0.5, (k / side) as f64 + 0.5) / side as f64;
            let f = self.slice.value_on_disc(rect.point(t));
            sum += f;
            seen = seen.max(f);
        }
        Content {
            integral: sum / (side * side) as f64 * rect.area(),
            seen,
            area: rect.area(),
        }
    }

    fn bound(&self, rect: Rect, _: &Content) -> f32 {
        self.bounds.over(self.slice.wo.as_dvec3(), rect)
    }

    fn total(&self) -> f64 {
        self.integral
    }
}

/// The thesis's image of f over [−1, 1]² (6.3.3): pixel centres, row by row.
struct DiscImage {
    side: usize,
    values: Vec<f32>,
    total: f64,
}

impl DiscImage {
    fn new(slice: &Slice<'_>, side: u32) -> Self {
        let n = side as usize;
        let mut values = Vec::with_capacity(n * n);
        for k in 0..n * n {
            // Pixel i has its centre at 2 (i + ½)/n − 1.
            let [x, y] = [k % n, k / n].map(|i| (i as f64 + 0.5) / n as f64 * 2.0 - 1.0);
            values.push(slice.value_on_disc(DVec2::new(x, y)) as f32);
        }
        // ∫ f dx dy = Σ f·(2/n)², where f is 0 outside the disc.
        let total = values.iter().map(|&v| f64::from(v)).sum::<f64>() * (2.0 / n as f64).powi(2);
        Self {
            side: n,
            values,
            total,
        }
    }

    /// Pixels whose centres lie in [low, low + side) of one axis.
    fn pixels(&self, low: f64, side: f64) -> std::ops::Range<usize> {
        self.first_pixel(low)..self.first_pixel(low + side).min(self.side)
    }

    /// The first pixel whose centre is not below `x` on one axis.
    fn first_pixel(&self, x: f64) -> usize {
        let position = (x + 1.0) * 0.5 * self.side as f64 - 0.5;
        position.ceil().max(0.0) as usize
    }
}

impl Contents for DiscImage {
    fn too_coarse(&self, _: u32) -> bool {
        false
    }

    /// Children of fewer than four pixels would be guesses.
    fn too_fine(&self, square: QuadCell) -> bool {
        square.side * 0.5 * (self.side as f64) < 8.0
    }

    fn content(&self, square: QuadCell, rect: Rect) -> Content {
        let (mut sum, mut seen) = (0.0, 0.0f64);
        for y in self.pixels(square.corner.y, square.side) {
            for x in self.pixels(square.corner.x, square.side) {
                let f = f64::from(self.values[y * self.side + x]);
                sum += f;
                seen = seen.max(f);
            }
        }
        Content {
            integral: sum * (2.0 / self.side as f64).powi(2),
            seen,
            area: rect.area(),
        }
    }

    fn bound(&self, _: Rect, content: &Content) -> f32 {
        content.seen as f32
    }

    fn total(&self) -> f64 {
        self.total
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::merl::LookupRule;
    use crate::material::merl::decode_embedded;
    use crate::points::Stream;
    use crate::sampler::TableChoice;
    use crate::sampler::adaptive_disc::tree::{Drawn, Leaf, WHOLE};
    use std::sync::Arc;

    fn volume(leaf: &Leaf) -> f64 {
        f64::from(leaf.bound) * Drawn::new(leaf, 0.0).rect.area()
    }

    /// The largest value over its leaf's bound, at `points` of each leaf of tree `k`.
    fn worst_share(
        forest: &Forest,
        k: usize,
        slice: &Slice,
        points: usize,
        random: &mut Stream,
    ) -> f64 {
        let mut worst = 0.0f64;
        for leaf in forest.tree(k).iter().map(|leaf| Drawn::new(leaf, 0.0)) {
            for _ in 0..points {
                let t = DVec2::new(random.next_f64(), random.next_f64());
                if let Some(wi) = leaf.direction(t, DVec2::X) {
                    worst = worst.max(slice.value(wi) / f64::from(leaf.bound));
                }
            }
        }
        worst
    }

    #[test]
    fn bounds_hold_and_trees_are_small_on_every_material() {
        let settings = AdaptiveDiscSettings::default();
        let knots = ThetaKnots::new(settings.tables, settings.choice).unwrap();
        crate::material::merl::embedded_names()
            .par_iter()
            .for_each(|name| {
                let brdf =
                    MerlBrdf::new(Arc::new(decode_embedded(name).unwrap()), LookupRule::Floor);
                let forest = forest(&brdf, &settings, knots);
                assert!(
                    forest.bytes() < 1_000_000,
                    "{name}: {} bytes",
                    forest.bytes()
                );
                let mut random = Stream::new(2);
                for k in 0..settings.tables {
                    let slice = Slice::new(&brdf, &settings, None, knots.theta(k));
                    let worst = worst_share(&forest, k, &slice, 20, &mut random);
                    assert!(
                        worst <= 1.0,
                        "{name}, knot {k}: a value {worst} times the bound"
                    );
                }
            });
    }

    #[test]
    fn no_value_exceeds_its_leafs_bound() {
        for (name, rule) in [
            ("chrome", LookupRule::Floor),
            ("black-obsidian", LookupRule::Floor),
            ("nickel", LookupRule::Linear),
            ("violet-acrylic", LookupRule::Centred),
        ] {
            let brdf = MerlBrdf::new(Arc::new(decode_embedded(name).unwrap()), rule);
            let settings = AdaptiveDiscSettings {
                tables: 9,
                ..Default::default()
            };
            let knots = ThetaKnots::new(9, TableChoice::Nearest).unwrap();
            let forest = forest(&brdf, &settings, knots);
            let mut random = Stream::new(1);
            for k in 0..9 {
                let slice = Slice::new(&brdf, &settings, None, knots.theta(k));
                let worst = worst_share(&forest, k, &slice, 100, &mut random);
                assert!(
                    worst <= 1.0,
                    "{name}, knot {k}: a value {worst} times the bound"
                );
                assert!(
                    worst > 0.8,
                    "{name}, knot {k}: the bounds are slack, at best {worst}"
                );
                let volume: f64 = forest.tree(k).iter().map(volume).sum();
                let trials = volume / forest.integral(k);
                assert!(
                    (1.0..3.0).contains(&trials),
                    "{name}, knot {k}: {trials} trials a draw"
                );
                assert_eq!(forest.tree(k).last().unwrap().upper, WHOLE);
            }
        }
    }

    /// What the refined construction mends: under the thesis's image, metals exceed their bounds.
    #[test]
    fn the_image_of_the_thesis_gives_no_bounds() {
        let brdf = MerlBrdf::new(
            Arc::new(decode_embedded("chrome").unwrap()),
            LookupRule::Floor,
        );
        let settings = AdaptiveDiscSettings {
            tables: 3,
            ..AdaptiveDiscSettings::as_published()
        };
        let knots = ThetaKnots::new(3, TableChoice::Nearest).unwrap();
        let forest = forest(&brdf, &settings, knots);
        let slice = Slice::new(&brdf, &settings, None, knots.theta(1));
        let (mut random, mut exceeded) = (Stream::new(1), 0);
        for leaf in forest.tree(1).iter().map(|leaf| Drawn::new(leaf, 0.0)) {
            for _ in 0..100 {
                let t = DVec2::new(random.next_f64(), random.next_f64());
                let value = leaf
                    .direction(t, DVec2::X)
                    .map_or(0.0, |wi| slice.value(wi));
                exceeded += u32::from(value > f64::from(leaf.bound));
            }
        }
        assert!(exceeded > 0);
    }
}
