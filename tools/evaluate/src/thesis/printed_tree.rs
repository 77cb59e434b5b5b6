//! One quadtree by the thesis's algorithms 12 to 15, with each of its optimisations on or off. The library's own disc is another program.

use glam::{DVec2, Vec3};

use merlkit::brdf::{Brdf, Importance};
use merlkit::points::Stream;

/// The optimisations of the thesis's section 6.3.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Optimisations {
    /// Squares are cut to the rectangle about their part of the disc (6.3.4).
    pub trim: bool,
    /// f is read from one image instead of being evaluated in each node anew (6.3.3).
    pub image: bool,
    /// N draws are distributed over the leaves in one pass instead of one search each (6.3.2).
    pub together: bool,
}

/// Where a tree ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct TreeLimits {
    /// Pixels a side of the image over [−1, 1]².
    pub side: usize,
    /// Most subdivisions.
    pub depth: u32,
    /// Mean number of trials allowed in a leaf.
    pub n_max: f64,
}

/// f_r over the unit disc for one `wo`.
pub(super) struct DiscFunction<'a> {
    pub brdf: &'a dyn Brdf,
    pub wo: Vec3,
}

impl DiscFunction<'_> {
    /// f_r of the direction above a point; 0 outside the disc.
    fn value(&self, p: DVec2) -> f64 {
        let z2 = 1.0 - p.length_squared();
        if z2 <= 0.0 {
            return 0.0;
        }
        let wi = p.extend(z2.sqrt()).as_vec3();
        f64::from(Importance::Mean.reduce(self.brdf.eval(self.wo, wi)))
    }
}

/// A square of the tree by its pixels: lower corner and side.
#[derive(Clone, Copy, Debug)]
struct PixelSquare {
    corner: [usize; 2],
    side: usize,
}

/// A leaf: where points are drawn, their bound, and the integral.
#[derive(Clone, Copy, Debug)]
struct PrintedLeaf {
    low: DVec2,
    high: DVec2,
    bound: f64,
    integral: f64,
}

/// A tree and what it took.
pub(super) struct PrintedTree<'a> {
    function: &'a DiscFunction<'a>,
    limits: TreeLimits,
    on: Optimisations,
    image: Vec<f32>,
    leaves: Vec<PrintedLeaf>,
    /// Sums of the leaves' integrals.
    cumulated: Vec<f64>,
    /// Evaluations of f while it was built.
    pub evaluations: u64,
    /// Squares that were divided.
    pub subdivisions: u64,
}

impl<'a> PrintedTree<'a> {
    /// Builds the tree.
    pub fn build(function: &'a DiscFunction<'a>, limits: TreeLimits, on: Optimisations) -> Self {
        let mut tree = Self {
            function,
            limits,
            on,
            image: Vec::new(),
            leaves: Vec::new(),
            cumulated: Vec::new(),
            evaluations: 0,
            subdivisions: 0,
        };
        if on.image {
            for k in 0..limits.side * limits.side {
                let value = function.value(tree.centre([k % limits.side, k / limits.side]));
                tree.image.push(value as f32);
            }
            tree.evaluations = tree.image.len() as u64;
        }
        let root = PixelSquare {
            corner: [0, 0],
            side: limits.side,
        };
        tree.visit(root, 0);
        let mut sum = 0.0;
        for leaf in &tree.leaves {
            sum += leaf.integral;
            tree.cumulated.push(sum);
        }
        tree
    }

    /// The middle of a pixel: 2 (i + ½)/n − 1 on each axis.
    fn centre(&self, pixel: [usize; 2]) -> DVec2 {
        let [x, y] = pixel.map(|i| (i as f64 + 0.5) / self.limits.side as f64 * 2.0 - 1.0);
        DVec2::new(x, y)
    }

    /// Algorithm 12: divides while I/V < 1/n_max, with I the integral and V the bound times the area.
    fn visit(&mut self, square: PixelSquare, depth: u32) {
        // Step 1: Σ f and the largest f over the square's pixels.
        let (mut sum, mut most) = (0.0, 0.0f64);
        for y in square.corner[1]..square.corner[1] + square.side {
            for x in square.corner[0]..square.corner[0] + square.side {
                let value = if self.on.image {
                    f64::from(self.image[y * self.limits.side + x])
                } else {
                    self.evaluations += 1;
                    self.function.value(self.centre([x, y]))
                };
                sum += value;
                most = most.max(value);
            }
        }
        if sum <= 0.0 {
            return;
        }
        // Step 2: I = Σ f·(2/n)² and V = M·A.
        let pixel = 2.0 / self.limits.side as f64;
        let [x, y] = square.corner.map(|i| i as f64 * pixel - 1.0);
        let low = DVec2::new(x, y);
        let mut leaf = PrintedLeaf {
            low,
            high: low + pixel * square.side as f64,
            bound: most,
            integral: sum * pixel * pixel,
        };
        if self.on.trim {
            trim(&mut leaf);
        }
        let size = leaf.high - leaf.low;
        let may_divide = depth < self.limits.depth && square.side.is_multiple_of(2);
        // Step 3: four squares, or a leaf.
        if may_divide && leaf.integral * self.limits.n_max < most * size.x * size.y {
            self.subdivisions += 1;
            let side = square.side / 2;
            for (dx, dy) in [(0, 0), (side, 0), (0, side), (side, side)] {
                let corner = [square.corner[0] + dx, square.corner[1] + dy];
                self.visit(PixelSquare { corner, side }, depth + 1);
            }
        } else {
            self.leaves.push(leaf);
        }
    }

