//! A draw, a density and the inverse of a draw, in the order of the numbered steps of `docs/half-vector-table.md`.
//!
//! Each is two halves: one looks things up ([`DrawTerms`], [`DensityTerms`]), the other is arithmetic without branches, so that
//! batches ([`super::batch`]) can do each half over many lanes.

use glam::{Vec2, Vec3};

use super::super::tables::IndexedTables;
use super::super::tables::lookup::{
    AzimuthSegment, InterpolatedRow, InterpolatedTable, invert_segment, invert_slope, slope_cdf,
};
use super::pair::TablePair;
use crate::direction_sampler::DirectionSample;
use crate::geometry::half_vector_chart::{ChartPoint, HalfVectorChart};

/// Cosine of the lowest direction drawn.
const LOWEST_COSINE: f32 = 1e-9;

/// A table about one `wo`: the chart of its half vectors, and the table interpolated to its polar angle.
#[derive(Clone, Copy)]
pub(in crate::sampler) struct TableView<'a, M> {
    tables: &'a IndexedTables,
    pub(in crate::sampler) chart: HalfVectorChart,
    pub(in crate::sampler) interpolated: M,
    /// Length of a segment on the azimuth's [0, 1].
    per_segment: f32,
    /// Unit of densities at nodes, per unit of the azimuth fraction.
    density_unit: f32,
}

/// What a point of the unit square chooses, before arithmetic: the half of a draw that looks things up.
#[derive(Clone, Copy)]
pub(in crate::sampler) struct DrawTerms {
    /// Cap where the row begins, and its width.
    low: f32,
    width: f32,
    slope: f32,
    /// Fraction of the row's probability that lies below the draw.
    fraction: f32,
    segment: AzimuthSegment,
    /// Probability left within the segment, in units of nodes.
    rest: f32,
    /// Side of the plane of incidence, 1 or −1.
    side: f32,
}

/// What the density at a point depends on: the half that looks things up.
#[derive(Clone, Copy)]
pub(in crate::sampler) struct DensityTerms {
    /// Cap where the row begins, and its width.
    pub(in crate::sampler) low: f32,
    pub(in crate::sampler) width: f32,
    pub(in crate::sampler) slope: f32,
    /// The row's probability.
    pub(in crate::sampler) mass: f32,
    pub(in crate::sampler) segment: AzimuthSegment,
    /// Position within the segment, 0 to 1.
    pub(in crate::sampler) position: f32,
}

impl DrawTerms {
    /// Its numbers, for columns of many.
    #[inline(always)]
    pub(in crate::sampler) fn to_array(self) -> [f32; 9] {
        [
            self.low,
            self.width,
            self.slope,
            self.fraction,
            self.segment.index,
            self.segment.low,
            self.segment.high,
            self.rest,
            self.side,
        ]
    }

    /// The inverse of [`Self::to_array`].
    #[inline(always)]
    pub(in crate::sampler) fn from_array(
        [
            low,
            width,
            slope,
            fraction,
            index,
            first,
            second,
            rest,
            side,
        ]: [f32; 9],
    ) -> Self {
        let segment = AzimuthSegment {
            index,
            low: first,
            high: second,
        };
        Self {
            low,
            width,
            slope,
            fraction,
            segment,
            rest,
            side,
        }
    }
}

impl DrawTerms {
    /// The coordinates in the chart that were chosen: cap and azimuth fraction.
    #[inline(always)]
    fn chart_coordinates(&self, per_segment: f32, fold: bool) -> (f32, f32) {
        // Steps 8 and 9: x in the row by the density 1 + slope·(2x − 1), and cap = low + width·x.
        let cap = self.low + self.width * invert_slope(self.slope, self.fraction);
        // Step 13: y = (k + position in segment k)/S.
        let y = (self.segment.index + invert_segment(self.segment, self.rest)) * per_segment;
        // Step 14: β = 2y − 1, or y with the side's sign if folded.
        let azimuth_fraction = if fold { y * self.side } else { 2.0 * y - 1.0 };
        (cap, azimuth_fraction.clamp(-1.0, 1.0))
    }

    /// Steps 8 to 17: the direction that was chosen.
    #[inline(always)]
    pub(in crate::sampler) fn direction(
        &self,
        chart: &HalfVectorChart,
        per_segment: f32,
        fold: bool,
    ) -> Vec3 {
        let (cap, azimuth_fraction) = self.chart_coordinates(per_segment, fold);
        raise_above_horizon(chart.direction(cap, azimuth_fraction))
    }
}

