//! The mass of the adaptive disc's density: no spikes where nothing is drawn, and a normaliser that is the integral.

use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

use glam::{Vec2, Vec3};
use merlkit::brdf::{Brdf, Importance};
use merlkit::direction_sampler::DirectionSampler;
use merlkit::geometry::{POINTS_PER_BIN, Quadrature, spherical};
use merlkit::material::Loaded;
use merlkit::material::merl::{Header, LookupRule, MerlBrdf, MerlTable, decode_embedded};
use merlkit::sampler::{
    AdaptiveDisc, AdaptiveDiscSettings, CascadeCdf, CascadeCdfSettings, LeafChoice,
};
use merlkit_evaluate::measure::accuracy::weight_spread;

fn table(value: fn(usize, usize, usize) -> [f64; 3]) -> Arc<MerlBrdf> {
    let table = MerlTable::from_fn(Header { phi_d_bins: 180 }, value);
    Arc::new(MerlBrdf::new(Arc::new(table), LookupRule::Floor))
}

fn disc(brdf: &Arc<MerlBrdf>, settings: AdaptiveDiscSettings) -> AdaptiveDisc {
    AdaptiveDisc::build(&Loaded::from_table(brdf.clone()), settings).unwrap()
}

/// All light but a Lambertian rest in the first bin of θh, 0.011° wide.
fn narrow_highlight() -> Arc<MerlBrdf> {
    table(|h, _, _| [if h == 0 { 1e7 } else { 0.3 * FRAC_1_PI }; 3])
}

/// The constructions whose trees keep half vectors: what they draw past the horizon is turned up.
fn carrying_half_vectors() -> [AdaptiveDiscSettings; 3] {
    [LeafChoice::Envelope, LeafChoice::Warp, LeafChoice::Integral].map(|leaves| {
        AdaptiveDiscSettings {
            leaves,
            ..Default::default()
        }
    })
}

#[test]
fn the_density_has_no_spike_at_the_mirror_direction() {
    let table = decode_embedded("nickel").unwrap();
    let brdf = Arc::new(MerlBrdf::new(Arc::new(table), LookupRule::Floor));
    let wo = Vec3::new(0.917_123_2, 0.387_753_46, 0.092_370_58);
    let mirror = Vec3::new(-wo.x, -wo.y, wo.z);
    for settings in carrying_half_vectors() {
        let disc = disc(&brdf, settings);
        let expected = disc.pdf(wo, mirror);
        // Without rejection the density is that of a leaf; the envelope's is f·cosθ over its integral.
        let known = if settings.leaves == LeafChoice::Envelope {
            379.0..381.0
        } else {
            300.0..460.0
        };
        assert!(
            known.contains(&expected),
            "{:?}: {expected}",
            settings.leaves
        );
        for z in [wo.z.next_up(), wo.z.next_down(), wo.z + 1e-5, wo.z - 1e-5] {
            let pdf = disc.pdf(wo, Vec3::new(mirror.x, mirror.y, z));
            assert!(
                (pdf / expected - 1.0).abs() < 0.05,
                "z = {z}: {pdf}, at the mirror {expected}"
            );
        }
    }
}

#[test]
fn the_density_of_a_narrow_highlight_integrates_to_one() {
    let brdf = narrow_highlight();
    let wo = spherical(75.5f64.to_radians(), 2.5).as_vec3();
    for settings in carrying_half_vectors() {
        let disc = disc(&brdf, settings);
        let mass = Quadrature::new(wo, POINTS_PER_BIN).integrate(|wi| f64::from(disc.pdf(wo, wi)));
        // With leaves by integral a density is as good as the estimates of leaves, and that of a warp jumps inside bins, where the
        // quadrature is off; no spike is left in either.
        let allowed = match settings.leaves {
            LeafChoice::Envelope => 1e-3,
            LeafChoice::Warp => 3e-3,
            LeafChoice::Integral => 2e-2,
        };
        assert!(
            (mass - 1.0).abs() < allowed,
            "{:?}: {mass}",
            settings.leaves
        );
    }
}

/// Bright within 2° of the opposite of `wo` alone, next to black elsewhere: what measurements hold at grazing angles.
fn garbage_at_grazing() -> Arc<MerlBrdf> {
    table(|_, d, _| [if d >= 88 { 1e6 } else { 3e-4 * FRAC_1_PI }; 3])
}

/// At a tree's own angle every weight is the tree's integral: the normaliser itself, which must be the albedo.
#[test]
fn weights_at_an_angle_of_a_tree_are_the_albedo() {
    let settings = AdaptiveDiscSettings {
        floor: 0.0,
        ..Default::default()
    };
    let measured = |name| {
        let table = decode_embedded(name).unwrap();
        Arc::new(MerlBrdf::new(Arc::new(table), LookupRule::Floor))
    };
    let mean = |f: Vec3| f64::from(Importance::Mean.reduce(f));
    for (brdf, tree, allowed) in [
        (measured("nickel"), 3, 1e-4),
        (measured("red-fabric"), 3, 1e-4),
        (measured("black-obsidian"), 3, 1e-4),
        (garbage_at_grazing(), 18, 1e-3),
    ] {
        let disc = disc(&brdf, settings);
        // Twenty trees from 0 to 90°.
        let theta = f64::from(tree) * std::f64::consts::FRAC_PI_2 / 19.0;
        let wo = spherical(theta, 0.0).as_vec3();
        let draw = disc.sample(wo, Vec2::new(0.37, 0.61)).unwrap();
        let weight = mean(brdf.eval_cos(wo, draw.wi)) / f64::from(draw.pdf);
        let albedo = Quadrature::new(wo, 10_946).integrate(|wi| mean(brdf.eval_cos(wo, wi)));
        assert!(
            (weight / albedo - 1.0).abs() < allowed,
            "tree {tree}: {weight}, {albedo}"
        );
    }
}

/// A bin narrower than any cell of the compressed cascade keeps its density to both of its edges.
#[test]
fn a_compressed_cascade_has_no_tail_of_weights_where_the_table_jumps() {
    let brdf = narrow_highlight();
    let cascade = CascadeCdf::build(&*brdf, CascadeCdfSettings::default()).unwrap();
    for degrees in [45.0, 84.7f64] {
        let wo = spherical(degrees.to_radians(), 0.4).as_vec3();
        let quadrature = Quadrature::new(wo, POINTS_PER_BIN);
        let spread = weight_spread(&cascade, &*brdf, &quadrature, Importance::Mean);
        assert!(
            spread.peak < 200.0 && spread.relstd < 1.0,
            "{degrees}°: {spread:?}"
        );
    }
}
