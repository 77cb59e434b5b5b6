//! Draws and densities of many lanes at once.
//!
//! A draw waits for f several times: once a trial, then once for each tree that could have drawn it. In a batch the lanes of a
//! block ask for f together, through the BRDF's own batches, which take a third of the time of single calls.

use glam::{DVec3, Vec2, Vec3};

use super::density::{DensityTarget, KnotDraw};
use super::disc::{AdaptiveDisc, PlacedTree, TreeView};
use super::draw::{LeafTrial, MAX_TRIALS, refine_point};
use super::tree::Forest;
use super::trees::Trees;
use crate::batch::Wo;
use crate::color::Rgb;
use crate::direction_sampler::DirectionSample;
use crate::geometry::{cosine_hemisphere, is_upper, unit_upper};
use crate::points::Stream;

/// Lanes of a block; its arrays fit in the first level of cache.
const LANES: usize = 32;
/// Values of f that the densities of a block need at most: those of two origins for each of four trees.
const MOST_VALUES: usize = 8 * LANES;

/// Draws of a batch.
pub(super) fn sample(
    disc: &AdaptiveDisc,
    wo: Wo<'_>,
    u: &[Vec2],
    out: &mut [Option<DirectionSample>],
) {
    let views = BatchViews::new(disc, wo);
    let mut block = DiscBlock::new();
    let mut values = Values::new();
    for (number, out) in out.chunks_mut(LANES).enumerate() {
        let lanes = number * LANES..number * LANES + out.len();
        block.load_views(&views, wo.lanes(lanes.clone()), out.len());
        block.choose_trees(disc, &u[lanes]);
        if let Trees::Rejecting(forest) = &disc.trees {
            block.accept_draws(disc, forest, &mut values);
        }
        block.carry_draws(disc);
        block.find_densities(disc, &mut values);
        for (lane, out) in out.iter_mut().enumerate() {
            *out = block.sample(disc, lane);
        }
    }
}

/// Densities of a batch.
pub(super) fn pdf(disc: &AdaptiveDisc, wo: Wo<'_>, wi: &[Vec3], out: &mut [f32]) {
    let views = BatchViews::new(disc, wo);
    let mut block = DiscBlock::new();
    let mut values = Values::new();
    for (number, out) in out.chunks_mut(LANES).enumerate() {
        let lanes = number * LANES..number * LANES + out.len();
        block.load_views(&views, wo.lanes(lanes.clone()), out.len());
        block.load_targets(&wi[lanes]);
        block.find_densities(disc, &mut values);
        for (lane, out) in out.iter_mut().enumerate() {
            *out = block.density(disc, lane);
        }
    }
}

/// What all lanes see of the trees, if `wo` is the same in all.
struct BatchViews<'a> {
    disc: &'a AdaptiveDisc,
    one: Option<TreeView>,
}

impl<'a> BatchViews<'a> {
    fn new(disc: &'a AdaptiveDisc, wo: Wo<'_>) -> Self {
        let one = match wo {
            Wo::One(wo) => unit_upper(wo).map(|wo| disc.view(wo)),
            Wo::Each(_) => None,
        };
        Self { disc, one }
    }
}

/// Lanes that go through the steps together.
struct DiscBlock {
    views: [Option<TreeView>; LANES],
    /// How many lanes are in use.
    count: usize,
    /// The tree that each lane draws from; none for the floor.
    slots: [Option<usize>; LANES],
    /// What that tree drew for its own direction.
    drawn: [Option<KnotDraw>; LANES],
    /// The direction asked for or drawn, among the azimuths that have trees.
    wi: [Option<Vec3>; LANES],
    /// The trees' densities there.
    densities: [[f64; 4]; LANES],
    trials: Trials,
}

/// The lanes whose draws are not accepted yet, and where they try next.
struct Trials {
    next: [Option<LeafTrial>; LANES],
    random: [Stream; LANES],
    /// Numbers of the lanes, the first `count` of them.
    lanes: [usize; LANES],
    count: usize,
}

/// Values of f for directions of trees, asked for together.
struct Values {
    wo: [Vec3; MOST_VALUES],
    wi: [Vec3; MOST_VALUES],
    f: [Rgb; MOST_VALUES],
    asked: [Asked; MOST_VALUES],
    count: usize,
}

/// Who asked for a value.
#[derive(Clone, Copy, Debug, Default)]
struct Asked {
    lane: usize,
    slot: usize,
    /// The level that f must exceed for a draw to be accepted, or the stretch of a density.
    number: f64,
}

impl Values {
    #[inline(always)]
    fn new() -> Self {
        Self {
            wo: [Vec3::ZERO; MOST_VALUES],
            wi: [Vec3::ZERO; MOST_VALUES],
            f: [Rgb::ZERO; MOST_VALUES],
            asked: [Asked::default(); MOST_VALUES],
            count: 0,
        }
    }

