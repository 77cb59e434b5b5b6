//! Tables over the half-vector square: every draw reflects above the horizon, and well-spread points stay well spread.
//!
//! For a few angles of `wo`, a density over the square of [`square`]: rows over θh that end where MERL's bins end, each with a
//! probability, a slope, and a density over the azimuth that is linear between nodes. Between two angles the *probabilities*
//! are interpolated, not the choice of a table, so (u1, u2) → `wi` is one continuous map a row, which can be inverted, and
//! Owen-scrambled points keep their stratification. All tables are integers of 16 bits or less; their mixtures are exact.
//!
//! Beside the cascade CDF (thesis 5.6; Lawrence et al. 2005) it differs in the horizon, which ends the square exactly instead
//! of cutting it, and in what it does between angles.

mod build;
mod rows;
mod square;
mod tables;

use std::f64::consts::PI;

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::{DirectionSample, DirectionSampler};
use crate::brdf::{Brdf, Importance};
use crate::geom::is_upper;
use crate::{Error, Result};
use square::{PARTS, Square};
use tables::{below_on_slope, find_on_slope};

pub(super) use square::{MERL_PARTS, PARTS as SQUARE_PARTS};
pub(super) use tables::{NODE_SUM, ONE, STEEPEST, Tables};

/// Settings of [`HalfVectorTable::build`].
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct HalfVectorSettings {
    /// Tables over the polar angle of `wo`, dense towards the horizon, 1 to 1024.
    pub tables: usize,
    /// Rows over θh, 2 to 79. They are put where the material asks for them; with 79, every bin of MERL below 44° has its own.
    pub rows: usize,
    /// Segments over the azimuth, each linear, 1 to 256.
    pub segments: usize,
    /// One side of the plane of incidence stands for both: half the bytes, and as much as the two differ is lost.
    pub fold: bool,
    /// The scalar that draws are proportional to.
    pub importance: Importance,
}

impl Default for HalfVectorSettings {
    fn default() -> Self {
        Self::PRESETS[5].1
    }
}

impl HalfVectorSettings {
    /// Settings by the size of their tables, smallest first: name and settings.
    pub const PRESETS: [(&str, Self); 8] = [
        ("2KB", Self::preset(6, 30, 3, true)),
        ("4KB", Self::preset(9, 38, 3, true)),
        ("8KB", Self::preset(14, 45, 3, true)),
        ("16KB", Self::preset(16, 69, 5, true)),
        ("32KB", Self::preset(16, 71, 12, false)),
        ("64KB", Self::preset(24, 71, 16, false)),
        ("256KB", Self::preset(48, 75, 32, false)),
        ("1MB", Self::preset(94, 79, 64, false)),
    ];

    const fn preset(tables: usize, rows: usize, segments: usize, fold: bool) -> Self {
        Self { tables, rows, segments, fold, importance: Importance::Mean }
    }

    /// Bytes of the tables.
    pub fn bytes(&self) -> usize {
        let row = 3 + 2 * (self.segments + 1);
        self.tables * (4 + self.rows * row) + 2 * (self.rows + 1)
    }

    /// # Errors
    /// [`Error::Argument`] for a number outside its domain.
    pub(super) fn check(&self) -> Result<()> {
        for (name, value, range) in [
            ("tables", self.tables, 1..=1024),
            ("rows", self.rows, 2..=PARTS),
            ("segments", self.segments, 1..=256),
        ] {
            if !range.contains(&value) {
                return Err(Error::argument(
                    format!("{value} {name}"),
                    format!("choose {} to {}", range.start(), range.end()),
                ));
            }
        }
        Ok(())
    }
}

/// The last table stands short of the horizon.
const LAST_KNOT: f64 = 89.0 / 180.0 * PI;

/// Cosines of the angles that have a table: 0° to 89°, denser towards the horizon, and the more so the fewer there are.
pub(super) fn knot_cosines(tables: usize) -> Vec<f32> {
    let steps = tables.saturating_sub(1).max(1) as f64;
    let power = if tables < 8 { 2.0 } else { 1.5 };
    (0..tables).map(|k| (LAST_KNOT * (1.0 - (1.0 - k as f64 / steps).powf(power))).cos() as f32).collect()
}

/// A density over the half-vector square at each of a few angles of `wo`.
#[derive(Clone, Debug)]
pub struct HalfVectorTable {
    settings: HalfVectorSettings,
    tables: Tables,
    /// The row that holds each part of the square.
    row_of: [u8; PARTS],
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
        Ok(Self::from_parts(settings, build::tables(brdf, &settings)))
    }

    /// Puts a sampler together from tables that have been validated.
    pub(super) fn from_parts(settings: HalfVectorSettings, tables: Tables) -> Self {
        let row = |part: usize| tables.edges[1..].partition_point(|&e| usize::from(e) <= part) as u8;
        let row_of = std::array::from_fn(row);
        Self { settings, tables, row_of }
    }

    /// The settings it was built with.
    pub fn settings(&self) -> &HalfVectorSettings {
        &self.settings
    }

    pub(super) fn tables(&self) -> &Tables {
        &self.tables
    }

    /// The point of the unit square that [`DirectionSampler::sample`] maps to `wi`, up to rounding; `None` unless both
    /// directions are above the horizon.
    pub fn invert(&self, wo: Vec3, wi: Vec3) -> Option<Vec2> {
        if !is_upper(wo) || !is_upper(wi) {
            return None;
        }
        let about = self.about(wo);
        let place = about.square.place(wi);
        let row = about.blend.row(usize::from(self.row_of[place.part]));
        let x = about.position(row.row, place.cap);
        let u = row.below + row.mass * below_on_slope(about.blend.slope(row.row), x);
        let v = about.blend.azimuth_below(row.row, unit_azimuth(place.b, self.settings.fold));
        Some(DVec2::new(u, refold(v, place.b, self.settings.fold)).as_vec2())
    }

    /// What depends on `wo` alone.
    #[inline]
    fn about(&self, wo: Vec3) -> About<'_> {
        let square = Square::about(wo);
        About { table: self, square, blend: self.tables.at(square.cos_o()) }
    }
}

