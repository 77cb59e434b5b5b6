//! The trees, and those that serve one `wo`.

use glam::{DVec2, DVec3, Vec3};

use super::build::{self, Subject};
use super::settings::AdaptiveDiscSettings;
use super::trees::Trees;
use crate::Result;
use crate::material::Loaded;
use crate::sampler::Settings;
use crate::sampler::azimuth_knots::check_azimuths;
use crate::sampler::direction_knots::DirectionKnots;

/// Sine of the direction that stands for the normal: it has an azimuth, and is the normal to f32.
const LEAST_SINE: f32 = 1e-12;

/// Quadtrees on the disc and the BRDF that draws are accepted under.
///
/// See [`SamplerSpec`](crate::sampler::SamplerSpec) for an example that builds a sampler.
#[derive(Clone, Debug)]
pub struct AdaptiveDisc {
    pub(super) material: Loaded,
    pub(super) settings: AdaptiveDiscSettings,
    pub(super) knots: DirectionKnots,
    /// Sine and cosine of each knot's angle.
    pub(super) directions: Vec<[f32; 2]>,
    pub(super) trees: Trees,
}

/// One tree, and where it is used.
#[derive(Clone, Copy)]
pub(super) struct PlacedTree {
    /// Its number among all trees.
    pub(super) index: usize,
    /// The knot of its polar angle.
    knot: usize,
    /// Cosine and sine of the azimuth of its direction.
    pub(super) turn: DVec2,
}

/// `wo` as the trees see it: among the azimuths that have trees, with its neighbours among the knots of both angles.
#[derive(Clone, Copy)]
pub(super) struct TreeView {
    pub(super) wo: DVec3,
    /// `wo` at unit length in f64; its components were rounded to f32.
    pub(super) unit_wo: DVec3,
    /// The mirror signs that bring `wo` there; the same bring `wi`.
    pub(super) signs: Vec3,
    /// The knots of the two polar angles.
    polar: [usize; 2],
    /// The first tree of each of the two azimuths.
    starts: [usize; 2],
    /// Cosine and sine of these azimuths.
    turns: [DVec2; 2],
    /// Weights of the second azimuth and of the second polar angle.
    pub(super) weights: [f64; 2],
}

impl TreeView {
    /// The tree of number `slot`: those of the first azimuth at the two polar angles, then those of the second.
    #[inline(always)]
    pub(super) fn tree(&self, slot: usize) -> PlacedTree {
        let (azimuth, knot) = (slot / 2, self.polar[slot % 2]);
        PlacedTree {
            index: self.starts[azimuth] + knot,
            knot,
            turn: self.turns[azimuth],
        }
    }

    /// The probabilities of the trees, which sum to 1.
    pub(super) fn shares(&self) -> [f64; 4] {
        let [azimuth, polar] = self.weights;
        [
            (1.0 - azimuth) * (1.0 - polar),
            (1.0 - azimuth) * polar,
            azimuth * (1.0 - polar),
            azimuth * polar,
        ]
    }

    /// Whether a tree is drawn from at all.
    #[inline(always)]
    pub(super) fn has_weight(&self, slot: usize) -> bool {
        let [azimuth, polar] = self.weights;
        let azimuth_weight = if slot < 2 { 1.0 - azimuth } else { azimuth };
        let polar_weight = if slot.is_multiple_of(2) {
            1.0 - polar
        } else {
            polar
        };
        azimuth_weight > 0.0 && polar_weight > 0.0
    }
}

/// The directions that have trees.
fn knots(settings: &AdaptiveDiscSettings, material: &Loaded) -> Result<DirectionKnots> {
    let AdaptiveDiscSettings {
        tables,
        choice,
        azimuths,
        ..
    } = *settings;
    DirectionKnots::new(tables, choice, material.symmetry(), azimuths)
}

impl AdaptiveDisc {
    /// Builds the trees on the threads of the current pool; the result does not depend on their number.
    ///
    /// # Errors
    /// [`crate::Error::Argument`] for settings outside their domains, and for azimuths of an isotropic material.
    pub fn build(material: &Loaded, settings: AdaptiveDiscSettings) -> Result<Self> {
        settings.check()?;
        check_azimuths(settings.azimuths, material.symmetry())?;
        let knots = knots(&settings, material)?;
        let settings = AdaptiveDiscSettings {
            azimuths: knots.azimuths.setting(),
            ..settings
        };
        let trees = build::trees(&Subject::new(material, &settings), &settings, knots);
        Self::from_parts(material, settings, trees)
    }