    /// Asks for f at `wi` for a tree's own direction.
    #[inline(always)]
    fn ask(&mut self, knot: DVec3, wi: Vec3, asked: Asked) {
        self.wo[self.count] = knot.as_vec3();
        self.wi[self.count] = wi;
        self.asked[self.count] = asked;
        self.count += 1;
    }

    /// Finds all values that were asked for.
    fn evaluate(&mut self, disc: &AdaptiveDisc) {
        let asked = 0..self.count;
        let wo = Wo::Each(&self.wo[asked.clone()]);
        let brdf = disc.material.brdf();
        brdf.eval_batch(wo, &self.wi[asked.clone()], &mut self.f[asked]);
    }

    /// The scalar of a value.
    #[inline(always)]
    fn scalar(&self, number: usize, disc: &AdaptiveDisc) -> f64 {
        f64::from(disc.settings.importance.reduce(self.f[number]))
    }
}

impl Trials {
    #[inline(always)]
    fn open(&mut self, lane: usize) {
        self.lanes[self.count] = lane;
        self.count += 1;
    }
}

impl DiscBlock {
    #[inline(always)]
    fn new() -> Self {
        Self {
            views: [None; LANES],
            count: 0,
            slots: [None; LANES],
            drawn: [None; LANES],
            wi: [None; LANES],
            densities: [[0.0; 4]; LANES],
            trials: Trials {
                next: [None; LANES],
                random: std::array::from_fn(|_| Stream::new(0)),
                lanes: [0; LANES],
                count: 0,
            },
        }
    }

    /// Takes the `wo` of up to [`LANES`] lanes.
    fn load_views(&mut self, views: &BatchViews<'_>, wo: Wo<'_>, count: usize) {
        self.count = count;
        for lane in 0..count {
            self.views[lane] = match wo {
                Wo::One(_) => views.one,
                Wo::Each(wo) => unit_upper(wo[lane]).map(|wo| views.disc.view(wo)),
            };
        }
    }

    /// Takes the directions whose density is asked for.
    fn load_targets(&mut self, wi: &[Vec3]) {
        for (lane, &wi) in wi.iter().enumerate() {
            self.wi[lane] = match (&self.views[lane], unit_upper(wi)) {
                (Some(view), Some(wi)) => Some(wi * view.signs),
                _ => None,
            };
        }
    }

    /// Chooses a tree for each lane, or the floor, and draws where a tree needs no trials.
    fn choose_trees(&mut self, disc: &AdaptiveDisc, u: &[Vec2]) {
        self.trials.count = 0;
        for (lane, &u) in u.iter().enumerate() {
            (self.slots[lane], self.drawn[lane], self.wi[lane]) = (None, None, None);
            let Some(view) = &self.views[lane] else {
                continue;
            };
            let (u, random) = refine_point(u);
            let (slot, point) = disc.choose(view, u);
            self.slots[lane] = slot;
            let Some(slot) = slot else {
                let wi = cosine_hemisphere(point).as_vec3();
                self.wi[lane] = is_upper(wi).then_some(wi);
                continue;
            };
            let tree = view.tree(slot);
            match &disc.trees {
                Trees::Rejecting(forest) if forest.integral(tree.index) > 0.0 => {
                    self.trials.next[lane] = Some(LeafTrial::new(forest, tree, point));
                    self.trials.random[lane] = random;
                    self.trials.open(lane);
                }
                _ => self.drawn[lane] = Some(disc.draw_without_trials(tree, point)),
            }
        }
    }

    /// Tries points of leaves until every lane has accepted one. All lanes try at the same time.
    fn accept_draws(&mut self, disc: &AdaptiveDisc, forest: &Forest, values: &mut Values) {
        for _ in 0..MAX_TRIALS {
            if self.trials.count == 0 {
                return;
            }
            // Step 1: a point and a level for each lane. One outside the disc is rejected unseen.
            let open = self.trials.count;
            (self.trials.count, values.count) = (0, 0);
            for number in 0..open {
                let lane = self.trials.lanes[number];
                self.propose(disc, forest, values, lane);
            }
            // Step 2: f at these points; a draw is accepted where f exceeds its level.
            values.evaluate(disc);
            for number in 0..values.count {
                self.judge(disc, forest, values, number);
            }
        }
    }