/// The table about one `wo`.
struct About<'a> {
    table: &'a HalfVectorTable,
    square: Square,
    blend: tables::Blend<'a>,
}

impl About<'_> {
    /// Caps at the edges of a row.
    #[inline]
    fn edges(&self, row: usize) -> (f64, f64) {
        let edge = |i: usize| self.square.edge(usize::from(self.table.tables.edges[i]));
        (edge(row), edge(row + 1))
    }

    /// A cap's position within a row, 0 to 1.
    #[inline]
    fn position(&self, row: usize, cap: f64) -> f64 {
        let (low, high) = self.edges(row);
        ((cap - low) / (high - low)).clamp(0.0, 1.0)
    }

    #[inline]
    fn draw(&self, u: Vec2) -> DVec3 {
        let fold = self.table.settings.fold;
        let row = self.blend.find_row(f64::from(u.x));
        let share = ((f64::from(u.x) - row.below) / row.mass).clamp(0.0, 1.0);
        let x = find_on_slope(self.blend.slope(row.row), share);
        let (low, high) = self.edges(row.row);
        let (v, side) = unfold(f64::from(u.y), fold);
        let y = self.blend.find_azimuth(row.row, v);
        let b = if fold { y * side } else { 2.0 * y - 1.0 };
        self.square.direction(low + (high - low) * x, b)
    }

    #[inline]
    fn density(&self, wi: Vec3) -> f32 {
        let place = self.square.place(wi);
        let row = usize::from(self.table.row_of[place.part]);
        let (low, high) = self.edges(row);
        let width = high - low;
        let x = ((place.cap - low) / width).clamp(0.0, 1.0);
        let along = self.blend.row(row).mass * (1.0 + self.blend.slope(row) * (2.0 * x - 1.0));
        let across = self.blend.azimuth_density(row, unit_azimuth(place.b, self.table.settings.fold));
        // The azimuth's share runs over [−1, 1]: half the density on [0, 1].
        (0.5 * along * across / (width * place.jacobian)).min(f64::from(f32::MAX)) as f32
    }

    #[inline]
    fn sample(&self, u: Vec2) -> DirectionSample {
        let wi = raise(self.draw(u).as_vec3());
        DirectionSample { wi, pdf: self.density(wi) }
    }
}

/// Directions at the very end of the square lie on the horizon; rounding may put them below it, by less than f32 tells the
/// length of a direction. They are moved to the nearest one above it.
#[inline]
fn raise(wi: Vec3) -> Vec3 {
    Vec3::new(wi.x, wi.y, wi.z.max(LOWEST))
}

/// Cosine of the lowest direction drawn.
const LOWEST: f32 = 1e-9;

/// The coordinate on [0, 1] of the azimuth's share `b` in [−1, 1]: folded at the plane of incidence, or whole.
#[inline]
fn unit_azimuth(b: f64, fold: bool) -> f64 {
    if fold { b.abs() } else { 0.5 * (b + 1.0) }
}

/// A number in [0, 1) as the azimuth's probability and its side: folded, both sides meet in the middle.
#[inline]
fn unfold(u: f64, fold: bool) -> (f64, f64) {
    let side = 2.0 * u - 1.0;
    if fold { (side.abs(), 1f64.copysign(side)) } else { (u, 1.0) }
}

/// The inverse of [`unfold`], the side being that of `b`.
fn refold(v: f64, b: f64, fold: bool) -> f64 {
    if fold { 0.5 + 0.5 * v.copysign(b) } else { v }
}

impl DirectionSampler for HalfVectorTable {
    /// Never fails for a `wo` above the horizon.
    #[inline]
    fn sample(&self, wo: Vec3, u: Vec2) -> Option<DirectionSample> {
        is_upper(wo).then(|| self.about(wo).sample(u))
    }

    #[inline]
    fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if is_upper(wo) && is_upper(wi) { self.about(wo).density(wi) } else { 0.0 }
    }

    fn bytes(&self) -> usize {
        self.tables.bytes()
    }

    fn sample_batch(&self, wo: Vec3, points: &[Vec2]) -> Vec<Option<DirectionSample>> {
        if !is_upper(wo) {
            return vec![None; points.len()];
        }
        let about = self.about(wo);
        points.iter().map(|&u| Some(about.sample(u))).collect()
    }
}
