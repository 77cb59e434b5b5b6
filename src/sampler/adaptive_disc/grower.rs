//! Splitting squares into leaves.

use super::quad_cell::{QuadCell, Rect};
use super::settings::{AdaptiveDiscSettings, LeafChoice};
use super::tree::{Grown, MOST_LEAVES};

/// Leaves kept free for the squares that are open when a tree is full: three a level.
const SPARE: usize = 20;

/// What a node's square holds, as far as it is known.
#[derive(Clone, Copy)]
pub(super) struct Content {
    pub integral: f64,
    /// Largest value seen, with a margin where that is the bound.
    pub seen: f64,
    pub area: f64,
}

/// Where the content of squares comes from.
pub(super) trait Contents {
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
    /// What a square must waste at least to be split, whatever the settings say.
    fn least_waste(&self, _: QuadCell) -> f64 {
        0.0
    }
}

/// Splits squares until each leaf needs at most `n_max` trials on average (algorithm 12), or wastes too few to matter.
pub(super) struct Grower<'a, C> {
    settings: &'a AdaptiveDiscSettings,
    contents: C,
    wasted: f64,
    leaves: Vec<Grown>,
}

impl<'a, C: Contents> Grower<'a, C> {
    pub fn new(settings: &'a AdaptiveDiscSettings, contents: C) -> Self {
        let wasted = settings.waste * contents.total();
        Self {
            settings,
            contents,
            wasted,
            leaves: Vec::new(),
        }
    }

    /// The leaves that can be drawn, in Z-order.
    pub fn grow(mut self) -> Vec<Grown> {
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
        let wasted = self.wasted.max(self.contents.least_waste(square));
        if may_split && self.wants_split(&content, content.seen, wasted) {
            return self.split(square, depth);
        }
        // Step 3: the same with the true bound, which also finds peaks that no point met.
        let bound = self.contents.bound(rect, &content);
        if may_split && self.wants_split(&content, f64::from(bound), wasted) {
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
    fn wants_split(&self, content: &Content, bound: f64, wasted: f64) -> bool {
        let volume = content.area * bound;
        content.integral * self.settings.n_max < volume && volume - content.integral > wasted
    }

    fn split(&mut self, square: QuadCell, depth: u32) {
        for i in 0..4 {
            self.visit(square.child(i), depth + 1);
        }
    }
}