    /// Asks for f at the next point of a lane.
    #[inline(always)]
    fn propose(&mut self, disc: &AdaptiveDisc, forest: &Forest, values: &mut Values, lane: usize) {
        let Some((tree, trial)) = self.trial(lane) else {
            return;
        };
        let Some(wi) = trial.leaf.direction(trial.point, tree.turn) else {
            self.try_again(disc, forest, lane);
            return;
        };
        let level = self.trials.random[lane].next_f64() * f64::from(trial.leaf.bound);
        let asked = Asked {
            lane,
            slot: 0,
            number: level,
        };
        values.ask(disc.knot_direction(tree), wi, asked);
    }

    /// Accepts a point whose f is known, or lets its lane try again.
    #[inline(always)]
    fn judge(&mut self, disc: &AdaptiveDisc, forest: &Forest, values: &Values, number: usize) {
        let Asked {
            lane,
            number: level,
            ..
        } = values.asked[number];
        let value = values.scalar(number, disc);
        if level >= value {
            self.try_again(disc, forest, lane);
            return;
        }
        if let Some((tree, _)) = self.trial(lane) {
            let wi = values.wi[number];
            let density = disc.density_of_value(forest, tree, wi, value);
            self.drawn[lane] = Some(KnotDraw { wi, density });
        }
    }

    #[inline(always)]
    fn try_again(&mut self, disc: &AdaptiveDisc, forest: &Forest, lane: usize) {
        if let Some((tree, mut trial)) = self.trial(lane) {
            let random = &mut self.trials.random[lane];
            trial.start_anew(forest, tree, disc.settings.leaves, random);
            self.trials.next[lane] = Some(trial);
            self.trials.open(lane);
        }
    }

    /// The tree that a lane draws from, and its next trial.
    #[inline(always)]
    fn trial(&self, lane: usize) -> Option<(PlacedTree, LeafTrial)> {
        let view = self.views[lane].as_ref()?;
        Some((view.tree(self.slots[lane]?), self.trials.next[lane]?))
    }

    /// Carries the trees' draws over to the `wo` of their lanes.
    fn carry_draws(&mut self, disc: &AdaptiveDisc) {
        for lane in 0..self.count {
            let (Some(view), Some(slot), Some(drawn)) =
                (&self.views[lane], self.slots[lane], &self.drawn[lane])
            else {
                continue;
            };
            let wi = disc.carry(view.tree(slot), view, drawn.wi);
            self.wi[lane] = is_upper(wi).then_some(wi);
        }
    }

    /// The densities of all trees with weight at the direction of each lane.
    fn find_densities(&mut self, disc: &AdaptiveDisc, values: &mut Values) {
        // Step 1: the directions that end there, and the values of f that their densities need.
        values.count = 0;
        for lane in 0..self.count {
            self.densities[lane] = [0.0; 4];
            let (Some(view), Some(wi)) = (&self.views[lane], self.wi[lane]) else {
                continue;
            };
            let target = DensityTarget::new(view, wi);
            for (slot, density) in self.densities[lane].iter_mut().enumerate() {
                if !view.has_weight(slot) {
                    continue;
                }
                let tree = view.tree(slot);
                for origin in &disc.origins(tree, &target) {
                    let Some(origin) = origin else {
                        continue;
                    };
                    let number = origin.stretch;
                    match disc.density_without_value(tree, origin.wi) {
                        Some(known) => *density += number * known,
                        None => {
                            let asked = Asked { lane, slot, number };
                            let knot = disc.knot_direction(tree);
                            values.ask(knot, origin.wi, asked);
                        }
                    }
                }
            }
        }
        // Step 2: the densities, each by its stretch.
        let Trees::Rejecting(forest) = &disc.trees else {
            return;
        };
        values.evaluate(disc);
        for number in 0..values.count {
            let Asked {
                lane,
                slot,
                number: stretch,
            } = values.asked[number];
            if let Some(view) = &self.views[lane] {
                let (tree, wi) = (view.tree(slot), values.wi[number]);
                let value = values.scalar(number, disc);
                let known = disc.density_of_value(forest, tree, wi, value);
                self.densities[lane][slot] += stretch * known;
            }
        }
    }

    /// What a lane drew.
    fn sample(&self, disc: &AdaptiveDisc, lane: usize) -> Option<DirectionSample> {
        let (view, wi) = (self.views[lane].as_ref()?, self.wi[lane]?);
        let densities = &self.densities[lane];
        if let Some(slot) = self.slots[lane]
            && !disc.keeps_density(slot, &self.drawn[lane]?, densities)
        {
            return None;
        }
        disc.sample_with(view, wi, densities)
    }

    /// The density at the direction of a lane.
    fn density(&self, disc: &AdaptiveDisc, lane: usize) -> f32 {
        match (&self.views[lane], self.wi[lane]) {
            (Some(view), Some(wi)) => disc.mix(view, &self.densities[lane], wi),
            _ => 0.0,
        }
    }
}
