//! Tables over the half-vector square: every draw reflects above the horizon, and well-spread points stay well spread.
//!
//! For a few angles of `wo`, a density over the square of [`square`]: rows over θh that end where MERL's bins end, each with a
//! probability, a slope, and a density over the azimuth that is linear between nodes. Between two angles the *probabilities*
//! are interpolated, not the choice of a table, so (u1, u2) → `wi` is one continuous map a row, which can be inverted, and
//! Owen-scrambled points keep their stratification. All tables are integers of 16 bits or less; their mixtures are exact.
//!
//! Beside the cascade CDF (thesis 5.6; Lawrence et al. 2005) it differs in the horizon, which ends the square exactly instead
//! of cutting it, and in what it does between angles.

mod azimuths;
mod batch;
mod build;
mod codec;
mod mixed;
mod mixture;
mod quantise;
mod rows;
mod settings;
mod square;
mod tables;
mod turn;

use std::f64::consts::PI;

use glam::{Vec2, Vec3};

use super::{DirectionSample, DirectionSampler, Settings};
use crate::batch::Wo;
use crate::brdf::Brdf;
use crate::geometry::unit_upper;
use crate::{Error, Result};
use mixture::{Mixture, Row, Segment, below_on_slope, find_in, find_on_slope};
use square::{Place, Square};
use tables::{Blend, Tables};

pub use azimuths::ByAzimuth;
pub(crate) use mixture::{NODE_UNIT, ROW_UNIT};
pub use settings::{HalfVector, HalfVectorSettings};
pub(crate) use square::Edge;
pub(crate) use tables::Stored;

/// The last table stands short of the horizon.
const LAST_KNOT: f64 = 89.0 / 180.0 * PI;

/// Cosines of the angles that have a table: 0° to 89°, denser towards the horizon, and the more so the fewer there are.
pub(super) fn knot_cosines(tables: usize) -> Vec<f32> {
    let steps = tables.saturating_sub(1).max(1) as f64;
    let power = if tables < 8 { 2.0 } else { 1.5 };
    (0..tables)
        .map(|k| (LAST_KNOT * (1.0 - (1.0 - k as f64 / steps).powf(power))).cos() as f32)
        .collect()
}

/// A density over the half-vector square at each of a few angles of `wo`.
#[derive(Clone, Debug)]
pub struct HalfVectorTable {
    settings: HalfVectorSettings,
    tables: Tables,
}

impl HalfVectorTable {
    /// Tabulates the isotropic `brdf` on the threads of the current pool; the result does not depend on their number.
    ///
    /// Where the BRDF is black at an angle, the table there follows the cosine.
    ///
    /// # Errors
    /// [`Error::Argument`] for settings outside their domains, or a BRDF that is not isotropic.
    pub fn build(brdf: &dyn Brdf, settings: HalfVectorSettings) -> Result<Self> {
        settings.check()?;
        if !brdf.is_isotropic() {
            return Err(Error::argument(
                "the half-vector table is for isotropic BRDFs",
                "choose another sampler",
            ));
        }
        if settings.azimuths.is_some() {
            return Err(settings::azimuths_of_isotropic());
        }
        Ok(Self::from_parts(settings, build::tables(brdf, &settings)))
    }

    /// Puts a sampler together from tables that have been validated.
    pub(super) fn from_parts(settings: HalfVectorSettings, stored: Stored) -> Self {
        Self {
            settings,
            tables: Tables::new(stored),
        }
    }

    /// The settings it was built with.
    pub fn settings(&self) -> &HalfVectorSettings {
        &self.settings
    }

    pub(crate) fn stored(&self) -> &Stored {
        self.tables.stored()
    }

    /// The point of the unit square that [`DirectionSampler::sample`] maps to `wi`, up to rounding; `None` unless both
    /// directions are above the horizon.
    pub fn invert(&self, wo: Vec3, wi: Vec3) -> Option<Vec2> {
        let (wo, wi) = (unit_upper(wo)?, unit_upper(wi)?);
        let about = self.about(Square::about(wo));
        let place = about.square.place(wi);
        let row = about.row(&place);
        let (low, width) = about.span(row.index);
        let x = position(place.cap, low, width);
        let u = row.probability(below_on_slope(about.blend.slope(row.index), x));
        let y = unit_azimuth(place.b, self.settings.fold);
        let v = refold(
            about.blend.azimuth_below(row.index, y),
            place.b,
            self.settings.fold,
        );
        Some(Vec2::new(u as f32, v as f32))
    }

