//! Angles and bins against values from an independent implementation and against a literal one.

use crate::support;
use std::sync::Arc;

use crate::support::{golden, naive, noise_table};
use glam::{DVec2, DVec3, Vec3};
use merlkit::Wo;
use merlkit::brdf::Brdf;
use merlkit::color::Rgb;
use merlkit::geometry::{HalfDiff, cosine_hemisphere};
use merlkit::material::merl::{BinIndex, LookupRule, MerlBrdf};
use merlkit::material::merl::{Header, MerlTable};
use merlkit::points::Stream;

#[test]
fn golden_directions_give_golden_angles_and_bins() {
    let mut other_bins = 0;
    let rows = golden("golden_lookup.csv");
    assert_eq!(rows.len(), 400);
    for row in &rows {
        let v: Vec<f64> = row.iter().map(|x| x.parse().unwrap()).collect();
        let (wi, wo) = (DVec3::new(v[0], v[1], v[2]), DVec3::new(v[3], v[4], v[5]));
        let angles = HalfDiff::from_directions(wo, wi).unwrap();
        assert!((angles.theta_h - v[6]).abs() < 1e-9, "{angles:?} {v:?}");
        assert!((angles.theta_d - v[7]).abs() < 1e-9, "{angles:?} {v:?}");
        let phi = angles.phi_d.rem_euclid(std::f64::consts::PI);
        assert!((phi - v[8]).abs() < 1e-7, "{angles:?} {v:?}");
        let bins = BinIndex::find(wo.as_vec3(), wi.as_vec3(), 180).unwrap();
        let expected = BinIndex {
            theta_h: v[9] as usize,
            theta_d: v[10] as usize,
            phi_d: v[11] as usize,
        };
        other_bins += usize::from(bins != expected);
    }
    // The directions of the file are rounded to f32 on the way in; only pairs within that of an edge may move.
    assert!(
        other_bins <= 2,
        "{other_bins} of {} pairs in another bin",
        rows.len()
    );
}

#[test]
fn bins_without_trigonometry_equal_bins_by_trigonometry() {
    let mut differ = 0;
    let pairs = 400_000;
    for (wo, wi) in support::pairs(pairs, 11) {
        for bins in [180, 360] {
            let (fast, slow) = (BinIndex::find(wo, wi, bins), naive::bins(wo, wi, bins));
            if fast != slow {
                assert!(
                    naive::near_an_edge(wo, wi, 1e-9),
                    "{wo} {wi}: {fast:?} {slow:?}"
                );
                differ += 1;
            }
        }
    }
    assert!(differ < 10, "{differ} of {pairs} pairs differ");
}

#[test]
fn of_two_million_random_pairs_none_is_in_another_bin_than_by_trigonometry() {
    let mut random = Stream::new(41);
    let mut direction =
        || cosine_hemisphere(DVec2::new(random.next_f64(), random.next_f64())).as_vec3();
    for _ in 0..2_000_000 {
        let (wo, wi) = (direction(), direction());
        assert_eq!(
            BinIndex::find(wo, wi, 360),
            naive::bins(wo, wi, 360),
            "{wo} {wi}"
        );
    }
}

/// Directions at every difficult place: pairs of all kinds, the exact mirror direction and `wo` itself, the normal,
/// tiny and huge components, and directions outside the domain.
fn difficult_pairs() -> (Vec<Vec3>, Vec<Vec3>) {
    let special = [
        Vec3::Z,
        Vec3::NEG_Z,
        Vec3::X,
        Vec3::ZERO,
        Vec3::NAN,
        Vec3::new(f32::NAN, 0.0, 1.0),
        Vec3::new(0.0, f32::INFINITY, 1.0),
        Vec3::new(1.0, 0.0, -0.0),
        Vec3::new(-0.0, 1.0, 1e-45),
        Vec3::new(0.6, -0.0, 0.8),
        Vec3::new(-0.6, 0.0, 0.8),
        Vec3::new(1e-40, -1e-45, 1.0),
        Vec3::splat(f32::MAX),
    ];
    let mut pairs: Vec<_> = support::pairs(20_000, 29).collect();
    let mirrored = |w: Vec3| Vec3::new(-w.x, -w.y, w.z);
    let exact: Vec<_> = pairs[..500]
        .iter()
        .flat_map(|&(wo, _)| [(wo, mirrored(wo)), (wo, wo)])
        .collect();
    pairs.extend(exact);
    for a in special {
        pairs.extend(special.iter().map(|&b| (a, b)));
    }
    pairs.into_iter().unzip()
}

