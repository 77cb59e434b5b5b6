//! What the page draws of anisotropic materials: a grid over four angles, and slices.

use merlkit::geometry::{HalfDiff, spherical};
use merlkit::glam::{DQuat, DVec3};
use merlkit::points::Stream;
use merlkit::{LookupRule, Material};
use serde_json::json;

use crate::read::{ask, session};

const BRUSHED: &str = "ward:sx=0.1,sy=0.3";

/// `wo` and `wi` of four angles in radians, by the definition: `wi` is turned by θh about y and by φh about z.
fn pair([theta_h, phi_h, theta_d, phi_d]: [f64; 4]) -> [DVec3; 2] {
    let half = spherical(theta_h, phi_h);
    let tilt = DQuat::from_axis_angle(DQuat::from_rotation_z(phi_h) * DVec3::Y, theta_h);
    let wi = tilt * spherical(theta_d, phi_h + phi_d);
    [2.0 * wi.dot(half) * half - wi, wi]
}

fn decode(word: u32) -> f32 {
    half::f16::from_bits(word as u16).to_f32().exp2()
}

#[test]
fn nodes_of_the_grid_are_values_of_the_brdf() {
    let session = session(&[BRUSHED]);
    let answer = ask(&session, "api/v1/grid?material=0");
    assert_eq!(
        answer.members["arrays"][0]["shape"],
        json!([24, 20, 64, 64, 3])
    );
    let loaded = Material::resolve(BRUSHED).unwrap();
    let loaded = loaded.load(LookupRule::Floor).unwrap();
    let logarithms = answer.bits("log2");
    let mut random = Stream::new(3);
    let (mut compared, mut brightest) = (0, 0f32);
    while compared < 3000 {
        let node = [24, 20, 64, 64].map(|count| (random.next_u64() % count) as usize);
        let [azimuth, d, h, column] = node;
        // θh has even steps of its square root, up to 90°.
        let angles = [
            (h as f64 / 63.0).powi(2) * 90.0,
            column as f64 / 64.0 * 360.0,
            d as f64 / 19.0 * 90.0,
            azimuth as f64 / 24.0 * 360.0,
        ];
        let [wo, wi] = pair(angles.map(f64::to_radians));
        if wo.z.min(wi.z) < 0.03 {
            continue;
        }
        let expected = loaded.brdf().eval(wo.as_vec3(), wi.as_vec3()).x;
        let start = 3 * (((azimuth * 20 + d) * 64 + h) * 64 + column);
        let found = decode(logarithms[start]);
        // A half has 11 bits: logarithms below 8 are off by 2⁻⁹ at most.
        assert!(
            (found / expected - 1.0).abs() < 0.002,
            "{angles:?}: {found} {expected}"
        );
        brightest = brightest.max(found);
        compared += 1;
    }
    assert!(brightest > 1.0, "{brightest}");
    // It is said how far values between the nodes are from the material's.
    let median = answer.members["median"].as_f64().unwrap();
    let most = answer.members["percentile99"].as_f64().unwrap();
    assert!(
        median > 0.0 && median < 0.005 && most < 0.1,
        "{median} {most}"
    );
}

#[test]
fn slices_of_anisotropic_materials_are_values_of_the_brdf() {
    let session = session(&[BRUSHED]);
    let loaded = Material::resolve(BRUSHED).unwrap();
    let loaded = loaded.load(LookupRule::Floor).unwrap();
    let answer = ask(&session, "api/v1/slice?material=0&phi_h=30&phi_d=70");
    let values = answer.floats("f");
    let (mut above, mut below) = (0, 0);
    for h in 0..90 {
        for d in 0..90 {
            let theta_h = ((h as f64 + 0.5) / 90.0).powi(2) * 90.0;
            let [wo, wi] = pair([theta_h, 30.0, d as f64 + 0.5, 70.0].map(f64::to_radians));
            let found = &values[3 * (90 * h + d)..][..3];
            if wo.z.min(wi.z) <= 0.0 {
                assert_eq!(found, [-1.0; 3]);
                below += 1;
                continue;
            }
            let found_angles = HalfDiff::from_directions(wo, wi).unwrap();
            assert!((found_angles.theta_h.to_degrees() - theta_h).abs() < 1e-6);
            let expected = loaded.brdf().eval(wo.as_vec3(), wi.as_vec3());
            for channel in 0..3 {
                // Directions differ by the rounding of f32, which counts near the horizon.
                let least = 1e-4 + 1e-6 / wo.z.min(wi.z) as f32;
                let relative = (found[channel] / expected[channel] - 1.0).abs();
                assert!(relative < least, "{h} {d}: {found:?} {expected}");
            }
            above += 1;
        }
    }
    assert!(above > 3000 && below > 1000, "{above} {below}");
    let turned = ask(&session, "api/v1/slice?material=0&phi_h=120&phi_d=70");
    assert_ne!(turned.floats("f"), values);
}