impl DensityTerms {
    /// Its numbers, for columns of many.
    #[inline(always)]
    pub(in crate::sampler) fn to_array(self) -> [f32; 8] {
        [
            self.low,
            self.width,
            self.slope,
            self.mass,
            self.segment.index,
            self.segment.low,
            self.segment.high,
            self.position,
        ]
    }

    /// The inverse of [`Self::to_array`].
    #[inline(always)]
    pub(in crate::sampler) fn from_array(
        [low, width, slope, mass, index, first, second, position]: [f32; 8],
    ) -> Self {
        let segment = AzimuthSegment {
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
            position,
        }
    }
}

impl<'a> TableView<'a, TablePair<'a>> {
    /// The table about the `wo` of a chart (step 4).
    #[inline(always)]
    pub(in crate::sampler) fn new(tables: &'a IndexedTables, chart: HalfVectorChart) -> Self {
        Self::from_pair(chart, tables.interpolate(chart.cos_o()))
    }

    /// The same where the tables of the two polar angles about that of `wo` are known.
    #[inline(always)]
    pub(in crate::sampler) fn from_pair(chart: HalfVectorChart, pair: TablePair<'a>) -> Self {
        Self {
            tables: pair.tables,
            chart,
            interpolated: pair,
            per_segment: pair.tables.per_segment(),
            density_unit: pair.tables.density_unit(),
        }
    }

    /// The same view with the two tables mixed beforehand.
    pub(in crate::sampler) fn with_premixed<M>(&self, premixed: M) -> TableView<'a, M> {
        TableView {
            tables: self.tables,
            chart: self.chart,
            interpolated: premixed,
            per_segment: self.per_segment,
            density_unit: self.density_unit,
        }
    }
}

impl<M: InterpolatedTable> TableView<'_, M> {
    /// Step 5: cap where a row begins, and its width.
    #[inline(always)]
    fn row_span(&self, row: usize) -> (f32, f32) {
        let [low, high] = self.tables.edges(row);
        let low = self.chart.edge_cap(low);
        (low, self.chart.edge_cap(high) - low)
    }

    /// Step 19: the row that holds a point.
    #[inline(always)]
    fn find_row(&self, point: &ChartPoint) -> InterpolatedRow {
        let part = self.chart.find_part(point);
        self.interpolated.row(self.tables.row_of_part(part))
    }

    /// Looks up what a point of the unit square chooses.
    #[inline(always)]
    pub(in crate::sampler) fn look_up_draw(&self, u: Vec2) -> DrawTerms {
        // Steps 7 and 8: the row in which the probability passes u1, and the fraction of it below u1.
        let (row, fraction) = self.interpolated.find_row(u.x);
        self.look_up_draw_in_row(row.index, fraction, u.y)
    }

    /// The same where the row is chosen, at a fraction of its probability.
    #[inline(always)]
    pub(in crate::sampler) fn look_up_draw_in_row(
        &self,
        row: usize,
        fraction: f32,
        u: f32,
    ) -> DrawTerms {
        let (low, width) = self.row_span(row);
        // Step 10: v = u2, or |2·u2 − 1| and its sign if folded.
        let (v, side) = unfold(u, self.tables.fold());
        // Steps 11 to 13: the segment in which the azimuth's probability passes v, and what is left of it.
        let (segment, rest) = self.interpolated.find_segment(row, v);
        DrawTerms {
            low,
            width,
            slope: self.interpolated.slope(row),
            fraction,
            segment,
            rest,
            side,
        }
    }

    /// The coordinates in the chart that were chosen: cap and azimuth fraction.
    #[inline(always)]
    pub(in crate::sampler) fn chart_coordinates(&self, terms: DrawTerms) -> (f32, f32) {
        terms.chart_coordinates(self.per_segment, self.tables.fold())
    }

    /// Steps 8 to 17: the direction that was chosen.
    #[inline(always)]
    pub(in crate::sampler) fn direction(&self, terms: DrawTerms) -> Vec3 {
        terms.direction(&self.chart, self.per_segment, self.tables.fold())
    }

    /// Looks up what the density at a point depends on.
    #[inline(always)]
    pub(in crate::sampler) fn look_up_density(&self, point: &ChartPoint) -> DensityTerms {
        // Step 19: the row.
        let row = self.find_row(point);
        let (low, width) = self.row_span(row.index);
        // Step 21: y = (β + 1)/2, or |β| if folded; its segment k, and the position in it.
        let y = unit_azimuth(point.azimuth_fraction, self.tables.fold());
        let (segment, position) = self.interpolated.locate_segment(row.index, y);
        DensityTerms {
            low,
            width,
            slope: self.interpolated.slope(row.index),
            mass: row.probability(),
            segment,
            position,
        }
    }

    /// The density per solid angle at a point, sr⁻¹.
    #[inline(always)]
    pub(in crate::sampler) fn density(&self, point: &ChartPoint, terms: DensityTerms) -> f32 {
        density(point, &terms, self.density_unit)
    }

    /// Steps 18 to 22.
    #[inline(always)]
    pub(in crate::sampler) fn pdf(&self, wi: Vec3) -> f32 {
        let point = self.chart.locate(wi);
        self.density(&point, self.look_up_density(&point))
    }

    /// Steps 7 to 22.
    #[inline(always)]
    pub(in crate::sampler) fn sample(&self, u: Vec2) -> DirectionSample {
        let wi = self.direction(self.look_up_draw(u));
        DirectionSample {
            wi,
            pdf: self.pdf(wi),
        }
    }

    /// Steps 18 to 21, then 23 and 24: the point of the unit square that is drawn as `wi`.
    pub(in crate::sampler) fn invert(&self, wi: Vec3) -> Vec2 {
        let fold = self.tables.fold();
        let point = self.chart.locate(wi);
        let row = self.find_row(&point);
        let (low, width) = self.row_span(row.index);
        // Step 23: u1 = probability below the row, and of the row x·(1 − slope + slope·x).
        let x = row_position(point.cap, low, width);
        let u1 = row.cdf(slope_cdf(self.interpolated.slope(row.index), x));
        // Step 24: u2 = probability of the azimuths below y, on the side of β if folded.
        let y = unit_azimuth(point.azimuth_fraction, fold);
        let v = self.interpolated.azimuth_cdf(row.index, y);
        let u2 = refold(v, point.azimuth_fraction, fold);
        Vec2::new(u1 as f32, u2 as f32)
    }
}