#[test]
fn many_evaluations_at_once_are_single_ones_to_the_bit() {
    let (wo, wi) = difficult_pairs();
    for (bins, one_in) in [(180, 3), (360, 5)] {
        let table = Arc::new(noise_table(bins, one_in, 3));
        for rule in LookupRule::ALL {
            let brdf = MerlBrdf::new(table.clone(), rule);
            let mut out = vec![Rgb::NAN; wo.len()];
            brdf.eval_batch(Wo::Each(&wo), &wi, &mut out);
            for ((&wo, &wi), &f) in wo.iter().zip(&wi).zip(&out) {
                assert!(f.is_finite(), "{rule:?} {wo} {wi}: {f}");
                assert_eq!(f, brdf.eval(wo, wi), "{rule:?} {wo} {wi}");
            }
            for &wo in wo.iter().rev().step_by(700) {
                brdf.eval_batch(Wo::One(wo), &wi, &mut out);
                assert!(
                    wi.iter().zip(&out).all(|(&wi, &f)| f == brdf.eval(wo, wi)),
                    "{rule:?} {wo}"
                );
            }
        }
    }
}

#[test]
fn every_rule_equals_its_definition() {
    for (bins, one_in) in [(180, 0), (180, 3), (360, 5)] {
        let table = Arc::new(noise_table(bins, one_in, 3));
        for rule in LookupRule::ALL {
            let brdf = MerlBrdf::new(table.clone(), rule);
            for (wo, wi) in support::pairs(60_000, 17) {
                if naive::near_an_edge(wo, wi, 1e-9) {
                    continue;
                }
                let fast = brdf.eval(wo, wi).as_dvec3();
                let (slow, weight) = naive::eval(&table, rule, wo, wi);
                // Values are at most 4; shares are f32, and what remains of them is divided by the valid ones' sum.
                assert!(
                    fast.abs_diff_eq(slow, 4e-6 / weight.max(1e-9)),
                    "{rule:?} {wo} {wi}: {fast} {slow}"
                );
            }
        }
    }
}

