//! Angles and bins against values from an independent implementation and against a literal one.

mod support;

use glam::DVec3;
use merlkit::brdf::BinIndex;
use merlkit::geom::HalfDiff;
use support::{golden, naive};

#[test]
fn golden_directions_give_golden_angles_and_bins() {
    let mut other_bins = 0;
    let rows = golden("golden_lookup.csv");
    assert_eq!(rows.len(), 400);
    for row in &rows {
        let v: Vec<f64> = row.iter().map(|x| x.parse().unwrap()).collect();
        let (wi, wo) = (DVec3::new(v[0], v[1], v[2]), DVec3::new(v[3], v[4], v[5]));
        let angles = HalfDiff::of(wo, wi).unwrap();
        assert!((angles.theta_h - v[6]).abs() < 1e-9, "{angles:?} {v:?}");
        assert!((angles.theta_d - v[7]).abs() < 1e-9, "{angles:?} {v:?}");
        let phi = angles.phi_d.rem_euclid(std::f64::consts::PI);
        assert!((phi - v[8]).abs() < 1e-7, "{angles:?} {v:?}");
        let bins = BinIndex::of(wo.as_vec3(), wi.as_vec3(), 180).unwrap();
        let expected = BinIndex { theta_h: v[9] as usize, theta_d: v[10] as usize, phi_d: v[11] as usize };
        other_bins += usize::from(bins != expected);
    }
    // The directions of the file are rounded to f32 on the way in; only pairs within that of an edge may move.
    assert!(other_bins <= 2, "{other_bins} of {} pairs in another bin", rows.len());
}

#[test]
fn bins_without_trigonometry_equal_bins_by_trigonometry() {
    let mut differ = 0;
    let pairs = 400_000;
    for (wo, wi) in support::pairs(pairs, 11) {
        for bins in [180, 360] {
            let (fast, slow) = (BinIndex::of(wo, wi, bins), naive::bins(wo, wi, bins));
            if fast != slow {
                assert!(naive::near_an_edge(wo, wi, 1e-9), "{wo} {wi}: {fast:?} {slow:?}");
                differ += 1;
            }
        }
    }
    assert!(differ < 10, "{differ} of {pairs} pairs differ");
}
