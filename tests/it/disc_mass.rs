//! The mass of the adaptive disc's density: no spikes where nothing is drawn, and a normaliser that is the integral.

use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

use glam::Vec3;
use merlkit::direction_sampler::DirectionSampler;
use merlkit::geometry::{POINTS_PER_BIN, Quadrature, spherical};
use merlkit::material::merl::{Header, LookupRule, MerlBrdf, MerlTable, decode_embedded};
use merlkit::sampler::{AdaptiveDisc, AdaptiveDiscSettings, LeafChoice};

fn table(value: fn(usize, usize, usize) -> [f64; 3]) -> Arc<MerlBrdf> {
    let table = MerlTable::from_fn(Header { phi_d_bins: 180 }, value);
    Arc::new(MerlBrdf::new(Arc::new(table), LookupRule::Floor))
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
        let disc = AdaptiveDisc::build(brdf.clone(), settings).unwrap();
        let expected = disc.pdf(wo, mirror);
        assert!((350.0..410.0).contains(&expected), "{expected}");
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
        let disc = AdaptiveDisc::build(brdf.clone(), settings).unwrap();
        let mass = Quadrature::new(wo, POINTS_PER_BIN).integrate(|wi| f64::from(disc.pdf(wo, wi)));
        assert!((mass - 1.0).abs() < 3e-3, "{:?}: {mass}", settings.leaves);
    }
}