    /// Draws `count` directions and returns the number of trials.
    pub fn draw(&self, count: usize, random: &mut Stream) -> u64 {
        let Some(&total) = self.cumulated.last() else {
            return 0;
        };
        let mut trials = 0;
        let mut leaf = 0;
        for k in 0..count {
            if self.on.together {
                // Draws take equal steps of the cumulated integrals, so that the leaves are passed once.
                let target = (k as f64 + random.next_f64()) / count as f64 * total;
                while leaf + 1 < self.leaves.len() && self.cumulated[leaf] <= target {
                    leaf += 1;
                }
            } else {
                let target = random.next_f64() * total;
                leaf = self.cumulated.partition_point(|sum| *sum <= target);
                leaf = leaf.min(self.leaves.len() - 1);
            }
            trials += self.draw_in(&self.leaves[leaf], random);
        }
        trials
    }

    /// Algorithm 14: points of the leaf until one is accepted under the bound; returns the trials. The bound is that of pixels, so there
    /// is a value above none of it.
    fn draw_in(&self, leaf: &PrintedLeaf, random: &mut Stream) -> u64 {
        /// Trials after which a leaf of hardly any light is given up.
        const MOST: u64 = 1_000_000;
        for trial in 1..MOST {
            let t = DVec2::new(random.next_f64(), random.next_f64());
            let value = self.function.value(leaf.low + t * (leaf.high - leaf.low));
            if random.next_f64() * leaf.bound < value {
                return trial;
            }
        }
        MOST
    }
}

/// Cuts a square to the rectangle about its part of the disc: |x| ≤ √(1 − y²) for the y of the square that is nearest to 0, and the same
/// for y.
fn trim(leaf: &mut PrintedLeaf) {
    let nearest = leaf.low.max(-leaf.high).max(DVec2::ZERO);
    let reach = DVec2::new(
        (1.0 - nearest.y * nearest.y).max(0.0).sqrt(),
        (1.0 - nearest.x * nearest.x).max(0.0).sqrt(),
    );
    leaf.low = leaf.low.max(-reach);
    leaf.high = leaf.high.min(reach);
}

#[cfg(test)]
mod tests {
    use super::*;
    use merlkit::Material;
    use merlkit::material::LookupRule;

    const ALL: Optimisations = Optimisations {
        trim: true,
        image: true,
        together: true,
    };

    /// Trials of a draw in the mean.
    fn count_trials(tree: &PrintedTree<'_>) -> f64 {
        tree.draw(40_000, &mut Stream::new(1)) as f64 / 40_000.0
    }

    #[test]
    fn each_optimisation_saves_what_it_is_for() {
        let material = Material::resolve("diffuse:kd=0.5").unwrap();
        let loaded = material.load(LookupRule::Floor).unwrap();
        let function = DiscFunction {
            brdf: &**loaded.brdf(),
            wo: Vec3::Z,
        };
        let limits = TreeLimits {
            side: 64,
            depth: 4,
            n_max: 1.25,
        };
        let whole = PrintedTree::build(&function, limits, ALL);
        let untrimmed = PrintedTree::build(&function, limits, Optimisations { trim: false, ..ALL });
        let direct = PrintedTree::build(
            &function,
            limits,
            Optimisations {
                image: false,
                ..ALL
            },
        );
        // A constant fills π/4 of the square, and half of a small square at the rim: n_max 1.25 < 4/π divides the rim to the end, with
        // trimmed rectangles as well, which waste fewer trials.
        assert_eq!(untrimmed.subdivisions, whole.subdivisions);
        let trials = [count_trials(&whole), count_trials(&untrimmed)];
        assert!(trials[0] + 0.01 < trials[1], "{trials:?}");
        assert_eq!(direct.subdivisions, whole.subdivisions);
        assert_eq!(whole.evaluations, 64 * 64);
        assert!(direct.evaluations > whole.evaluations);
        // A draw of a constant takes V/I trials.
        let flat = TreeLimits {
            n_max: 4.0,
            ..limits
        };
        let root = PrintedTree::build(&function, flat, ALL);
        assert_eq!(root.subdivisions, 0);
        let trials = count_trials(&root);
        assert!(
            (trials - 4.0 / std::f64::consts::PI).abs() < 0.02,
            "{trials}"
        );
    }
}
