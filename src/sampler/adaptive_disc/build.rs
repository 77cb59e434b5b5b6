//! Growing the trees.

use rayon::prelude::*;

use super::bounds::MaxTable;
use super::contents::{DiscImage, PointValues};
use super::grower::Grower;
use super::masses::MassRule;
use super::sampled::SampledValues;
use super::scouts::{Scouts, about_disc};
use super::settings::{AdaptiveDiscSettings, Construction, LeafChoice};
use super::slice::Slice;
use super::tree::{Forest, Grown, GrownTree};
use super::trees::Trees;
use super::warp::{self, TableBounds, USABLE, WarpGrower, Warps};
use crate::brdf::Brdf;
use crate::geometry::concentric_square;
use crate::material::Loaded;
use crate::sampler::azimuth_knots::TurnedBrdf;
use crate::sampler::direction_knots::DirectionKnots;

/// What the differences of two rules for ∫ f may add up to in all bins. Every density is divided by ∫ f, and what that is off by
/// is a bias of every mean weight; it is less than a tenth of the differences, which are those of the poorer rule.
const NORMALISER_TOLERANCE: f64 = 1e-4;
/// How far lattices of ∫ f may differ where it only decides on divisions.
const DIVISION_TOLERANCE: f64 = 5e-3;
/// Most trials a draw may need on average. A tree that is not allowed to be deep enough for its material is replaced by
/// the uniform disc.
pub(super) const MOST_TRIALS: f64 = 1000.0;

/// A material and what is known of its values.
pub(super) struct Subject<'a> {
    brdf: &'a dyn Brdf,
    /// Of a MERL table, which bounds its values.
    bounds: Option<MaxTable>,
}

impl<'a> Subject<'a> {
    pub fn new(material: &'a Loaded, settings: &AdaptiveDiscSettings) -> Self {
        let table = material.table();
        Self {
            brdf: &**material.brdf(),
            bounds: table.map(|table| MaxTable::new(table, settings.importance)),
        }
    }
}

/// Builds the trees of all knots, in parallel over knots.
pub(super) fn trees(
    subject: &Subject<'_>,
    settings: &AdaptiveDiscSettings,
    knots: DirectionKnots,
) -> Trees {
    let angles: Vec<[f64; 2]> = (0..knots.count()).map(|k| knots.angles(k)).collect();
    if settings.leaves == LeafChoice::Warp {
        let trees: Vec<warp::Tree> = angles
            .par_iter()
            .map(|&angles| grow_warp(subject, settings, angles))
            .collect();
        let mut warps = Warps::default();
        trees.iter().for_each(|tree| warps.push(tree));
        return Trees::Warped(warps);
    }
    let trees: Vec<GrownTree> = angles
        .par_iter()
        .map(|&angles| grow_tree(subject, settings, angles))
        .collect();
    Trees::Rejecting(Forest::join(&trees))
}

fn grow_warp(
    subject: &Subject<'_>,
    settings: &AdaptiveDiscSettings,
    [theta, azimuth]: [f64; 2],
) -> warp::Tree {
    let Some(bounds) = &subject.bounds else {
        let turned = TurnedBrdf::new(subject.brdf, azimuth);
        let slice = Slice::new(&turned, settings, None, theta);
        let scouts = Scouts::send(&slice, concentric_square);
        return WarpGrower {
            settings,
            slice: &slice,
            bounds: &scouts,
            integral: scouts.integral(),
        }
        .grow();
    };
    let slice = Slice::new(subject.brdf, settings, Some(bounds), theta);
    let bounds = TableBounds {
        table: bounds,
        wo: slice.wo.as_dvec3(),
    };
    WarpGrower {
        settings,
        slice: &slice,
        bounds: &bounds,
        // A warp's density is that of its own probabilities. ∫ f only scales the waste that divisions are compared with.
        integral: slice.rough_integral(DIVISION_TOLERANCE),
    }
    .grow()
}

fn grow_tree(
    subject: &Subject<'_>,
    settings: &AdaptiveDiscSettings,
    [theta, azimuth]: [f64; 2],
) -> GrownTree {
    match &subject.bounds {
        Some(bounds) => {
            let slice = Slice::new(subject.brdf, settings, Some(bounds), theta);
            grow_bounded(&slice, bounds)
        }
        None => {
            let turned = TurnedBrdf::new(subject.brdf, azimuth);
            grow_sampled(&Slice::new(&turned, settings, None, theta))
        }
    }
}

