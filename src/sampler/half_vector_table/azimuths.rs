//! Half-vector tables for anisotropic materials: one for each of a few azimuths of `wo`.
//!
//! A `wo` between two azimuths is served by both, in proportion to nearness; the density is that of the mixture. Half vectors
//! keep their azimuth on the surface as far as the horizon allows ([`Turn`]). What the material's symmetry repeats is held once.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::settings::azimuths_of_isotropic;
use super::square::Square;
use super::tables::Stored;
use super::turn::Turn;
use super::{DirectionSample, DirectionSampler, HalfVectorSettings, HalfVectorTable};
use crate::Result;
use crate::brdf::Brdf;
use crate::color::Rgb;
use crate::geometry::{Symmetry, unit_upper};
use crate::sampler::Settings;
use crate::sampler::knots::split_unit;

/// A half-vector table for each of a few azimuths of `wo`.
#[derive(Clone, Debug)]
pub struct ByAzimuth {
    settings: HalfVectorSettings,
    symmetry: Symmetry,
    tables: Vec<HalfVectorTable>,
}

/// A table and how far `wo` is turned from its azimuth.
type Turned<'a> = (&'a HalfVectorTable, Turn);

/// What serves one `wo`: two tables and the share of the second.
struct Pair<'a> {
    /// About `wo` among the azimuths that have tables.
    square: Square,
    /// By which it came there, and `wi` with it.
    signs: Vec3,
    tables: [Turned<'a>; 2],
    share: f64,
}

impl ByAzimuth {
    /// Tabulates the anisotropic `brdf` on the threads of the current pool; the result does not depend on their number. What
    /// is tabulated is [`HalfVectorSettings::for_anisotropic`].
    ///
    /// # Errors
    /// [`Error::Argument`] for settings outside their domains, or a BRDF that is isotropic.
    pub fn build(brdf: &dyn Brdf, settings: HalfVectorSettings) -> Result<Self> {
        let symmetry = brdf.symmetry();
        if symmetry == Symmetry::Isotropic {
            return Err(azimuths_of_isotropic());
        }
        settings.check()?;
        let settings = settings.for_anisotropic();
        let count = settings.azimuths.unwrap_or(1);
        let table = HalfVectorSettings {
            azimuths: None,
            ..settings
        };
        let step = step(symmetry, count);
        let tables = (0..count)
            .into_par_iter()
            .map(|k| {
                let view = View::new(brdf, Symmetry::START + step * k as f64);
                HalfVectorTable::build(&view, table)
            })
            .collect::<Result<_>>()?;
        Ok(Self::from_parts(settings, symmetry, tables))
    }

    /// Puts a sampler together from as many tables as the settings say.
    pub(super) fn from_parts(
        settings: HalfVectorSettings,
        symmetry: Symmetry,
        tables: Vec<HalfVectorTable>,
    ) -> Self {
        Self {
            settings,
            symmetry,
            tables,
        }
    }

    pub(super) fn stored(&self) -> Vec<&Stored> {
        self.tables.iter().map(HalfVectorTable::stored).collect()
    }

    /// The settings it was built with, the number of azimuths among them.
    pub fn settings(&self) -> &HalfVectorSettings {
        &self.settings
    }

    fn pair(&self, wo: Vec3) -> Pair<'_> {
        let signs = self.symmetry.signs(wo);
        let folded = with_azimuth(wo * signs);
        let (count, step) = (self.tables.len(), step(self.symmetry, self.tables.len()));
        let azimuth = f64::from(folded.y).atan2(f64::from(folded.x)) - Symmetry::START;
        let at = (azimuth / step).max(0.0);
        // Rounding may pass the last azimuth; where they go round, behind it comes the first.
        let first = (at as usize).min(if self.symmetry == Symmetry::Quarter {
            count - 2
        } else {
            count - 1
        });
        let share = (at - first as f64).min(1.0);
        let turned = |k: usize, turns: f64| (&self.tables[k % count], Turn::by(turns * step));
        let tables = [turned(first, share), turned(first + 1, share - 1.0)];
        Pair {
            square: Square::about(folded),
            signs,
            tables,
            share,
        }
    }
}

/// Radians between two azimuths that have a table: both ends have one where they are mirrors; elsewhere they meet.
fn step(symmetry: Symmetry, count: usize) -> f64 {
    let steps = if symmetry == Symmetry::Quarter {
        count - 1
    } else {
        count
    };
    symmetry.span() / steps as f64
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

impl Pair<'_> {
    fn pdf(&self, wi: Vec3) -> f32 {
        let place = self.square.place(wi);
        let widest = self.square.widest_at(place.cap);
        let pdf = |(table, turn): Turned<'_>| {
            f64::from(table.pdf_turned(&self.square, &place, widest, turn))
        };
        let [first, second] = self.tables.map(pdf);
        (first * (1.0 - self.share) + second * self.share) as f32
    }

    fn sample(&self, u: Vec2) -> DirectionSample {
        let (second, rest) = split_unit(f64::from(u.x), self.share);
        let (table, turn) = self.tables[usize::from(second)];
        let u = Vec2::new((rest as f32).min(1f32.next_down()), u.y);
        let wi = table.draw_turned(&self.square, u, turn);
        DirectionSample {
            wi: wi * self.signs,
            pdf: self.pdf(wi),
        }
    }
}

impl DirectionSampler for ByAzimuth {
    /// Never fails for a `wo` above the horizon.
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        unit_upper(wo).map(|wo| self.pair(wo).sample(u))
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        unit_upper(wo).zip(unit_upper(wi)).map_or(0.0, |(wo, wi)| {
            let pair = self.pair(wo);
            pair.pdf(wi * pair.signs)
        })
    }

    fn bytes(&self) -> usize {
        self.tables.iter().map(DirectionSampler::bytes).sum()
    }

    fn sample_batch(&self, wo: Vec3, points: &[Vec2]) -> Vec<Option<DirectionSample>> {
        let pair = unit_upper(wo).map(|wo| self.pair(wo));
        points
            .iter()
            .map(|&u| pair.as_ref().map(|pair| pair.sample(u)))
            .collect()
    }
}

/// A BRDF turned so that an azimuth of the surface becomes 0. A table asks it for `wo` of azimuth 0 alone, where it can't be
/// told from an isotropic one.
struct View<'a> {
    brdf: &'a dyn Brdf,
    cos: f32,
    sin: f32,
}

impl<'a> View<'a> {
    fn new(brdf: &'a dyn Brdf, azimuth: f64) -> Self {
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

impl Brdf for View<'_> {
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        self.brdf.eval(self.on_surface(wo), self.on_surface(wi))
    }

    fn is_isotropic(&self) -> bool {
        true
    }
}