    /// What depends on `wo` alone.
    #[inline]
    fn about(&self, square: Square) -> About<'_, Blend<'_>> {
        self.with(square, self.blend_at(&square))
    }

    /// The tables of the two angles about that of a square's `wo`.
    #[inline]
    pub(super) fn blend_at(&self, square: &Square) -> Blend<'_> {
        self.tables.at(square.cos_o())
    }

    #[inline(always)]
    pub(super) fn with<'a>(&'a self, square: Square, blend: Blend<'a>) -> About<'a, Blend<'a>> {
        let (segments, unit) = blend.scale();
        // The azimuth's share runs over [−1, 1]: half the density on [0, 1].
        About {
            table: self,
            square,
            blend,
            per_segment: 1.0 / segments,
            unit: 0.5 * unit,
        }
    }
}

/// The table about one `wo`. Mixing its tables beforehand halves the time of a draw and takes as long as some hundred (`cargo
/// bench --bench sample`): for large batches.
#[derive(Clone, Copy)]
pub(super) struct About<'a, M> {
    table: &'a HalfVectorTable,
    square: Square,
    blend: M,
    per_segment: f32,
    /// Unit of densities at nodes, per unit of the azimuth's share.
    unit: f32,
}

/// What a point of the unit square chooses, before arithmetic: the part of a draw that looks things up.
#[derive(Clone, Copy)]
pub(super) struct Choice {
    /// Cap where the row begins, and its width.
    low: f32,
    width: f32,
    slope: f32,
    /// Share of the row's probability.
    share: f32,
    segment: Segment,
    /// Rest of the segment's probability.
    rest: f32,
    side: f32,
}

/// What the density at a place depends on: the part that looks things up.
#[derive(Clone, Copy)]
pub(super) struct Found {
    low: f32,
    width: f32,
    slope: f32,
    mass: f32,
    segment: Segment,
    /// Position within the segment.
    share: f32,
}

impl Choice {
    #[inline(always)]
    pub(super) fn to_array(self) -> [f32; 9] {
        let Self {
            low,
            width,
            slope,
            share,
            segment,
            rest,
            side,
        } = self;
        [
            low,
            width,
            slope,
            share,
            segment.index,
            segment.low,
            segment.high,
            rest,
            side,
        ]
    }

    #[inline(always)]
    pub(super) fn from_array(
        [low, width, slope, share, index, first, second, rest, side]: [f32; 9],
    ) -> Self {
        let segment = Segment {
            index,
            low: first,
            high: second,
        };
        Self {
            low,
            width,
            slope,
            share,
            segment,
            rest,
            side,
        }
    }
}

impl Found {
    #[inline(always)]
    pub(super) fn to_array(self) -> [f32; 8] {
        let Self {
            low,
            width,
            slope,
            mass,
            segment,
            share,
        } = self;
        [
            low,
            width,
            slope,
            mass,
            segment.index,
            segment.low,
            segment.high,
            share,
        ]
    }

    #[inline(always)]
    pub(super) fn from_array(
        [low, width, slope, mass, index, first, second, share]: [f32; 8],
    ) -> Self {
        let segment = Segment {
            index,
            low: first,
            high: second,
        };
        Self {
            low,
            width,
            slope,
            mass,
            segment,
            share,
        }
    }
}