/// The tree of a MERL table.
fn grow_bounded(slice: &Slice<'_>, bounds: &MaxTable) -> GrownTree {
    let settings = slice.settings;
    // Step 1: ∫ f, by which accepted draws are normalised.
    let integral = slice.integral_of_table(bounds.rule(), NORMALISER_TOLERANCE);
    // Step 2: the leaves. Where ∫ f is not usable there are none, and the uniform disc is drawn from.
    let leaves = match settings.construction {
        _ if !USABLE.contains(&integral) => Vec::new(),
        Construction::Grid(side) => Grower::new(settings, DiscImage::new(slice, side)).grow(),
        Construction::Refined => Grower::new(
            settings,
            PointValues {
                slice,
                bounds,
                integral,
            },
        )
        .grow(),
    };
    // Step 3: leaves that are chosen by V = M·A have the density f/∫f. Those chosen by their own estimates I of ∫ f are
    // normalised by ΣI.
    let drawn: f64 = leaves.iter().map(|l| l.weight).sum();
    let (leaves, integral) = match settings.leaves {
        _ if needs_too_many_trials(&leaves, integral) => (Vec::new(), 0.0),
        LeafChoice::Integral => (leaves, drawn),
        LeafChoice::Envelope | LeafChoice::Warp => (leaves, integral),
    };
    GrownTree {
        leaves,
        integral,
        excess: None,
    }
}

/// The tree of any other BRDF, whose values may exceed what is taken for their bound.
fn grow_sampled(slice: &Slice<'_>) -> GrownTree {
    let settings = slice.settings;
    // Step 1: where lobes are, and a rough ∫ f.
    let scouts = &Scouts::send(slice, about_disc);
    let mut leaves = match settings.construction {
        _ if !USABLE.contains(&scouts.integral()) => Vec::new(),
        Construction::Grid(side) => Grower::new(settings, DiscImage::new(slice, side)).grow(),
        Construction::Refined => Grower::new(settings, SampledValues { slice, scouts }).grow(),
    };
    // Step 2: ∫ f and ∫ min(f, bound) of each leaf. Draws are accepted with the probability min(f, bound)/bound.
    let rule = MassRule { slice, scouts };
    let (mut whole, mut bounded) = (0.0, 0.0);
    for leaf in &mut leaves {
        let masses = rule.integrate(leaf.square, f64::from(leaf.bound));
        whole += masses.whole;
        bounded += masses.bounded;
        // A leaf that is chosen by its integral has that of what is accepted in it.
        if settings.leaves == LeafChoice::Integral {
            leaf.weight = masses.bounded;
        }
    }
    // Step 3: the density is min(f, bound)/∫min(f, bound), whichever way leaves are chosen.
    if !USABLE.contains(&bounded) || needs_too_many_trials(&leaves, bounded) {
        return GrownTree {
            leaves: Vec::new(),
            integral: 0.0,
            excess: Some(0.0),
        };
    }
    GrownTree {
        leaves,
        integral: bounded,
        excess: Some((1.0 - bounded / whole).clamp(0.0, 1.0)),
    }
}

/// A draw takes ΣV/∫f trials on average, with V = M·A of a leaf.
fn needs_too_many_trials(leaves: &[Grown], integral: f64) -> bool {
    let volume: f64 = leaves.iter().map(Grown::volume).sum();
    leaves.is_empty() || volume > MOST_TRIALS * integral
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Symmetry;
    use crate::material::MerlBrdf;
    use crate::material::merl::LookupRule;
    use crate::material::merl::decode_embedded;
    use crate::points::Stream;
    use crate::sampler::TableChoice;
    use crate::sampler::adaptive_disc::tree::{Drawn, Leaf, WHOLE};
    use crate::sampler::knots::ThetaKnots;
    use glam::DVec2;
    use std::sync::Arc;

    fn forest(brdf: &MerlBrdf, settings: &AdaptiveDiscSettings, knots: ThetaKnots) -> Forest {
        let material = Loaded::from_table(Arc::new(brdf.clone()));
        let subject = Subject::new(&material, settings);
        let (tables, choice) = (knots.count(), TableChoice::Mixture);
        let knots = DirectionKnots::new(tables, choice, Symmetry::Isotropic, None).unwrap();
        match trees(&subject, settings, knots) {
            Trees::Rejecting(forest) => forest,
            Trees::Warped(_) => panic!("trees without bounds"),
        }
    }

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
            // Leaves as small as the image allows, where points meet chrome's peak.
            depth: 10,
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
