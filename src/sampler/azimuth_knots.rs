//! Tables at a few azimuths of `wo`, for anisotropic materials, and what serves the azimuths between them.

use glam::Vec3;

use super::store::Tensors;
use super::{Field, Settings};
use crate::batch::Wo;
use crate::brdf::Brdf;
use crate::color::Rgb;
use crate::geometry::Symmetry;
use crate::{Error, Result};

/// Azimuths of `wo` that have tables where no number is given.
pub(super) const DEFAULT_AZIMUTHS: usize = 8;

/// Azimuths of `wo` that have a table: equally spaced over those that represent all others, one for an isotropic material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct AzimuthKnots {
    symmetry: Symmetry,
    count: usize,
}

/// The two azimuths about one `wo`, and `wo` among the azimuths that have tables.
#[derive(Clone, Copy, Debug)]
pub(super) struct AzimuthNeighbours {
    /// `wo`, mirrored.
    pub wo: Vec3,
    /// The mirror signs that bring `wo` there; the same bring `wi`.
    pub signs: Vec3,
    pub first: usize,
    pub second: usize,
    /// Weight of the second; 0 for an isotropic material.
    pub weight: f64,
}

impl AzimuthKnots {
    /// So many azimuths, 2 or more, or [`DEFAULT_AZIMUTHS`]; for an isotropic material there is one in any case.
    pub fn new(symmetry: Symmetry, count: Option<usize>) -> Self {
        let count = match symmetry {
            Symmetry::Isotropic => 1,
            _ => count.unwrap_or(DEFAULT_AZIMUTHS),
        };
        Self { symmetry, count }
    }

    pub fn count(self) -> usize {
        self.count
    }

    /// The number of azimuths as a setting: `None` for an isotropic material.
    pub fn setting(self) -> Option<usize> {
        (!self.is_isotropic()).then_some(self.count)
    }

    /// Whether azimuths count from `wo` instead of from the surface's x.
    pub fn is_isotropic(self) -> bool {
        self.symmetry == Symmetry::Isotropic
    }

    /// Radians between two azimuths that have a table: both ends have one where they are mirrors; elsewhere they meet.
    pub fn step(self) -> f64 {
        let steps = match self.symmetry {
            Symmetry::Quarter => self.count - 1,
            _ => self.count,
        };
        self.symmetry.span() / steps as f64
    }

    /// Azimuth `k`, radians; 0 for an isotropic material.
    pub fn azimuth(self, k: usize) -> f64 {
        match self.symmetry {
            Symmetry::Isotropic => 0.0,
            _ => Symmetry::START + self.step() * k as f64,
        }
    }

    /// What serves `wo`, above the horizon and of unit length.
    #[inline]
    pub fn neighbours(self, wo: Vec3) -> AzimuthNeighbours {
        if self.is_isotropic() {
            return AzimuthNeighbours {
                wo,
                signs: Vec3::ONE,
                first: 0,
                second: 0,
                weight: 0.0,
            };
        }
        // Step 1: mirror wo among the azimuths that have tables.
        let signs = self.symmetry.signs(wo);
        let folded = with_azimuth(wo * signs);
        // Step 2: its azimuth in steps between tables gives the table below it, and the weight of the one above.
        let azimuth = f64::from(folded.y).atan2(f64::from(folded.x)) - Symmetry::START;
        let steps = (azimuth / self.step()).max(0.0);
        // Rounding may pass the last azimuth; where they go round, behind it comes the first.
        let last = match self.symmetry {
            Symmetry::Quarter => self.count - 2,
            _ => self.count - 1,
        };
        let first = (steps as usize).min(last);
        AzimuthNeighbours {
            wo: folded,
            signs,
            first,
            second: (first + 1) % self.count,
            weight: (steps - first as f64).min(1.0),
        }
    }
}

/// Directions too near to the normal for f32 to square have the first azimuth, which every symmetry has.
fn with_azimuth(wo: Vec3) -> Vec3 {
    let near = wo.x * wo.x + wo.y * wo.y < 1e-30;
    if near {
        Vec3::new(-1e-12, -0.0, wo.z)
    } else {
        wo
    }
}