    /// Puts a sampler together from trees that were grown or, if stored, validated. The settings name the azimuths.
    pub(super) fn from_parts(
        material: &Loaded,
        settings: AdaptiveDiscSettings,
        trees: Trees,
    ) -> Result<Self> {
        let knots = knots(&settings, material)?;
        let mut directions = Vec::with_capacity(knots.polar.count());
        for k in 0..knots.polar.count() {
            let (sin, cos) = knots.polar.theta(k).sin_cos();
            // Without a length in the plane the normal would forget the azimuth that its tree is turned by. Values of measured
            // files depend on it there; those of a table don't.
            let least = if material.table().is_none() {
                LEAST_SINE
            } else {
                0.0
            };
            directions.push([(sin as f32).max(least), cos as f32]);
        }
        Ok(Self {
            material: material.clone(),
            settings,
            knots,
            directions,
            trees,
        })
    }

    /// The settings it was built with.
    pub fn settings(&self) -> &AdaptiveDiscSettings {
        &self.settings
    }

    /// Trials that a draw takes on average, over the trees; 1 where nothing is rejected.
    pub fn mean_trials(&self) -> f64 {
        let Trees::Rejecting(forest) = &self.trees else {
            return 1.0;
        };
        let count = forest.integrals.len();
        let sum: f64 = (0..count).map(|k| forest.trials(k).max(1.0)).sum();
        sum / count.max(1) as f64
    }

    /// The largest part, over the trees, of ∫ f_r·cosθ that exceeds the leaves' bounds. Draws follow min(f_r, bound) there. 0 for a
    /// MERL table, which bounds its values, and for trees without rejection, which need no bounds.
    pub fn largest_excess(&self) -> f64 {
        match &self.trees {
            Trees::Rejecting(forest) => {
                let largest = forest.excess.iter().copied().fold(0.0, f32::max);
                f64::from(largest)
            }
            Trees::Warped(_) => 0.0,
        }
    }

    #[inline(always)]
    pub(super) fn view(&self, wo: Vec3) -> TreeView {
        let near = self.knots.neighbours(wo);
        let turns = near
            .axes
            .map(|axis| axis.try_normalize().unwrap_or(DVec2::X));
        let wo = near.wo.as_dvec3();
        TreeView {
            wo,
            unit_wo: wo.normalize(),
            signs: near.signs,
            polar: [near.polar.first, near.polar.second],
            starts: near.starts,
            turns,
            weights: [near.weight, near.polar.share],
        }
    }

    /// The direction that a tree was built for.
    #[inline(always)]
    pub(super) fn knot_direction(&self, tree: PlacedTree) -> DVec3 {
        let [sin, cos] = self.directions[tree.knot].map(f64::from);
        (tree.turn * sin).extend(cos)
    }

    /// f for the direction of a tree, as the scalar that trees are built on.
    #[inline]
    pub(super) fn value(&self, tree: PlacedTree, wi: Vec3) -> f64 {
        let wo = self.knot_direction(tree).as_vec3();
        let f = self.material.brdf().eval(wo, wi);
        f64::from(self.settings.importance.reduce(f))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;
    use std::sync::Arc;

    use super::*;
    use crate::brdf::Brdf;
    use crate::direction_sampler::DirectionSampler;
    use crate::geometry::{cosine_hemisphere, spherical};
    use crate::material::Loaded;
    use crate::points::Stream;

    /// Isotropic, and still not constant about the normal where `wo` is the normal: as noisy measurements are.
    struct Lopsided;

    impl Brdf for Lopsided {
        fn eval(&self, wo: Vec3, wi: Vec3) -> Vec3 {
            let apart = wi.y.atan2(wi.x) - wo.y.atan2(wo.x);
            Vec3::splat(0.2 + 0.1 * apart.cos())
        }

        fn is_isotropic(&self) -> bool {
            true
        }
    }

    /// Next to the normal the density integrates to 1 at every azimuth.
    #[test]
    fn trees_of_the_normal_are_turned_with_the_direction_asked_for() {
        let material = Loaded::from_brdf(Arc::new(Lopsided));
        let disc = AdaptiveDisc::build(&material, AdaptiveDiscSettings::default()).unwrap();
        let mut random = Stream::new(3);
        for azimuth in [0.0, 0.65, 2.0, 4.4] {
            let wo = spherical(0.01, azimuth).as_vec3();
            let (mut mass, count) = (0.0, 20_000);
            for _ in 0..count {
                let u = DVec2::new(random.next_f64(), random.next_f64());
                let wi = cosine_hemisphere(u).as_vec3();
                mass += f64::from(disc.pdf(wo, wi)) / f64::from(wi.z) * 0.5 * TAU;
            }
            let mass = mass / f64::from(count);
            assert!((mass - 1.0).abs() < 0.01, "{azimuth}: {mass}");
        }
    }
}
