//! Pairs of directions at which a fit compares two materials.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DQuat, DVec3, Vec3};
use merlkit::geometry::{reflect_about, spherical};
use merlkit::points::PointSet;

/// The largest polar angle of either direction, degrees: measurements nearer the horizon are unreliable (Ngan et al. 2005).
pub const LARGEST_ANGLE: f64 = 80.0;

/// Fixed pairs of directions, spread evenly over the axes of a MERL table: √θh, θd and φd. Half of them have half vectors
/// within 22.5° of the normal, so highlights count as they do in a sum over a table's cells.
pub(super) struct FitPairs {
    pub(super) wo: Vec<Vec3>,
    pub(super) wi: Vec<Vec3>,
    /// cosθi of each pair.
    pub(super) cos_i: Vec<f64>,
}

impl FitPairs {
    /// `count` pairs from Owen-scrambled Sobol points with `seed`. Half vectors lie in the plane y = 0 for isotropic materials
    /// and have all azimuths for others.
    pub(super) fn draw(count: usize, seed: u64, isotropic: bool) -> Self {
        let mut pairs = Self {
            wo: Vec::with_capacity(count),
            wi: Vec::with_capacity(count),
            cos_i: Vec::with_capacity(count),
        };
        let least_cosine = LARGEST_ANGLE.to_radians().cos();
        let mut index = 0;
        while pairs.wo.len() < count {
            let [wo, wi] = pair_at(PointSet::Sobol.point4(seed, index, 0), isotropic);
            index += 1;
            if wo.z >= least_cosine && wi.z >= least_cosine {
                pairs.wo.push(wo.as_vec3());
                pairs.wi.push(wi.as_vec3());
                pairs.cos_i.push(wi.z);
            }
        }
        pairs
    }

    pub(super) fn len(&self) -> usize {
        self.wo.len()
    }
}

/// The pair with θh = 90°·u², θd = 90°·v, φd = 360°·w, and φh = 360°·x for anisotropic materials.
fn pair_at([u, v, w, x]: [f32; 4], isotropic: bool) -> [DVec3; 2] {
    let theta_h = FRAC_PI_2 * f64::from(u) * f64::from(u);
    let phi_h = if isotropic { 0.0 } else { TAU * f64::from(x) };
    let difference = spherical(FRAC_PI_2 * f64::from(v), TAU * f64::from(w));
    // The difference vector is wi in the frame of the half vector: turn it about y by θh, then about z by φh.
    let turn = DQuat::from_rotation_z(phi_h) * DQuat::from_rotation_y(theta_h);
    let wi = turn * difference;
    [reflect_about(wi, spherical(theta_h, phi_h)), wi]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_above_the_horizon_and_crowd_in_the_highlight() {
        for isotropic in [true, false] {
            let pairs = FitPairs::draw(2000, 1, isotropic);
            let mut near = 0;
            for (wo, wi) in pairs.wo.iter().zip(&pairs.wi) {
                assert!(wo.z > 0.17 && wi.z > 0.17);
                near += usize::from((*wo + *wi).normalize().z > 0.98);
            }
            assert!(near > 500, "{near} of 2000 within 11° of the normal");
        }
    }
}