/// Directions that are turned together.
const LANES: usize = 256;

/// A BRDF turned so that an azimuth of the surface becomes 0. A table asks it for `wo` of azimuth 0 alone, where it can't be
/// told from an isotropic one.
pub(super) struct TurnedBrdf<'a> {
    brdf: &'a dyn Brdf,
    cos: f32,
    sin: f32,
}

impl<'a> TurnedBrdf<'a> {
    pub fn new(brdf: &'a dyn Brdf, azimuth: f64) -> Self {
        Self {
            brdf,
            cos: azimuth.cos() as f32,
            sin: azimuth.sin() as f32,
        }
    }

    fn on_surface(&self, w: Vec3) -> Vec3 {
        Vec3::new(
            self.cos * w.x - self.sin * w.y,
            self.sin * w.x + self.cos * w.y,
            w.z,
        )
    }
}

impl Brdf for TurnedBrdf<'_> {
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        self.brdf.eval(self.on_surface(wo), self.on_surface(wi))
    }

    fn eval_batch(&self, wo: Wo<'_>, wi: &[Vec3], out: &mut [Rgb]) {
        wo.assert_lanes(wi.len(), out.len());
        // A few at a time, without an allocation.
        let (mut given, mut sampled) = ([Vec3::ZERO; LANES], [Vec3::ZERO; LANES]);
        for start in (0..wi.len()).step_by(LANES) {
            let lanes = start..wi.len().min(start + LANES);
            let count = lanes.len();
            for (k, lane) in lanes.clone().enumerate() {
                given[k] = self.on_surface(wo.lane(lane));
                sampled[k] = self.on_surface(wi[lane]);
            }
            let turned = match wo {
                Wo::One(_) => Wo::One(given[0]),
                Wo::Each(_) => Wo::Each(&given[..count]),
            };
            self.brdf
                .eval_batch(turned, &sampled[..count], &mut out[lanes]);
        }
    }

    fn is_isotropic(&self) -> bool {
        true
    }
}

/// The setting of methods that have tables at several azimuths of `wo`.
pub(super) fn azimuths_field<S: Settings>(
    get: fn(&S) -> Option<usize>,
    set: fn(&mut S, Option<usize>),
) -> Field<S> {
    Field::optional_count(
        "azimuths",
        "auto",
        2..=256,
        "azimuths of wo that have tables, for anisotropic materials; auto is 8",
        get,
        set,
    )
}

/// Refuses azimuths for a material that needs no more than one.
///
/// # Errors
/// [`Error::Argument`] for a number of azimuths and an isotropic material.
pub(super) fn check_azimuths(azimuths: Option<usize>, symmetry: Symmetry) -> Result<()> {
    if symmetry == Symmetry::Isotropic && azimuths.is_some() {
        return Err(azimuths_of_isotropic());
    }
    Ok(())
}

/// Refuses a file whose tables are not at azimuths as the material needs them.
///
/// # Errors
/// [`Error::Invalid`] for azimuths of an isotropic material, and for none of an anisotropic one.
pub(super) fn check_stored_azimuths(
    azimuths: Option<usize>,
    symmetry: Symmetry,
    tensors: &Tensors,
) -> Result<()> {
    match (symmetry, azimuths) {
        (Symmetry::Isotropic, Some(count)) => {
            let found = format!("tables of {count} azimuths");
            Err(tensors.invalid("one table for an isotropic material", found))
        }
        (Symmetry::Isotropic, None) | (_, Some(_)) => Ok(()),
        (_, None) => Err(tensors.invalid("azimuths of an anisotropic material", "none")),
    }
}

/// The error for azimuths that an isotropic material has no use for.
pub(super) fn azimuths_of_isotropic() -> Error {
    Error::argument(
        "tables by azimuth are for anisotropic materials, and this one is isotropic",
        "leave the azimuths out: one table serves all of them",
    )
}
