//! Tables at a few directions of `wo`: polar angles, and for anisotropic materials azimuths.

use glam::{DVec2, Vec3};

use super::azimuth_knots::AzimuthKnots;
use super::knots::{KnotPair, TableChoice, ThetaKnots};
use crate::Result;
use crate::geometry::Symmetry;

/// Directions of `wo` that have a table: every polar angle at the first azimuth, then at the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct DirectionKnots {
    pub polar: ThetaKnots,
    pub azimuths: AzimuthKnots,
    choice: TableChoice,
}

/// The tables about one `wo`: at two azimuths, two polar angles each.
#[derive(Clone, Copy, Debug)]
pub(super) struct DirectionNeighbours {
    /// `wo` among the azimuths that have tables.
    pub wo: Vec3,
    /// The mirror signs that bring `wo` there; the same bring `wi`.
    pub signs: Vec3,
    /// The polar angles, as numbers of knots.
    pub polar: KnotPair,
    /// The first table of each azimuth, to which the number of a polar angle is added.
    pub starts: [usize; 2],
    /// The direction in the plane that each azimuth has; that of `wo`, not of unit length, for an isotropic material.
    pub axes: [DVec2; 2],
    /// Weight of the second azimuth; 0 for an isotropic material.
    pub weight: f64,
}

impl DirectionKnots {
    /// `tables` polar angles, 1 to 4096, at so many azimuths as the material's symmetry and `azimuths` say.
    pub fn new(
        tables: usize,
        choice: TableChoice,
        symmetry: Symmetry,
        azimuths: Option<usize>,
    ) -> Result<Self> {
        Ok(Self {
            polar: ThetaKnots::new(tables, choice)?,
            azimuths: AzimuthKnots::new(symmetry, azimuths),
            choice,
        })
    }

    /// How many tables there are.
    pub fn count(self) -> usize {
        self.polar.count() * self.azimuths.count()
    }

    /// Polar angle and azimuth of a table, radians.
    pub fn angles(self, table: usize) -> [f64; 2] {
        let (azimuth, polar) = (table / self.polar.count(), table % self.polar.count());
        [self.polar.theta(polar), self.azimuths.azimuth(azimuth)]
    }

    /// What serves `wo`, above the horizon and of unit length.
    #[inline]
    pub fn neighbours(self, wo: Vec3) -> DirectionNeighbours {
        let around = self.azimuths.neighbours(wo);
        let axes = if self.azimuths.is_isotropic() {
            [wo.truncate().as_dvec2(); 2]
        } else {
            // The one after the last is the first again, turned by the whole range of azimuths.
            let first = self.azimuths.azimuth(around.first);
            [first, first + self.azimuths.step()].map(DVec2::from_angle)
        };
        let weight = match self.choice {
            TableChoice::Mixture => around.weight,
            TableChoice::Nearest => around.weight.round(),
        };
        DirectionNeighbours {
            wo: around.wo,
            signs: around.signs,
            polar: self.polar.neighbours(wo),
            starts: [around.first, around.second].map(|j| j * self.polar.count()),
            axes,
            weight,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::spherical;

    #[test]
    fn tables_about_a_direction_enclose_it() {
        for symmetry in [Symmetry::Quarter, Symmetry::Half, Symmetry::Whole] {
            let knots = DirectionKnots::new(10, TableChoice::Mixture, symmetry, Some(5)).unwrap();
            assert_eq!(knots.count(), 50);
            for k in 0..100 {
                let wo = spherical(0.7, f64::from(k) * 0.0631).as_vec3();
                let near = knots.neighbours(wo);
                assert_eq!(near.wo * near.signs, wo);
                // The folded direction lies between the two axes, the nearer the greater the weight.
                let angles = near.axes.map(|axis| {
                    let folded = near.wo.truncate().as_dvec2().normalize();
                    axis.dot(folded).clamp(-1.0, 1.0).acos()
                });
                let step = knots.azimuths.step();
                assert!(
                    (angles[0] - near.weight * step).abs() < 1e-5,
                    "{symmetry:?} {k}: {near:?}"
                );
                assert!(
                    (angles[0] + angles[1] - step).abs() < 1e-5,
                    "{symmetry:?} {k}"
                );
            }
        }
    }

    #[test]
    fn an_isotropic_material_has_one_azimuth() {
        let knots =
            DirectionKnots::new(4, TableChoice::Mixture, Symmetry::Isotropic, Some(9)).unwrap();
        assert_eq!(knots.count(), 4);
        let near = knots.neighbours(spherical(0.3, 2.0).as_vec3());
        assert_eq!(
            (near.weight, near.starts, near.signs),
            (0.0, [0, 0], Vec3::ONE)
        );
        assert_eq!(knots.angles(3)[1], 0.0);
    }
}