#[test]
fn a_constant_table_is_constant_between_its_samples() {
    let constant = Rgb::new(0.25, 0.5, 3.0);
    for bins in [180, 360] {
        // Holes change nothing as long as one neighbour is left.
        let holes = move |h: usize, d: usize, p: usize| (h + d + p).is_multiple_of(2);
        let value = move |h, d, p| {
            if holes(h, d, p) {
                [-1.0; 3]
            } else {
                [0.25, 0.5, 3.0]
            }
        };
        let full = MerlTable::from_fn(Header { phi_d_bins: bins }, |_, _, _| [0.25, 0.5, 3.0]);
        let holed = MerlTable::from_fn(Header { phi_d_bins: bins }, value);
        for (table, rules) in [(full, &LookupRule::ALL[..]), (holed, &LookupRule::ALL[1..])] {
            let table = Arc::new(table);
            for &rule in rules {
                let brdf = MerlBrdf::new(table.clone(), rule);
                for (wo, wi) in support::pairs(40_000, 5).filter(|(o, i)| o.z > 0.0 && i.z > 0.0) {
                    let f = brdf.eval(wo, wi);
                    assert!(
                        f.abs_diff_eq(constant, 1e-6),
                        "{rule:?} {bins} {wo} {wi}: {f}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_table_of_holes_is_black() {
    let table = Arc::new(MerlTable::from_fn(Header { phi_d_bins: 180 }, |_, _, _| {
        [f64::NAN; 3]
    }));
    for rule in LookupRule::ALL {
        assert_eq!(
            MerlBrdf::new(table.clone(), rule).eval(Vec3::Z, Vec3::Z),
            Rgb::ZERO
        );
    }
}

#[test]
fn directions_outside_the_domain_have_the_value_zero() {
    let table = Arc::new(noise_table(180, 0, 1));
    let outside = [
        Vec3::NAN,
        Vec3::new(f32::NAN, 0.0, 1.0),
        Vec3::new(0.0, f32::INFINITY, 1.0),
        Vec3::ZERO,
        Vec3::X,
        Vec3::NEG_Z,
        Vec3::new(0.6, 0.0, -0.8),
        Vec3::new(1.0, 0.0, -0.0),
    ];
    for rule in LookupRule::ALL {
        let brdf = MerlBrdf::new(table.clone(), rule);
        for bad in outside {
            for good in [Vec3::Z, Vec3::new(0.6, 0.0, 0.8), bad] {
                assert_eq!(brdf.eval(bad, good), Rgb::ZERO, "{rule:?} {bad} {good}");
                assert_eq!(brdf.eval(good, bad), Rgb::ZERO, "{rule:?} {good} {bad}");
            }
        }
    }
}

#[test]
fn tables_of_180_are_reciprocal() {
    let table = Arc::new(noise_table(180, 4, 9));
    for rule in LookupRule::ALL {
        let brdf = MerlBrdf::new(table.clone(), rule);
        for (wo, wi) in
            support::pairs(100_000, 23).filter(|&(o, i)| !naive::near_an_edge(o, i, 1e-6))
        {
            let (there, back) = (brdf.eval(wo, wi), brdf.eval(wi, wo));
            let slack = if rule == LookupRule::Floor { 0.0 } else { 1e-5 };
            assert!(
                there.abs_diff_eq(back, slack),
                "{rule:?} {wo} {wi}: {there} {back}"
            );
        }
    }
}

#[test]
fn tables_of_360_tell_phi_d_from_its_opposite() {
    let halves = |_, _, p| if p < 180 { [1.0; 3] } else { [2.0; 3] };
    let table = Arc::new(MerlTable::from_fn(Header { phi_d_bins: 360 }, halves));
    for rule in LookupRule::ALL {
        let brdf = MerlBrdf::new(table.clone(), rule);
        for (wo, wi) in support::pairs(50_000, 31) {
            let phi_d = HalfDiff::from_directions(wo.as_dvec3(), wi.as_dvec3())
                .unwrap()
                .phi_d;
            // A degree or less from 0 and π the linear rules blend the halves.
            if wi.z <= 0.0 || wo.z <= 0.0 || phi_d.sin().abs() < 0.02 {
                continue;
            }
            let expected = if phi_d > 0.0 { 1.0 } else { 2.0 };
            assert!(
                (brdf.eval(wo, wi).x - expected).abs() < 1e-6,
                "{rule:?} {wo} {wi}"
            );
            assert!(
                (brdf.eval(wi, wo).x - (3.0 - expected)).abs() < 1e-6,
                "{rule:?} {wo} {wi}"
            );
        }
    }
}

#[test]
fn pairs_in_one_plane_with_the_normal_have_the_bins_of_arctangents() {
    for k in 0..360 {
        let (a, b) = (f64::from(k) * 0.247, f64::from(k) * 0.5 - 90.0);
        let flat = |t: f64| {
            Vec3::new(
                t.to_radians().sin() as f32,
                0.0,
                t.to_radians().cos() as f32,
            )
        };
        let (wo, wi) = (flat(a), flat(b));
        for bins in [180, 360] {
            let (fast, slow) = (BinIndex::find(wo, wi, bins), naive::bins(wo, wi, bins));
            assert!(
                fast == slow || naive::near_an_edge_of_theta(wo, wi, 1e-9),
                "{wo} {wi}: {fast:?} {slow:?}"
            );
        }
    }
    for azimuth in [0.3f32, 1.9, 3.5, 5.8] {
        let wi = Vec3::new(0.6 * azimuth.cos(), 0.6 * azimuth.sin(), 0.8);
        let wo = Vec3::new(-wi.x, -wi.y, wi.z);
        let bins = BinIndex::find(wo, wi, 360).unwrap();
        assert_eq!(
            (bins.theta_h, bins.phi_d),
            (0, azimuth.to_degrees() as usize)
        );
    }
}