/// The density per solid angle at a point, sr⁻¹; `unit` is that of densities at nodes, per unit of the azimuth fraction.
#[inline(always)]
pub(in crate::sampler) fn density(point: &ChartPoint, terms: &DensityTerms, unit: f32) -> f32 {
    // Step 19: x, the position of the cap within the row.
    let x = row_position(point.cap, terms.low, terms.width);
    // Step 22: along = mass·(1 + slope·(2x − 1)), across = n0·(1 − f) + n1·f, and
    //          pdf = along·across·unit/(width·dσ(wi) per coordinates).
    let along = terms.mass * (1.0 + terms.slope * (2.0 * x - 1.0));
    let across = terms.segment.low + (terms.segment.high - terms.segment.low) * terms.position;
    (along * across * unit / (terms.width * point.jacobian)).min(f32::MAX)
}

/// Step 19: a cap's position within a row, 0 to 1.
#[inline(always)]
fn row_position(cap: f32, low: f32, width: f32) -> f32 {
    ((cap - low) / width).clamp(0.0, 1.0)
}

/// Step 17: directions at the very end of the chart lie on the horizon, and rounding may put them below it, by less than f32
/// resolves of the length of a direction. They become the nearest direction above it.
#[inline(always)]
pub(in crate::sampler) fn raise_above_horizon(wi: Vec3) -> Vec3 {
    Vec3::new(wi.x, wi.y, wi.z.max(LOWEST_COSINE))
}

/// Step 21: the coordinate on [0, 1] of an azimuth fraction in [−1, 1], folded at the plane of incidence or whole.
#[inline(always)]
pub(in crate::sampler) fn unit_azimuth(azimuth_fraction: f32, fold: bool) -> f32 {
    if fold {
        azimuth_fraction.abs()
    } else {
        0.5 * (azimuth_fraction + 1.0)
    }
}

/// Step 10: a number in [0, 1) as the azimuth's probability and its side; folded, both sides meet in the middle.
#[inline(always)]
pub(in crate::sampler) fn unfold(u: f32, fold: bool) -> (f32, f32) {
    let side = 2.0 * u - 1.0;
    if fold {
        (side.abs(), 1f32.copysign(side))
    } else {
        (u, 1.0)
    }
}

/// Step 24: the inverse of [`unfold`], the side being that of the azimuth fraction.
fn refold(v: f64, azimuth_fraction: f32, fold: bool) -> f64 {
    if fold {
        0.5 + 0.5 * v.copysign(f64::from(azimuth_fraction))
    } else {
        v
    }
}
