//! Many draws in one descent (thesis 6.3.2).

use glam::{DVec2, Vec3};

use super::density::KnotDraw;
use super::disc::{AdaptiveDisc, TreeView};
use super::draw::MAX_TRIALS;
use super::settings::LeafChoice;
use super::tree::{Drawn, Forest};
use super::trees::Trees;
use crate::direction_sampler::{DirectionSample, draw_stratified};
use crate::geometry::{cosine_hemisphere, unit_upper};
use crate::points::{PointSet, Stream};

impl AdaptiveDisc {
    /// Draws `count` directions for one `wo` whose numbers in every node of the tree are their expectation, rounded at random:
    /// one descent distributes them over the leaves (thesis 6.3.2, algorithms 17 and 18). Trees that are warped instead are drawn
    /// from by [`draw_stratified`]. Each draw alone has the density `pdf`; `None` is a failed draw.
    pub fn draw_stratified(
        &self,
        wo: Vec3,
        count: usize,
        seed: u64,
    ) -> Vec<Option<DirectionSample>> {
        match &self.trees {
            Trees::Rejecting(forest) => share_draws(self, forest, wo, count, seed),
            Trees::Warped(_) => draw_stratified(self, wo, count, seed),
        }
    }
}

/// Draws `count` directions whose numbers in every node are their expectation, rounded at random.
fn share_draws(
    disc: &AdaptiveDisc,
    forest: &Forest,
    wo: Vec3,
    count: usize,
    seed: u64,
) -> Vec<Option<DirectionSample>> {
    let Some(wo) = unit_upper(wo) else {
        return vec![None; count];
    };
    let view = disc.view(wo);
    let mut random = Stream::new(seed);
    let floor = disc.settings.floor;
    let [a, b, c, d] = view.shares().map(|share| (1.0 - floor) * share);
    let counts = share_out(count, [a, b, c, d, floor], &mut random);
    let mut batch = Batch {
        disc,
        forest,
        view,
        random,
        out: Vec::with_capacity(count),
    };
    batch.cosine(counts[4], seed);
    for (slot, count) in counts[..4].iter().enumerate() {
        batch.tree(slot, *count, seed);
    }
    batch.out
}

/// Integers that sum to `count`: each is its part of it by weight, rounded up or down at random so that its expectation is exact.
///
/// Systematic sampling: one random offset for all, where algorithm 17 draws the remainders one by one.
fn share_out<const N: usize>(count: usize, weights: [f64; N], random: &mut Stream) -> [usize; N] {
    // The first i get ⌊count·(w₁ + … + wᵢ)/Σw + offset⌋ in all. The uniform offset makes each expectation exact.
    let total: f64 = weights.iter().sum();
    let offset = random.next_f64();
    let mut cumulated = 0.0;
    let mut given = 0;
    std::array::from_fn(|i| {
        cumulated += weights[i];
        let until = if i + 1 == N {
            count
        } else {
            (cumulated / total * count as f64 + offset) as usize
        };
        let share = until.min(count).saturating_sub(given);
        given += share;
        share
    })
}

struct Batch<'a> {
    disc: &'a AdaptiveDisc,
    forest: &'a Forest,
    view: TreeView,
    random: Stream,
    out: Vec<Option<DirectionSample>>,
}

impl Batch<'_> {
    fn cosine(&mut self, count: usize, seed: u64) {
        for i in 0..count as u64 {
            let wi = cosine_hemisphere(PointSet::Sobol.point(seed, i, 0).as_dvec2()).as_vec3();
            self.out.push(self.disc.finish_floor(&self.view, wi));
        }
    }

    fn tree(&mut self, slot: usize, count: usize, seed: u64) {
        let tree = self.view.tree(slot);
        if self.forest.integral(tree.index) <= 0.0 {
            return self.cosine(count, seed.wrapping_add(1 + tree.index as u64));
        }
        let goal = self.out.len() + count;
        match self.disc.settings.leaves {
            LeafChoice::Integral => self.shares(slot, count, MAX_TRIALS),
            // As many proposals as were rejected are shared again, until all are accepted.
            LeafChoice::Envelope | LeafChoice::Warp => {
                for _ in 0..MAX_TRIALS {
                    if self.out.len() == goal {
                        break;
                    }
                    self.shares(slot, goal - self.out.len(), 1);
                }
            }
        }
        self.out.resize(goal, None);
    }

    /// Distributes `count` draws of up to `trials` trials over the leaves: one every 1/count of their CDF, from one random offset
    /// on, so that every square of the tree gets its expected number, rounded.
    fn shares(&mut self, slot: usize, count: usize, trials: u32) {
        let offset = self.random.next_f64();
        for i in 0..count {
            let leaf = self.forest.draw(
                self.view.tree(slot).index,
                (i as f64 + offset) / count as f64,
            );
            let drawn = (0..trials).find_map(|_| self.trial(slot, &leaf));
            self.out.extend(drawn.map(Some));
        }
    }

    fn trial(&mut self, slot: usize, leaf: &Drawn) -> Option<DirectionSample> {
        let tree = self.view.tree(slot);
        let point = DVec2::new(self.random.next_f64(), self.random.next_f64());
        let wi = leaf.direction(point, tree.turn)?;
        let level = self.random.next_f64() * f64::from(leaf.bound);
        let value = self.disc.value(tree, wi);
        if level >= value {
            return None;
        }
        let density = self.disc.density_of_value(self.forest, tree, wi, value);
        let drawn = KnotDraw { wi, density };
        self.disc.finish_tree(&self.view, slot, drawn)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_sum_to_the_count_and_average_to_the_weights() {
        let weights = [0.5, 0.0, 1.25, 0.25];
        let mut random = Stream::new(3);
        let mut sums = [0usize; 4];
        let rounds = 20_000;
        for _ in 0..rounds {
            let shares = share_out(7, weights, &mut random);
            assert_eq!(shares.iter().sum::<usize>(), 7);
            assert_eq!(shares[1], 0);
            for (sum, share) in sums.iter_mut().zip(shares) {
                *sum += share;
            }
        }
        for (sum, weight) in sums.iter().zip(weights) {
            assert!(
                (*sum as f64 / f64::from(rounds) - 3.5 * weight).abs() < 0.03,
                "{sums:?}"
            );
        }
    }
}
