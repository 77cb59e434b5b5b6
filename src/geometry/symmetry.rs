//! Turns and mirrors of both directions that leave a reflectance as it is.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::Vec3;

/// What may be done to both directions at once without changing f_r.
///
/// The example of [`Material`](crate::material::Material) asks whether a material is isotropic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Symmetry {
    /// Any turn about the normal.
    Isotropic,
    /// Mirroring x, and mirroring y: a quarter turn of azimuths of `wo` represents all of them.
    Quarter,
    /// Half a turn: the azimuths of half a turn represent all of them.
    Half,
    /// Nothing.
    Whole,
}

impl Symmetry {
    /// The first of the azimuths that represent all of them, radians.
    pub const START: f64 = -PI;

    /// The range of azimuths of `wo` that represent all of them, in radians, from [`Self::START`] on; 0 for isotropic.
    pub fn span(self) -> f64 {
        match self {
            Self::Isotropic => 0.0,
            Self::Quarter => FRAC_PI_2,
            Self::Half => PI,
            Self::Whole => TAU,
        }
    }

    /// The signs that bring `wo` among the azimuths of [`Self::span`], and `wi` with it; all 1 where any azimuth will do.
    pub fn signs(self, wo: Vec3) -> Vec3 {
        match self {
            Self::Isotropic | Self::Whole => Vec3::ONE,
            Self::Half => Vec3::new(opposite_sign(wo.y), opposite_sign(wo.y), 1.0),
            Self::Quarter => Vec3::new(opposite_sign(wo.x), opposite_sign(wo.y), 1.0),
        }
    }
}

/// −1 for positive numbers and 1 for negative ones; zeros count by their signs.
#[inline(always)]
fn opposite_sign(v: f32) -> f32 {
    if v.is_sign_negative() { 1.0 } else { -1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::spherical;

    #[test]
    fn folded_directions_stand_within_the_span() {
        for symmetry in [Symmetry::Quarter, Symmetry::Half, Symmetry::Whole] {
            for k in 0..720 {
                let wo = spherical(0.7, f64::from(k).to_radians() * 0.5 - PI).as_vec3();
                let folded = wo * symmetry.signs(wo);
                let from = f64::from(folded.y).atan2(f64::from(folded.x)) - Symmetry::START;
                assert!(
                    (0.0..=symmetry.span() + 1e-6).contains(&from),
                    "{symmetry:?} {k}: {from}"
                );
                assert_eq!(folded * symmetry.signs(wo), wo);
                assert_eq!(symmetry.signs(folded), Vec3::ONE);
            }
        }
    }
}
