//! Directions whose length is not 1 are renormalised: BRDFs and samplers give what they give for the unit direction.

use crate::support::loaded;
use std::sync::Arc;

use glam::{Vec2, Vec3};
use merlkit::brdf::Brdf;
use merlkit::geometry::{spherical, unit_upper};
use merlkit::material::merl::HardCase;
use merlkit::material::merl::{LookupRule, MerlBrdf};
use merlkit_evaluate::measure::hard::hard_samplers;

#[test]
fn directions_of_any_length_are_renormalised() {
    let table = Arc::new(HardCase::named("noise").unwrap().table());
    for rule in LookupRule::ALL {
        let brdf = Arc::new(MerlBrdf::new(table.clone(), rule));
        for hard in hard_samplers().unwrap() {
            let sampler = hard.spec.build(&loaded(&brdf)).unwrap();
            for (wo_length, wi_length) in [
                (1.001f32, 1.0f32),
                (1.0, 0.999),
                (1e-20, 1e20),
                (3.0, 1e-30),
            ] {
                let wo = spherical(0.7, 0.4).as_vec3() * wo_length;
                let wi = spherical(1.1, 2.9).as_vec3() * wi_length;
                let (unit_wo, unit_wi) = (unit_upper(wo).unwrap(), unit_upper(wi).unwrap());
                assert!(
                    (unit_wo.length() - 1.0).abs() < 1e-6 && (unit_wi.length() - 1.0).abs() < 1e-6
                );
                let place = format!("{} {rule:?} {wo} {wi}", hard.name);
                assert_eq!(brdf.eval(wo, wi), brdf.eval(unit_wo, unit_wi), "{place}");
                assert_eq!(
                    brdf.eval_cos(wo, wi),
                    brdf.eval_cos(unit_wo, unit_wi),
                    "{place}"
                );
                assert_eq!(
                    sampler.pdf(wo, wi),
                    sampler.pdf(unit_wo, unit_wi),
                    "{place}"
                );
                let u = Vec2::new(0.3, 0.6);
                assert_eq!(sampler.sample(wo, u), sampler.sample(unit_wo, u), "{place}");
            }
        }
    }
}

#[test]
fn what_is_no_direction_has_no_unit() {
    for w in [
        Vec3::ZERO,
        Vec3::X,
        -Vec3::Z,
        Vec3::NAN,
        Vec3::INFINITY,
        Vec3::new(f32::MAX, 0.0, 1e-45),
    ] {
        assert_eq!(unit_upper(w), None, "{w}");
    }
    assert_eq!(unit_upper(Vec3::new(0.0, 0.0, 1e-45)), Some(Vec3::Z));
    let nearly = Vec3::new(0.6, 0.0, 0.8 + 1e-7);
    assert_eq!(unit_upper(nearly), Some(nearly));
}