impl<M: Mixture> About<'_, M> {
    /// Where a row begins, and its width, in caps.
    #[inline(always)]
    fn span(&self, row: usize) -> (f32, f32) {
        let [low, high] = self.table.tables.edges(row);
        let low = self.square.cap(low);
        (low, self.square.cap(high) - low)
    }

    /// The row that holds a place.
    #[inline(always)]
    fn row(&self, place: &Place) -> Row {
        self.blend
            .row(self.table.tables.row_of(self.square.part(place)))
    }

    #[inline(always)]
    pub(super) fn choose(&self, u: Vec2) -> Choice {
        let (row, share) = self.blend.find_row(u.x);
        self.choose_in(row.index, share, u.y)
    }

    /// What `u` chooses in a row that is chosen at a share of its probability.
    #[inline(always)]
    pub(super) fn choose_in(&self, row: usize, share: f32, u: f32) -> Choice {
        let (low, width) = self.span(row);
        let (v, side) = unfold(u, self.table.settings.fold);
        let (segment, rest) = self.blend.find_segment(row, v);
        Choice {
            low,
            width,
            slope: self.blend.slope(row),
            share,
            segment,
            rest,
            side,
        }
    }

    /// The point of the square that was chosen: cap and azimuth.
    #[inline(always)]
    pub(super) fn point(&self, choice: Choice) -> (f32, f32) {
        let cap = choice.low + choice.width * find_on_slope(choice.slope, choice.share);
        let y = (choice.segment.index + find_in(choice.segment, choice.rest)) * self.per_segment;
        let b = if self.table.settings.fold {
            y * choice.side
        } else {
            2.0 * y - 1.0
        };
        (cap, b.clamp(-1.0, 1.0))
    }

    #[inline(always)]
    fn direction(&self, choice: Choice) -> Vec3 {
        let (cap, b) = self.point(choice);
        raise(self.square.direction(cap, b))
    }

    #[inline(always)]
    pub(super) fn find(&self, place: &Place) -> Found {
        let row = self.row(place);
        let (low, width) = self.span(row.index);
        let y = unit_azimuth(place.b, self.table.settings.fold);
        let (segment, share) = self.blend.segment_at(row.index, y);
        Found {
            low,
            width,
            slope: self.blend.slope(row.index),
            mass: row.mass(),
            segment,
            share,
        }
    }

    #[inline(always)]
    pub(super) fn density(&self, place: &Place, found: Found) -> f32 {
        let x = position(place.cap, found.low, found.width);
        let along = found.mass * (1.0 + found.slope * (2.0 * x - 1.0));
        let across = found.segment.low + (found.segment.high - found.segment.low) * found.share;
        (along * across * self.unit / (found.width * place.jacobian)).min(f32::MAX)
    }

    #[inline]
    fn pdf(&self, wi: Vec3) -> f32 {
        let place = self.square.place(wi);
        self.density(&place, self.find(&place))
    }

    #[inline]
    fn sample(&self, u: Vec2) -> DirectionSample {
        let wi = self.direction(self.choose(u));
        DirectionSample {
            wi,
            pdf: self.pdf(wi),
        }
    }
}

/// A cap's position within a row, 0 to 1.
#[inline(always)]
fn position(cap: f32, low: f32, width: f32) -> f32 {
    ((cap - low) / width).clamp(0.0, 1.0)
}

/// Directions at the very end of the square lie on the horizon; rounding may put them below it, by less than f32 tells the
/// length of a direction. They are moved to the nearest one above it.
#[inline(always)]
pub(super) fn raise(wi: Vec3) -> Vec3 {
    Vec3::new(wi.x, wi.y, wi.z.max(LOWEST))
}

/// Cosine of the lowest direction drawn.
const LOWEST: f32 = 1e-9;

/// The coordinate on [0, 1] of the azimuth's share `b` in [−1, 1]: folded at the plane of incidence, or whole.
#[inline(always)]
fn unit_azimuth(b: f32, fold: bool) -> f32 {
    if fold { b.abs() } else { 0.5 * (b + 1.0) }
}

/// A number in [0, 1) as the azimuth's probability and its side: folded, both sides meet in the middle.
#[inline(always)]
fn unfold(u: f32, fold: bool) -> (f32, f32) {
    let side = 2.0 * u - 1.0;
    if fold {
        (side.abs(), 1f32.copysign(side))
    } else {
        (u, 1.0)
    }
}

/// The inverse of [`unfold`], the side being that of `b`.
fn refold(v: f64, b: f32, fold: bool) -> f64 {
    if fold {
        0.5 + 0.5 * v.copysign(f64::from(b))
    } else {
        v
    }
}

impl DirectionSampler for HalfVectorTable {
    /// Never fails for a `wo` above the horizon.
    #[inline]
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        unit_upper(wo).map(|wo| self.about(Square::about(wo)).sample(u))
    }

    #[inline]
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        unit_upper(wo)
            .zip(unit_upper(wi))
            .map_or(0.0, |(wo, wi)| self.about(Square::about(wo)).pdf(wi))
    }

    fn bytes(&self) -> usize {
        self.tables.bytes()
    }

    #[track_caller]
    fn sample_batch(&self, wo: Wo<'_>, u: &[Vec2], out: &mut [Option<DirectionSample>]) {
        wo.assert_lanes(u.len(), out.len());
        batch::sample(self, wo, u, out);
    }

    #[track_caller]
    fn pdf_batch(&self, wo: Wo<'_>, wi: &[Vec3], out: &mut [f32]) {
        wo.assert_lanes(wi.len(), out.len());
        batch::pdf(self, wo, wi, out);
    }
}
